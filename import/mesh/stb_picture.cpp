#include "import/mesh/stb_picture.h"

#include <stb_image.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#include <string_view>

#include <simvis/error.h>
#include "import/mesh/png_chunks.h"
#include "import/mesh/stb_stream.h"

namespace simvis {
namespace {

constexpr int kMaxSide_px = 16384;
constexpr int kChannels = 4;
constexpr std::string_view kStbOutOfMemory = "outofmem";

bool starts_with(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> start) {
  return bytes.size() >= start.size() && std::equal(start.begin(), start.end(), bytes.begin());
}

// A row of HDR has 4 bytes a pixel, or a start of 4 bytes and runs of up to 127 pixels for each of 4 channels.
std::size_t least_hdr_bytes(std::size_t width, std::size_t height) {
  constexpr std::size_t kRunPixels = 127, kRunBytes = 2;
  const std::size_t runs = (width + kRunPixels - 1) / kRunPixels;
  return height * std::min(4 * width, 4 + 4 * runs * kRunBytes);
}

// Returns the least bytes of a picture of this size. Deflate, which compresses best of all other kinds that stb_image
// reads, compresses to 1/1032 at best, and a pixel has at least one bit.
std::size_t least_bytes(std::span<const std::uint8_t> bytes, std::size_t width, std::size_t height) {
  if (is_hdr(bytes)) return least_hdr_bytes(width, height);
  constexpr std::size_t kMaxPixelsPerByte = 1032 * 8, kHeaderBytes = 1024;
  const std::size_t least = width * height / kMaxPixelsPerByte;
  return least > kHeaderBytes ? least - kHeaderBytes : 0;
}

std::string size_text(std::int64_t width_px, std::int64_t height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px) + " pixels";
}

}  // namespace

bool is_png_or_jpeg(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  constexpr std::uint8_t kJpeg[] = {0xFF, 0xD8, 0xFF};
  return starts_with(bytes, kPng) || starts_with(bytes, kJpeg);
}

void check_picture_bytes(std::span<const std::uint8_t> bytes, int width_px, int height_px, const std::string& subject) {
  const auto width = static_cast<std::size_t>(width_px), height = static_cast<std::size_t>(height_px);
  if (bytes.size() < least_bytes(bytes, width, height)) {
    throw InputError(subject + " claims " + size_text(width_px, height_px) + " but has only " +
                     std::to_string(bytes.size()) + " bytes");
  }
  check_png_chunks(bytes, subject);
}

void check_picture_size(std::int64_t width_px, std::int64_t height_px, const std::string& subject) {
  if (width_px < 1 || height_px < 1) throw InputError(subject + " has a broken header");
  if (width_px <= kMaxSide_px && height_px <= kMaxSide_px) return;
  throw InputError(subject + " has " + size_text(width_px, height_px) + "; expected at most " +
                   std::to_string(kMaxSide_px) + " on a side");
}

void throw_stb_failure(const std::string& subject) {
  const std::string_view reason = stbi_failure_reason();
  if (reason == kStbOutOfMemory) throw std::bad_alloc();  // says nothing about the file
  // What stb_image says of the last kind that it tries: the signatures have been looked at before.
  const bool is_of_another_kind = reason == "bad png sig" || reason == "unknown image type";
  throw InputError(subject + " cannot be decoded: " + (is_of_another_kind ? "it is broken" : std::string(reason)));
}

Texture decode_with_stb(std::span<const std::uint8_t> bytes, const std::string& subject) {
  const auto fail = [&](const std::string& what) { throw InputError(subject + what); };
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) fail(" has more than 2 GiB");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    fail(is_png_or_jpeg(bytes)
             ? " has a broken header"
             : " is of no known kind; expected PNG, JPEG, TGA, BMP, PSD, GIF, HDR, PNM, TIFF or WebP");
  }
  check_picture_size(width, height, subject);
  check_picture_bytes(bytes, width, height, subject);
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  StbStream file(bytes);
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgba(
      stbi_load_from_callbacks(&StbStream::callbacks(), &file, &width, &height, &channels, kChannels), stbi_image_free);
  if (rgba == nullptr) throw_stb_failure(subject);
  if (file.lacks_bytes() && !is_png_or_jpeg(bytes)) fail(std::string(" ") + kPictureEndsEarly);
  if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) != pixels) {
    fail(" has pictures of two sizes");
  }
  Texture texture;
  texture.width = static_cast<std::uint32_t>(width);
  texture.height = static_cast<std::uint32_t>(height);
  texture.rgba.assign(rgba.get(), rgba.get() + pixels * kChannels);
  return texture;
}

}  // namespace simvis
