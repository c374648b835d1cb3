// A scene as people see it, without a device: what elements draw for them, read from the draw list.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/element.h>
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// A built scene whose elements observe what the test gives them.
class PeopleView : public Observations {
 public:
  explicit PeopleView(std::string_view commands, const std::filesystem::path& folder = "")
      : built(build_scene(parse_commands(commands, "s.xml", folder))),
        people(built.scene.root(), Audience::people),
        sensors(built.scene.root()) {}

  ObservedScan scan(std::string_view sensor) const override { return scans.at(std::string(sensor)); }
  bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const override {
    return people.find_mount(mount, world_from_mount);
  }

  /// A frame, as a simulation with a visualization camera makes it; then what people see.
  const DrawList& frame() {
    for (const std::size_t i : built.parameters.drain_changed_elements()) {
      const ElementDescriptor& element = built.parameters.elements()[i];
      built.elements[i]->update(built.parameters.values().subspan(element.first_value, element.parameters.size()));
    }
    people.update();
    for (const auto& element : built.elements) element->observe(*this);
    return people.update();
  }

  /// A frame after a change of one parameter.
  const DrawList& frame_with(std::string_view element, std::string_view parameter, double value) {
    built.parameters.set(built.parameters.index(element, parameter), value);
    return frame();
  }

  BuiltScene built;
  Flattener people, sensors;
  std::map<std::string, ObservedScan> scans;
};

/// Points and lines have six corners each: of a point +x -x +y -y +z -z; of a line three at its start and three at its
/// end.
struct SeenMarker {
  glm::dvec3 corner[6];  ///< world
  glm::vec4 color{0};

  glm::dvec3 mean(int first, int count) const {
    glm::dvec3 sum{0};
    for (int i = first; i < first + count; ++i) sum += corner[i];
    return sum / static_cast<double>(count);
  }
  glm::dvec3 center() const { return mean(0, 6); }
  double size() const { return glm::distance(corner[0], corner[1]); }
  glm::dvec3 from() const { return mean(0, 3); }
  glm::dvec3 to() const { return mean(3, 3); }
  double width() const { return glm::distance(corner[0], corner[1]); }
};

inline glm::dvec3 world_corner(const DrawList& list, const DrawItem& item, std::size_t vertex) {
  return list.world_from_node[item.transform] * glm::dvec4(list.meshes[item.mesh]->positions[vertex], 1);
}

/// One marker for each point of a mesh of points. Its corners are those of an octahedron as large as the point's
/// square.
inline std::vector<SeenMarker> points_in(const DrawList& list, const DrawItem& item) {
  const Mesh& mesh = *list.meshes[item.mesh];
  std::vector<SeenMarker> markers(mesh.positions.size());
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const glm::dvec3 center = world_corner(list, item, i);
    for (std::size_t k = 0; k < 6; ++k) {
      markers[i].corner[k] = center;
      markers[i].corner[k][static_cast<int>(k / 2)] += (k % 2 == 0 ? 1 : -1) * mesh.surface->radius_m;
    }
    markers[i].color = mesh.attributes[i].color;
  }
  return markers;
}

inline std::vector<SeenMarker> markers_in(const DrawList& list, const DrawItem& item) {
  const Mesh& mesh = *list.meshes[item.mesh];
  if (mesh.topology == Topology::points) return points_in(list, item);
  std::vector<SeenMarker> markers(mesh.positions.size() / 6);
  for (std::size_t i = 0; i < 6 * markers.size(); ++i) {
    markers[i / 6].corner[i % 6] = world_corner(list, item, i);
    markers[i / 6].color = mesh.attributes[i].color;
  }
  return markers;
}

/// A corner within `reach_m` of its mesh's origin is rounded to float32 once: half a unit in the last place along each
/// axis. The world places of the test lie within `world_m`, in double: a few roundings.
inline double corner_tolerance_m(double reach_m, double world_m = 0) {
  return std::sqrt(3.0) * (std::ldexp(reach_m, -24) + 8 * std::ldexp(world_m + reach_m, -53));
}

inline glm::dmat4 moved_to(double x, double y, double z) {
  glm::dmat4 m{1.0};
  m[3] = {x, y, z, 1};
  return m;
}

}  // namespace simvis
