#include "exchange/messages/cdr.h"

#include <simvis/error.h>

namespace simvis::ros {

namespace {

// The middle of the encapsulation is the representation, its end says how many bytes of padding follow the message.
constexpr std::size_t kRepresentationBytes = 2, kMaxPadding = 3;

}  // namespace

CdrDecoder::CdrDecoder(std::string_view bytes, std::string_view type) : type_(type) {
  if (bytes.size() < kEncapsulation.size()) fail("has no encapsulation");
  if (bytes.substr(0, kRepresentationBytes) != kEncapsulation.substr(0, kRepresentationBytes)) {
    fail("has another encapsulation, expected little-endian CDR");
  }
  body_ = bytes.substr(kEncapsulation.size());
}

void CdrDecoder::read(std::string& text) {
  std::uint32_t size = 0;
  read(size);
  require(size, 1);
  text.clear();
  if (size == 0) return;  // some encoders write an empty text so
  const char* const data = take(size);
  if (data[size - 1] != '\0') fail("a text does not end with zero");
  text.assign(data, size - 1);
}

void CdrDecoder::finish() const {
  const std::size_t left = body_.size() - at_;
  if (left > kMaxPadding) fail(std::to_string(left) + " bytes are left behind the last field");
}

void CdrDecoder::align(std::size_t size) {
  const std::size_t padding = (std::size_t{0} - at_) & (size - 1);
  take(padding);
}

bool CdrDecoder::read_bool() {
  const char byte = *take(1);
  if (byte != 0 && byte != 1) fail("a truth value is neither 0 nor 1");
  return byte == 1;
}

const char* CdrDecoder::take(std::size_t size) {
  require(size, 1);
  const char* const data = body_.data() + at_;
  at_ += size;
  return data;
}

void CdrDecoder::require(std::size_t count, std::size_t size) const {
  const std::size_t left = body_.size() - at_;
  if (count <= left / size) return;
  fail("needs " + std::to_string(count * size) + " bytes, but " + std::to_string(left) + " are left");
}

void CdrDecoder::fail(const std::string& what) const {
  throw InputError("message " + std::string(type_) + ", byte " + std::to_string(at_) + ": " + what);
}

}  // namespace simvis::ros
