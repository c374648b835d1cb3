// What a scene consists of, for `simvis-run --list`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/scan.h>
#include "simvis/scene_builder.h"

namespace simvis {

/// The visible shapes of a part or an element.
struct ListedShapes {
  std::uint64_t triangles = 0;
  bool any = false;                          ///< there are triangles, lines or points
  glm::dvec3 box_min_m{0}, box_max_m{0};     ///< in the world; 0 without shapes
  std::vector<const Material*> materials{};  ///< each once, in the order of traversal
};

struct ListedParameter {
  AttributeSpec spec;
  double value = 0;
};

struct ListedElement {
  std::string name, type, insert_at;
  std::vector<ListedParameter> parameters;
  ListedShapes shapes;
};

struct ListedSensor {
  std::string name, type, insert_at, method;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< as executed, without those of every command
  std::vector<OutputSpec> outputs;                              ///< what the sensor gives
  std::optional<glm::dmat4> world_from_sensor;                  ///< empty: it stands in a part that is switched off
};

struct ListedPart {
  std::string name, insert_at;  ///< of ROOT, `insert_at` is empty
  std::string source;           ///< the file as written, the name of the shape, or "frame"
  std::size_t depth = 0;        ///< 0: ROOT
  std::vector<std::string> insertion_points{};
  std::vector<std::size_t> elements{}, sensors{};  ///< that stand at its insertion points: numbers in SceneList
  ListedShapes shapes{};                           ///< without those of parts and elements that are inserted in it
};

/// Lifetime  valid as long as the scene that it was made from, and while that does not change.
struct SceneList {
  std::vector<ListedPart> parts;  ///< ROOT first, each before those that are inserted in it
  std::vector<ListedElement> elements;
  std::vector<ListedSensor> sensors;
  std::vector<std::string> warnings;
};

/// Lists a scene as it stands: boxes are those of the present values of its parameters.
SceneList list_scene(const BuiltScene& built);

/// The list as an indented tree.
std::string to_text(const SceneList& list);

/// The list as JSON: one object with arrays `parts`, `elements`, `joints` (names of elements), `sensors`, `warnings`.
std::string to_json(const SceneList& list);

}  // namespace simvis
