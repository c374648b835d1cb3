// Imports MJCF models as parts: bodies and sites become insertion points, geoms shapes, joints element commands.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/node.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "import/mesh/picture_file.h"
#include "import/mjcf/mjcf_dynamics.h"
#include "import/mjcf/mjcf_geoms.h"
#include "import/model/unique_names.h"

namespace simvis {
namespace {

constexpr double kMjcfDegrees = 180 / std::numbers::pi;
constexpr int kMaxReplicates = 100000;  // of a model
// Sections that say nothing about what sensors see.
constexpr std::string_view kUnseenSections[] = {"compiler", "option",  "size",     "statistic", "default", "asset",
                                                "visual",   "contact", "keyframe", "worldbody", "sensor",  "actuator"};

class MjcfImport {
 public:
  MjcfImport(const ImportRequest& request, ContentPool& pool)
      : tree_(std::make_shared<MjcfTree>(request.file)), geoms_(model_, report_, pool) {}

  PartContent run() {
    const auto root = std::make_shared<Separator>();
    root->name = model_.name();
    read_equalities();
    for (const MjcfElement& world : model_.sections("worldbody")) {
      if (tree_->bodies.empty()) tree_->bodies.push_back({.element = world, .own = "", .name = ""});
      add_content(world, *root, {});
    }
    add_followers();
    report_unread();
    geoms_.require_any();
    PartContent content;
    content.root = root;
    if (!tree_->bodies.empty()) content.model = std::make_shared<MjcfSource>(tree_);
    content.commands = std::move(joints_);
    std::ranges::move(mimics_, std::back_inserter(content.commands));
    content.warnings = report_.release();
    return content;
  }

 private:
  struct Mimic {
    std::string leader;
    double multiplier = 1, offset = 0;
  };
  struct Joint {
    std::string name;
    bool turns = false;
  };
  struct Follower {
    std::string name;  // in the file
    Location where;
    Command command;  // of a joint without limits
  };

  // <equality><joint> with a straight line makes a joint follow another.
  void read_equalities() {
    for (const MjcfElement& section : model_.sections("equality")) {
      for (const MjcfElement& each : section.children()) {
        const std::string follower = each.text("joint1"), leader = each.text("joint2");
        std::vector<double> c = each.numbers("polycoef", 1, 5);
        if (c.empty()) c = {0, 1};
        c.resize(5, 0);
        const bool is_line = each.tag() == "joint" && !leader.empty() && c[2] == 0 && c[3] == 0 && c[4] == 0;
        if (is_line && each.flag("active", true)) {
          follows_[follower] = {leader, c[1], c[0]};
        } else if (each.tag() != "connect" && each.tag() != "weld") {  // which physics takes over
          report_.leave_out("<equality> that is no line between two joints", each.at());
        }
      }
    }
  }

  void report_unread() {
    for (const MjcfElement& section : model_.top()) {
      const bool is_known = std::ranges::count(kUnseenSections, section.tag()) > 0 || section.tag() == "equality";
      if (!is_known) report_.leave_out("element <" + std::string(section.tag()) + ">", section.at());
    }
  }

  // Where content stands: a body by its number, and the frame within it.
  struct Inside {
    std::size_t body = 0;
    glm::dmat4 body_from_frame{1.0};
    int depth = 0;
    std::string suffix{};  // of names, by the <replicate> elements around
  };

  // What stands in a body or a frame. The calls are nested as these are.
  void add_content(const MjcfElement& parent, Group& group, const Inside& inside) {
    if (inside.depth > kMaxMjcfDepth) parent.fail("is nested too deeply");
    for (const MjcfElement& child : parent.children()) {
      const std::string_view tag = child.tag();
      if (tag == "geom") {
        tree_->bodies[inside.body].geoms.push_back({child, inside.body_from_frame});
        if (const NodePtr geom = geoms_.make(child)) group.add(geom);
      } else if (tag == "body") {
        add_body(child, group, inside);
      } else if (tag == "frame") {
        const auto frame = std::make_shared<Separator>();
        const glm::dmat4 place = mjcf_pose(child, model_);
        add_place(place, *frame);
        add_content(child, *frame, {inside.body, inside.body_from_frame * place, inside.depth + 1, inside.suffix});
        group.add(frame);
      } else if (tag == "replicate") {
        add_replicates(child, group, inside);
      } else if (tag == "site") {
        add_point(child, "site", mjcf_pose(child, model_), inside.suffix, group);
      } else if (tag == "camera") {
        // A camera of MuJoCo looks along -z with y up, a sensor of SimVis along x with z up.
        add_point(child, "camera",
                  mjcf_pose(child, model_) * glm::dmat4(0, 0, -1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1),
                  inside.suffix, group);
      } else if (tag == "inertial") {
        tree_->bodies[inside.body].inertials.push_back(child);
      } else if (tag != "joint" && tag != "freejoint") {
        report_.leave_out("element <" + std::string(tag) + ">", child.at());
      }
    }
  }

