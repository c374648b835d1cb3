// Copies of draw lists that follow them, for layers and for flow: equal to the list of each frame, and copied as a
// whole only where the log of the list does not say what has changed.
#include "sensors/camera/surface_layer.h"

#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "sensors/camera/camera_moment.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

std::shared_ptr<const Mesh> triangle(float size) {
  auto mesh = std::make_shared<Mesh>();
  mesh->positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
  mesh->indices = {0, 1, 2};
  return mesh;
}

std::shared_ptr<const Material> glass(float opacity) {
  auto material = std::make_shared<Material>();
  material->opacity = opacity;
  return material;
}

// Three items, each with its own mesh and transform, with a log, as a flattener has it.
DrawList followed_list() {
  DrawList list;
  list.world_from_node.assign(4, glm::dmat4(1));
  for (std::uint32_t i = 0; i < 3; ++i) {
    list.meshes.push_back(triangle(1 + static_cast<float>(i)));
    list.materials.push_back(glass(i == 0 ? 0.4f : 1.0f));
    list.material_revision.push_back(1);
    list.items.push_back({.mesh = i, .material = i, .transform = i + 1});
  }
  list.changes.mark_structure_dirty();
  return list;
}

// One change after another. `changed` is called after each, with whether it is one of the structure.
template <typename Changed>
void change_step_by_step(DrawList& list, const Changed& changed) {
  list.world_from_node[2] = glm::translate(glm::dmat4(1), glm::dvec3(1, 2, 3));
  list.changes.mark_transforms_dirty({2, 3});
  ++list.revisions.transforms;
  changed(false);
  list.items[1].visible = false;
  list.changes.mark_item_dirty(1);
  list.meshes[2] = triangle(7);
  list.changes.mark_item_dirty(2);
  ++list.revisions.structure;
  changed(false);
  list.materials[1] = glass(0.7f);
  list.material_revision[1] = ++list.revisions.materials;
  changed(false);
  list.items.push_back({.mesh = 0, .material = 0, .transform = 3});
  list.changes.mark_structure_dirty();
  ++list.revisions.structure;
  changed(true);
}

TEST_CASE("a copy follows the log of its list, and is copied as a whole only with another structure") {
  DrawList list = followed_list();
  LayerList copy(SurfaceLayer::visible);
  CHECK(same_content(copy.follow(list), list));
  std::uint64_t copies = 1;
  CHECK(copy.copies() == copies);
  change_step_by_step(list, [&](bool structure) {
    copies += structure ? 1 : 0;
    CHECK(same_content(copy.follow(list), list));
    CHECK(copy.list().revisions == list.revisions);
    CHECK(copy.copies() == copies);
  });
  // A list without a log is copied each time.
  const DrawList without = list;
  CHECK(same_content(copy.follow(without), without));
  CHECK(copy.copies() == copies + 1);
}

TEST_CASE("the log of a copy says what has changed in it") {
  DrawList list = followed_list();
  LayerList copy(SurfaceLayer::visible);
  copy.follow(list);
  const ListVersion before = copy.list().changes.version();
  list.world_from_node[3][3].x = 5;
  list.changes.mark_transforms_dirty({3, 4});
  list.items[0].visible = false;
  list.changes.mark_item_dirty(0);
  const DrawListDelta& log = copy.follow(list).changes;
  const auto moved = log.moved_since(before);
  REQUIRE(moved);
  REQUIRE(moved->size() == 1);
  CHECK((*moved)[0].first == 3);
  CHECK((*moved)[0].end == 4);
  const auto items = log.items_since(before);
  REQUIRE(items);
  CHECK(std::vector(items->begin(), items->end()) == std::vector<std::uint32_t>{0});
}

TEST_CASE("a copy of another layer has materials that are solid or nothing, also when they change") {
  DrawList list = followed_list();
  LayerList first(SurfaceLayer::first), opaque(SurfaceLayer::first_opaque);
  const auto opacities = [&](LayerList& copy) {
    std::vector<float> all;
    for (const std::shared_ptr<const Material>& each : copy.follow(list).materials) all.push_back(each->opacity);
    return all;
  };
  CHECK(opacities(first) == std::vector<float>{1, 1, 1});
  CHECK(opacities(opaque) == std::vector<float>{0, 1, 1});
  list.materials[1] = glass(0.7f);
  list.material_revision[1] = ++list.revisions.materials;
  CHECK(opacities(first) == std::vector<float>{1, 1, 1});
  CHECK(opacities(opaque) == std::vector<float>{0, 0, 1});
  CHECK(opaque.copies() == 1);
}

TEST_CASE("scenes that are kept for flow stay as they were, and their memory serves later ones") {
  DrawList list = followed_list();
  const std::vector<std::uint32_t> shape{7, 8, 9};
  SceneKeeper keeper(SurfaceLayer::visible);
  std::shared_ptr<const KeptScene> before, now;
  for (int frame = 0; frame < 20; ++frame) {
    CAPTURE(frame);
    list.world_from_node[1][3].x = frame;
    list.changes.mark_transforms_dirty({1, 2});
    before = std::move(now);
    now = keeper.keep({list, shape}, {});
    CHECK(now->list.world_from_node[1][3].x == frame);
    CHECK(now->shape == shape);
    if (before) CHECK(before->list.world_from_node[1][3].x == frame - 1);
  }
  CHECK(keeper.lists_copied() == 2);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
