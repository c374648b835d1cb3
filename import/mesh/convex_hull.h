// The convex hull of points.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace simvis {

/// Triangles around all points, counter-clockwise seen from outside, as indices of points. A point that lies outside by
/// less than 1e-10 of the longest way between two of them counts as inside. Empty: all points lie in a plane as far as
/// that, or there are fewer than four. Coordinates are finite.
std::vector<std::uint32_t> convex_hull(std::span<const glm::dvec3> points);

}  // namespace simvis
