// The element `joint_command`: the joints of a robot move as messages or clients command.
//
//   <element type="joint_command" name="COMMAND" insert_at="ARM" robot="ARM_BODY"
//   trajectory_topic="/arm/joint_trajectory"/>
//
// Parameters  command: each new value says that targets of the element `robot` were commanded. Targets that are speeds
//             or efforts, and the efforts of servos, become 0 after `timeout`; positions hold.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/element.h>
#include <simvis/error.h>
#include <simvis/node.h>
#include <simvis/pose.h>
#include "elements/command_source.h"
#include "elements/dynamics/command_timer.h"
#include "elements/dynamics/robot.h"
#include "engine/base/words.h"

namespace simvis {
namespace {

class JointCommandElement : public Element, public Stateful, public CommandSource {
 public:
  /// Throws InputError: the element is no robot, or a topic no topic of ROS.
  explicit JointCommandElement(const ElementContext& context);
  void update(ParameterView values) override { timer_.set(values[0]); }
  void archive(StateArchive& state) override;

  std::vector<CommandTopic> command_topics() const override { return {state_topic_, values_topic_, trajectory_topic_}; }
  std::int64_t timeout_ns() const override { return timer_.timeout_ns(); }
  bool takes_any(std::span<const std::string> joints) const override;
  using CommandSource::accept;
  AcceptedCommand accept(const JointCommand& command) override;
  AcceptedCommand accept(const JointValues& values) override;
  AcceptedCommand accept(const JointPath& path) override;
  std::vector<ParameterSetting> before_frame(std::int64_t begin_ns, std::int64_t end_ns) override;
  void give_up() override { replace_path(std::nullopt, {}); }

 private:
  std::vector<const RobotElement::DrivenJoint*> find_joints(const std::vector<std::string>& names) const;
  void read_listed(const ElementContext& context);
  void add_target(const RobotElement::DrivenJoint& joint, double value, std::vector<ParameterSetting>& settings) const;
  ParameterSetting target(const RobotElement::DrivenJoint& joint, double value) const;
  static void check_limits(const RobotElement::DrivenJoint& joint, double value);
  static void check_path(const JointPath& path, const std::vector<const RobotElement::DrivenJoint*>& joints);
  void replace_path(std::optional<JointPath> path, std::span<const std::string> commanded);
  void begin_path();
  void follow_path(std::int64_t time_ns, std::vector<ParameterSetting>& settings);

