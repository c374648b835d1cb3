#include "simvis/ignored_items.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/object_tree.h>
#include <simvis/ray_caster.h>
#include <simvis/sensor.h>
#include "elements/visibility_flags.h"
#include "engine/base/even_points.h"
#include "scenegraph/graph_walk.h"
#include "simvis/inside_solid.h"
#include "simvis/mount_frame.h"
#include "simvis/selected_items.h"

namespace simvis {
namespace {

// The insertion points of what the attribute `ignore` of a sensor names.
struct IgnoredPoints {
  std::set<std::string> points;
  bool are_solids_around = false;    // of their shapes only those that contain the sensor
  std::vector<std::string> unknown;  // words of the attribute that name no object
};

using ItemsOfPoints = std::unordered_map<std::string_view, std::vector<std::uint32_t>>;

ItemsOfPoints items_of_points(const Flattener& flattener) {
  ItemsOfPoints items;
  const std::vector<ItemSource>& sources = flattener.item_sources();
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (sources[i].point != nullptr) items[sources[i].point->name].push_back(i);
  }
  return items;
}

std::set<std::string> named_points(const ObjectTree& objects, const std::string& value,
                                   std::vector<std::string>& unknown) {
  std::set<std::string> points;
  for (const std::uint32_t object : objects.named(value, unknown)) {
    for (const std::uint32_t each : objects.content_of(object)) points.insert(objects[each].name);
  }
  return points;
}

// The points whose shapes stand around a mount, the innermost one first: of each group that holds it, the last point in
// front of it.
std::vector<std::string> points_around(const Group& root, const Mount& mount) {
  std::vector<std::string> open(1), found;
  walk_graph(root, {.visit =
                        [&](const Node& node, const WalkState&) {
                          if (&node == &mount) found.assign(open.rbegin(), open.rend());
                          if (dynamic_cast<const Group*>(&node) != nullptr) open.push_back(open.back());
                          if (node.kind() == NodeKind::insertion_point) open.back() = node.name;
                        },
                    .leave = [&](const Group&) { open.pop_back(); }});
  return found;
}

// The point of the own link. Empty: the sensor has none, or none with shapes.
std::string own_point(const BuiltScene& built, const BuiltSensor& sensor,
                      const std::function<bool(const std::string&)>& has_shapes) {
  const ObjectTree& objects = built.scene.objects();
  const std::optional<std::uint32_t> own = objects.find(sensor.command.require("insert_at").value);
  if (!own || objects[*own].kind == ObjectKind::world) return {};
  if (has_shapes(objects[*own].name)) return objects[*own].name;
  for (const std::string& point : points_around(*built.scene.root(), *sensor.mount)) {
    const std::optional<std::uint32_t> object = objects.find(point);
    if (object && objects[*object].part == objects[*own].part && has_shapes(point)) return point;
  }
  return {};
}

// None for types such as `bumper`, which have an attribute of this name themselves. `has_shapes` says whether shapes
// stand behind an insertion point.
IgnoredPoints ignored_points(const BuiltScene& built, const BuiltSensor& sensor,
                             const std::function<bool(const std::string&)>& has_shapes) {
  IgnoredPoints ignored;
  const AttributeTable own_rows = find_sensor_type(sensor.type)->attributes;
  if (std::ranges::count(own_rows, kIgnore, &AttributeSpec::name) > 0) return ignored;
  if (const CommandAttribute* const written = sensor.command.find(kIgnore)) {
    if (written->value == kIgnoreNone) return ignored;
    ignored.points = named_points(built.scene.objects(), written->value, ignored.unknown);
    return ignored;
  }
  if (std::string own = own_point(built, sensor, has_shapes); !own.empty()) ignored.points.insert(std::move(own));
  ignored.are_solids_around = true;
  return ignored;
}

// The attribute `near` of a camera, in metres: nearer surfaces are not drawn. 0 for sensors without it.
double near_of(const BuiltSensor& sensor) {
  double near_m = 0;
  if (const CommandAttribute* const written = sensor.command.find("near")) {
    parse_number(written->value, near_m);
    return near_m;
  }
  for (const AttributeSpec& row : find_sensor_type(sensor.type)->attributes) {
    if (row.name == "near") parse_number(row.default_value, near_m);
  }
  return near_m;
}

std::uint32_t visibility_mask_of(const BuiltSensor& sensor) {
  double mask = kAllVisibilityFlags;
  if (const CommandAttribute* const written = sensor.command.find(kVisibilityMask)) parse_number(written->value, mask);
  return static_cast<std::uint32_t>(mask);
}

// By item of the flattener's last update(). Empty: all items have all flags.
std::vector<std::uint32_t> flags_of_items(const BuiltScene& built, const Flattener& flattener) {
  const std::vector<const VisibilityFlags*> elements = visibility_flags_of(built.scene);
  std::vector<std::uint32_t> flags;
  if (elements.empty()) return flags;
  std::vector<const ShapeSelection*> selections;
  selections.reserve(elements.size());
  for (const VisibilityFlags* const each : elements) selections.push_back(&each->shapes);
  for (const SelectedItem& each : selections_of_items(selections, flattener)) {
    flags.push_back(each.selection == 0 ? kAllVisibilityFlags : elements[each.selection - 1]->flags);
  }
  return flags;
}

// One sensor of a flattened scene.
class Finder {
 public:
  Finder(const BuiltScene& built, const Flattener& flattener, const DrawList& list,
         const std::function<void(const std::string&)>& warn)
      : built_(built),
        flattener_(flattener),
        list_(list),
        warn_(warn),
        items_(items_of_points(flattener)),
        flags_(flags_of_items(built, flattener)) {}

