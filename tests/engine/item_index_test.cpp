// A change log of a draw list saves its readers a comparison and does not change their results: worlds of many
// primitives, some of which move, change, appear and disappear, compared with copies of the same list without a log.
#include "engine/geometry/item_index.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <random>
#include <vector>

#include "engine/render/render_queue.h"
#include "scenegraph/flattener.h"
#include "sensors/laser_scanner/rendered_scan.h"
#include "sensors/raster_depth/vertex_rounding.h"
#include "tests/support/ray_casting.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

std::shared_ptr<const Mesh> finished(Mesh mesh, Topology topology = Topology::triangles) {
  mesh.attributes.resize(mesh.positions.size());
  mesh.topology = topology;
  compute_bounds(mesh);
  return std::make_shared<const Mesh>(std::move(mesh));
}

/// One primitive.
Mesh of(std::vector<glm::vec3> corners) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < corners.size(); ++i) mesh.indices.push_back(i);
  mesh.positions = std::move(corners);
  return mesh;
}

std::shared_ptr<const Material> painted(const glm::vec4& color, bool double_sided) {
  Material material;
  material.base_color = color;
  material.double_sided = double_sided;
  if (color.a < 1) material.alpha_mode = AlphaMode::blend;
  return std::make_shared<const Material>(material);
}

/// Groups of primitives of few kinds, which can be moved one by one or as a group, hidden, and get other meshes.
class Crowd {
 public:
  Crowd(int groups, int primitives, double size_m, const glm::dvec3& middle) : size_m_(size_m) {
    root_->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1.0), middle)));
    for (int g = 0; g < groups; ++g) {
      groups_.push_back({std::make_shared<Separator>(), std::make_shared<Transform>(glm::dmat4(1.0))});
      groups_.back().holder->add(groups_.back().place);
      root_->add(groups_.back().holder);
    }
    for (int t = 0; t < primitives; ++t) add();
  }

  GroupPtr root() const { return root_; }

  void add() {
    std::uniform_int_distribution<std::size_t> group(0, groups_.size() - 1), kind(0, 999);
    Primitive primitive{.place = std::make_shared<Transform>(place()), .group = group(random_)};
    primitive.holder->add(primitive.place);
    primitive.holder->add(std::make_shared<MaterialNode>(materials_[kind(random_) % materials_.size()]));
    primitive.holder->add(primitive.visibility);
    primitive.shape = std::make_shared<Shape>(meshes_[kind(random_) % meshes_.size()]);
    primitive.holder->add(primitive.shape);
    groups_[primitive.group].holder->add(primitive.holder);
    primitives_.push_back(primitive);
  }

  void remove() {
    const Primitive primitive = primitives_[any(primitives_.size())];
    groups_[primitive.group].holder->remove(*primitive.holder);
    std::erase_if(primitives_, [&](const Primitive& each) { return each.holder == primitive.holder; });
  }

  void move() { primitives_[any(primitives_.size())].place->set_matrix(place()); }
  void move_a_little() {
    const std::shared_ptr<Transform>& place = primitives_[any(primitives_.size())].place;
    place->set_matrix(glm::translate(glm::dmat4(1.0), {0.01, 0, 0}) * place->matrix());
  }
  void show_or_hide() {
    Visibility& visibility = *primitives_[any(primitives_.size())].visibility;
    visibility.set_visible(!visibility.visible());
  }
  Visibility& first_visibility() { return *primitives_.front().visibility; }
  /// Gives the first primitive, which becomes a sphere, another mesh.
  void reshape_first() { reshape(primitives_.front().shape, *meshes_[kSphere]); }
  void reshape() { reshape(primitives_[any(primitives_.size())].shape, *meshes_[any(meshes_.size())]); }
  /// Gives one of the first primitives another mesh: from the second time on, its mesh has a slot of its own.
  void reshape_again() { reshape(primitives_[any(5)].shape, *meshes_[any(meshes_.size())]); }
  void move_group() { groups_[any(groups_.size())].place->set_matrix(random_pose(random_, 1)); }

 private:
  struct Parent {
    std::shared_ptr<Separator> holder;
    std::shared_ptr<Transform> place;
  };
  struct Primitive {
    std::shared_ptr<Separator> holder = std::make_shared<Separator>();
    std::shared_ptr<Transform> place;
    std::size_t group = 0;
    std::shared_ptr<Visibility> visibility = std::make_shared<Visibility>();
    std::shared_ptr<Shape> shape{};
  };

  static void reshape(const std::shared_ptr<Shape>& shape, Mesh mesh) {
    for (glm::vec3& position : mesh.positions) position *= 1.1f;
    compute_bounds(mesh);
    shape->set_mesh(std::make_shared<const Mesh>(std::move(mesh)));
  }

  std::size_t any(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }
  glm::dmat4 place() {
    const glm::dvec3 scales[] = {{1, 1, 1}, {1, 1, 1}, {-1, 1, 1}, {1, 3, 0.5}, {1, 1, 0}};
    const glm::dvec3 scale = scales[any(std::size(scales))];
    std::uniform_real_distribution<double> unit(-1, 1);
    const glm::dvec3 where = size_m_ * glm::dvec3(unit(random_), unit(random_), 0.2 * unit(random_));
    const bool turned = any(2) == 0;  // primitives of a kind without rotation differ in their places only
    return glm::translate(glm::dmat4(1.0), where) * (turned ? random_pose(random_, 0) : glm::dmat4(1.0)) *
           glm::scale(glm::dmat4(1.0), scale);
  }

  double size_m_;
  std::mt19937 random_{7};
  GroupPtr root_ = std::make_shared<Separator>();
  std::vector<Parent> groups_;
  std::vector<Primitive> primitives_;
  static constexpr std::size_t kSphere = 2;  // in meshes_
  std::vector<std::shared_ptr<const Mesh>> meshes_{
      finished(half_box_mesh(glm::vec3(0.3f))), finished(half_box_mesh({1.5f, 0.1f, 0.1f})),
      finished(sphere_mesh(0.4, 16)), finished(of({{9, 0, 0}, {9, 1, 0}, {9, 0, 1}})),
      finished(of({{0, 0, 0}, {1, 0, 0}}), Topology::lines)};
  std::vector<std::shared_ptr<const Material>> materials_{painted({0.8f, 0.2f, 0.1f, 1}, false),
                                                          painted({0.1f, 0.6f, 0.2f, 1}, true),
                                                          painted({0, 0.2f, 0.9f, 0.5f}, true)};
};