  std::string name_, robot_name_;
  CommandTopic state_topic_, values_topic_, trajectory_topic_;
  const RobotElement* robot_;  // the scene keeps it as long as this element
  std::vector<RobotElement::DrivenJoint> joints_;
  std::vector<std::string> listed_;  // joints whose values come without names
  CommandTimer timer_;
  std::optional<JointPath> path_;      // under way
  bool path_begins_ = false;           // its first point is not there yet
  std::vector<std::string> stopping_;  // joints of a replaced path, whose speeds and efforts become 0
};

constexpr std::string_view kValuesTopic = "values_topic", kJoints = "joints";

constexpr AttributeSpec kJointCommandRows[] = {
    {.name = "robot", .kind = AttributeKind::element, .text = "required: the element of type robot whose joints move"},
    {.name = "topic",
     .kind = AttributeKind::text,
     .text = "topic of sensor_msgs/JointState messages with targets; default: /NAME/joint_commands"},
    {.name = kValuesTopic,
     .kind = AttributeKind::text,
     .text = "topic of std_msgs/Float64MultiArray messages with the targets of `joints`; default: /NAME/commands"},
    {.name = kJoints,
     .kind = AttributeKind::text,
     .text = "joints whose targets a Float64MultiArray has, in its order, separated by spaces; default: all driven "
             "joints, in the order of the robot's parameters"},
    {.name = "trajectory_topic",
     .kind = AttributeKind::text,
     .text = "topic of trajectory_msgs/JointTrajectory messages; default: /NAME/joint_trajectory"},
    kCommandTimeoutRow,
    kCommandRow,
};

const ElementRegistration kJointCommandRegistration({
    .name = "joint_command",
    .summary = "The joints of a robot move as ROS messages or clients command.",
    .notes =
        "A command sets the parameters target_JOINT of the element robot: positions of joints driven by position, "
        "velocities and efforts of the others; efforts of servos, if the message has any, become their effort_JOINT. "
        "Joints of a JointState that follow others keep following them. A trajectory is followed on straight lines, or "
        "on cubic curves "
        "where its points have velocities. A later message replaces one that is under way. In shared memory, "
        "write the targets of the robot, then command.",
    .attributes = kJointCommandRows,
    .create = create_element<JointCommandElement>,
});

using DrivenJoint = RobotElement::DrivenJoint;
using JointKindOf = DrivenJoint::Kind;

/// The numbers that a joint of this kind takes.
template <typename Lists>
const std::vector<double>& numbers_for(const Lists& lists, JointKindOf kind) {
  return kind == JointKindOf::position   ? lists.positions
         : kind == JointKindOf::velocity ? lists.velocities
                                         : lists.efforts;
}

std::string_view name_of(JointKindOf kind) {
  return kind == JointKindOf::position ? "position" : kind == JointKindOf::velocity ? "velocity" : "effort";
}

void require_once(const std::vector<std::string>& joints) {
  std::set<std::string_view> known;
  for (const std::string& joint : joints) {
    if (!known.insert(joint).second) throw InputError("joint " + in_quotes(joint) + " comes twice");
  }
}

template <typename Lists>
void check_counts(const Lists& lists, std::size_t joints) {
  for (const std::vector<double>* const list : {&lists.positions, &lists.velocities, &lists.efforts}) {
    if (list->empty() || list->size() == joints) continue;
    throw InputError("a list has " + std::to_string(list->size()) + " values for " + std::to_string(joints) +
                     " joints, expected as many, or none");
  }
}

[[noreturn]] void refuse_without_values(const DrivenJoint& joint) {
  throw InputError("joint " + in_quotes(joint.name) + " is driven by " + std::string(name_of(joint.kind)) +
                   ", expected values of that kind");
}

template <typename Lists>
void require_numbers(const Lists& lists, const std::vector<const DrivenJoint*>& joints) {
  for (const DrivenJoint* const joint : joints) {
    if (numbers_for(lists, joint->kind).empty()) refuse_without_values(*joint);
  }
}

/// The numbers of one kind in a JointState, by joint. A list has one for each name, or one for each joint that is
/// driven so: in this form hardware interfaces of ros2_control write joints of several kinds.
class NumbersOfKind {
 public:
  NumbersOfKind(const std::vector<double>& list, JointKindOf kind, const std::vector<const DrivenJoint*>& joints)
      : list_(list), is_full_(list.size() == joints.size()) {
    const auto driven = std::ranges::count_if(
        joints, [&](const DrivenJoint* joint) { return joint != nullptr && joint->kind == kind; });
    if (list.empty() || is_full_ || list.size() == static_cast<std::size_t>(driven)) return;
    throw InputError("a list has " + std::to_string(list.size()) + " values for " + std::to_string(joints.size()) +
                     " joints, of which " + std::to_string(driven) + " are driven by " + std::string(name_of(kind)) +
                     ", expected as many as one of them, or none");
  }
  bool is_full() const { return is_full_ && !list_.empty(); }
  /// The number of the next joint of this kind, which has this place among the names.
  double next(const DrivenJoint& joint, std::size_t place) {
    if (list_.empty()) refuse_without_values(joint);
    return list_[is_full_ ? place : next_++];
  }

