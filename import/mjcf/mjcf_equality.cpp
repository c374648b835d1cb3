#include "import/mjcf/mjcf_equality.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <simvis/pose.h>

namespace simvis {
namespace {

class EqualityReader {
 public:
  EqualityReader(const MjcfTree& tree, ModelDescription& file, ImportReport& report)
      : tree_(tree), file_(file), report_(report), file_from_body_(tree.bodies.size(), glm::dmat4(1)) {
    for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
      const MjcfBody& body = tree.bodies[i];
      if (i > 0) file_from_body_[i] = file_from_body_[body.parent] * body.parent_from_body;
      if (i == 0 || !body.own.empty()) by_name_.emplace(i == 0 ? "world" : body.own, i);
      for (const MjcfJoint& joint : body.joints) joints_.emplace(joint.own, joint.motion.name);
    }
  }

  void read(const MjcfElement& element, const std::string& prefix) {
    prefix_ = prefix;
    if (!element.flag("active", true)) return;
    bool is_taken = false;
    if (element.tag() == "joint") {
      is_taken = read_joint(element);
    } else if (element.tag() == "connect" || element.tag() == "weld") {
      is_taken = read_constraint(element);
    }
    if (!is_taken) report_.leave_out("<equality><" + std::string(element.tag()) + "> of this kind", element.at());
  }

 private:
  bool read_joint(const MjcfElement& element) {
    std::vector<double> line = element.numbers("polycoef", 1, 5);
    if (line.empty()) line = {0, 1};
    line.resize(5, 0);
    const auto follower = joints_.find(prefix_ + element.text("joint1")),
               leader = joints_.find(prefix_ + element.text("joint2"));
    if (follower == joints_.end() || leader == joints_.end()) return false;
    if (line[2] != 0 || line[3] != 0 || line[4] != 0) return false;
    for (ModelBody& body : file_.bodies) {
      const auto find = [&](const std::string& name) {
        return std::ranges::find(body.model.joints, name, &ModelJoint::name);
      };
      const auto own = find(follower->second), other = find(leader->second);
      if (own == body.model.joints.end() || other == body.model.joints.end() || !own->leader.empty()) continue;
      own->leader = other->name;
      own->multiplier = line[1];
      own->offset = line[0];
      own->is_coupled = true;
      return true;
    }
    return false;
  }

  std::map<std::string, std::size_t>::const_iterator find_body(const std::string& name) const {
    return by_name_.find(name == "world" ? name : prefix_ + name);
  }

  // Whether a body is part of the static one, which comes first.
  bool stands(std::size_t body) const {
    const auto& links = file_.bodies.front().model.links;
    return std::ranges::find(links, tree_.bodies[body].name, &ModelLink::name) != links.end();
  }

  // Both links stand where the file places them. An anchor is given in the first body.
  bool read_constraint(const MjcfElement& element) {
    const auto a = find_body(element.text("body1")), b = find_body(element.text("body2", "world"));
    if (a == by_name_.end() || b == by_name_.end() || a->second == b->second) return false;
    if (const auto pose = element.numbers("relpose", 7, 7); !pose.empty()) {
      const bool is_set = std::any_of(pose.begin() + 3, pose.end(), [](double value) { return value != 0; });
      if (is_set) return false;
    }
    ModelConstraint made;
    made.where = element.at();
    made.kind = element.tag() == "connect" ? ModelConstraint::Kind::point : ModelConstraint::Kind::fixed;
    std::size_t first = a->second, second = b->second;
    glm::dmat4 first_from_joint(1);
    first_from_joint[3] = glm::dvec4(element.vector("anchor", glm::dvec3(0)), 1);
    glm::dmat4 second_from_joint = rigid_inverse(file_from_body_[second]) * file_from_body_[first] * first_from_joint;
    if (stands(first)) {
      std::swap(first, second);
      std::swap(first_from_joint, second_from_joint);
    }
    if (stands(first)) return true;  // both do
    made.a = tree_.bodies[first].name;
    made.b = stands(second) ? "" : tree_.bodies[second].name;
    made.a_from_joint = first_from_joint;
    made.b_from_joint = second_from_joint;
    file_.constraints.push_back(std::move(made));
    return true;
  }

  const MjcfTree& tree_;
  ModelDescription& file_;
  ImportReport& report_;
  std::string prefix_;  // of the names in the section that is read
  std::vector<glm::dmat4> file_from_body_;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, std::string> joints_;  // from the name in the file to that of the element
};

}  // namespace

void read_mjcf_equalities(const MjcfTree& tree, ModelDescription& file, ImportReport& report) {
  EqualityReader reader(tree, file, report);
  for (const auto& [section, prefix] : tree.sections("equality")) {
    for (const MjcfElement& each : section.children()) reader.read(each, prefix);
  }
}

}  // namespace simvis