const glm::dmat4 kCameraFromSensor({0, 0, 1, 0}, {-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 0, 1});

/// A picture with depth, and a planar scan.
FramePlan picture_and_scan(const glm::dmat4& sensor_from_world, RenderedScan& scan) {
  FramePlan plan = test::plan_of(48, 32, 30, true, true);
  test::view_of(plan).view_from_world = kCameraFromSensor * sensor_from_world;
  scan.plan("scanner", "", sensor_from_world, plan, "scanner");
  return plan;
}

void check_same_bytes(Renderer& accounted, const DrawList& list, Renderer& compared, const DrawList& copy,
                      const FramePlan& plan) {
  const std::span<const PassResult> a = accounted.render(list, plan), b = compared.render(copy, plan);
  REQUIRE(a.size() == b.size());
  for (std::size_t pass = 0; pass < a.size(); ++pass) {
    CHECK(test::same_bytes(a[pass].depth, b[pass].depth));
    CHECK(test::same_bytes(a[pass].color, b[pass].color));
    for (std::size_t view = 0; view < a[pass].views.size(); ++view) {
      ViewCounts counts = a[pass].views[view];
      counts.boxes_examined = b[pass].views[view].boxes_examined;
      CHECK(counts == b[pass].views[view]);
    }
  }
  CHECK(accounted.counters() == compared.counters());
}

void check_same_rounding(const DrawList& list, const DrawList& copy, const glm::dmat4& sensor_from_world) {
  const VertexRounding accounted(list, sensor_from_world), compared(copy, sensor_from_world);
  for (double range_m = 0x1p-13; range_m < 0x1p13; range_m *= 1.09) {
    REQUIRE(accounted.at(range_m) == compared.at(range_m));
  }
}