 private:
  const std::vector<double>& list_;
  bool is_full_;
  std::size_t next_ = 0;
};

// In rad or m. It is far above the way of a joint between two points, and so far below the largest double that the sums
// of a cubic curve are finite.
constexpr double kMaxSegmentWay = kMaxCoordinate_m;

/// The time from the point before to point `i`; to the first one from the start of the path.
double segment_s(const JointPath& path, std::size_t i) {
  return static_cast<double>(path.points[i].time_ns - (i == 0 ? 0 : path.points[i - 1].time_ns)) / 1e9;
}

/// Throws InputError for a velocity whose curve over `seconds` could overflow. SI units of the joint.
void check_segment(const DrivenJoint& joint, double velocity, double seconds) {
  if (std::abs(velocity) * seconds <= kMaxSegmentWay) return;
  throw InputError("joint " + in_quotes(joint.name) + ": the velocity " + format_number(velocity) + " over " +
                   format_number(seconds) + " s to the next point is out of range, expected a way of at most " +
                   format_number(kMaxSegmentWay));
}

/// The position between two points: on a cubic curve if both have velocities (de Boor, "A Practical Guide to Splines",
/// chapter 4), else on a line.
double position_between(const JointPath::Point& from, const JointPath::Point& to, std::size_t joint, double share) {
  const double a = from.positions[joint], b = to.positions[joint];
  if (from.velocities.empty() || to.velocities.empty()) return std::lerp(a, b, share);
  const double seconds = static_cast<double>(to.time_ns - from.time_ns) / 1e9;
  const double va = from.velocities[joint] * seconds, vb = to.velocities[joint] * seconds;
  const double s2 = share * share, s3 = s2 * share;
  return a * (2 * s3 - 3 * s2 + 1) + va * (s3 - 2 * s2 + share) + b * (3 * s2 - 2 * s3) + vb * (s3 - s2);
}

}  // namespace

JointCommandElement::JointCommandElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      robot_name_(context.command.require("robot").value),
      state_topic_(command_topic(context, "topic", "joint_commands", CommandContent::joints)),
      values_topic_(command_topic(context, kValuesTopic, "commands", CommandContent::joint_values)),
      trajectory_topic_(command_topic(context, "trajectory_topic", "joint_trajectory", CommandContent::joint_path)),
      robot_(dynamic_cast<RobotElement*>(context.find_element(robot_name_))),
      timer_(context.attributes.number("timeout")) {
  if (robot_ == nullptr) {
    fail_at(context.attributes.where("robot"), "attribute \"robot\": " + in_quotes(robot_name_) +
                                                   " is not allowed, expected the name of an element of type robot");
  }
  joints_ = robot_->driven_joints();
  read_listed(context);
  const auto mark = std::make_shared<Group>();
  mark->name = name_;
  context.scene.insert(context.command, mark);
}

void JointCommandElement::read_listed(const ElementContext& context) {
  if (!context.attributes.is_set(kJoints)) {
    for (const DrivenJoint& joint : joints_) listed_.push_back(joint.name);
    return;
  }
  for (const std::string_view word : words_of(context.attributes.text(kJoints))) listed_.emplace_back(word);
  try {
    find_joints(listed_);
  } catch (const InputError& error) {
    fail_at(context.attributes.where(kJoints), error.what());
  }
}

std::vector<const DrivenJoint*> JointCommandElement::find_joints(const std::vector<std::string>& names) const {
  require_once(names);
  std::vector<const DrivenJoint*> found;
  for (const std::string& name : names) {
    const auto joint = std::ranges::find(joints_, name, &DrivenJoint::name);
    if (joint == joints_.end()) {
      std::vector<std::string_view> known;
      for (const DrivenJoint& each : joints_) known.push_back(each.name);
      throw InputError("there is no driven joint " + in_quotes(name) + suggestion(name, known));
    }
    found.push_back(&*joint);
  }
  return found;
}

// A curve between points within the limits may leave them, and rounding may exceed a limit, so the value is clamped. It
// is finite, since check_path() and check_limits() have checked all numbers that it is computed from.
ParameterSetting JointCommandElement::target(const DrivenJoint& joint, double value) const {
  return {robot_name_, joint.parameter, std::clamp(value / joint.unit, joint.min, joint.max)};
}

void JointCommandElement::check_limits(const DrivenJoint& joint, double value) {
  const double written = value / joint.unit;
  if (written >= joint.min - joint.rounding && written <= joint.max + joint.rounding) return;
  throw InputError("joint " + in_quotes(joint.name) + ": the " + std::string(name_of(joint.kind)) + " " +
                   format_number(written) + " is out of range, expected " + format_number(joint.min) + " to " +
                   format_number(joint.max));
}

bool JointCommandElement::takes_any(std::span<const std::string> joints) const {
  return joints.empty() || std::ranges::any_of(joints, [&](const std::string& name) {
           return robot_->follows(name) || std::ranges::find(joints_, name, &DrivenJoint::name) != joints_.end();
         });
}

void JointCommandElement::add_target(const DrivenJoint& joint, double value,
                                     std::vector<ParameterSetting>& settings) const {
  check_limits(joint, value);
  settings.push_back(target(joint, value));
}

// Joints that follow others have no target of their own, and stand in the messages of hardware interfaces.
AcceptedCommand JointCommandElement::accept(const JointCommand& command) {
  require_once(command.names);
  std::vector<std::string> driven = command.names;
  std::erase_if(driven, [&](const std::string& joint) { return robot_->follows(joint); });
  const std::vector<const DrivenJoint*> found = find_joints(driven);
  std::vector<const DrivenJoint*> joints;  // by name; null: it follows another one
  for (std::size_t next = 0; const std::string& joint : command.names) {
    joints.push_back(robot_->follows(joint) ? nullptr : found[next++]);
  }
  NumbersOfKind positions(command.positions, JointKindOf::position, joints),
      velocities(command.velocities, JointKindOf::velocity, joints),
      efforts(command.efforts, JointKindOf::effort, joints);
  std::vector<ParameterSetting> settings{{name_, "command", timer_.next()}};
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i] == nullptr) continue;
    const DrivenJoint& joint = *joints[i];
    NumbersOfKind& numbers = joint.kind == JointKindOf::position   ? positions
                             : joint.kind == JointKindOf::velocity ? velocities
                                                                   : efforts;
    add_target(joint, numbers.next(joint, i), settings);
    if (joint.effort_parameter.empty() || !efforts.is_full()) continue;
    settings.push_back({robot_name_, joint.effort_parameter, command.efforts[i]});
  }
  return {.settings = std::move(settings), .begin = [this, names = driven] { replace_path(std::nullopt, names); }};
}

