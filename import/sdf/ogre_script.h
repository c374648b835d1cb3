// The materials that Gazebo knows by name, and those of OGRE's material scripts.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

namespace simvis {

/// The first pass of a material: colours as on a display, from 0 to 1, and the file name of its first texture.
struct OgreMaterial {
  std::optional<glm::dvec4> diffuse, ambient;
  glm::dvec3 emissive{0};
  std::string texture;
};

/// One of the plain colours that every Gazebo has, such as "Gazebo/Grey".
std::optional<OgreMaterial> find_gazebo_color(const std::string& name);

/// Looks for `material NAME` in a script, and in the materials that it is derived from. Empty: the script does not have
/// it, or cannot be read.
std::optional<OgreMaterial> find_ogre_material(const std::filesystem::path& script, const std::string& name);

}  // namespace simvis
