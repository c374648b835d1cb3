#include "import/programs/decode/pnm_picture.h"

#include <algorithm>

#include <simvis/error.h>
#include "import/mesh/stb_picture.h"
#include "import/mesh/stb_stream.h"

namespace simvis {
namespace {

class PnmReader {
 public:
  PnmReader(std::span<const std::uint8_t> bytes, const std::string& subject) : bytes_(bytes), subject_(subject) {
    is_text_ = bytes_[1] == '2' || bytes_[1] == '3';
    channels_ = bytes_[1] == '2' || bytes_[1] == '5' ? 1 : 3;
  }

  Texture read() {
    const std::uint32_t width = header_number(), height = header_number();
    check_picture_size(width, height, subject_);
    largest_ = header_number();
    if (largest_ < 1 || largest_ > 65535) fail("has a broken header");
    ++at_;  // one blank, and then the pixels
    const std::size_t pixels = std::size_t{width} * height, sample_bytes = is_text_ || largest_ > 255 ? 2 : 1;
    const std::size_t least = pixels * channels_ * sample_bytes - (is_text_ ? 1 : 0);
    if (at_ > bytes_.size() || bytes_.size() - at_ < least) fail(kPictureEndsEarly);
    Texture texture;
    texture.width = width;
    texture.height = height;
    texture.rgba.assign(4 * pixels, 255);
    for (std::size_t i = 0; i < pixels; ++i) read_pixel(&texture.rgba[4 * i]);
    return texture;
  }

 private:
  [[noreturn]] void fail(const char* what) const { throw InputError(subject_ + " " + what); }

  void read_pixel(std::uint8_t* rgba) {
    for (std::size_t c = 0; c < channels_; ++c) rgba[c] = read_sample();
    if (channels_ == 1) rgba[1] = rgba[2] = rgba[0];
  }

  std::uint8_t read_sample() {
    std::uint32_t value = 0;
    if (is_text_) {
      value = next_number(kPictureEndsEarly);
    } else {
      value = bytes_[at_++];
      if (largest_ > 255) value = value << 8 | bytes_[at_++];
    }
    return static_cast<std::uint8_t>((std::min(value, largest_) * 255 + largest_ / 2) / largest_);
  }

  std::uint32_t header_number() { return next_number("has a broken header"); }

  // The next number behind blanks and comments.
  std::uint32_t next_number(const char* otherwise) {
    skip_blanks();
    if (at_ >= bytes_.size() || !is_digit(bytes_[at_])) fail(otherwise);
    std::uint32_t number = 0;
    for (; at_ < bytes_.size() && is_digit(bytes_[at_]); ++at_) {
      number = std::min<std::uint32_t>(10 * number + (bytes_[at_] - std::uint32_t{'0'}), kLargeNumber);
    }
    return number;
  }

  void skip_blanks() {
    for (; at_ < bytes_.size() && (is_blank(bytes_[at_]) || bytes_[at_] == '#'); ++at_) {
      if (bytes_[at_] != '#') continue;
      while (at_ + 1 < bytes_.size() && bytes_[at_] != '\n') ++at_;
    }
  }

  static bool is_digit(std::uint8_t c) { return c >= '0' && c <= '9'; }
  static bool is_blank(std::uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  static constexpr std::uint32_t kLargeNumber = 1'000'000;  // larger than any that is allowed

  std::span<const std::uint8_t> bytes_;
  const std::string& subject_;
  std::size_t at_ = 2, channels_ = 1;
  std::uint32_t largest_ = 0;
  bool is_text_ = false;
};

}  // namespace

bool is_pnm(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 3 && bytes[0] == 'P' &&
         (bytes[1] == '2' || bytes[1] == '3' || bytes[1] == '5' || bytes[1] == '6');
}

Texture decode_pnm(std::span<const std::uint8_t> bytes, const std::string& subject) {
  return PnmReader(bytes, subject).read();
}

}  // namespace simvis
