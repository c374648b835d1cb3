// The convex hull of points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace simvis {

/// Distances between points and planes, about 5 s of a processor. A million points on a sphere take 4 * 10^8 of them;
/// two circles across each other take some that grow with the square of their points.
inline constexpr std::size_t kMaxHullSteps = 1'000'000'000;

/// Triangles around all points, counter-clockwise seen from outside, as indices of points. A point that lies outside by
/// less than 1e-10 of the longest way between two of them counts as inside. Empty: all points lie in a plane as far as
/// that, or there are fewer than four. Nothing: it takes more than `max_steps`. Coordinates are finite.
std::optional<std::vector<std::uint32_t>> convex_hull(std::span<const glm::dvec3> points,
                                                      std::size_t max_steps = kMaxHullSteps);

}  // namespace simvis
