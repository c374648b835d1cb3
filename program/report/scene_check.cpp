#include "program/report/scene_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <simvis/attributes.h>
#include "program/report/scene_list.h"
#include "scenegraph/graph_walk.h"
#include "sensors/camera/pinhole_view.h"
#include "simvis/mount_frame.h"

namespace simvis {
namespace {

std::string at_place(const Location& where, const std::string& what) { return to_string(where) + ": " + what; }

bool is_seen_by_lasers(const WalkState& state) {
  if (state.material == nullptr) return true;
  const Material& material = *state.material->shown();
  const float alpha = material.alpha_mode == AlphaMode::blend ? material.base_color.a : 1;
  return alpha * material.opacity >= kMinDepthVisibleAlpha;
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

// The share of all directions from `eye` that meets the triangle, above 0 if its back is seen.
double solid_angle(const glm::dvec3& eye, const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
  const glm::dvec3 a = p - eye, b = q - eye, c = r - eye;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = glm::dot(a, glm::cross(b, c));
  const double rest = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return 2 * std::atan2(volume, rest) / (4 * std::numbers::pi);
}

// A sensor and where it looks from.
struct Eye {
  const BuiltSensor* sensor;
  glm::dvec3 at;
  double near_m = 0;       // of a camera: surfaces nearer than this are not drawn
  bool is_inside = false;  // of a solid that was reported
};

double near_of(const BuiltSensor& sensor) {
  const bool is_camera = std::ranges::count(sensor.outputs, OutputKind::image, &OutputSpec::kind) > 0;
  if (!is_camera) return 0;
  double near_m = 0;
  parse_number(kNearAttribute.default_value, near_m);  // of all cameras
  if (const CommandAttribute* const written = sensor.command.find("near")) parse_number(written->value, near_m);
  return near_m;
}

class SolidCheck {
 public:
  SolidCheck(const BuiltScene& built, std::vector<std::string>& problems) : built_(built), problems_(problems) {}

  void run() {
    walk_graph(*built_.scene.root(),
               {.visit = [this](const Node& node, const WalkState& state) { find_eye(node, state); }, .leave = {}});
    if (eyes_.empty()) return;
    points_.push_back("ROOT");
    walk_graph(*built_.scene.root(), {.visit = [this](const Node& node, const WalkState& state) { visit(node, state); },
                                      .leave = [this](const Group&) { points_.pop_back(); }});
  }

 private:
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
    if (dynamic_cast<const Group*>(&node) != nullptr) points_.push_back(points_.back());
    if (node.kind() == NodeKind::insertion_point) points_.back() = node.name;
    if (node.kind() != NodeKind::shape || !state.visible) return;
    const Mesh& mesh = *static_cast<const Shape&>(node).mesh();
    if (mesh.topology == Topology::triangles && !mesh.indices.empty() && is_seen_by_lasers(state)) check(mesh, state);
  }

  void check(const Mesh& mesh, const WalkState& state) {
    std::vector<glm::dvec3> corners;
    corners.reserve(mesh.positions.size());
    for (const glm::vec3& position : mesh.positions) {
      corners.emplace_back(state.world_from_node * glm::dvec4(glm::dvec3(position), 1));
    }
    glm::dvec3 low = corners[mesh.indices[0]], high = low;
    for (const std::uint32_t index : mesh.indices) {
      low = glm::min(low, corners[index]);
      high = glm::max(high, corners[index]);
    }
    const double mirrored = glm::determinant(glm::dmat3(state.world_from_node)) < 0 ? -1 : 1;
    for (Eye& eye : eyes_) {
      if (eye.is_inside || glm::any(glm::lessThan(eye.at, low)) || glm::any(glm::greaterThan(eye.at, high))) continue;
      const glm::dvec3 farthest = glm::max(high - eye.at, eye.at - low);
      if (glm::length(farthest) < eye.near_m) continue;
      double winding = 0;
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        winding +=
            solid_angle(eye.at, corners[mesh.indices[i]], corners[mesh.indices[i + 1]], corners[mesh.indices[i + 2]]);
      }
      if (mirrored * winding > kInside) report(eye, mesh);
    }
  }

  void report(Eye& eye, const Mesh& mesh) {
    eye.is_inside = true;
    const std::string name = mesh.name.empty() ? std::string() : ", mesh " + in_quotes(mesh.name);
    problems_.push_back(
        at_place(eye.sensor->command.where, "sensor " + in_quotes(eye.sensor->name) + " is inside a solid of part " +
                                                in_quotes(points_.back()) + name + ", whose back faces it sees"));
  }

  // A point within a closed surface has the winding number 1, and one at a side of an open surface at most a half.
  static constexpr double kInside = 0.75;

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
