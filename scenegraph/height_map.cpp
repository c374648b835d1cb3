#include "scenegraph/height_map.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// The largest power of two that is no longer than a length, with its sign. The length is not 0.
double power_below(double length) { return std::copysign(std::exp2(std::floor(std::log2(std::abs(length)))), length); }

void add_triangles(Mesh& mesh, std::uint32_t width, std::uint32_t height) {
  mesh.indices.reserve(std::size_t{6} * (width - 1) * (height - 1));
  for (std::uint32_t row = 0; row + 1 < height; ++row) {
    for (std::uint32_t column = 0; column + 1 < width; ++column) {
      const std::uint32_t a = row * width + column, b = a + width;
      mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
}

}  // namespace

HeightMap height_map(const HeightPicture& picture, const glm::dvec2& size_m, double low_m, double high_m) {
  const std::uint32_t width = picture.width, height = picture.height;
  const glm::dvec3 cell(size_m.x / (width - 1), size_m.y / (height - 1), (high_m - low_m) * picture.unit);
  // A product with a power of two is exact, and so is half of a whole number.
  const bool is_flat = cell.z == 0;
  const glm::dvec3 unit(power_below(cell.x), power_below(cell.y), is_flat ? 0 : power_below(cell.z));
  const glm::dvec3 scale(cell.x / unit.x, cell.y / unit.y, is_flat ? 1 : cell.z / unit.z);
  const auto z = [&](std::uint32_t column, std::uint32_t row) {
    return double{picture.values[std::size_t{row} * width + column]} * unit.z;
  };
  HeightMap map;
  map.place = glm::dmat4(glm::dvec4(scale.x, 0, 0, 0), glm::dvec4(0, scale.y, 0, 0), glm::dvec4(0, 0, scale.z, 0),
                         glm::dvec4(0, 0, low_m, 1));
  Mesh& mesh = map.mesh;
  mesh.name = "heightmap";
  mesh.positions.reserve(picture.values.size());
  mesh.attributes.reserve(picture.values.size());
  for (std::uint32_t row = 0; row < height; ++row) {
    for (std::uint32_t column = 0; column < width; ++column) {
      const std::uint32_t left = column > 0 ? column - 1 : 0, right = std::min(column + 1, width - 1);
      const std::uint32_t top = row > 0 ? row - 1 : 0, bottom = std::min(row + 1, height - 1);
      const double slope_x = (z(right, row) - z(left, row)) / ((right - left) * unit.x);
      const double slope_y = (z(column, top) - z(column, bottom)) / ((bottom - top) * unit.y);
      mesh.positions.emplace_back((column - (width - 1) / 2.0) * unit.x, ((height - 1) / 2.0 - row) * unit.y,
                                  z(column, row));
      VertexAttributes attributes;
      attributes.normal = glm::vec3(glm::normalize(glm::dvec3(-slope_x, -slope_y, 1)));
      attributes.uv[0] = attributes.uv[1] = {double(column) / (width - 1), double(row) / (height - 1)};
      mesh.attributes.push_back(attributes);
    }
  }
  add_triangles(mesh, width, height);
  compute_bounds(mesh);
  return map;
}

Mesh mesh_in_place(const HeightMap& map) {
  Mesh mesh = map.mesh;
  const glm::dvec3 scale(map.place[0][0], map.place[1][1], map.place[2][2]);
  for (glm::vec3& p : mesh.positions) p = glm::vec3(map.place * glm::dvec4(p, 1));
  for (VertexAttributes& each : mesh.attributes) {
    each.normal = glm::vec3(glm::normalize(glm::dvec3(each.normal) / scale));
  }
  compute_bounds(mesh);
  return mesh;
}

}  // namespace simvis
