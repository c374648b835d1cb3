// Small Inventor and VRML files, written by tests.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "import/inventor/inventor_importer.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

inline const std::string kInventorHeader = "#Inventor V2.1 ascii\n", kVrml97Header = "#VRML V2.0 utf8\n";

/// Whether this build reads Inventor; skip() if it does not.
inline bool has_coin() {
  static const bool has = [] {
    TemporaryFolder folder;
    write_text(folder / "empty.iv", kInventorHeader);
    ContentPool pool;
    try {
      import_inventor({folder / "empty.iv"}, pool);
    } catch (const InputError& e) {
      if (std::string(e.what()).find("has no Coin") == std::string::npos) throw;
      return false;
    }
    return true;
  }();
  if (!has) skip("this build has no Coin");
  return has;
}

/// Writes files into a folder and reads them as parts.
class InventorFiles {
 public:
  LoadedPart load(const std::string& name, const std::string& text) {
    write_text(folder / name, text);
    LoadedPart part;
    part.content = import_part(folder / name, pool);
    part.list = flatten(part.content);
    return part;
  }
  LoadedPart iv(const std::string& nodes) {
    return load("part.iv", kInventorHeader + "Separator {\n" + nodes + "\n}\n");
  }
  LoadedPart vrml(const std::string& nodes) { return load("part.wrl", kVrml97Header + nodes + "\n"); }

  TemporaryFolder folder;
  ContentPool pool;
};

inline const Mesh& mesh_of(const LoadedPart& part, std::size_t item) {
  return *part.list.meshes[part.list.items[item].mesh];
}

inline const Material& material_of(const LoadedPart& part, std::size_t item) {
  return *part.list.materials[part.list.items[item].material];
}

inline glm::dvec3 origin_of(const LoadedPart& part, std::size_t item) {
  return part.list.world_from_node[part.list.items[item].transform][3];
}

/// IEC 61966-2-1.
inline double linear_of_srgb(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

/// What a part draws, measured in its own frame.
struct PartMeasure {
  std::size_t triangles = 0, lines = 0, points = 0;
  double area = 0;
  glm::dvec3 min{INFINITY}, max{-INFINITY};
};

inline PartMeasure measure(const DrawList& list) {
  PartMeasure sum;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const glm::dmat4& world = list.world_from_node[item.transform];
    const auto at = [&](std::size_t i) { return glm::dvec3(world * glm::dvec4(mesh.positions[mesh.indices[i]], 1)); };
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      sum.min = glm::min(sum.min, at(i));
      sum.max = glm::max(sum.max, at(i));
    }
    if (mesh.topology == Topology::points) sum.points += mesh.indices.size();
    if (mesh.topology == Topology::lines) sum.lines += mesh.indices.size() / 2;
    if (mesh.topology != Topology::triangles) continue;
    sum.triangles += mesh.indices.size() / 3;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      sum.area += glm::length(glm::cross(at(i + 1) - at(i), at(i + 2) - at(i))) / 2;
    }
  }
  return sum;
}

}  // namespace simvis::test
