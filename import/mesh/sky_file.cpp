#include "import/mesh/sky_file.h"

#include <string>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/sandbox/sandboxed_decode.h"

namespace simvis {
namespace {

constexpr float kMaxRadiance = 1e12f;  // as of the attributes of the sky

bool is_radiance(float value) { return value >= 0 && value <= kMaxRadiance; }

}  // namespace

SkyPicture read_sky_picture(const std::filesystem::path& file) {
  const Bytes bytes = read_whole_file(file);
  SkyPicture picture = decode_sky_in_sandbox(bytes, file.string() + ": error: the picture of the sky");
  for (std::size_t i = 0; i < picture.radiance.size(); ++i) {
    const glm::vec3& seen = picture.radiance[i];
    if (is_radiance(seen.r) && is_radiance(seen.g) && is_radiance(seen.b)) continue;
    fail_at({.file = file.string()},
            "the picture of the sky has a value that is negative, not finite or above 10^12 in column " +
                std::to_string(i % picture.width) + " of row " + std::to_string(i / picture.width));
  }
  return picture;
}

}  // namespace simvis