void check_same_sight(const DrawList& list, const View& view) {
  const ViewProjection projection = make_projection(view);
  const ItemIndex& index = *index_of(list);
  std::vector<std::uint32_t> found, seen;
  index.find_seen(projection, found);
  std::ranges::sort(found);
  for (std::uint32_t item = 0; item < list.items.size(); ++item) {
    const Mesh& mesh = *list.meshes[list.items[item].mesh];
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    const WorldBox box =
        make_box(list.world_from_node[list.items[item].transform], 0.5 * (low + high), 0.5 * (high - low));
    if (!outside(projection, box)) seen.push_back(item);
  }
  REQUIRE(found == seen);
}

}  // namespace

TEST_CASE(
    "moving, changing, added and removed primitives: the same draws, hits and roundings as for a list that is "
    "compared") {
  std::mt19937 random(3);
  for (const double away_m : {0.0, 1e7}) {
    const glm::dvec3 middle(away_m, -away_m, 0.5 * away_m);
    Crowd crowd(20, 2000, 30, middle);
    Flattener flattener(crowd.root());
    Renderer accounted(test::device()), compared(test::device());
    const RayEngine caster{make_host_ray_caster()};
    RenderedScan scan({.beams = 61, .rings = 1, .min_azimuth_rad = -1.5, .max_azimuth_rad = 1.5}, 256);
    std::vector<glm::dvec3> directions;
    for (int ray = 0; ray < 200; ++ray) directions.push_back(random_direction(random));
    for (int frame = 0; frame < 12; ++frame) {
      CAPTURE(frame);
      for (int i = 0; i < 15; ++i) crowd.move();
      for (int i = 0; i < 15; ++i) crowd.move_a_little();
      for (int i = 0; i < 9; ++i) crowd.show_or_hide();
      for (int i = 0; i < 3; ++i) crowd.reshape_again();
      if (frame % 6 == 1) crowd.reshape();
      if (frame % 3 == 1) crowd.move_group();
      if (frame == 5) {
        for (int i = 0; i < 4000; ++i) crowd.move();
      }
      if (frame % 4 == 2) {
        for (int i = 0; i < 40; ++i) crowd.remove();
        for (int i = 0; i < 50; ++i) crowd.add();
      }
      const DrawList& list = flattener.update();
      const DrawList copy = list;
      REQUIRE(list.changes.kept());
      REQUIRE(!copy.changes.kept());
      const glm::dmat4 world_from_sensor = glm::translate(glm::dmat4(1.0), middle) * random_pose(random, 10);
      const glm::dmat4 sensor_from_world = rigid_inverse(world_from_sensor);
      const FramePlan plan = picture_and_scan(sensor_from_world, scan);
      if (frame % 5 == 4) continue;  // a reader that skipped frames gets all changes since
      for (const Pass& pass : plan.passes) check_same_sight(list, pass.views[0]);
      check_same_bytes(accounted, list, compared, copy, plan);
      check_same_rounding(list, copy, sensor_from_world);
      const RayEngine afresh{make_host_ray_caster()};
      CHECK(caster.cast(list, world_from_sensor, directions) == afresh.cast(copy, world_from_sensor, directions));
    }
  }
}

TEST_CASE("hidden primitives: the same picture, hits and roundings as without them") {
  std::mt19937 random(11);
  Crowd crowd(5, 600, 12, {0, 0, 0});
  Flattener flattener(crowd.root());
  Renderer hiding(test::device()), lacking(test::device());
  const RayEngine caster{make_host_ray_caster()};
  RenderedScan scan({.beams = 61, .rings = 1, .min_azimuth_rad = -1.5, .max_azimuth_rad = 1.5}, 256);
  std::vector<glm::dvec3> directions;
  for (int ray = 0; ray < 500; ++ray) directions.push_back(random_direction(random));
  flattener.update();
  for (int frame = 0; frame < 10; ++frame) {
    CAPTURE(frame);
    for (int i = 0; i < 100; ++i) crowd.show_or_hide();
    const DrawList& list = flattener.update();
    DrawList without = list;
    std::vector<std::uint32_t> item_of;
    for (std::uint32_t i = 0; i < list.items.size(); ++i) {
      if (list.items[i].visible) item_of.push_back(i);
    }
    std::erase_if(without.items, [](const DrawItem& item) { return !item.visible; });
    REQUIRE(without.items.size() < list.items.size());
    const glm::dmat4 world_from_sensor = random_pose(random, 4);
    const glm::dmat4 sensor_from_world = rigid_inverse(world_from_sensor);
    const FramePlan plan = picture_and_scan(sensor_from_world, scan);
    const std::span<const PassResult> a = hiding.render(list, plan), b = lacking.render(without, plan);
    for (std::size_t pass = 0; pass < a.size(); ++pass) {
      CHECK(test::same_bytes(a[pass].depth, b[pass].depth));
      CHECK(test::same_bytes(a[pass].color, b[pass].color));
      for (std::size_t view = 0; view < a[pass].views.size(); ++view) {
        CHECK(a[pass].views[view].draws == b[pass].views[view].draws);
      }
    }
    check_same_rounding(list, without, sensor_from_world);
    std::vector<RayHit> expected = host_engine().cast(without, world_from_sensor, directions);
    for (RayHit& hit : expected) {
      if (std::isfinite(hit.range_m)) hit.item = item_of[hit.item];
    }
    CHECK(caster.cast(list, world_from_sensor, directions) == expected);
  }
  CHECK(flattener.counters().rebuilds == 1);
}

