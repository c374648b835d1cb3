// The bodies of an MJCF model with their joints and geoms, and the names that they have in a part.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/mjcf/mjcf_element.h"

namespace simvis {

struct MjcfJoint {
  enum class Kind { hinge, slide, ball, free } kind = Kind::hinge;
  MjcfElement element;
  std::string own;   ///< in the file; of one without a name, as the importer calls it
  std::string name;  ///< of its element
};

struct MjcfGeom {
  MjcfElement element;
  glm::dmat4 body_from_frame{1.0};  ///< of the <frame> elements around it
};

struct MjcfBody {
  MjcfElement element;  ///< <body>, or the first <worldbody>
  std::string own;      ///< in the file; empty: the world, or a body without a name
  std::string name;     ///< of its insertion point; empty: the world
  std::size_t parent = 0;
  glm::dmat4 parent_from_body{1.0};
  std::vector<MjcfJoint> joints{};
  std::vector<MjcfGeom> geoms{};
  std::vector<MjcfElement> inertials{};
};

/// A model as the importer has read it.
struct MjcfTree {
  explicit MjcfTree(const std::filesystem::path& file) : model(file) {}
  MjcfModel model;
  std::vector<MjcfBody> bodies{};  ///< the world first, then in the order of the file, parents before children
};

}  // namespace simvis
