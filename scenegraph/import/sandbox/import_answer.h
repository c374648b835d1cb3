// What an import program answers: messages as they come, and at last a scene or the reason why there is none.
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
  error = 'E',    ///< what a library reported as an error, and went on
  warning = 'W',  ///< the same as a warning
  refusal = 'R',  ///< why the file cannot be read
  scene = 'S'     ///< pack_imported_scene()
};

/// Messages beyond this are dropped.
inline constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 10;

/// The program's side.
class AnswerWriter {
 public:
  explicit AnswerWriter(int descriptor);
  /// Written at once, so that it outlives a crash. Ends the process when nobody takes it.
  void add(AnswerKind kind, std::span<const std::uint8_t> bytes);
  void add(AnswerKind kind, std::string_view text);

 private:
  int descriptor_;
  std::size_t message_bytes_ = 0;
};

/// SimVis's side.
struct ImportAnswer {
  std::vector<std::string> errors, warnings;           ///< on one line each, valid UTF-8, none twice
  std::optional<std::string> refusal;                  ///< on one line; it may name the file, in whatever encoding
  std::optional<std::span<const std::uint8_t>> scene;  ///< within the bytes that were read
};

/// Takes what is whole of an answer: a program that crashed leaves an end that is not. Trusts nothing in it.
ImportAnswer read_import_answer(std::span<const std::uint8_t> bytes);

}  // namespace simvis
