// Cutting polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace simvis {

/// More corners than this in one polygon are nobody's intention, and the time grows with their square.
inline constexpr std::size_t kMaxPolygonCorners = 1000;

/// The triangles, as indices into `corners`, that fill a plane polygon, convex or not, and wind the way it does; n - 2
/// of them. One that crosses itself or is not plane is covered somehow. `corners` are finite, 3 to kMaxPolygonCorners.
std::vector<std::array<std::uint32_t, 3>> triangles_of_polygon(std::span<const glm::vec3> corners);

}  // namespace simvis