TEST_CASE("a shown, hidden or changed primitive costs its own work, not that of the world") {
  Crowd crowd(1, 1000, 20, {0, 0, 0});
  Flattener flattener(crowd.root());
  const RayEngine caster{make_host_ray_caster()};
  crowd.reshape_again();
  for (int i = 0; i < 5; ++i) crowd.show_or_hide();
  const auto cost_of = [&](const auto& change) {
    caster.cast_one(flattener.update(), {1, 0, 0});
    const FlattenCounters flattened = flattener.counters();
    const RayCounters cast = caster.caster->counters();
    change();
    caster.cast_one(flattener.update(), {1, 0, 0});
    CHECK(flattener.counters().rebuilds == flattened.rebuilds);
    CHECK(flattener.counters().nodes_visited == flattened.nodes_visited);
    RayCounters cost = caster.caster->counters();
    cost.item_trees_built -= cast.item_trees_built;
    cost.item_trees_refitted -= cast.item_trees_refitted;
    cost.items_placed -= cast.items_placed;
    cost.meshes_built -= cast.meshes_built;
    return cost;
  };
  Visibility& visibility = crowd.first_visibility();
  visibility.set_visible(true);
  for (const bool visible : {false, true, false}) {
    const RayCounters cost = cost_of([&] { visibility.set_visible(visible); });
    CHECK(cost.item_trees_built == 0);
    CHECK(cost.item_trees_refitted == 0);
    CHECK(cost.items_placed == 0);
    CHECK(cost.meshes_built == 0);
  }
  visibility.set_visible(true);
  crowd.reshape_first();
  const RayCounters reshaped = cost_of([&] { crowd.reshape_first(); });
  CHECK(reshaped.item_trees_built == 0);
  CHECK(reshaped.item_trees_refitted == 1);
  CHECK(reshaped.items_placed == 1);
  CHECK(reshaped.meshes_built == 1);
}

TEST_CASE("invisible primitives are rarely examined, and resting ones never") {
  // The same primitives around the sensor, and ten times as many of them beyond.
  std::uint64_t looked_at[2] = {}, items[2] = {};
  for (const int more : {0, 1}) {
    Crowd crowd(1, 1000, 20, {0, 0, 0});
    Crowd beyond(1, more * 10000 + 1, 20, {-1000, 0, 0});
    const auto world = std::make_shared<Separator>();
    world->add(crowd.root());
    world->add(beyond.root());
    Flattener flattener(world);
    const DrawList& list = flattener.update();
    View view = test::plan_of(48, 32, 30, true, true).passes[0].views[0];
    view.view_from_world = kCameraFromSensor;
    std::vector<std::uint32_t> seen;
    looked_at[more] = index_of(list)->find_seen(make_projection(view), seen);
    items[more] = list.items.size();
    CHECK(seen.size() > 50);

    const RayEngine caster{make_host_ray_caster()};
    caster.cast_one(list, {1, 0, 0});
    RayCounters expected = caster.caster->counters();
    crowd.move();
    flattener.update();
    caster.cast_one(list, {1, 0, 0});
    ++expected.items_placed;
    ++expected.item_trees_refitted;
    expected.rays = 2;
    expected.item_tests = caster.caster->counters().item_tests;
    expected.triangle_tests = caster.caster->counters().triangle_tests;
    expected.single_rays = caster.caster->counters().single_rays;
    CHECK(caster.caster->counters() == expected);
  }
  MESSAGE(looked_at[0] << " boxes of " << items[0] << " items, " << looked_at[1] << " of " << items[1]);
  CHECK(looked_at[1] <= looked_at[0] + 2 * Bvh::kMaxDepth);  // the path down to those around
}