  std::vector<std::uint32_t> find(const BuiltSensor& sensor, std::string& warning) const {
    const std::vector<std::uint32_t> masked = masked_items(sensor);
    std::vector<std::uint32_t> ignored = ignored_items(sensor, masked, warning), all;
    std::ranges::set_union(ignored, masked, std::back_inserter(all));
    return all;
  }

 private:
  std::vector<std::uint32_t> masked_items(const BuiltSensor& sensor) const {
    std::vector<std::uint32_t> items;
    const std::uint32_t mask = visibility_mask_of(sensor);
    if (flags_.empty() && mask != 0) return items;
    for (std::uint32_t i = 0; i < list_.items.size(); ++i) {
      if (((flags_.empty() ? kAllVisibilityFlags : flags_[i]) & mask) == 0) items.push_back(i);
    }
    return items;
  }

  // Those of the attribute `ignore`, or of the own link. The warning names no masked ones.
  std::vector<std::uint32_t> ignored_items(const BuiltSensor& sensor, std::span<const std::uint32_t> masked,
                                           std::string& warning) const {
    const IgnoredPoints ignored =
        ignored_points(built_, sensor, [this](const std::string& point) { return items_.contains(point); });
    for (const std::string& word : ignored.unknown) {
      warn_(to_string(sensor.command.require(kIgnore).where) + ": attribute " + in_quotes(kIgnore) + ": " +
            built_.scene.objects().unknown("part or link", word));
    }
    std::vector<std::uint32_t> items;
    for (const std::string& point : ignored.points) {
      const auto own = items_.find(point);
      if (own != items_.end()) items.insert(items.end(), own->second.begin(), own->second.end());
    }
    std::ranges::sort(items);
    if (!ignored.are_solids_around || items.empty()) return items;
    std::erase_if(items, [&](std::uint32_t i) { return std::ranges::binary_search(masked, i); });
    keep_solids_around(sensor, items);
    if (!items.empty()) warning = warning_of(sensor, *ignored.points.begin(), items);
    return items;
  }

  void keep_solids_around(const BuiltSensor& sensor, std::vector<std::uint32_t>& items) const {
    glm::dmat4 world_from_mount;
    if (!flattener_.find_mount(*sensor.mount, world_from_mount)) return items.clear();
    const auto is_other = [this, own = own_part_points(sensor)](std::uint32_t i) {
      const InsertionPoint* const point = flattener_.item_sources()[i].point;
      return list_.items[i].visible && (point == nullptr || !own.contains(point->name));
    };
    std::erase_if(items, [&, near_m = near_of(sensor)](std::uint32_t i) {
      const DrawItem& item = list_.items[i];
      return !is_depth_visible(list_.materials[item.material].get()) ||
             !is_inside_solid(*list_.meshes[item.mesh], list_.world_from_node[item.transform],
                              glm::dvec3(world_from_mount[3]), near_m) ||
             contains_most_others(i, is_other);
    });
  }

  std::set<std::string> own_part_points(const BuiltSensor& sensor) const {
    const ObjectTree& objects = built_.scene.objects();
    std::set<std::string> points;
    const std::optional<std::uint32_t> own = objects.find(sensor.command.require("insert_at").value);
    for (const std::uint32_t each : objects.content_of(objects[*own].part)) points.insert(objects[each].name);
    return points;
  }

  // Whether more shapes of other parts have their middle in the box of the solid than outside. Then it is a room and no
  // housing. Shapes without an end do not count.
  template <typename IsOther>
  bool contains_most_others(std::uint32_t item, const IsOther& is_other) const {
    const WorldBox room = box_of(item);
    std::size_t inside = 0, outside = 0;
    for (std::uint32_t i = 0; i < list_.items.size(); ++i) {
      if (!is_other(i)) continue;
      const WorldBox box = box_of(i);
      if (!is_finite(box)) continue;
      const glm::dvec3 middle_m = (box.low_m + box.high_m) / 2.0;
      const bool is_in =
          glm::all(glm::lessThan(room.low_m, middle_m)) && glm::all(glm::lessThan(middle_m, room.high_m));
      ++(is_in ? inside : outside);
    }
    return inside > outside;
  }