  // Copies of the content, each moved on from the one before by an offset and a turn, with numbers behind their names.
  void add_replicates(const MjcfElement& replicate, Group& group, const Inside& inside) {
    const double count = replicate.number("count", 0);
    if (!(count >= 1 && count <= kMaxReplicates && count == std::floor(count))) {
      replicate.fail("has the count " + replicate.text("count") + ", expected a whole number from 1 to " +
                     std::to_string(kMaxReplicates));
    }
    replicates_ += static_cast<int>(count);
    if (replicates_ > kMaxReplicates) replicate.fail("makes more than " + std::to_string(kMaxReplicates) + " copies");
    glm::dmat4 step = mjcf_pose(replicate, model_), place(1);
    step[3] = glm::dvec4(replicate.vector("offset", glm::dvec3(0)), 1);
    const std::size_t digits = std::to_string(static_cast<int>(count)).size();
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const auto copy = std::make_shared<Separator>();
      add_place(place, *copy);
      std::string number = std::to_string(i);
      number.insert(0, digits - std::min(digits, number.size()), '0');
      add_content(replicate, *copy,
                  {inside.body, inside.body_from_frame * place, inside.depth + 1,
                   replicate.text("sep") + number + inside.suffix});
      group.add(copy);
      place = place * step;
    }
  }

  static void add_place(const glm::dmat4& matrix, Group& group) {
    if (matrix != glm::dmat4(1)) group.add(std::make_shared<Transform>(matrix));
  }

  static void add_named_point(const std::string& name, Group& group) {
    const auto point = std::make_shared<InsertionPoint>();
    point->name = name;
    group.add(point);
  }

  void add_point(const MjcfElement& element, const char* kind, const glm::dmat4& place, const std::string& suffix,
                 Group& group) {
    const auto name = element.written("name");
    if (!name || name->empty()) return;  // no reference can name it
    const auto separator = std::make_shared<Separator>();
    separator->name = kind;
    add_place(place, *separator);
    add_named_point(points_.add(*name + suffix), *separator);
    group.add(separator);
  }

  // { place, for each joint its anchor and its point, the body's point, content }
  void add_body(const MjcfElement& body, Group& parent, const Inside& inside) {
    const auto written = body.written("name");
    const std::string name = points_.add(written.value_or("body") + inside.suffix);
    const auto group = std::make_shared<Separator>();
    group->name = name;
    const glm::dmat4 place = mjcf_pose(body, model_);
    add_place(place, *group);
    const std::size_t own = tree_->bodies.size();
    tree_->bodies.push_back({.element = body,
                             .own = written ? *written + inside.suffix : "",
                             .name = name,
                             .parent = inside.body,
                             .parent_from_body = inside.body_from_frame * place});
    for (const MjcfElement& child : body.children()) {
      if (child.tag() != "joint" && child.tag() != "freejoint") continue;
      add_joint(child, name, inside.suffix, *group);
    }
    add_named_point(name, *group);
    add_content(body, *group, {own, glm::dmat4(1), inside.depth + 1, inside.suffix});
    parent.add(group);
  }

  static MjcfJoint::Kind kind_of(const std::string& type) {
    if (type == "free") return MjcfJoint::Kind::free;
    if (type == "ball") return MjcfJoint::Kind::ball;
    return type == "slide" ? MjcfJoint::Kind::slide : MjcfJoint::Kind::hinge;
  }

  void add_joint(const MjcfElement& joint, const std::string& body, const std::string& suffix, Group& group) {
    const std::string type = joint.tag() == "freejoint" ? "free" : joint.text("type", "hinge");
    const bool turns = type == "hinge", is_loose = type == "free" || type == "ball";
    if (!turns && !is_loose && type != "slide")
      joint.fail("has the type " + in_quotes(type) + ", expected free, ball, slide or hinge");
    const auto written = joint.written("name");
    const std::string own = written ? *written + suffix : body + "_joint";
    const std::string name = elements_.add(own);
    tree_->bodies.back().joints.push_back({kind_of(type), joint, own, name});
    if (!is_loose) known_joints_[own] = {name, turns};
    const glm::dvec3 anchor = type == "free" ? glm::dvec3(0) : joint.vector("pos", glm::dvec3(0));
    const std::string point = points_.add(name == body ? name + "_joint" : name);
    glm::dmat4 there(1), back(1);
    there[3] = glm::dvec4(anchor, 1);
    back[3] = glm::dvec4(-anchor, 1);
    add_place(there, group);
    add_named_point(point, group);
    add_place(back, group);
    if (is_loose) return add_loose_joint(name, point);
    add_joint_command(joint, own, {name, turns}, point);
  }