TEST_CASE("a log reports moved items, and copies have no log") {
  DrawList list;
  CHECK(!list.changes.kept());
  CHECK(!list.changes.same_structure(list.changes.version()));
  list.changes.mark_structure_dirty();
  const ListVersion first = list.changes.version();
  CHECK(list.changes.same_structure(first));
  CHECK(list.changes.moved_since(first)->empty());
  CHECK(list.changes.items_since(first)->empty());
  list.changes.mark_transforms_dirty({2, 3});
  list.changes.mark_transforms_dirty({5, 9});
  const ListVersion second = list.changes.version();
  list.changes.mark_transforms_dirty({1, 2});
  REQUIRE(list.changes.moved_since(first)->size() == 3);
  CHECK(list.changes.moved_since(first)->front().first == 2);
  REQUIRE(list.changes.moved_since(second)->size() == 1);
  CHECK(list.changes.moved_since(second)->front().end == 2);
  CHECK(!list.changes.moved_since({}));
  list.changes.mark_item_dirty(4);
  list.changes.mark_item_dirty(2);
  CHECK(list.changes.same_structure(second));
  REQUIRE(list.changes.items_since(second)->size() == 2);
  CHECK(list.changes.items_since(second)->front() == 4);
  CHECK(list.changes.moved_since(second)->size() == 1);
  CHECK(!list.changes.items_since({}));

  const DrawList copy = list;
  CHECK(!copy.changes.kept());
  CHECK(!copy.changes.moved_since(second));
  CHECK(index_of(copy) == nullptr);

  DrawList other;
  other.changes.mark_structure_dirty();
  CHECK(!other.changes.same_structure(first));
  for (int i = 0; i < 200'000; ++i) list.changes.mark_transforms_dirty({7, 8});  // more than it stores
  for (int i = 0; i < 200'000; ++i) list.changes.mark_item_dirty(3);
  CHECK(!list.changes.items_since(second));
  CHECK(!list.changes.moved_since(second));
  CHECK(list.changes.moved_since(list.changes.version())->empty());
  other = list;
  CHECK(!other.changes.kept());
  list.changes.mark_structure_dirty();
  CHECK(!list.changes.same_structure(second));
}

TEST_CASE("moved items get their place in the draw order as if all were sorted again") {
  std::mt19937 random(5);
  const auto any = [&](std::uint32_t below) {
    return std::uniform_int_distribution<std::uint32_t>(0, below - 1)(random);
  };
  DrawList list;
  RenderQueue order, afresh;
  constexpr std::uint32_t kItems = 500;
  std::vector<Drawable> drawables;
  for (std::uint32_t item = 0; item < kItems; ++item) {
    list.world_from_node.push_back(test::at(any(20), 0, 0));
    if (item % 7 == 0) continue;
    Drawable& drawable = drawables.emplace_back();
    drawable.item = drawable.transform = item;
    drawable.rank = any(6);
  }
  const auto fill = [&](RenderQueue& filled) {
    filled.clear(kItems);
    for (const Drawable& drawable : drawables) filled.add(drawable);
    filled.sort(list);
  };
  fill(order);
  for (int frame = 0; frame < 200; ++frame) {
    std::vector<std::uint32_t> moved;
    for (std::uint32_t i = any(12); i-- > 0;) {
      moved.push_back(any(kItems));  // some of them twice
      list.world_from_node[moved.back()] = test::at(any(20), 0, 0);
    }
    order.sort(list, moved);
    fill(afresh);
    for (std::uint32_t p = 0; p < drawables.size(); ++p) {
      REQUIRE(order[p].item == afresh[p].item);
      REQUIRE(order.position(order[p].item) == p);
    }
    CHECK(order.position(0) == RenderQueue::kNone);
  }
}

TEST_SUITE_END();
