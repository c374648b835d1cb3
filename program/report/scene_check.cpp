#include "program/report/scene_check.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <simvis/attributes.h>
#include "program/report/scene_list.h"
#include "scenegraph/graph_walk.h"
#include "simvis/ignored_items.h"
#include "simvis/inside_solid.h"

namespace simvis {
namespace {

std::string at_place(const Location& where, const std::string& what) { return to_string(where) + ": " + what; }

bool is_seen_by_lasers(const WalkState& state) {
  return is_depth_visible(state.material == nullptr ? nullptr : state.material->shown().get());
}

std::string in_metres(double size_m) { return format_number(std::round(size_m * 1000) / 1000); }

// A part whose command states a unit or a scale is meant to be so large.
void check_part_sizes(const BuiltScene& built, std::vector<std::string>& problems) {
  for (const ListedPart& part : list_scene(built).parts) {
    const glm::dvec3 size_m = part.shapes.box_max_m - part.shapes.box_min_m;
    if (part.depth == 0 || std::max({size_m.x, size_m.y, size_m.z}) < kMaxPartSize_m) continue;
    const Command& command = built.scene.part_command(part.name);
    if (command.find("unit") != nullptr || command.find("scale") != nullptr) continue;
    problems.push_back(
        at_place(command.where, "part " + in_quotes(part.name) + " is " + in_metres(size_m.x) + " x " +
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

void check_solids(const BuiltScene& built, unsigned threads, std::vector<std::string>& problems) {
  for (const SolidAround& solid : seen_solids_around(built, threads)) {
    const std::string name = solid.mesh.empty() ? std::string() : ", mesh " + in_quotes(solid.mesh);
    problems.push_back(at_place(solid.sensor->command.where,
                                "sensor " + in_quotes(solid.sensor->name) + " is inside a solid of part " +
                                    in_quotes(solid.point) + name + ", whose back faces it sees"));
  }
}

}  // namespace

std::vector<std::string> check_scene(const BuiltScene& built, unsigned threads) {
  std::vector<std::string> problems;
  check_part_sizes(built, problems);
  check_part_opacities(built, problems);
  check_solids(built, threads, problems);
  return problems;
}

}  // namespace simvis
