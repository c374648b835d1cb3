#include "import/grid_map/grid_part.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include <simvis/node.h>
#include "import/mesh/shape_node.h"

namespace simvis {

void check_grid_size(const std::filesystem::path& file, const char* what, const glm::dvec3& cells) {
  const auto refuse = [&](const std::string& expected) {
    fail_at({.file = file.string()}, std::string(what) + " " + format_number(cells.x) + " x " + format_number(cells.y) +
                                         " x " + format_number(cells.z) + " cells, expected at most " + expected);
  };
  if (cells.x * cells.y * cells.z > static_cast<double>(kMaxGridCells)) {
    refuse(std::to_string(kMaxGridCells) + " in all");
  }
  if (std::max({cells.x, cells.y, cells.z}) > static_cast<double>(kMaxAxisCells)) {
    refuse(std::to_string(kMaxAxisCells) + " along an axis");
  }
  constexpr double kWord = CellGrid::kWordBits;
  if (kWord * std::ceil(cells.x / kWord) * cells.y * cells.z > static_cast<double>(kMaxFilledCells)) {
    refuse(std::to_string(kMaxFilledCells) + " after rows along x are filled up to a multiple of " +
           format_number(kWord));
  }
}

PartContent grid_part(const std::filesystem::path& file, const PlacedGrid& grid, ContentPool& pool) {
  std::optional<Mesh> walls = cell_walls(grid.cells, grid.cell_m, grid.texture_m);
  if (!walls) {
    fail_at({.file = file.string()}, "has walls of more than " + std::to_string(kMaxWallRectangles) +
                                         " rectangles, expected a map with less noise");
  }
  if (walls->indices.empty()) {
    fail_at({.file = file.string()}, "has no occupied cell, so that there is nothing to show");
  }
  const auto root = std::make_shared<Separator>();
  root->name = file.stem().string();
  if (grid.part_from_grid != glm::dmat4(1)) root->add(std::make_shared<Transform>(grid.part_from_grid));
  Material material;
  material.name = "wall";
  material.double_sided = true;
  const std::string name = material.name;
  const auto look = std::make_shared<MaterialNode>(pool.intern(std::move(material)));
  look->name = name;
  root->add(look);
  root->add(shape_node(std::move(*walls), pool));
  PartContent content;
  content.root = root;
  return content;
}

}  // namespace simvis
