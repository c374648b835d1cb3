#include "scenegraph/flattener.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include <simvis/error.h>

TEST_SUITE_BEGIN("scenegraph");

using namespace simvis;

namespace {

glm::dmat4 moved(double x, double y = 0, double z = 0) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

std::shared_ptr<Mesh> some_mesh() {
  auto mesh = std::make_shared<Mesh>();
  mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh->attributes.resize(3);
  mesh->indices = {0, 1, 2};
  compute_bounds(*mesh);
  return mesh;
}

std::shared_ptr<Material> painted(float red) {
  auto material = std::make_shared<Material>();
  material->base_color = {red, 0, 0, 1};
  return material;
}

double x_of(const DrawList& list, std::size_t item) { return list.world_from_node[list.items.at(item).transform][3].x; }

// separator { move 1, shape, group { move 10, shape }, shape }, shape
struct Example {
  GroupPtr root = std::make_shared<Separator>();
  std::shared_ptr<Separator> separator = std::make_shared<Separator>();
  std::shared_ptr<Group> group = std::make_shared<Group>();
  std::shared_ptr<Transform> outer = std::make_shared<Transform>(moved(1));
  std::shared_ptr<Transform> inner = std::make_shared<Transform>(moved(10));
  std::shared_ptr<Shape> shape = std::make_shared<Shape>(some_mesh());

  Example() {
    root->add(separator);
    separator->add(outer);
    separator->add(shape);
    separator->add(group);
    group->add(inner);
    group->add(shape);
    separator->add(shape);
    root->add(shape);
  }
};

}  // namespace

TEST_CASE("a group passes its state on, a separator restores it") {
  Example e;
  Flattener flattener(e.root);
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == 4);
  CHECK(x_of(list, 0) == 1);
  CHECK(x_of(list, 1) == 11);
  CHECK(x_of(list, 2) == 11);
  CHECK(x_of(list, 3) == 0);
  CHECK(list.meshes.size() == 1);
}

TEST_CASE("a changed transform rewrites only what it affects") {
  Example e;
  Flattener flattener(e.root);
  flattener.update();
  const FlattenCounters before = flattener.counters();

  e.inner->set_matrix(moved(20));
  const DrawList& list = flattener.update();
  CHECK(x_of(list, 0) == 1);
  CHECK(x_of(list, 1) == 21);
  CHECK(x_of(list, 2) == 21);
  CHECK(flattener.counters().transforms_written == before.transforms_written + 1);
  CHECK(flattener.counters().rebuilds == before.rebuilds);

  e.outer->set_matrix(moved(2));
  e.inner->set_matrix(moved(30));
  flattener.update();
  CHECK(x_of(list, 1) == 32);
  CHECK(flattener.counters().transforms_written == before.transforms_written + 3);
  CHECK(flattener.counters().nodes_visited == before.nodes_visited);
}

TEST_CASE("an unchanged graph costs nothing") {
  Example e;
  Flattener flattener(e.root);
  const DrawList::Revisions revisions = flattener.update().revisions;
  const FlattenCounters before = flattener.counters();
  e.outer->set_matrix(e.outer->matrix());
  CHECK(flattener.update().revisions == revisions);
  CHECK(flattener.counters() == before);
}

TEST_CASE("a node under two parents is drawn twice, and moves in both places") {
  const auto root = std::make_shared<Separator>();
  const auto part = std::make_shared<Separator>();
  const auto joint = std::make_shared<Transform>(moved(0, 1));
  part->add(joint);
  part->add(std::make_shared<Shape>(some_mesh()));
  for (const double x : {5.0, 7.0}) {
    const auto place = std::make_shared<Separator>();
    place->add(std::make_shared<Transform>(moved(x)));
    place->add(part);
    root->add(place);
  }
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == 2);
  CHECK(x_of(list, 0) == 5);
  CHECK(x_of(list, 1) == 7);
  joint->set_matrix(moved(100));
  flattener.update();
  CHECK(x_of(list, 0) == 105);
  CHECK(x_of(list, 1) == 107);
  CHECK(flattener.counters().transforms_written == 2);
}

