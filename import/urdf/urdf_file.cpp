#include "import/urdf/urdf_file.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include "import/model/joint_commands.h"
#include "import/urdf/urdf_looks.h"

namespace simvis {
namespace {

struct JointType {
  std::string_view name;
  ModelJoint::Kind kind;
};
constexpr JointType kJointTypes[] = {
    {"fixed", ModelJoint::Kind::fixed},           {"revolute", ModelJoint::Kind::revolute},
    {"continuous", ModelJoint::Kind::continuous}, {"prismatic", ModelJoint::Kind::prismatic},
    {"floating", ModelJoint::Kind::floating},     {"planar", ModelJoint::Kind::planar},
    {"spherical", ModelJoint::Kind::ball}};

bool has_axis(ModelJoint::Kind kind) {
  return kind != ModelJoint::Kind::fixed && kind != ModelJoint::Kind::floating && kind != ModelJoint::Kind::ball;
}

ModelJoint::Kind kind_of(const UrdfElement& joint) {
  const std::string type = joint.text("type");
  const auto* const found = std::ranges::find(kJointTypes, type, &JointType::name);
  if (found != std::end(kJointTypes)) return found->kind;
  joint.fail("has the type " + in_quotes(type) +
             ", expected fixed, revolute, continuous, prismatic, floating or planar");
}

glm::dvec3 axis_of(const UrdfElement& joint) {
  const auto [x, y, z] = joint.child("axis").numbers<3>("xyz", {1, 0, 0});
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (!(largest > 0)) joint.fail("has the axis 0 0 0, expected a vector that is not zero");
  return glm::normalize(glm::dvec3(x, y, z) / largest);
}

// The commas between the numbers of vectors become spaces in the document itself, which several read.
void replace_commas(const XmlText& text, std::vector<std::string>& warnings) {
  std::vector<pugi::xml_node> open{text.document().document_element()};
  const std::size_t before = warnings.size();
  while (!open.empty()) {
    const pugi::xml_node node = open.back();
    open.pop_back();
    for (const char* const name : {"xyz", "rpy", "size", "scale", "rgba"}) {
      pugi::xml_attribute numbers = node.attribute(name);
      std::string written = numbers.value();
      if (written.find(',') == written.npos) continue;
      if (warnings.size() == before) {
        warnings.push_back(to_string(text.at(node)) + ": element <" + node.name() +
                           "> has commas between the numbers of " + name +
                           "; they are read as spaces, here and in others");
      }
      std::ranges::replace(written, ',', ' ');
      numbers.set_value(written.c_str());
    }
    for (pugi::xml_node child = node.last_child(); child; child = child.previous_sibling()) open.push_back(child);
  }
}

class UrdfReader {
 public:
  explicit UrdfReader(XmlText text)
      : text_(std::make_shared<const XmlText>(std::move(text))), robot_(robot_of(*text_)) {}

  UrdfFile run() {
    replace_commas(*text_, file_.warnings);
    read_name();
    read_links();
    read_joints();
    put_in_order();
    file_.text = text_;
    return std::move(file_);
  }

 private:
  static UrdfElement robot_of(const XmlText& text) {
    const UrdfElement top(text, text.document().document_element());
    if (top.tag() != std::string_view("robot")) {
      fail_at(top.where(), "the element <" + std::string(top.tag()) + "> is no robot, expected <robot>");
    }
    return top;
  }

  void warn(const UrdfElement& where, const UrdfElement& owner, const std::string& what) {
    file_.warnings.push_back(to_string(where.where()) + ": " + owner.says(what));
  }

  void read_name() {
    const std::string version = robot_.text("version");
    if (robot_.has("version") && version != "1.0") {
      robot_.fail("is of version " + in_quotes(version) + ", expected 1.0");
    }
    file_.name = robot_.name();
    if (!file_.name.empty()) return;
    file_.warnings.push_back(to_string(robot_.where()) + ": the robot has no name");
    file_.name = "robot";
  }

  // Names become names of elements and insertion points.
  static std::string name_of(const UrdfElement& element) {
    std::string name = element.name();
    if (name.find_first_not_of(" \t\r\n") == name.npos) element.fail("has an empty name");
    return name;
  }

  void read_links() {
    UrdfLooks looks(robot_, file_.warnings);
    for (const UrdfElement& each : robot_.children("link")) {
      std::string name = name_of(each);
      if (!numbers_.emplace(name, links_.size()).second) each.fail("is there twice, expected links of different names");
      links_.push_back({std::move(name), each, looks.visuals(each)});
    }
    if (links_.empty()) robot_.fail("has no link");
  }

  std::size_t link_of(const UrdfElement& joint, const char* tag) const {
    const std::string name = joint.child(tag).text("link");
    if (name.empty()) joint.fail("has no " + std::string(tag) + " link");
    const auto found = numbers_.find(name);
    if (found != numbers_.end()) return found->second;
    joint.fail("has the " + std::string(tag) + " link " + in_quotes(name) + ", which is not there");
  }

