// The light of a scene that declares none.
#pragma once

#include <numbers>

#include <simvis/draw_list.h>

namespace simvis {

/// Daylight from above, slightly from behind and from the left of a viewer who looks along the world's +x, so that each
/// face of a box has a different brightness. A white surface that faces the light reflects irradiance / pi = 0.7, in
/// addition to the ambient 0.3.
inline const Light kDefaultLight{.kind = LightKind::directional,
                                 .intensity = 0.7 * std::numbers::pi,
                                 .direction = glm::normalize(glm::dvec3(0.45, -0.3, -0.85))};

}  // namespace simvis