TEST_CASE("materials: equal pointers share a slot, a changed node has its own, and a change writes only that") {
  const auto root = std::make_shared<Separator>();
  const auto material = painted(0.25f);
  const auto first = std::make_shared<MaterialNode>(material);
  const auto second = std::make_shared<MaterialNode>(material);
  const auto shape = std::make_shared<Shape>(some_mesh());
  for (const auto& node : {first, second}) {
    root->add(node);
    root->add(shape);
  }
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  CHECK(list.materials.size() == 1);

  second->set_material(painted(0.5f));
  flattener.update();
  REQUIRE(list.materials.size() == 2);
  const FlattenCounters before = flattener.counters();
  const DrawList::Revisions revisions = list.revisions;

  second->set_material(painted(0.75f));
  flattener.update();
  CHECK(list.materials[list.items[0].material]->base_color.r == 0.25f);
  CHECK(list.materials[list.items[1].material]->base_color.r == 0.75f);
  CHECK(flattener.counters().rebuilds == before.rebuilds);
  CHECK(flattener.counters().materials_written == before.materials_written + 1);
  CHECK(list.revisions.structure == revisions.structure);
  CHECK(list.revisions.transforms == revisions.transforms);
  CHECK(list.material_revision[list.items[1].material] > list.material_revision[list.items[0].material]);
}

TEST_CASE("a shape without a material is white") {
  const auto root = std::make_shared<Separator>();
  root->add(std::make_shared<Shape>(some_mesh()));
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  CHECK(list.materials.at(list.items.at(0).material)->base_color == glm::vec4(1));
}

TEST_CASE("a changed light writes its slot") {
  const auto root = std::make_shared<Separator>();
  const auto lamp = std::make_shared<LightNode>(Light{});
  root->add(std::make_shared<Transform>(moved(3)));
  root->add(lamp);
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  Light bright;
  bright.intensity = 7;
  lamp->set_light(bright);
  flattener.update();
  CHECK(list.lights.at(0).light.intensity == 7);
  CHECK(list.world_from_node[list.lights.at(0).transform][3].x == 3);
  CHECK(flattener.counters().lights_written == 1);
  CHECK(flattener.counters().rebuilds == 1);
}

TEST_CASE("a changed visibility rewrites the items that it governs") {
  // visibility { shape, separator { visibility, shape }, shape }, shape
  const auto root = std::make_shared<Separator>();
  const auto part = std::make_shared<Separator>(), inside = std::make_shared<Separator>();
  const auto outer = std::make_shared<Visibility>(), inner = std::make_shared<Visibility>();
  const auto shape = std::make_shared<Shape>(some_mesh());
  for (const NodePtr& node : std::initializer_list<NodePtr>{outer, shape, inside, shape}) part->add(node);
  inside->add(inner);
  inside->add(shape);
  root->add(part);
  root->add(shape);
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  const auto seen = [&](bool with_outer, bool with_inner) {
    outer->set_visible(with_outer);
    inner->set_visible(with_inner);
    flattener.update();
    std::string visible;
    for (const DrawItem& item : list.items) visible += item.visible ? '1' : '0';
    return visible;
  };
  CHECK(seen(true, true) == "1111");
  CHECK(seen(true, false) == "1011");
  CHECK(seen(false, false) == "0001");
  CHECK(seen(false, true) == "0001");
  CHECK(seen(true, true) == "1111");
  CHECK(flattener.counters().rebuilds == 1);
  CHECK(flattener.counters().items_shown_or_hidden == 1 + 2 + 0 + 3);
}

TEST_CASE("a hidden light leaves the list") {
  const auto root = std::make_shared<Separator>();
  const auto visibility = std::make_shared<Visibility>();
  root->add(visibility);
  root->add(std::make_shared<LightNode>(Light{}));
  Flattener flattener(root);
  CHECK(flattener.update().lights.size() == 1);
  visibility->set_visible(false);
  CHECK(flattener.update().lights.empty());
  visibility->set_visible(true);
  CHECK(flattener.update().lights.size() == 1);
}

TEST_CASE("a switch shows one child, all or none") {
  const auto root = std::make_shared<Separator>();
  const auto choice = std::make_shared<Switch>();
  const auto shape = std::make_shared<Shape>(some_mesh());
  choice->add(shape);
  choice->add(std::make_shared<Transform>(moved(4)));
  choice->add(shape);
  root->add(choice);
  Flattener flattener(root);
  CHECK(flattener.update().items.size() == 2);
  choice->set_which(Switch::kNone);
  CHECK(flattener.update().items.empty());
  choice->set_which(2);
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == 1);
  CHECK(x_of(list, 0) == 0);  // the transform in front of it was not traversed
}