  struct WorldBox {
    glm::dvec3 low_m{std::numeric_limits<double>::infinity()}, high_m{-std::numeric_limits<double>::infinity()};
  };
  static bool is_finite(const WorldBox& box) {
    return glm::all(
        glm::lessThan(glm::abs(box.low_m) + glm::abs(box.high_m), glm::dvec3(std::numeric_limits<double>::max())));
  }
  WorldBox box_of(std::uint32_t item) const {
    const Mesh& mesh = *list_.meshes[list_.items[item].mesh];
    const glm::dmat4& world_from_mesh = list_.world_from_node[list_.items[item].transform];
    WorldBox box;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 at((corner & 1) != 0 ? mesh.bounds_max.x : mesh.bounds_min.x,
                          (corner & 2) != 0 ? mesh.bounds_max.y : mesh.bounds_min.y,
                          (corner & 4) != 0 ? mesh.bounds_max.z : mesh.bounds_min.z);
      const glm::dvec3 in_world(world_from_mesh * glm::dvec4(at, 1));
      box.low_m = glm::min(box.low_m, in_world);
      box.high_m = glm::max(box.high_m, in_world);
    }
    return box;
  }

  std::string warning_of(const BuiltSensor& sensor, const std::string& point,
                         std::span<const std::uint32_t> items) const {
    std::string names;
    for (const std::uint32_t i : items) {
      const Shape& shape = *flattener_.item_sources()[i].shape;
      const std::string& name = shape.name.empty() ? shape.mesh()->name : shape.name;
      if (!name.empty()) names += (names.empty() ? "" : ", ") + in_quotes(name);
    }
    const std::string count = items.size() == 1 ? "a shape" : std::to_string(items.size()) + " shapes";
    return to_string(sensor.command.where) + ": sensor " + in_quotes(sensor.name) + " stands inside " + count +
           " of its own link " + in_quotes(point) + (names.empty() ? "" : " (" + names + ")") + " and does not see " +
           (items.size() == 1 ? "it" : "them") +
           "; its attribute ignore=\"none\" lets it see everything, and ignore=\"" + point +
           "\" leaves out the whole link without this warning";
  }

  const BuiltScene& built_;
  const Flattener& flattener_;
  const DrawList& list_;
  const std::function<void(const std::string&)>& warn_;
  ItemsOfPoints items_;
  std::vector<std::uint32_t> flags_;  // by item; empty: all have all
};

}  // namespace

std::vector<std::uint32_t> unseen_items(const BuiltScene& built, const BuiltSensor& sensor) {
  Flattener flattener(built.scene.root());
  const DrawList& list = flattener.update();
  IgnoredItems ignored(Audience::sensors);
  ignored.update(built, flattener, list, [](const std::string&) {});
  const std::span<const std::uint32_t> items = ignored.of(sensor.id);
  return {items.begin(), items.end()};
}

namespace {

struct Eye {
  const BuiltSensor* sensor;
  glm::dvec3 at_m;
  double near_m;
};

std::vector<Eye> eyes_of(const BuiltScene& built, const Flattener& flattener) {
  std::vector<Eye> eyes;
  for (const BuiltSensor& sensor : built.sensors) {
    glm::dmat4 world_from_mount, world_from_sensor;
    if (sensor.sensor->visualization() || !flattener.find_mount(*sensor.mount, world_from_mount)) continue;
    if (!rigid_mount_frame(world_from_mount, world_from_sensor)) continue;
    eyes.push_back({&sensor, glm::dvec3(world_from_sensor[3]), near_of(sensor)});
  }
  return eyes;
}

// The share of all directions in which the eye sees the item. The outside of a house has an eye within it, but the
// walls of its rooms hide it.
double seen_share(const Eye& eye, RayCaster& rays, std::uint32_t item, std::span<const std::uint32_t> ignored) {
  constexpr std::uint32_t kDirections = 256;
  std::vector<glm::dvec3> directions;
  for (std::uint32_t i = 0; i < kDirections; ++i) directions.push_back(even_point_of_ball(i, kDirections));
  std::vector<RayHit> hits(kDirections);
  const std::vector<double> nearest_m(kDirections, eye.near_m);
  rays.ignore(ignored);
  rays.cast(glm::translate(glm::dmat4(1), eye.at_m), directions, hits, nearest_m);
  const auto seen =
      std::ranges::count_if(hits, [item](const RayHit& hit) { return std::isfinite(hit.range_m) && hit.item == item; });
  return static_cast<double>(seen) / kDirections;
}

}  // namespace

