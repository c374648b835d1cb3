#include "scenegraph/import/mesh/picture_file.h"

#include <stb_image.h>

#include <algorithm>
#include <limits>
#include <memory>

#include <simvis/error.h>
#include "scenegraph/import/mesh/input_file.h"

namespace simvis {
namespace {

constexpr int kMaxSide_px = 16384;
constexpr int kChannels = 4;

bool starts_with(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> start) {
  return bytes.size() >= start.size() && std::equal(start.begin(), start.end(), bytes.begin());
}

bool is_png_or_jpeg(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  constexpr std::uint8_t kJpeg[] = {0xFF, 0xD8, 0xFF};
  return starts_with(bytes, kPng) || starts_with(bytes, kJpeg);
}

// Returns whether a PNG or JPEG of this size can hold so many pixels: deflate compresses to 1/1032 at best, and a pixel
// has at least one bit.
bool can_hold(std::size_t file_bytes, std::size_t pixels) {
  constexpr std::size_t kMaxPixelsPerByte = 1032 * 8, kHeaderBytes = 1024;
  return pixels / kMaxPixelsPerByte <= file_bytes + kHeaderBytes;
}

}  // namespace

// stb_image also reads many other formats, less carefully. Only PNG and JPEG are passed to it.
Texture decode_picture(std::span<const std::uint8_t> bytes, const std::string& subject) {
  const auto fail = [&](const std::string& what) { throw InputError(subject + what); };
  if (!is_png_or_jpeg(bytes)) fail(" is neither PNG nor JPEG");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    fail(" has more than 2 GiB");
  }
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0 || width < 1 || height < 1) {
    fail(" has a broken header");
  }
  const std::string size_text = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width > kMaxSide_px || height > kMaxSide_px) {
    fail(" has " + size_text + "; expected at most " + std::to_string(kMaxSide_px) + " on a side");
  }
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!can_hold(bytes.size(), pixels)) {
    fail(" claims " + size_text + " but has only " + std::to_string(size) + " bytes");
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgba(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kChannels), stbi_image_free);
  if (rgba == nullptr) fail(std::string(" cannot be decoded: ") + stbi_failure_reason());
  if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) != pixels) {
    fail(" has pictures of two sizes");
  }
  Texture texture;
  texture.width = static_cast<std::uint32_t>(width);
  texture.height = static_cast<std::uint32_t>(height);
  texture.rgba.assign(rgba.get(), rgba.get() + pixels * kChannels);
  return texture;
}

Texture read_picture_file(const std::filesystem::path& file) {
  return decode_picture(read_whole_file(file), file.string() + ": error: the picture");
}

}  // namespace simvis
