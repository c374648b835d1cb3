#include "import/programs/decode/sky_radiance.h"

#include <stb_image.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include <simvis/error.h>
#include "import/mesh/stb_picture.h"
#include "import/mesh/stb_stream.h"
#include "import/programs/decode/exr_file.h"

namespace simvis {
namespace {

SkyPicture decode_hdr(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) throw InputError("has more than 2 GiB");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    throw InputError("has a broken header");
  }
  if (const std::string refusal = refusal_of_sky(width, height); !refusal.empty()) throw InputError(refusal);
  check_picture_bytes(bytes, width, height, "");
  StbStream file(bytes);
  const std::unique_ptr<float, void (*)(void*)> values(
      stbi_loadf_from_callbacks(&StbStream::callbacks(), &file, &width, &height, &channels, 3), stbi_image_free);
  if (values == nullptr) throw_stb_failure("");
  if (file.lacks_bytes()) throw InputError(kPictureEndsEarly);
  SkyPicture picture{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  picture.radiance.resize(std::size_t{picture.width} * picture.height);
  std::memcpy(picture.radiance.data(), values.get(), picture.radiance.size() * sizeof(glm::vec3));
  return picture;
}

}  // namespace

SkyPicture decode_sky_radiance(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kExrStart[] = {0x76, 0x2f, 0x31, 0x01};
  if (bytes.size() >= sizeof kExrStart && std::memcmp(bytes.data(), kExrStart, sizeof kExrStart) == 0) {
    return decode_exr_sky(bytes);
  }
  if (is_hdr(bytes)) return decode_hdr(bytes);
  throw InputError("is of another kind, expected OpenEXR or Radiance HDR");
}

}  // namespace simvis
