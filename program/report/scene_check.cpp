#include "program/report/scene_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <simvis/attributes.h>
#include "program/report/scene_list.h"
#include "scenegraph/graph_walk.h"
#include "simvis/ignored_items.h"
#include "simvis/inside_solid.h"
#include "simvis/mount_frame.h"

namespace simvis {
namespace {

std::string at_place(const Location& where, const std::string& what) { return to_string(where) + ": " + what; }

bool is_seen_by_lasers(const WalkState& state) {
  return is_depth_visible(state.material == nullptr ? nullptr : state.material->shown().get());
}

std::string in_metres(double size_m) { return format_number(std::round(size_m * 1000) / 1000); }

void check_part_sizes(const BuiltScene& built, std::vector<std::string>& problems) {
  for (const ListedPart& part : list_scene(built).parts) {
    const glm::dvec3 size_m = part.shapes.box_max_m - part.shapes.box_min_m;
    if (part.depth == 0 || std::max({size_m.x, size_m.y, size_m.z}) < kMaxPartSize_m) continue;
    problems.push_back(at_place(built.scene.part_command(part.name).where,
                                "part " + in_quotes(part.name) + " is " + in_metres(size_m.x) + " x " +
                                    in_metres(size_m.y) + " x " + in_metres(size_m.z) +
                                    " m large; expected less than " + format_number(kMaxPartSize_m) +
                                    " m, or its lengths are in another unit (attributes unit and scale)"));
  }
}

// A part whose surfaces all let more than half of the light pass is seen by no laser and in no depth image.
void check_part_opacities(const BuiltScene& built, std::vector<std::string>& problems) {
  const bool has_scanner = std::ranges::any_of(built.sensors, [](const BuiltSensor& sensor) {
    return std::ranges::count(sensor.outputs, OutputKind::scan_column, &OutputSpec::kind) > 0;
  });
  if (!has_scanner) return;
  struct Count {
    std::size_t surfaces = 0, seen = 0;
  };
  std::map<std::string, Count> parts;
  std::vector<std::string> open{"ROOT"};
  walk_graph(*built.scene.root(), {.visit =
                                       [&](const Node& node, const WalkState& state) {
                                         if (dynamic_cast<const Group*>(&node) != nullptr) open.push_back(open.back());
                                         const bool is_part = node.kind() == NodeKind::insertion_point &&
                                                              built.scene.has_part(node.name);
                                         if (is_part) open.back() = node.name;
                                         if (node.kind() != NodeKind::shape || !state.visible) return;
                                         Count& count = parts[open.back()];
                                         ++count.surfaces;
                                         count.seen += is_seen_by_lasers(state);
                                       },
                                   .leave = [&](const Group&) { open.pop_back(); }});
  for (const auto& [name, count] : parts) {
    if (count.seen > 0 || name == "ROOT") continue;
    problems.push_back(at_place(built.scene.part_command(name).where,
                                "part " + in_quotes(name) + " has an opacity below " +
                                    format_number(kMinDepthVisibleAlpha) +
                                    " everywhere, so that lasers do not see it; its attribute opacity sets another"));
  }
}

// A sensor and where it looks from.
struct Eye {
  const BuiltSensor* sensor;
  glm::dvec3 at;
  double near_m = 0;                // of a camera: surfaces nearer than this are not drawn
  bool is_inside = false;           // of a solid that was reported
  std::set<std::string> ignored{};  // points of which it sees no solid around it
};

class SolidCheck {
 public:
  SolidCheck(const BuiltScene& built, std::vector<std::string>& problems) : built_(built), problems_(problems) {}

  void run() {
    std::set<std::string> with_shapes;
    walk([&](const Node& node, const WalkState& state) {
      if (node.kind() == NodeKind::shape) with_shapes.insert(points_.back());
      find_eye(node, state);
    });
    if (eyes_.empty()) return;
    for (Eye& eye : eyes_) {
      eye.ignored = ignored_points(built_, *eye.sensor, [&](const std::string& point) {
                      return with_shapes.contains(point);
                    }).points;
    }
    walk([this](const Node& node, const WalkState& state) { visit(node, state); });
  }

 private:
  template <typename Visit>
  void walk(const Visit& visit_node) {
    points_.assign(1, "ROOT");
    walk_graph(*built_.scene.root(), {.visit =
                                          [&](const Node& node, const WalkState& state) {
                                            if (dynamic_cast<const Group*>(&node) != nullptr) {
                                              points_.push_back(points_.back());
                                            }
                                            if (node.kind() == NodeKind::insertion_point) points_.back() = node.name;
                                            visit_node(node, state);
                                          },
                                      .leave = [this](const Group&) { points_.pop_back(); }});
  }

  void find_eye(const Node& node, const WalkState& state) {
    if (node.kind() != NodeKind::mount) return;
    for (const BuiltSensor& sensor : built_.sensors) {
      glm::dmat4 world_from_sensor;
      if (sensor.mount.get() != &node || sensor.sensor->visualization()) continue;
      if (!rigid_mount_frame(state.world_from_node, world_from_sensor)) continue;
      eyes_.push_back({&sensor, glm::dvec3(world_from_sensor[3]), near_of(sensor)});
    }
  }

  void visit(const Node& node, const WalkState& state) {
    if (node.kind() != NodeKind::shape || !state.visible) return;
    const Mesh& mesh = *static_cast<const Shape&>(node).mesh();
    if (mesh.topology == Topology::triangles && !mesh.indices.empty() && is_seen_by_lasers(state)) check(mesh, state);
  }

  void check(const Mesh& mesh, const WalkState& state) {
    for (Eye& eye : eyes_) {
      if (eye.is_inside || eye.ignored.contains(points_.back())) continue;
      if (is_inside_solid(mesh, state.world_from_node, eye.at, eye.near_m)) report(eye, mesh);
    }
  }

  void report(Eye& eye, const Mesh& mesh) {
    eye.is_inside = true;
    const std::string name = mesh.name.empty() ? std::string() : ", mesh " + in_quotes(mesh.name);
    problems_.push_back(
        at_place(eye.sensor->command.where, "sensor " + in_quotes(eye.sensor->name) + " is inside a solid of part " +
                                                in_quotes(points_.back()) + name + ", whose back faces it sees"));
  }

  const BuiltScene& built_;
  std::vector<std::string>& problems_;
  std::vector<Eye> eyes_;
  std::vector<std::string> points_;  // the last insertion point before the node, for each open group
};

}  // namespace

std::vector<std::string> check_scene(const BuiltScene& built) {
  std::vector<std::string> problems;
  check_part_sizes(built, problems);
  check_part_opacities(built, problems);
  SolidCheck(built, problems).run();
  return problems;
}

}  // namespace simvis