std::vector<SolidAround> seen_solids_around(const BuiltScene& built, unsigned threads) {
  constexpr double kMinShare = 0.25;  // less is seen of a solid whose own content hides it
  Flattener flattener(built.scene.root());
  const DrawList& list = flattener.update();
  IgnoredItems ignored(Audience::sensors);
  ignored.update(built, flattener, list, [](const std::string&) {});
  std::vector<Eye> eyes = eyes_of(built, flattener);
  std::vector<SolidAround> found;
  std::unique_ptr<RayCaster> rays;  // for the first eye within a solid
  for (std::uint32_t i = 0; i < list.items.size() && !eyes.empty(); ++i) {
    const DrawItem& item = list.items[i];
    const Mesh& mesh = *list.meshes[item.mesh];
    if (!item.visible || mesh.topology != Topology::triangles || mesh.indices.empty()) continue;
    if (!is_depth_visible(list.materials[item.material].get())) continue;
    std::erase_if(eyes, [&](const Eye& eye) {
      const std::span<const std::uint32_t> unseen = ignored.of(eye.sensor->id);
      if (std::ranges::binary_search(unseen, i)) return false;
      if (!is_inside_solid(mesh, list.world_from_node[item.transform], eye.at_m, eye.near_m)) return false;
      if (rays == nullptr) {
        rays = make_host_ray_caster({}, threads);
        rays->set_world(list);
      }
      if (seen_share(eye, *rays, i, unseen) < kMinShare) return false;
      const InsertionPoint* const point = flattener.item_sources()[i].point;
      found.push_back({eye.sensor, point == nullptr ? "ROOT" : point->name, mesh.name});
      return true;
    });
  }
  return found;
}

void IgnoredItems::update(const BuiltScene& built, const Flattener& flattener, const DrawList& list,
                          const std::function<void(const std::string&)>& warn) {
  if (rebuilds_ == flattener.counters().rebuilds) return;
  rebuilds_ = flattener.counters().rebuilds;
  sensors_.clear();
  const Finder finder(built, flattener, list, warn);
  for (const BuiltSensor& sensor : built.sensors) {
    const Audience audience = sensor.sensor->visualization() ? Audience::people : Audience::sensors;
    if (audience != audience_) continue;
    std::string warning;
    std::vector<std::uint32_t> items = finder.find(sensor, warning);
    if (items.empty()) continue;
    Ignoring& ignoring = sensors_[sensor.id];
    ignoring.items = std::make_shared<const std::vector<std::uint32_t>>(std::move(items));
    ignoring.warning = std::move(warning);
  }
}

std::span<const std::uint32_t> IgnoredItems::of(std::size_t sensor) const {
  const auto found = sensors_.find(sensor);
  return found == sensors_.end() ? std::span<const std::uint32_t>() : *found->second.items;
}

// Of a list that has only moved, the tables of items, meshes and materials are not copied.
const DrawList& IgnoredItems::seen_list(std::size_t sensor, const DrawList& list) {
  const auto found = sensors_.find(sensor);
  if (found == sensors_.end()) return list;
  Ignoring& ignoring = found->second;
  DrawList& seen = ignoring.seen;
  const bool same_tables = ignoring.is_made && seen.revisions.structure == list.revisions.structure &&
                           seen.revisions.materials == list.revisions.materials;
  if (same_tables) {
    seen.lights = list.lights;
    seen.world_from_node = list.world_from_node;
    seen.environment = list.environment;
    seen.sky = list.sky;
    seen.medium = list.medium;
    seen.revisions = list.revisions;
  } else {
    seen = list;
    for (const std::uint32_t item : *ignoring.items) seen.items[item].visible = false;
    ignoring.is_made = true;
  }
  return seen;
}

std::vector<std::size_t> IgnoredItems::count_views(const FramePlan& plan) {
  std::vector<std::size_t> views;
  for (const Pass& pass : plan.passes) views.push_back(pass.views.size());
  return views;
}

std::string IgnoredItems::leave_out(std::size_t sensor, std::span<const std::size_t> views, std::size_t casts,
                                    FramePlan& plan) {
  const auto found = sensors_.find(sensor);
  if (found == sensors_.end()) return {};
  const std::size_t count = found->second.items->size();
  const std::string without = ", without " + std::to_string(count) + (count == 1 ? " item" : " items");
  bool sees = casts < plan.casts.size();
  for (std::size_t pass = 0; pass < plan.passes.size(); ++pass) {
    const std::size_t first = pass < views.size() ? views[pass] : 0;
    for (View& view : std::span(plan.passes[pass].views).subspan(first)) {
      view.ignored = found->second.items;
      view.reason += without;
      sees = true;
    }
  }
  for (RayCast& cast : std::span(plan.casts).subspan(casts)) cast.reason += without;
  return sees ? std::exchange(found->second.warning, {}) : std::string();
}

}  // namespace simvis
