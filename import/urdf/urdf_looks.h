// Reads what is seen of the links of a URDF robot: shapes and materials.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "import/model/model_description.h"
#include "import/urdf/urdf_element.h"

namespace simvis {

struct UrdfMaterial {
  std::string name;
  glm::dvec4 color{0, 0, 0, 1};  ///< sRGB and alpha, from 0 to 1
  std::string texture;           ///< file name as written; empty: there is none
  friend bool operator==(const UrdfMaterial&, const UrdfMaterial&) = default;
};

struct UrdfVisual {
  std::string name;
  ModelShape shape;  ///< a box, sphere, cylinder, capsule or mesh
  std::string mesh;  ///< file name of a mesh as written
  std::optional<UrdfMaterial> material;
};

/// The materials of a robot, by name, and the visuals that use them.
class UrdfLooks {
 public:
  /// Reads all materials: those of the robot, then those that visuals define, which others may use too.
  UrdfLooks(const UrdfElement& robot, std::vector<std::string>& warnings);

  /// Those that can be shown. The others are left out with a warning, see urdf_file.h.
  std::vector<UrdfVisual> visuals(const UrdfElement& link);

 private:
  UrdfMaterial read_definition(const UrdfElement& material);
  void add_definition(const UrdfElement& material);
  std::optional<UrdfVisual> visual(const UrdfElement& visual, const UrdfElement& link);
  std::optional<UrdfMaterial> material(const UrdfElement& visual, const UrdfElement& link);
  void warn(const UrdfElement& where, const UrdfElement& owner, const std::string& what);

  std::map<std::string, UrdfMaterial> definitions_;
  std::vector<std::string>& warnings_;
};

}  // namespace simvis
