// Scenes that are exported as GLB and read again.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "program/live/glb_file.h"
#include "program/live/glb_matrix.h"
#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "tests/support/temporary_folder.h"

namespace simvis::live {

// A matrix is a product of two in double, and of four where it shears: some dozens of roundings of 1e-16, and the turns
// stop when columns are square within 1e-9.
inline constexpr double kMatrix = 1e-12, kSheared = 1e-8;
// Factors are float32 and are divided and multiplied once: 6e-8 each, on numbers up to 1.
inline constexpr float kFactor = 2e-7f;

/// A scene without a device, and its draw list.
struct Scenery {
  explicit Scenery(const std::string& xml, const std::filesystem::path& folder = {})
      : Scenery(parse_commands(xml, "s.xml", folder)) {}
  explicit Scenery(const std::filesystem::path& file) : Scenery(read_commands(file)) {}
  explicit Scenery(const std::vector<Command>& commands)
      : scene({}, commands), flattener(scene.built.scene.root()), list(with_pictures()) {}
  const DrawList& with_pictures() {
    scene.built.scene.read_pictures();
    return flattener.update();
  }
  std::string glb() const {
    std::vector<SceneItem> items;
    for (const ItemSource& source : flattener.item_sources()) {
      items.push_back({.part = source.point == nullptr ? "" : source.point->name, .mesh = "", .triangles = 0});
    }
    return glb_bytes(list, items);
  }
  LiveScene scene;
  Flattener flattener;
  const DrawList& list;
};

/// Those that a GLB holds: with primitives, and of a size.
inline std::vector<DrawItem> exported_items(const DrawList& list) {
  std::vector<DrawItem> items;
  for (const DrawItem& item : list.items) {
    if (list.meshes[item.mesh]->indices.empty() || gltf_nodes_of(list.world_from_node[item.transform]).empty())
      continue;
    items.push_back(item);
  }
  return items;
}

inline double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(a[i][k] - b[i][k]));
  }
  return largest;
}

inline void check_same(const Material& now, const Material& before) {
  for (int i = 0; i < 4; ++i) CHECK(std::abs(now.base_color[i] - before.base_color[i]) <= kFactor);
  for (int i = 0; i < 3; ++i)
    CHECK(std::abs(now.emissive[i] - before.emissive[i]) <= kFactor * (1 + before.emissive[i]));
  CHECK(now.name == before.name);
  CHECK(now.alpha_mode == before.alpha_mode);
  CHECK(now.roughness == before.roughness);
  CHECK(now.metallic == before.metallic);
  CHECK(now.double_sided == before.double_sided);
  CHECK(now.unlit == before.unlit);
  REQUIRE((now.base_color_texture == nullptr) == (before.base_color_texture == nullptr));
  if (now.base_color_texture == nullptr) return;
  CHECK(now.base_color_texture->rgba == before.base_color_texture->rgba);
  CHECK(now.base_color_texture->sampler == before.base_color_texture->sampler);
}

/// The list, written and read again.
inline void check_round_trip(const Scenery& before, const std::string& glb) {
  const TemporaryFolder folder;
  write_text(folder / "again.glb", glb);
  const Scenery again("<part file=\"again.glb\" name=\"AGAIN\" insert_at=\"ROOT\"/>", folder.path());
  CHECK(again.scene.built.scene.warnings().empty());
  const std::vector<DrawItem> exported = exported_items(before.list);
  REQUIRE(again.list.items.size() == exported.size());
  std::set<std::pair<std::uint32_t, std::uint32_t>> meshes, materials;  // that were compared: now, then
  for (std::size_t i = 0; i < exported.size(); ++i) {
    const DrawItem &a = again.list.items[i], &b = exported[i];
    const Mesh &now = *again.list.meshes[a.mesh], &then = *before.list.meshes[b.mesh];
    if (meshes.emplace(a.mesh, b.mesh).second) {
      CHECK(now.positions == then.positions);
      CHECK(now.indices == then.indices);
    }
    const glm::dmat4& world = before.list.world_from_node[b.transform];
    const double tolerance = gltf_nodes_of(world).size() == 1 ? kMatrix : kSheared;
    CHECK(difference(again.list.world_from_node[a.transform], world) < tolerance * (1 + glm::length(world[3])));
    if (materials.emplace(a.material, b.material).second) {
      check_same(*again.list.materials[a.material], *before.list.materials[b.material]);
    }
  }
  REQUIRE(again.list.lights.size() == before.list.lights.size());
  for (std::size_t i = 0; i < again.list.lights.size(); ++i) {
    const LightItem &a = again.list.lights[i], &b = before.list.lights[i];
    const glm::dmat4 &now = again.list.world_from_node[a.transform], &then = before.list.world_from_node[b.transform];
    CHECK(a.light.kind == b.light.kind);
    // Colours of a GLB are at most 1: what is above is part of the intensity.
    const glm::dvec3 sent = a.light.intensity * glm::dvec3(a.light.color);
    const glm::dvec3 expected = b.light.intensity * glm::dvec3(b.light.color);
    CHECK(glm::length(sent - expected) <= kFactor * glm::length(expected));
    CHECK(glm::length(now[3] - then[3]) < kMatrix * (1 + glm::length(then[3])));
    if (b.light.kind == LightKind::point) continue;
    const glm::dvec4 from(a.light.direction, 0), to(b.light.direction, 0);
    CHECK(glm::length(glm::normalize(now * from) - glm::normalize(then * to)) < kMatrix);
  }
}

}  // namespace simvis::live
