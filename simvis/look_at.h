// The attribute look_at of sensors.
#pragma once

#include <glm/glm.hpp>

#include <simvis/command.h>
#include <simvis/scene.h>

namespace simvis {

/// Below this distance a target gives no direction.
inline constexpr double kMinLookDistance_m = 1e-6;
/// Below this sine of the angle between the direction and the vertical, no side of the sensor is up.
inline constexpr double kMinLookSine = 1e-6;

/// Returns parent_from_sensor for a command with `look_at`, whose position in the frame of its insertion point is
/// given: x points at the target, and z is as near to the world's +z as that allows. The target is "x y z" in the frame
/// of the insertion point, in metres, or the origin of a part as it stands now. Scale and shear of that frame are taken
/// out.
///
/// Errors  InputError at the attribute: neither three numbers nor a part, a target at the sensor's place, above or
/// below
///         it, a place that is switched off or has no volume.
glm::dmat4 look_at_offset(const Scene& scene, const Command& sensor, const glm::dvec3& position_m);

}  // namespace simvis
