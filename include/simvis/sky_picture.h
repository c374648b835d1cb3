// A picture of the light that comes from all around.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace simvis {

/// An equirectangular picture of radiance. A pixel is a patch of equal radiance.
///
/// Shape        radiance[row * width + column], rows from the top; at least one pixel.
/// Units        linear RGB radiance, finite and at least 0.
/// Frame        z is up. Row 0 begins at the elevation 90 degrees, the last row ends at -90. Column 0 begins at the
///              azimuth 180 degrees and the last column ends at -180, counter-clockwise from +x about +z: +x is in the
///              middle of the picture, +y at a quarter of its width from the left, as a camera that looks along +x
///              would show it.
struct SkyPicture {
  std::uint32_t width = 0,          ///< in pixels
      height = 0;                   ///< in pixels
  std::vector<glm::vec3> radiance;  ///< of the pixels
};

}  // namespace simvis