AcceptedCommand JointCommandElement::accept(const JointValues& values) {
  if (values.values.size() != listed_.size()) {
    throw InputError("the message has " + std::to_string(values.values.size()) + " values, expected " +
                     std::to_string(listed_.size()) + ", one for each joint of " + in_quotes(name_));
  }
  std::vector<ParameterSetting> settings{{name_, "command", timer_.next()}};
  for (std::size_t next = 0; const DrivenJoint* const joint : find_joints(listed_)) {
    add_target(*joint, values.values[next++], settings);
  }
  return {.settings = std::move(settings), .begin = [this] { replace_path(std::nullopt, listed_); }};
}

void JointCommandElement::check_path(const JointPath& path, const std::vector<const DrivenJoint*>& joints) {
  std::int64_t before_ns = -1;
  for (const JointPath::Point& point : path.points) {
    check_counts(point, joints.size());
    require_numbers(point, joints);
    for (std::size_t i = 0; i < joints.size(); ++i) check_limits(*joints[i], numbers_for(point, joints[i]->kind)[i]);
    if (point.time_ns <= before_ns) {
      throw InputError("the times of the trajectory's points are not ascending from 0, expected that they are");
    }
    before_ns = point.time_ns;
  }
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const std::vector<double>& velocities = path.points[i].velocities;
    const double longest_s = std::max(segment_s(path, i), i + 1 < path.points.size() ? segment_s(path, i + 1) : 0);
    for (std::size_t j = 0; j < velocities.size(); ++j) {
      if (joints[j]->kind == JointKindOf::position) check_segment(*joints[j], velocities[j], longest_s);
    }
  }
}

AcceptedCommand JointCommandElement::accept(const JointPath& path) {
  check_path(path, find_joints(path.names));
  return {.settings = {}, .begin = [this, path = path]() mutable { replace_path(std::move(path), {}); }};
}

