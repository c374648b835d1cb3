// Points that fill a disc or a ball evenly, in any number: each stands for an equal area.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>

namespace simvis {

/// By this angle, in radians, each point is turned against the one before it.
inline constexpr double kGoldenTurn_rad = 2 * std::numbers::pi / (std::numbers::phi * std::numbers::phi);

/// Point i of n of the disc of radius 1 on Vogel's spiral ("A better way to construct the sunflower head", Mathematical
/// Biosciences 44, 1979). Its distance from the middle grows with i.
inline glm::dvec2 even_point_of_disc(std::uint32_t i, std::uint32_t n) {
  const double radius = std::sqrt((i + 0.5) / n), angle = kGoldenTurn_rad * i;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Point i of n of the surface of the ball of radius 1, on the spherical Fibonacci lattice (Hannay and Nye, "Fibonacci
/// numerical integration on a sphere", Journal of Physics A 37, 2004). z falls by 2 / n from one to the next.
inline glm::dvec3 even_point_of_ball(std::uint32_t i, std::uint32_t n) {
  const double z = 1 - (2.0 * i + 1) / n, radius = std::sqrt(1 - z * z), angle = kGoldenTurn_rad * i;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace simvis
