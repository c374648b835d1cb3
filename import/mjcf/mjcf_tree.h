// The bodies of an MJCF model with their joints and geoms, and the names that they have in a part.
#pragma once

#include <filesystem>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "import/mjcf/mjcf_assets.h"
#include "import/mjcf/mjcf_element.h"
#include "import/model/model_description.h"

namespace simvis {

struct MjcfJoint {
  MjcfElement element;
  std::string own;       ///< name in the file; of a joint without one, as the importer calls it
  ModelJoint motion;     ///< kind, name of its element, axis in the body's frame, limits; without links and dynamics
  glm::dvec3 anchor{0};  ///< in the body's frame; 0 of a free joint
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

/// The model itself, or one that an <attach> adds to it, with what then stands in front of the names in it.
struct MjcfMember {
  const MjcfModel* model;
  std::string prefix;
};

/// A section of the model or of an attached one, such as <actuator>.
struct MjcfSection {
  MjcfElement element;
  std::string prefix;
};

/// A model as the importer has read it.
struct MjcfTree {
  explicit MjcfTree(const std::filesystem::path& file) {
    models.emplace_back(file);
    members.push_back({&models.front(), ""});
  }
  MjcfTree(const MjcfTree&) = delete;
  MjcfTree& operator=(const MjcfTree&) = delete;

  const MjcfModel& model() const { return models.front(); }
  /// The sections with this tag, those of the model first. Names in a section begin with its prefix.
  std::vector<MjcfSection> sections(std::string_view tag) const {
    std::vector<MjcfSection> all;
    for (const MjcfMember& member : members) {
      for (MjcfElement& section : member.model->sections(tag)) all.push_back({std::move(section), member.prefix});
    }
    return all;
  }

  std::list<MjcfModel> models;      ///< the file's own first, then each file that is attached
  std::vector<MjcfMember> members;  ///< one for each <attach>, behind the model itself
  /// What the importer has read of assets; their readers add to it.
  std::shared_ptr<MjcfReadAssets> assets = std::make_shared<MjcfReadAssets>();
  std::vector<MjcfBody> bodies{};  ///< the world first, then in the order of the file, parents before children
};

}  // namespace simvis
