// Where insertion points stand in a scene, and which of them move others.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/scene.h>
#include "engine/base/program_api.h"

namespace simvis {

struct NestedPoint {
  std::optional<glm::dmat4> world_from_point;  ///< as the scene stands; empty: it is switched off
  glm::dmat4 world_from_group{1.0};            ///< the frame in which its part or link stands
  std::optional<std::size_t> above;  ///< the place in `names` of the nearest point whose part or link moves it
};

/// Returns a point for each name of a part or link, in the order of `names`. A name that no point has gives a point
/// without a pose, and so does a name that is repeated, from its second time on.
SIMVIS_PROGRAM_API std::vector<NestedPoint> nested_points(const Scene& scene, std::span<const std::string> names);

}  // namespace simvis
