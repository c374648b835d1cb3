// Random splats, the same for each seed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "engine/draw/splat_cloud.h"

namespace simvis::test {

inline double uniform(std::mt19937& numbers, double low, double high) {
  return low + (high - low) * static_cast<double>(numbers()) / 0x1p32;
}

inline glm::dvec3 uniform_vec(std::mt19937& numbers, double low, double high) {
  const double x = uniform(numbers, low, high), y = uniform(numbers, low, high);
  return {x, y, uniform(numbers, low, high)};
}

/// Splats before the origin of a view that looks along z: round ones, discs and needles of all opacities.
inline SplatCloud random_splats(std::uint32_t seed, std::size_t count, std::uint32_t degree,
                                SplatEncoding encoding = SplatEncoding::srgb) {
  std::mt19937 numbers(seed);
  SplatCloud cloud{.encoding = encoding, .degree = degree, .splats = {}, .harmonics = {}};
  for (std::size_t i = 0; i < count; ++i) {
    Splat splat;
    splat.center = glm::vec3(uniform_vec(numbers, -1, 1) + glm::dvec3(0, 0, 2.5));
    const glm::dvec3 magnitude = uniform_vec(numbers, -3, -0.7);
    splat.sigma = glm::vec3(std::pow(10, magnitude.x), std::pow(10, magnitude.y), std::pow(10, magnitude.z));
    const glm::dvec3 axis = uniform_vec(numbers, -1, 1);
    splat.rotation = glm::vec4(glm::normalize(glm::dvec4(axis, uniform(numbers, -1, 1))));
    splat.opacity = static_cast<float>(uniform(numbers, 0, 1));
    cloud.splats.push_back(splat);
    for (std::uint32_t c = 0; c < harmonics_count(degree); ++c) {
      cloud.harmonics.push_back(glm::vec3(uniform_vec(numbers, -0.8, 0.8)));
    }
  }
  return cloud;
}

/// The same splats in another order.
inline SplatCloud shuffled(const SplatCloud& cloud, std::uint32_t seed) {
  std::vector<std::size_t> order(cloud.splats.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::shuffle(order, std::mt19937(seed));
  SplatCloud other{.encoding = cloud.encoding, .degree = cloud.degree, .splats = {}, .harmonics = {}};
  const std::size_t coefficients = harmonics_count(cloud.degree);
  for (const std::size_t i : order) {
    other.splats.push_back(cloud.splats[i]);
    const auto first = cloud.harmonics.begin() + static_cast<std::ptrdiff_t>(i * coefficients);
    other.harmonics.insert(other.harmonics.end(), first, first + static_cast<std::ptrdiff_t>(coefficients));
  }
  return other;
}

}  // namespace simvis::test
