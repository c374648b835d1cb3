#include "import/mesh/height_picture.h"

#include <stb_image.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/mesh/picture_file.h"
#include "import/mesh/sky_file.h"
#include "import/mesh/stb_picture.h"
#include "import/sandbox/sandboxed_decode.h"
#include "scenegraph/shape_limits.h"

namespace simvis {
namespace {

constexpr double kWhite = 65535;  // stb spreads 8 bits to 16
constexpr std::uint8_t kExrStart[] = {0x76, 0x2f, 0x31, 0x01};

[[noreturn]] void refuse_heights(const std::filesystem::path& file, const std::string& what) {
  fail_at({.file = file.string()}, "the picture of heights " + what);
}

void check_side(const std::filesystem::path& file, std::int64_t width, std::int64_t height) {
  if (const std::string refusal = refusal_of_heights(width, height); !refusal.empty()) refuse_heights(file, refusal);
}

HeightPicture read_png_heights(const Bytes& bytes, const std::filesystem::path& file) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    refuse_heights(file, "has more than 2 GiB");
  }
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    refuse_heights(file, "has a broken header");
  }
  check_side(file, width, height);
  check_picture_bytes(bytes, width, height, file.string() + ": error: the picture of heights");
  const std::unique_ptr<stbi_us, void (*)(void*)> grey(
      stbi_load_16_from_memory(bytes.data(), size, &width, &height, &channels, 1), stbi_image_free);
  if (grey == nullptr) throw_stb_failure(file.string() + ": error: the picture of heights");
  HeightPicture picture{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}, 1 / kWhite};
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  picture.values.assign(grey.get(), grey.get() + pixels);
  return picture;
}

HeightPicture read_exr_heights(const Bytes& bytes, const std::filesystem::path& file) {
  HeightPicture picture = decode_heights_in_sandbox(bytes, file.string() + ": error: the picture of heights");
  check_side(file, picture.width, picture.height);
  for (const float value : picture.values) {
    if (!(std::abs(value) <= kMaxShapeLength_m)) refuse_heights(file, "has a value that is not finite or beyond 10^6");
  }
  return picture;
}

const PictureReaderRegistration kPictureReader({.texture = read_picture_file,
                                                .heights = read_height_picture,
                                                .sky = read_sky_picture});

}  // namespace

HeightPicture read_height_picture(const std::filesystem::path& file) {
  const Bytes bytes = read_whole_file(file);
  if (bytes.size() >= 4 && std::equal(kExrStart, kExrStart + 4, bytes.begin())) return read_exr_heights(bytes, file);
  if (!is_png_or_jpeg(bytes)) refuse_heights(file, "is of another kind, expected PNG or EXR");
  return read_png_heights(bytes, file);
}

}  // namespace simvis
