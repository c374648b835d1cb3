// A box as a part file of every mesh format, and what a file was loaded as.
#pragma once

#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/draw_list.h>
#include <simvis/part_importer.h>

namespace simvis::test {

/// A box from (1, 2, 3) to (2, 4, 6): no two axes alike, no side through the origin, every number exact in float.
inline constexpr double kBoxSurface_m2 = 2 * (1 * 2 + 2 * 3 + 1 * 3);

std::string obj_box();

enum class PlyFormat { text, little, big };
std::string ply_box(PlyFormat format);

/// `with_normals`: false leaves them 0 0 0, as many programs write them.
std::string stl_box(bool binary, bool with_normals = true);

/// `scale`: what the numbers are divided by, for units.
std::string dae_box(const std::string& asset, float scale = 1, const std::string& node_matrix = "",
                    const std::string& effect = "<diffuse><color>1 0.5 0 1</color></diffuse>");
inline constexpr const char* kMetresZUp = R"(<unit name="meter" meter="1"/><up_axis>Z_UP</up_axis>)";

/// Appends the four bytes.
void put_float(std::string& bytes, float value, bool big_endian = false);

PartContent import(const std::filesystem::path& file, ContentPool& pool, bool up_given = false, UpAxis up = UpAxis::z);

/// A part flattened, with its warnings.
struct Loaded {
  DrawList list;
  std::vector<std::string> warnings;
};
Loaded load(const std::filesystem::path& file, bool up_given = false, UpAxis up = UpAxis::z);

struct Totals {
  int triangles = 0;
  double surface_m2 = 0;
  glm::dvec3 min{INFINITY}, max{-INFINITY};
  double largest_normal_error = 0;  ///< against the geometry, as a length
};
Totals total(const DrawList& list);

/// Checks that it is the box.
void check_box(const DrawList& list);

}  // namespace simvis::test
