#include "bench/scenes/solids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

namespace simvis::bench {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

int at_least(int least, double count) { return std::max(least, static_cast<int>(std::lround(count))); }

struct SurfacePoint {
  glm::dvec3 position_m, normal;
};

/// Adds columns x rows pairs of triangles, counter-clockwise if u x v points outwards; u and v run from 0 to 1. A row
/// that is one point (a pole) gets single triangles.
void add_grid(Mesh& mesh, int columns, int rows, const std::function<SurfacePoint(double u, double v)>& surface,
              bool pole_below = false, bool pole_above = false) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const SurfacePoint point = surface(static_cast<double>(c) / columns, static_cast<double>(r) / rows);
      mesh.positions.emplace_back(point.position_m);
      mesh.attributes.push_back({.normal = glm::vec3(point.normal)});
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const auto i = first + static_cast<std::uint32_t>(r * (columns + 1) + c);
      const auto above = i + static_cast<std::uint32_t>(columns) + 1;
      if (r > 0 || !pole_below) mesh.indices.insert(mesh.indices.end(), {i, i + 1, above + 1});
      if (r + 1 < rows || !pole_above) mesh.indices.insert(mesh.indices.end(), {i, above + 1, above});
    }
  }
}

}  // namespace

Mesh box_of(const glm::dvec3& size_m, double triangles) {
  Mesh mesh;
  const int cells = at_least(1, std::sqrt(triangles / 12));
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1;
    add_grid(mesh, cells, cells, [&](double u, double v) {
      glm::dvec3 at(0), normal(0);
      at[axis] = sign / 2;
      at[(axis + 1) % 3] = (u - 0.5) * sign;
      at[(axis + 2) % 3] = v - 0.5;
      normal[axis] = sign;
      return SurfacePoint{at * size_m, normal};
    });
  }
  return mesh;
}

Mesh wall_of(const glm::dvec2& size_m, double triangles) {
  Mesh mesh;
  const int cells = at_least(1, std::sqrt(triangles / 2));
  add_grid(mesh, cells, cells, [&](double u, double v) {
    return SurfacePoint{glm::dvec3((u - 0.5) * size_m.x, (v - 0.5) * size_m.y, 0), {0, 0, 1}};
  });
  return mesh;
}

Mesh sphere_of(double radius_m, double triangles) {
  Mesh mesh;
  const int rows = at_least(3, (1 + std::sqrt(1 + triangles)) / 2);
  const auto surface = [&](double u, double v) {
    const double azimuth = kTurn * u, elevation = kTurn / 2 * (v - 0.5);
    const glm::dvec3 out(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                         std::sin(elevation));
    return SurfacePoint{radius_m * out, out};
  };
  add_grid(mesh, 2 * rows, rows, surface, true, true);
  return mesh;
}

Mesh cylinder_of(double radius_m, double height_m, double triangles) {
  Mesh mesh;
  const int around = at_least(8, std::sqrt(triangles));
  const auto at = [&](double u, double radius, double z) {
    return glm::dvec3(radius * std::cos(kTurn * u), radius * std::sin(kTurn * u), z);
  };
  add_grid(mesh, around, at_least(1, triangles / 2 / around - 1), [&](double u, double v) {
    return SurfacePoint{at(u, radius_m, (v - 0.5) * height_m), at(u, 1, 0)};
  });
  add_grid(
      mesh, around, 1,
      [&](double u, double v) {
        return SurfacePoint{at(u, radius_m * (1 - v), height_m / 2), {0, 0, 1}};
      },
      false, true);
  add_grid(
      mesh, around, 1,
      [&](double u, double v) {
        return SurfacePoint{at(u, radius_m * v, -height_m / 2), {0, 0, -1}};
      },
      true, false);
  return mesh;
}

}  // namespace simvis::bench
