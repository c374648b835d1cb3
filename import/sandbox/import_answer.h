// The answer of an import program: messages during the import, then a scene or the reason why there is none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

enum class AnswerKind : std::uint8_t {
  error = 'E',    ///< an error that a library reported before it continued
  warning = 'W',  ///< a warning that a library reported
  refusal = 'R',  ///< the reason why the file is broken
  machine = 'M',  ///< the reason why the machine cannot read the file, broken or not
  input = 'I',    ///< the name of a file that was read
  scene = 'S'     ///< pack_imported_scene()
};

/// The largest total size of all messages. Further messages are dropped.
inline constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 10;

/// A message as it stands in an answer.
std::vector<std::uint8_t> packed_message(AnswerKind kind, std::string_view text);

/// Writes all bytes. Allocates nothing. Ends the process if the other side has closed the pipe.
void write_answer(int descriptor, std::span<const std::uint8_t> bytes);

/// The import program's side.
class AnswerWriter {
 public:
  explicit AnswerWriter(int descriptor);
  /// Writes the message at once, so that it survives a crash. Ends the process if the other side has closed the pipe.
  void add(AnswerKind kind, std::span<const std::uint8_t> bytes);
  void add(AnswerKind kind, std::string_view text);
  /// Begins a message of `size` bytes, which come by write().
  void begin(AnswerKind kind, std::uint64_t size);
  void write(std::span<const std::uint8_t> bytes);

 private:
  int descriptor_;
  std::size_t message_bytes_ = 0;
};

/// SimVis's side.
struct ImportAnswer {
  std::vector<std::string> errors, warnings;           ///< one line each, valid UTF-8, without duplicates
  std::vector<std::string> inputs;                     ///< names of files, in any encoding
  std::optional<std::string> refusal;                  ///< one line; may name the file, in any encoding
  std::optional<std::string> machine_fault;            ///< the same
  std::optional<std::span<const std::uint8_t>> scene;  ///< points into the bytes that were read
};

/// Reads the complete messages of an answer. A program that crashed may leave an incomplete one at the end. The bytes
/// are not trusted.
ImportAnswer read_import_answer(std::span<const std::uint8_t> bytes);

}  // namespace simvis
