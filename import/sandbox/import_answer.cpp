#include "import/sandbox/import_answer.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <functional>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "scenegraph/language/control_characters.h"
#include "scenegraph/language/source_text.h"

namespace simvis {
namespace {

// Sixteen bytes that must change with the layout of a scene, so that the answer of a program of another version is
// refused and not misread.
constexpr std::string_view kGreeting = "simvis-import-5\n";
constexpr std::size_t kHeadBytes = 1 + sizeof(std::uint64_t);

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

using MessageHead = std::array<std::uint8_t, kHeadBytes>;

MessageHead head_of(AnswerKind kind, std::uint64_t size) {
  MessageHead head;
  head[0] = static_cast<std::uint8_t>(kind);
  std::memcpy(head.data() + 1, &size, sizeof size);
  return head;
}

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

bool is_utf8(const std::string& text) {
  try {
    [[maybe_unused]] const SourceText checked(text, {});
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// Libraries quote any bytes of the file, so the text may be invalid UTF-8 or contain control characters.
std::string printable(std::span<const std::uint8_t> bytes) {
  std::string text = on_one_line({bytes.begin(), bytes.end()});
  if (!is_utf8(text)) std::replace_if(text.begin(), text.end(), std::not_fn(is_ascii), '?');
  return text;
}

void add_once(std::vector<std::string>& texts, std::string text) {
  if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(std::move(text));
}

}  // namespace

std::vector<std::uint8_t> packed_message(AnswerKind kind, std::string_view text) {
  const MessageHead head = head_of(kind, text.size());
  std::vector<std::uint8_t> message(head.begin(), head.end());
  message.insert(message.end(), text.begin(), text.end());
  return message;
}

void write_answer(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) ::_exit(1);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

AnswerWriter::AnswerWriter(int descriptor) : descriptor_(descriptor) { write_answer(descriptor_, bytes_of(kGreeting)); }

void AnswerWriter::add(AnswerKind kind, std::span<const std::uint8_t> bytes) {
  if (kind == AnswerKind::error || kind == AnswerKind::warning || kind == AnswerKind::input) {
    if (message_bytes_ + bytes.size() > kMaxMessageBytes) return;
    message_bytes_ += bytes.size();
  }
  write_answer(descriptor_, head_of(kind, bytes.size()));
  write_answer(descriptor_, bytes);
}

void AnswerWriter::begin(AnswerKind kind, std::uint64_t size) { write_answer(descriptor_, head_of(kind, size)); }

void AnswerWriter::write(std::span<const std::uint8_t> bytes) { write_answer(descriptor_, bytes); }

void AnswerWriter::add(AnswerKind kind, std::string_view text) { add(kind, bytes_of(text)); }

ImportAnswer read_import_answer(std::span<const std::uint8_t> bytes) {
  ImportAnswer answer;
  const auto greeting = bytes_of(kGreeting);
  if (bytes.size() < greeting.size() || !std::equal(greeting.begin(), greeting.end(), bytes.begin())) return answer;
  bytes = bytes.subspan(greeting.size());
  std::size_t message_bytes = 0;
  while (bytes.size() >= kHeadBytes) {
    const auto kind = static_cast<AnswerKind>(bytes[0]);
    const auto size = binary_at<std::uint64_t>(bytes, 1);
    bytes = bytes.subspan(kHeadBytes);
    if (size > bytes.size()) break;
    const std::span<const std::uint8_t> content = bytes.first(size);
    bytes = bytes.subspan(size);
    if (kind == AnswerKind::scene) {
      answer.scene = content;
      continue;
    }
    message_bytes += content.size();
    if (message_bytes > kMaxMessageBytes) continue;
    if (kind == AnswerKind::error) add_once(answer.errors, printable(content));
    if (kind == AnswerKind::warning) add_once(answer.warnings, printable(content));
    if (kind == AnswerKind::input) answer.inputs.emplace_back(content.begin(), content.end());
    if (kind == AnswerKind::refusal) answer.refusal = on_one_line({content.begin(), content.end()});
    if (kind == AnswerKind::machine) answer.machine_fault = on_one_line({content.begin(), content.end()});
  }
  return answer;
}

}  // namespace simvis
