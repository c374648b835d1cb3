#include "scenegraph/height_map.h"

#include <algorithm>

namespace simvis {

Mesh height_map_mesh(const HeightPicture& picture, const glm::dvec2& size_m, double low_m, double high_m) {
  const std::uint32_t width = picture.width, height = picture.height;
  const glm::dvec2 cell_m(size_m.x / (width - 1), size_m.y / (height - 1));
  const auto z = [&](std::uint32_t column, std::uint32_t row) {
    return low_m + double{picture.values[std::size_t{row} * width + column]} * (high_m - low_m);
  };
  Mesh mesh;
  mesh.name = "heightmap";
  mesh.positions.reserve(picture.values.size());
  mesh.attributes.reserve(picture.values.size());
  for (std::uint32_t row = 0; row < height; ++row) {
    for (std::uint32_t column = 0; column < width; ++column) {
      const std::uint32_t left = column > 0 ? column - 1 : 0, right = std::min(column + 1, width - 1);
      const std::uint32_t top = row > 0 ? row - 1 : 0, bottom = std::min(row + 1, height - 1);
      const double slope_x = (z(right, row) - z(left, row)) / ((right - left) * cell_m.x);
      const double slope_y = (z(column, top) - z(column, bottom)) / ((bottom - top) * cell_m.y);
      mesh.positions.emplace_back(column * cell_m.x - size_m.x / 2, size_m.y / 2 - row * cell_m.y, z(column, row));
      VertexAttributes attributes;
      attributes.normal = glm::vec3(glm::normalize(glm::dvec3(-slope_x, -slope_y, 1)));
      attributes.uv[0] = attributes.uv[1] = {double(column) / (width - 1), double(row) / (height - 1)};
      mesh.attributes.push_back(attributes);
    }
  }
  mesh.indices.reserve(std::size_t{6} * (width - 1) * (height - 1));
  for (std::uint32_t row = 0; row + 1 < height; ++row) {
    for (std::uint32_t column = 0; column + 1 < width; ++column) {
      const std::uint32_t a = row * width + column, b = a + width;
      mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  compute_bounds(mesh);
  return mesh;
}

}  // namespace simvis
