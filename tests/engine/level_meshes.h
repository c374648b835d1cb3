// Meshes whose coarser levels the tests know.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <simvis/mesh.h>
#include "tests/support/random_room.h"

namespace simvis::test {

inline constexpr double kBallRadius_m = 1;
inline constexpr int kBallSegments = 96;

// How far the triangles of a sphere of `segments` lie within it, at most: the sagitta of a quad's diagonal.
inline double sagitta_m(double radius_m, int segments) {
  const double angle = std::numbers::pi / segments;  // half of a side's angle
  return radius_m * (1 - std::cos(angle) * std::cos(angle));
}

inline Mesh ball_mesh() {
  Mesh mesh = sphere_mesh(kBallRadius_m, kBallSegments);
  mesh.attributes.resize(mesh.positions.size());
  compute_bounds(mesh);
  return mesh;
}

// A hilly square of 2 x 2 m with noise, and a second sheet above a part of it: smooth, rough, and with borders.
inline Mesh hills(int cells, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> noise(-0.01f, 0.01f);
  Mesh mesh;
  const auto add_sheet = [&](float raised_m, float width_m) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size()), row = static_cast<std::uint32_t>(cells) + 1;
    for (int i = 0; i <= cells; ++i) {
      for (int k = 0; k <= cells; ++k) {
        const float x = width_m * static_cast<float>(i) / static_cast<float>(cells),
                    y = 2 * static_cast<float>(k) / static_cast<float>(cells);
        mesh.positions.push_back({x, y, raised_m + 0.2f * std::sin(4 * x) * std::cos(3 * y) + noise(random)});
        mesh.attributes.emplace_back();
        if (i == cells || k == cells) continue;
        const std::uint32_t at = first + static_cast<std::uint32_t>(i) * row + static_cast<std::uint32_t>(k);
        mesh.indices.insert(mesh.indices.end(), {at, at + row, at + 1, at + 1, at + row, at + row + 1});
      }
    }
  };
  add_sheet(0, 2);
  add_sheet(0.15f, 0.7f);
  compute_bounds(mesh);
  return mesh;
}

// hills() of so many cells have enough triangles to be tiled.
inline constexpr int kTiledCells = 130;

}  // namespace simvis::test