TEST_CASE("mounts report their place, but only if they are reached") {
  const auto root = std::make_shared<Separator>();
  const auto mount = std::make_shared<Mount>();
  const auto place = std::make_shared<Transform>(moved(1, 2, 3));
  const auto choice = std::make_shared<Switch>();
  root->add(place);
  root->add(choice);
  choice->add(mount);
  Flattener flattener(root);
  flattener.update();
  glm::dmat4 world_from_mount{0.0};
  REQUIRE(flattener.find_mount(*mount, world_from_mount));
  CHECK(world_from_mount == moved(1, 2, 3));
  place->set_matrix(moved(9));
  flattener.update();
  REQUIRE(flattener.find_mount(*mount, world_from_mount));
  CHECK(world_from_mount == moved(9));
  choice->set_which(Switch::kNone);
  flattener.update();
  CHECK_FALSE(flattener.find_mount(*mount, world_from_mount));
}

TEST_CASE("a graph 100,000 levels deep and one 100,000 nodes wide") {
  constexpr int kCount = 100'000;
  const auto shape = std::make_shared<Shape>(some_mesh());
  const auto deep = std::make_shared<Separator>();
  GroupPtr at = deep;
  for (int level = 0; level < kCount; ++level) {
    const auto next = std::make_shared<Separator>();
    next->add(std::make_shared<Transform>(moved(1)));
    at->add(next);
    at = next;
  }
  at->add(shape);
  const auto root = std::make_shared<Separator>();
  root->add(deep);
  for (int i = 0; i < kCount; ++i) root->add(shape);
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == kCount + 1);
  CHECK(x_of(list, 0) == kCount);
  CHECK(x_of(list, 1) == 0);
}

TEST_CASE("a cycle is refused") {
  const auto root = std::make_shared<Separator>();
  const auto inner = std::make_shared<Group>();
  root->add(inner);
  inner->add(root);
  {
    Flattener flattener(root);
    CHECK_THROWS_WITH_AS(flattener.update(), doctest::Contains("cycle"), InputError);
  }
  inner->remove(*root);
}

TEST_CASE("after any changes the list equals a newly flattened one") {
  std::mt19937 random(7);
  const auto pick = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  std::vector<GroupPtr> groups{std::make_shared<Separator>()};
  std::vector<std::shared_ptr<Transform>> transforms;
  std::vector<std::shared_ptr<MaterialNode>> materials;
  std::vector<std::shared_ptr<Visibility>> visibilities;
  std::vector<std::shared_ptr<Shape>> shapes;
  const auto shape = std::make_shared<Shape>(some_mesh());
  Flattener flattener(groups.front());
  for (int step = 0; step < 2000; ++step) {
    switch (pick(12)) {
      case 0:
        groups.push_back(pick(2) ? std::make_shared<Group>() : std::make_shared<Separator>());
        groups[pick(groups.size() - 1)]->add(groups.back());
        break;
      case 1:
        transforms.push_back(std::make_shared<Transform>(moved(static_cast<double>(step))));
        groups[pick(groups.size())]->add(transforms.back());
        break;
      case 2:
        materials.push_back(std::make_shared<MaterialNode>(painted(static_cast<float>(step))));
        groups[pick(groups.size())]->add(materials.back());
        break;
      case 3:
        groups[pick(groups.size())]->add(shape);
        break;
      case 4:
        if (!materials.empty()) materials[pick(materials.size())]->set_material(painted(static_cast<float>(-step)));
        break;
      case 5:
        visibilities.push_back(std::make_shared<Visibility>());
        groups[pick(groups.size())]->add(visibilities.back());
        break;
      case 6:
        shapes.push_back(std::make_shared<Shape>(some_mesh()));
        groups[pick(groups.size())]->add(shapes.back());
        break;
      case 7:
        if (step % 8 == 0) groups[pick(groups.size())]->add(std::make_shared<LightNode>(Light{}));
        break;
      case 8:
        if (!visibilities.empty()) visibilities[pick(visibilities.size())]->set_visible(pick(3) > 0);
        break;
      case 9:
        if (!shapes.empty()) shapes[pick(shapes.size())]->set_mesh(some_mesh());
        break;
      default:
        if (!transforms.empty()) transforms[pick(transforms.size())]->set_matrix(moved(0, static_cast<double>(step)));
    }
    const DrawList& list = flattener.update();
    if (step % 10 == 0) {
      Flattener fresh(groups.front());
      REQUIRE(same_content(list, fresh.update()));
      REQUIRE(content_hash(list) == content_hash(fresh.update()));
    }
  }
  CHECK(flattener.update().items.size() > 100);
  CHECK(flattener.counters().transforms_written > 0);
  CHECK(flattener.counters().items_shown_or_hidden > 0);
  CHECK(flattener.counters().meshes_written > 0);
}

TEST_SUITE_END();
