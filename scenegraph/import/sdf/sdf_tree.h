// The links of an SDF file as a tree: a joint makes a link follow another.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "scenegraph/import/sdf/sdf_poses.h"
#include "scenegraph/import/sdf/sdf_report.h"

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
  std::vector<SdfLink*> followers{};    ///< links whose joint has this one as its parent
  bool is_root = true;                  ///< no link above it
};

/// Names that are unique within a part, made from those of the file: MODEL/LINK, without control characters.
class SdfNames {
 public:
  std::string point(const std::string& name) { return unique(clean(name), points_); }
  std::string element(const std::string& name) { return unique(clean(name), elements_); }
  /// Names of sensors become names of files, so that '.' becomes '_', as does '/' within one of the three names.
  std::string sensor(const std::string& link, const std::string& name);

 private:
  static std::string clean(const std::string& name);
  static std::string unique(std::string name, std::set<std::string>& taken);
  std::set<std::string> points_, elements_, sensors_;
};

struct SdfTree {
  std::vector<std::unique_ptr<SdfLink>> links;  ///< in the order of the file
};

/// Collects the links of all models and their joints. The first joint that moves a link counts; further ones, and those
/// that close a circle, are left out with a warning.
SdfTree make_sdf_tree(SdfContent& content, SdfPoses& poses, SdfNames& names, SdfReport& report);

/// What the names in a scope begin with: "MODEL/" for each model around them, but none for a file's single model and
/// for merged ones.
std::string sdf_prefix(const SdfContent& content, const SdfScope& scope);

}  // namespace simvis