  void read_joints() {
    const std::vector<UrdfElement> elements = robot_.children("joint");
    for (const UrdfElement& each : elements) {
      const std::string name = name_of(each);
      if (!joints_.emplace(name, UrdfJoint{{.name = name}, each}).second) {
        each.fail("is there twice, expected joints of different names");
      }
    }
    for (const UrdfElement& each : elements) joints_.at(each.name()).model = read_joint(each);
    std::vector<ModelJoint*> all;
    for (auto& [name, joint] : joints_) all.push_back(&joint.model);
    resolve_leaders(
        all, [&](const ModelJoint& joint, const std::string& what) { joints_.at(joint.name).element.fail(what); });
  }

  ModelJoint read_joint(const UrdfElement& element) {
    using Kind = ModelJoint::Kind;
    ModelJoint joint{.kind = kind_of(element), .name = element.name(), .where = element.where()};
    joint.parent = link_of(element, "parent");
    joint.child = link_of(element, "child");
    joint.parent_from_joint = element.origin();
    if (joint.kind == Kind::ball && !std::exchange(has_ball_, true)) {
      warn(element, element, "is spherical, as only Bullet's robots are; it is a ball joint, here and in others");
    }
    if (has_axis(joint.kind)) joint.axis = axis_of(element);
    if (joint.kind == Kind::revolute || joint.kind == Kind::prismatic) read_limits(element, joint);
    read_mimic(element, joint);
    return joint;
  }

  void read_limits(const UrdfElement& element, ModelJoint& joint) {
    const UrdfElement limit = element.child("limit");
    if (!limit) return warn(element, element, "has no limits; it is left open");
    const double lower = limit.number("lower", 0), upper = limit.number("upper", 0);
    if (lower > upper) return warn(limit, element, "has a lower limit above its upper one; it is left open");
    joint.lower = lower;
    joint.upper = upper;
  }

  void read_mimic(const UrdfElement& element, ModelJoint& joint) {
    const UrdfElement mimic = element.child("mimic");
    if (!mimic) return;
    if (joint.kind == ModelJoint::Kind::fixed) {
      return warn(mimic, element, "is fixed and mimics another one; the mimic is ignored");
    }
    const std::string leader = mimic.text("joint");
    if (leader.empty()) mimic.fail("names no joint");
    if (!joints_.contains(leader)) {
      return warn(mimic, element, "mimics joint " + in_quotes(leader) + ", which is not there; it moves by itself");
    }
    joint.leader = leader;
    joint.multiplier = mimic.number("multiplier", 1);
    joint.offset = mimic.number("offset", 0);
  }

  // The root is the link without a joint above it.
  std::size_t find_root(const std::vector<const UrdfJoint*>& above) const {
    std::optional<std::size_t> root;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (above[i] != nullptr) continue;
      if (root) {
        links_[i].element.fail("has no joint above it, as link " + in_quotes(links_[*root].name) +
                               " has none, expected one root");
      }
      root = i;
    }
    if (!root) robot_.fail("has a joint above each of its links, expected a root");
    return *root;
  }

  // Links and joints as UrdfFile has them.
  void put_in_order() {
    std::vector<const UrdfJoint*> above(links_.size());
    std::vector<std::vector<const UrdfJoint*>> below(links_.size());
    for (const auto& [name, joint] : joints_) {
      const std::size_t child = joint.model.child;
      if (above[child] != nullptr) links_[child].element.fail("has two joints above it, expected one");
      above[child] = &joint;
      below[joint.model.parent].push_back(&joint);
    }
    constexpr std::size_t kNotReached = static_cast<std::size_t>(-1);
    std::vector<std::size_t> order(links_.size(), kNotReached), open{find_root(above)};
    while (!open.empty()) {
      const std::size_t link = open.back();
      open.pop_back();
      order[link] = file_.links.size();
      if (above[link] != nullptr) {
        UrdfJoint joint = *above[link];
        joint.model.parent = order[joint.model.parent];
        joint.model.child = order[link];
        file_.joints.push_back(std::move(joint));
      }
      file_.links.push_back(std::move(links_[link]));
      for (auto each = below[link].rbegin(); each != below[link].rend(); ++each) open.push_back((*each)->model.child);
    }
    const auto lost = std::ranges::find(order, kNotReached);
    if (lost == order.end()) return;
    links_[static_cast<std::size_t>(lost - order.begin())].element.fail("is in a cycle of joints, expected a tree");
  }

  std::shared_ptr<const XmlText> text_;
  UrdfElement robot_;
  UrdfFile file_;
  // As in the file, before they are put in order.
  std::vector<UrdfLink> links_;
  std::map<std::string, std::size_t, std::less<>> numbers_;
  std::map<std::string, UrdfJoint> joints_;
  bool has_ball_ = false;
};

}  // namespace

UrdfFile read_urdf(XmlText text) { return UrdfReader(std::move(text)).run(); }

}  // namespace simvis
