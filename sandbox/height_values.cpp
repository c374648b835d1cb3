#include "sandbox/height_values.h"

#include <array>
#include <cstring>

namespace simvis {
namespace {

using HeightSize = std::array<std::uint32_t, 2>;  // width, height; the values follow

}  // namespace

std::vector<std::uint8_t> pack_heights(const HeightPicture& picture) {
  const HeightSize size{picture.width, picture.height};
  std::vector<std::uint8_t> bytes(sizeof size + picture.values.size() * sizeof(float));
  std::memcpy(bytes.data(), &size, sizeof size);
  std::memcpy(bytes.data() + sizeof size, picture.values.data(), bytes.size() - sizeof size);
  return bytes;
}

bool unpack_heights(std::span<const std::uint8_t> bytes, HeightPicture& picture) {
  HeightSize size{};
  if (bytes.size() < sizeof size) return false;
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes = bytes.subspan(sizeof size);
  if (!refusal_of_heights(size[0], size[1]).empty()) return false;
  const std::size_t count = std::size_t{size[0]} * size[1];
  if (bytes.size() != count * sizeof(float)) return false;
  picture = {size[0], size[1], std::vector<float>(count)};
  std::memcpy(picture.values.data(), bytes.data(), bytes.size());
  return true;
}

}  // namespace simvis
