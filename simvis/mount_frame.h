// The rigid frame of a sensor whose mount transform contains scale, shear or mirroring.
#pragma once

#include <glm/glm.hpp>
#include "engine/base/program_api.h"

namespace simvis {

/// Computes the rigid frame of a sensor from the transform of its mount. The origin and the direction of x are those of
/// the mount; z is the component of the mount's z axis orthogonal to x; y = z x x makes the frame right-handed.
///
/// So scale and shear are removed. In a mirrored part (a negative scale), forward and up of the sensor follow the part,
/// but its left is not mirrored, because a sensor cannot be mirrored.
/// Returns false if x or z has no direction (a scale of 0), if x and z are parallel, or if the transform is not finite.
SIMVIS_PROGRAM_API bool rigid_mount_frame(const glm::dmat4& world_from_mount, glm::dmat4& world_from_sensor);

}  // namespace simvis
