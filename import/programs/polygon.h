// Cuts polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace simvis {

/// The largest number of corners in one polygon. Real files stay below it, and the time grows with its square.
inline constexpr std::size_t kMaxPolygonCorners = 1000;

/// Returns the n - 2 triangles, as indices into `corners`, that fill a planar polygon, convex or not. They have the
/// winding order of the polygon. For a polygon that crosses itself or is not planar the coverage is not specified.
/// `corners` has 3 to kMaxPolygonCorners finite points.
std::vector<std::array<std::uint32_t, 3>> triangles_of_polygon(std::span<const glm::vec3> corners);

}  // namespace simvis