// Speeds and efforts that the replaced path has set would hold for ever, so before_frame() sets them to 0. Joints in
// `commanded` are left out: they have new values.
void JointCommandElement::replace_path(std::optional<JointPath> path, std::span<const std::string> commanded) {
  if (path_ && !path_begins_) {
    for (const std::string& name : path_->names) {
      if (std::ranges::find(stopping_, name) == stopping_.end()) stopping_.push_back(name);
    }
  }
  std::erase_if(stopping_,
                [&](const std::string& name) { return std::ranges::find(commanded, name) != commanded.end(); });
  path_ = std::move(path);
  path_begins_ = true;
}

// The way to the first point starts where the joints stand.
void JointCommandElement::begin_path() {
  path_begins_ = false;
  if (path_->points.empty() || path_->points.front().time_ns == 0) return;
  JointPath::Point start;
  for (const DrivenJoint* const joint : find_joints(path_->names)) {
    start.positions.push_back(robot_->joint_position(joint->name));
  }
  if (!path_->points.front().velocities.empty()) start.velocities.assign(path_->names.size(), 0);
  if (!path_->points.front().efforts.empty()) start.efforts.assign(path_->names.size(), 0);
  path_->points.insert(path_->points.begin(), std::move(start));
}

void JointCommandElement::follow_path(std::int64_t time_ns, std::vector<ParameterSetting>& settings) {
  if (path_begins_) begin_path();
  const std::vector<const DrivenJoint*> joints = find_joints(path_->names);
  if (path_->points.empty()) {
    for (const DrivenJoint& joint : joints_) {
      settings.push_back(target(joint, joint.kind == JointKindOf::position ? robot_->joint_position(joint.name) : 0));
    }
    path_.reset();
    return;
  }
  const auto later = std::ranges::upper_bound(path_->points, time_ns, {}, &JointPath::Point::time_ns);
  if (later == path_->points.begin()) return;
  const JointPath::Point& from = *std::prev(later);
  const bool is_over = later == path_->points.end();
  const double share =
      is_over ? 0 : static_cast<double>(time_ns - from.time_ns) / static_cast<double>(later->time_ns - from.time_ns);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointKindOf kind = joints[i]->kind;
    double value = is_over && kind == JointKindOf::position ? from.positions[i] : 0;
    if (!is_over && kind == JointKindOf::position) value = position_between(from, *later, i, share);
    if (!is_over && kind != JointKindOf::position) {
      const std::vector<double>&a = numbers_for(from, kind), &b = numbers_for(*later, kind);
      value = std::lerp(a[i], b[i], share);
    }
    settings.push_back(target(*joints[i], value));
  }
  if (is_over) path_.reset();
}

std::vector<ParameterSetting> JointCommandElement::before_frame(std::int64_t begin_ns, std::int64_t end_ns) {
  std::vector<ParameterSetting> settings;
  if (timer_.at(begin_ns) == CommandTimer::Event::ends) {
    for (const DrivenJoint& joint : joints_) {
      if (joint.kind != JointKindOf::position) settings.push_back(target(joint, 0));
      if (!joint.effort_parameter.empty()) settings.push_back({robot_name_, joint.effort_parameter, 0});
    }
  }
  for (const DrivenJoint* const joint : find_joints(stopping_)) {
    if (joint->kind != JointKindOf::position) settings.push_back(target(*joint, 0));
  }
  stopping_.clear();
  if (path_ && end_ns >= path_->start_ns) follow_path(end_ns - path_->start_ns, settings);
  return settings;
}

void JointCommandElement::archive(StateArchive& state) {
  state(timer_, path_, path_begins_, stopping_);
  if (!state.is_reading()) return;
  find_joints(stopping_);
  if (!path_) return;
  const std::vector<const DrivenJoint*> joints = find_joints(path_->names);
  std::int64_t before_ns = -1;
  for (const JointPath::Point& point : path_->points) {
    check_counts(point, joints.size());
    require_numbers(point, joints);
    state.require(point.time_ns > before_ns);
    before_ns = point.time_ns;
  }
}

}  // namespace simvis
