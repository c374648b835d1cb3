#include "import/sdf/sdf_mimic.h"

#include <cmath>

namespace simvis {
namespace {

SdfElement mimic_of(const SdfLink& link) { return link.joint->element.child("axis").child("mimic"); }

// The link that a joint of this name moves, as seen from a scope: "NAME", or "MODEL::NAME" for one within a model.
const SdfLink* find_moved_link(const SdfScope& scope, const std::string& name, const SdfTree& tree) {
  const std::size_t colons = name.find("::");
  if (colons != std::string::npos) {
    const auto model = scope.by_name.find(name.substr(0, colons));
    if (model == scope.by_name.end() || model->second->scope == nullptr) return nullptr;
    return find_moved_link(*model->second->scope, name.substr(colons + 2), tree);
  }
  for (const auto& link : tree.links) {
    if (link->joint != nullptr && link->joint_scope == &scope && link->joint->name == name) return link.get();
  }
  return nullptr;
}

}  // namespace

bool sdf_joint_turns(const SdfElement& joint) {
  const std::string type = joint.attribute("type");
  return type == "revolute" || type == "continuous" || type == "hinge";
}

bool sdf_joint_slides(const SdfElement& joint) { return joint.attribute("type") == "prismatic"; }

std::optional<SdfMimic> find_sdf_mimic(const SdfLink& link, const SdfTree& tree, ImportReport& report) {
  const SdfElement own = mimic_of(link);
  if (!own) return std::nullopt;
  const auto ignore = [&](const std::string& why) {
    report.warn(own.at(), "joint " + in_quotes(link.joint->name) + " " + why + "; it moves by itself");
    return std::nullopt;
  };
  SdfMimic mimic;
  const SdfLink* leader = &link;
  for (std::size_t steps = 0; const SdfElement next = mimic_of(*leader); ++steps) {
    if (steps > tree.links.size()) return ignore("mimics itself in a circle");
    const double multiplier = next.child("multiplier").number(1), reference = next.child("reference").number(0);
    const double offset = next.child("offset").number(0) - multiplier * reference;
    if (!std::isfinite(multiplier) || !std::isfinite(offset)) next.fail("has a number that is not finite");
    mimic.offset += mimic.multiplier * offset;
    mimic.multiplier *= multiplier;
    const std::string name = next.attribute("joint");
    leader = find_moved_link(*leader->joint_scope, name, tree);
    if (leader == nullptr) return ignore("mimics joint " + in_quotes(name) + ", which is not there");
    const bool moves = sdf_joint_turns(leader->joint->element) || sdf_joint_slides(leader->joint->element);
    if (!moves) return ignore("mimics joint " + in_quotes(name) + ", which is not revolute or prismatic");
  }
  mimic.leader = leader->joint_name;
  mimic.leader_turns = sdf_joint_turns(leader->joint->element);
  return mimic;
}

}  // namespace simvis