  // A free body moves within its parent, and a ball turns about its anchor, from the pose in the file.
  void add_loose_joint(const std::string& name, const std::string& point) {
    Command command;
    command.kind = CommandKind::element;
    command.attributes = {{"type", "pose", {}}, {"name", name, {}}, {"insert_at", point, {}}};
    joints_.push_back(to_string(command));
  }

  void add_joint_command(const MjcfElement& joint, const std::string& own, const Joint& made,
                         const std::string& point) {
    Command command;
    command.kind = CommandKind::element;
    const auto add = [&](const char* name, const std::string& value) {
      command.attributes.push_back({name, value, {}});
    };
    const glm::dvec3 axis = joint.vector("axis", glm::dvec3(0, 0, 1));
    if (axis == glm::dvec3(0)) joint.fail("has the axis 0 0 0, expected a vector that is not zero");
    add("type", "joint");
    add("name", made.name);
    add("insert_at", point);
    add("axis", format_number(axis.x) + " " + format_number(axis.y) + " " + format_number(axis.z));
    add("kind", made.turns ? "revolute" : "prismatic");
    if (follows_.contains(own)) {
      followers_.push_back({own, joint.at(), std::move(command)});
      return;
    }
    add_limits(joint, made.turns, add);
    joints_.push_back(to_string(command));
  }

  // Leaders may come later in the file, so followers come last. One whose leader follows another joint follows that.
  void add_followers() {
    for (Follower& each : followers_) {
      const bool turns = known_joints_.at(each.name).turns;
      Mimic mimic = follows_.at(each.name);
      std::size_t steps = 0;
      for (auto next = follows_.find(mimic.leader); next != follows_.end() && steps <= follows_.size(); ++steps) {
        mimic.offset += mimic.multiplier * next->second.offset;
        mimic.multiplier *= next->second.multiplier;
        mimic.leader = next->second.leader;
        next = follows_.find(mimic.leader);
      }
      const auto leader = known_joints_.find(mimic.leader);
      if (leader == known_joints_.end() || steps > follows_.size()) {
        report_.warn(each.where, "joint " + in_quotes(each.name) + " follows joint " + in_quotes(mimic.leader) +
                                     ", which is not there or follows it; it moves by itself");
        joints_.push_back(to_string(each.command));
        continue;
      }
      const double unit = turns ? kMjcfDegrees : 1;
      each.command.attributes.front().value = "mimic_joint";
      each.command.attributes.push_back({"leader", leader->second.name, {}});
      each.command.attributes.push_back(
          {"multiplier", format_number(mimic.multiplier * unit / (leader->second.turns ? kMjcfDegrees : 1)), {}});
      each.command.attributes.push_back({"offset", format_number(mimic.offset * unit), {}});
      mimics_.push_back(to_string(each.command));
    }
  }

  // A joint's value counts from the pose in which the file places its body, so that `ref` is subtracted.
  template <typename Add>
  void add_limits(const MjcfElement& joint, bool turns, const Add& add) {
    const std::vector<double> range = joint.numbers("range", 2, 2);
    const std::string limited = joint.text("limited", "auto");
    const double unit = turns && !model_.is_degrees ? kMjcfDegrees : 1, ref = joint.number("ref", 0);
    if (ref != 0) report_.warn(joint.at(), "the joint has a \"ref\", which is its value 0 here");
    if (range.empty() || limited == "false" || (limited == "auto" && !model_.autolimits)) return;
    const double lower = (range[0] - ref) * unit, upper = (range[1] - ref) * unit;
    if (lower > upper) {
      return report_.warn(joint.at(), "the lower limit " + format_number(range[0]) + " is above the upper limit " +
                                          format_number(range[1]) + "; the joint has no limits");
    }
    add("lower", format_number(lower));
    add("upper", format_number(upper));
    const double value = std::clamp(0.0, lower, upper);
    if (value != 0) add("value", format_number(value));
  }

  std::shared_ptr<MjcfTree> tree_;
  const MjcfModel& model_ = tree_->model;
  ImportReport report_;
  MjcfGeoms geoms_;
  UniqueNames points_, elements_;
  int replicates_ = 0;
  std::map<std::string, Mimic> follows_;       // by the name of the follower
  std::map<std::string, Joint> known_joints_;  // by the name in the file
  std::vector<Follower> followers_;
  std::vector<std::string> joints_, mimics_;
};

PartContent import_mjcf(const ImportRequest& request, ContentPool& pool) { return MjcfImport(request, pool).run(); }

const PartImporterRegistration registration({".xml"}, import_mjcf);

}  // namespace
}  // namespace simvis
