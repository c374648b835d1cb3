// The light that a surface sends to a camera, computed on the host: the radiance of a point of a triangle.
//
// Model    base colour x (ambient + irradiance / pi) + emission, with the lights of KHR_lights_punctual: what the
//          pictures of cameras show of matte surfaces (shaders/mesh_color.frag). Highlights, metallic shares, shadows,
//          fog, and maps other than the base colour are left out; textures are sampled at their largest level.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "sensors/event_camera/scene_over_time.h"

namespace simvis {

/// Luminance of the point of a triangle that `weights` (barycentric, sum 1) name, seen along `direction` (V, any
/// length) at that time.
double surface_light(const SceneOverTime& scene, double share, std::uint32_t item, std::uint32_t primitive,
                     const glm::dvec3& weights, const glm::dvec3& direction);

/// Luminance where nothing is seen.
double background_light(const DrawList& list);

}  // namespace simvis
