// The links of an SDF file as a tree: a joint makes a link follow another.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "import/model/import_report.h"
#include "import/model/model_description.h"
#include "import/model/unique_names.h"
#include "import/sdf/sdf_poses.h"

namespace simvis {

struct SdfLink {
  SdfScope* scope = nullptr;
  SdfItem* item = nullptr;
  std::string prefix;               ///< of the names in its model
  std::string point;                ///< name of its insertion point
  glm::dmat4 world_from_link{1.0};  ///< as the file places it
  // The joint above the link; null: the link stands in its model.
  SdfItem* joint = nullptr;
  SdfScope* joint_scope = nullptr;
  std::string joint_name, joint_point;  ///< joint_point is the link's own if both have one frame
  glm::dmat4 world_from_joint{1.0};     ///< that of the link if there is no joint
  std::optional<ModelJoint> motion{};   ///< of the joint; set by read_sdf_joints()
  const SdfLink* parent = nullptr;      ///< the link that the joint hangs on; null: none
  std::vector<SdfLink*> followers{};    ///< links whose parent this one is
};

/// Names that are unique within a part, made from those of the file: MODEL/LINK, without control characters.
class SdfNames {
 public:
  std::string point(const std::string& name) { return points_.add(clean(name)); }
  std::string element(const std::string& name) { return elements_.add(clean(name)); }
  /// Names of sensors become names of files, so that '.' becomes '_', as does '/' within one of the three names.
  std::string sensor(const std::string& link, const std::string& name);

 private:
  static std::string clean(const std::string& name);
  UniqueNames points_, elements_, sensors_;
};

struct SdfTree {
  std::vector<std::unique_ptr<SdfLink>> links;  ///< in the order of the file
};

/// Collects the links of all models and their joints. The first joint that moves a link counts; further ones, and those
/// that close a circle, are left out with a warning.
SdfTree make_sdf_tree(SdfContent& content, SdfPoses& poses, SdfNames& names, ImportReport& report);

/// link_from_child of a collision, visual, light or sensor in the link.
glm::dmat4 sdf_place_in(const SdfLink& link, const SdfElement& child, SdfPoses& poses);

/// joint_from_axis of the link's joint: turns the frame in which <xyz> stands into the joint's. The link has a joint.
glm::dmat4 sdf_joint_from_axis(const SdfLink& link, SdfPoses& poses);

/// What the names in a scope begin with: "MODEL/" for each model around them, but none for a file's single model and
/// for merged ones.
std::string sdf_prefix(const SdfContent& content, const SdfScope& scope);

}  // namespace simvis
