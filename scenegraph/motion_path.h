// Screws between poses, and the paths that are made of them. <simvis/motion_path.h> defines what a path is.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include <simvis/motion_path.h>

namespace simvis {

/// The screw from one transform to another, whose difference is rigid. Its point is the origin at the end.
ScrewMotion screw_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now);

/// The displacement about the screw's point at `share` of the motion: exp(share twist). -1 leads from its end to its
/// beginning.
Displacement screw_at(const ScrewMotion& screw, double share);

/// A path in one piece along the screw from one rigid pose to another.
MotionPath path_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now);

/// The rigid pose at `share` of the way from `first` (0) to `last` (1), along the screw that leads from one to the
/// other. Shares outside of [0, 1] extrapolate.
glm::dmat4 pose_between(const glm::dmat4& first, const glm::dmat4& last, double share);

/// The displacements of which displacement() is the product, at most.
std::size_t displacements(const MotionPath& path);

/// The factor by which displacement() at `share` multiplies the screws of a piece, at least 1: shares below -1 continue
/// the first piece, which may be short.
double extrapolation(const MotionPath& path, double share);

/// Bounds the lengths that round in displacement() of a point: distances from the points of the displacements, and
/// their ways. `parts` is the extrapolation(): ways and turns of the first piece are multiplied by it, and so are the
/// distances to which they move the point.
double rounded_length_m(const MotionPath& path, const glm::dvec3& point_m, double parts);

}  // namespace simvis
