// Where a sensor stands, when the way to it scales, shears or mirrors.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// The rigid frame nearest in meaning to a mount's: it stands where the mount stands and looks where its x axis points;
/// its z axis is the mount's, as far as it is square to x; y = z x x makes it right-handed.
///
/// So scale and shear fall away, and in a mirrored part (a negative scale) the sensor still looks ahead with its head
/// up, but its left is not the mirrored left: a sensor is not a thing that can be mirrored.
/// False when x or z has no direction, because the way to the mount flattens everything (a scale of 0) or is not
/// finite.
bool rigid_mount_frame(const glm::dmat4& world_from_mount, glm::dmat4& world_from_sensor);

}  // namespace simvis
