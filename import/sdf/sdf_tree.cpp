#include "import/sdf/sdf_tree.h"

#include <algorithm>
#include <map>
#include <utility>

#include <simvis/pose.h>
#include "import/mesh/picture_file.h"
#include "scenegraph/language/control_characters.h"

namespace simvis {
namespace {

// Two poses that were made by different products of the same matrices differ by rounding alone: lengths in metres and
// elements of rotations.
constexpr double kSamePose = 1e-12;

bool is_same_pose(const glm::dmat4& a, const glm::dmat4& b) {
  for (int column = 0; column < 4; ++column) {
    const glm::dvec4 difference = glm::abs(a[column] - b[column]);
    if (std::max({difference.x, difference.y, difference.z}) > kSamePose) return false;
  }
  return true;
}

// The element that <xyz> of the joint's first axis stands in: empty for the joint's own frame.
std::string axis_frame(const SdfElement& joint) {
  const SdfElement axis = joint.child("axis"), xyz = axis.child("xyz");
  constexpr int kFirstWithJointAxes = 5;  // before, axes stand in the model's frame
  const bool in_model = joint.file().version < kFirstWithJointAxes || axis.child("use_parent_model_frame").flag(false);
  if (in_model) return "__model__";
  return xyz ? xyz.attribute("expressed_in") : std::string();
}

class TreeMaker {
 public:
  TreeMaker(SdfContent& content, SdfPoses& poses, SdfNames& names, ImportReport& report)
      : content_(content), poses_(poses), names_(names), report_(report) {}

  SdfTree run() {
    add_links(content_.world);
    add_joints(content_.world);
    return std::move(tree_);
  }

 private:
  void add_links(SdfScope& scope) {
    const glm::dmat4 world_from_scope = poses_.scope(scope);
    const std::string prefix = sdf_prefix(content_, scope);
    for (const auto& item : scope.items) {
      if (item->kind == SdfItemKind::link) {
        SdfLink& link = *tree_.links.emplace_back(std::make_unique<SdfLink>());
        link.scope = &scope;
        link.item = item.get();
        link.prefix = prefix;
        link.point = names_.point(prefix + item->name);
        link.world_from_link = world_from_scope * poses_.item(scope, *item);
        link.world_from_joint = link.world_from_link;
        by_item_[item.get()] = &link;
      } else if (item->scope != nullptr) {
        add_links(*item->scope);
      }
    }
  }

  void add_joints(SdfScope& scope) {
    for (const auto& item : scope.items) {
      if (item->kind == SdfItemKind::joint) try_to_add_joint(scope, *item);
      if (item->scope != nullptr) add_joints(*item->scope);
    }
  }

  // A joint whose links are not there, as those of an <include> that is left out.
  void try_to_add_joint(SdfScope& scope, SdfItem& joint) {
    SdfItem *parent = nullptr, *child = nullptr;
    try {
      parent = poses_.link(scope, joint.parent, joint.element);
      child = poses_.link(scope, joint.child, joint.element);
    } catch (const InputError& error) {
      return report_.warn(without_word_error(error.what()) + "; joint " + in_quotes(joint.name) + " is left out");
    }
    add_joint(scope, joint, parent, child);
  }

  void add_joint(SdfScope& scope, SdfItem& joint, SdfItem* parent_item, SdfItem* child_item) {
    const auto leave_out = [&](const std::string& why) {
      report_.warn(joint.element.at(), "joint " + in_quotes(joint.name) + " is left out: " + why);
    };
    if (child_item == nullptr) return leave_out("its child is the world or a model without a link");
    SdfLink& child = *by_item_.at(child_item);
    SdfLink* const parent = parent_item == nullptr ? nullptr : by_item_.at(parent_item);
    if (child.joint != nullptr) return leave_out("joint " + in_quotes(child.joint->name) + " moves its child already");
    for (const SdfLink* above = parent; above != nullptr; above = above->parent) {
      if (above == &child) return leave_out("it closes a circle of joints");
    }
    child.joint = &joint;
    child.joint_scope = &scope;
    child.world_from_joint = poses_.scope(scope) * poses_.item(scope, joint);
    const std::string name = sdf_prefix(content_, scope) + joint.name;
    child.joint_name = names_.element(name);
    if (is_same_pose(child.world_from_joint, child.world_from_link)) {
      child.world_from_joint = child.world_from_link;
      child.joint_point = child.point;
    } else {
      child.joint_point = names_.point(name);
    }
    if (parent == nullptr) return;
    child.parent = parent;
    parent->followers.push_back(&child);
  }

  SdfContent& content_;
  SdfPoses& poses_;
  SdfNames& names_;
  ImportReport& report_;
  SdfTree tree_;
  std::map<const SdfItem*, SdfLink*> by_item_;
};

}  // namespace

std::string SdfNames::sensor(const std::string& link, const std::string& name) {
  std::string last = clean(name);
  std::ranges::replace(last, '/', '_');
  return sensors_.add(sensor_name(clean(link) + "/" + last));
}

std::string SdfNames::clean(const std::string& name) {
  std::string cleaned = name;
  std::ranges::replace_if(cleaned, is_control, '_');
  for (std::size_t at = cleaned.find("::"); at != std::string::npos; at = cleaned.find("::")) {
    cleaned.replace(at, 2, "/");
  }
  return cleaned;
}

std::string sdf_prefix(const SdfContent& content, const SdfScope& scope) {
  std::string prefix;
  for (const SdfScope* each = &scope; each->outer != nullptr; each = each->outer) {
    const bool is_single = content.is_single_model && each->outer->outer == nullptr;
    if (!is_single && !each->is_merged) prefix = each->item->name + "/" + prefix;
  }
  return prefix;
}

glm::dmat4 sdf_place_in(const SdfLink& link, const SdfElement& child, SdfPoses& poses) {
  const SdfPose pose = read_sdf_pose(child);
  if (pose.relative_to.empty()) return pose.matrix;
  return rigid_inverse(poses.item(*link.scope, *link.item)) * poses.pose(*link.scope, pose, "");
}

glm::dmat4 sdf_joint_from_axis(const SdfLink& link, SdfPoses& poses) {
  const SdfElement& joint = link.joint->element;
  const std::string frame = axis_frame(joint);
  if (frame.empty()) return glm::dmat4(1);
  return rigid_inverse(poses.item(*link.joint_scope, *link.joint)) * poses.frame(*link.joint_scope, frame, joint);
}

SdfTree make_sdf_tree(SdfContent& content, SdfPoses& poses, SdfNames& names, ImportReport& report) {
  return TreeMaker(content, poses, names, report).run();
}

}  // namespace simvis
