#include "import/sandbox/picture_values.h"

#include <array>
#include <cstring>

namespace simvis {
namespace {

using PictureSize = std::array<std::uint32_t, 2>;  // width, height; the values follow

template <class T>
std::vector<std::uint8_t> pack(const PictureSize& size, const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(sizeof size + values.size() * sizeof(T));
  std::memcpy(bytes.data(), &size, sizeof size);
  std::memcpy(bytes.data() + sizeof size, values.data(), bytes.size() - sizeof size);
  return bytes;
}

template <class T>
bool unpack(std::span<const std::uint8_t> bytes, std::string (*refusal)(std::int64_t, std::int64_t),
            std::uint32_t& width, std::uint32_t& height, std::vector<T>& values) {
  PictureSize size{};
  if (bytes.size() < sizeof size) return false;
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes = bytes.subspan(sizeof size);
  if (!refusal(size[0], size[1]).empty()) return false;
  const std::size_t count = std::size_t{size[0]} * size[1];
  if (bytes.size() != count * sizeof(T)) return false;
  width = size[0];
  height = size[1];
  values.resize(count);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return true;
}

}  // namespace

std::vector<std::uint8_t> pack_heights(const HeightPicture& picture) {
  return pack({picture.width, picture.height}, picture.values);
}

std::vector<std::uint8_t> pack_sky(const SkyPicture& picture) {
  return pack({picture.width, picture.height}, picture.radiance);
}

bool unpack_heights(std::span<const std::uint8_t> bytes, HeightPicture& picture) {
  return unpack(bytes, refusal_of_heights, picture.width, picture.height, picture.values);
}

bool unpack_sky(std::span<const std::uint8_t> bytes, SkyPicture& picture) {
  return unpack(bytes, refusal_of_sky, picture.width, picture.height, picture.radiance);
}

}  // namespace simvis
