#include "import/model/joint_commands.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/model/file_command.h"

namespace simvis {
namespace {

constexpr double kDegreesOfRadian = 180 / std::numbers::pi;
// Limits of formats that count from another value are differences; rad or m.
constexpr double kStartRounding = 1e-9;

bool joint_turns(const ModelJoint& joint) {
  return joint.kind == ModelJoint::Kind::revolute || joint.kind == ModelJoint::Kind::continuous;
}
bool has_one_value(const ModelJoint& joint) { return joint_turns(joint) || joint.kind == ModelJoint::Kind::prismatic; }
double unit_of_value(const ModelJoint& joint) { return joint_turns(joint) ? kDegreesOfRadian : 1; }

// Degrees that a file has written read again as they were: the conversion to radians and back errs by one or two units
// of the last of 17 digits.
double value_of(double value) {
  constexpr int kDigits = 15;
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits);
  double rounded = value;
  if (error == std::errc()) std::from_chars(text.data(), end, rounded);
  return std::clamp(rounded + 0.0, -kMaxCoordinate_m, kMaxCoordinate_m);
}

FileCommand motion_command(const char* type, const ModelJoint& joint, const std::string& point) {
  FileCommand command(CommandKind::element, type, joint.name, point);
  command.add("axis", joint.axis);
  command.add("kind", joint_turns(joint) ? "revolute" : "prismatic");
  return command;
}

// In radians or metres.
double start_of(const ModelJoint& joint) {
  double start = 0;
  if (joint.lower) start = std::max(start, *joint.lower);
  if (joint.upper) start = std::min(start, *joint.upper);
  return start;
}

std::string simple_command(const ModelJoint& joint, const std::string& point) {
  FileCommand command = motion_command("joint", joint, point);
  const double unit = unit_of_value(joint);
  if (joint.lower) command.add("lower", value_of(*joint.lower * unit));
  if (joint.upper) command.add("upper", value_of(*joint.upper * unit));
  if (const double start = start_of(joint); start != 0) command.add("value", value_of(start * unit));
  return command.text();
}

std::string follower_command(const ModelJoint& joint, const std::string& point, double unit_of_leader) {
  FileCommand command = motion_command("mimic_joint", joint, point);
  command.add("leader", joint.leader);
  command.add("multiplier", joint.multiplier * (unit_of_value(joint) / unit_of_leader));
  command.add("offset", joint.offset * unit_of_value(joint));
  return command.text();
}

void add_planar(const ModelJoint& joint, const std::string& point, std::vector<std::string>& commands) {
  constexpr double kNearX = 0.9;  // the cosine of 26 degrees
  const glm::dvec3 side = std::abs(joint.axis.x) > kNearX ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(side - glm::dot(side, joint.axis) * joint.axis), y = glm::cross(joint.axis, x);
  const auto add = [&](const char* ending, const glm::dvec3& axis, ModelJoint::Kind kind) {
    ModelJoint part{.kind = kind, .name = joint.name + ending};
    part.axis = axis;
    commands.push_back(motion_command("joint", part, point).text());
  };
  add("_X", x, ModelJoint::Kind::prismatic);
  add("_Y", y, ModelJoint::Kind::prismatic);
  add("_TURN", joint.axis, ModelJoint::Kind::revolute);
}

// Position = multiplier * that of the leader + offset, in radians and metres; the leader follows no other joint.
struct Chain {
  const ModelJoint* leader = nullptr;
  double multiplier = 1, offset = 0;
};

using JointsByName = std::map<std::string, const ModelJoint*, std::less<>>;

// Empty: `wrong` has been told why.
std::optional<Chain> chain_of(const ModelJoint& joint, const JointsByName& joints, const WrongLeader& wrong) {
  const auto refuse = [&](const std::string& what) {
    wrong(joint, what);
    return std::nullopt;
  };
  if (!has_one_value(joint)) return refuse("mimics another joint and is not revolute, continuous or prismatic");
  Chain chain{.leader = &joint};
  for (std::size_t steps = 0; !chain.leader->leader.empty(); ++steps) {
    if (steps > joints.size()) return refuse("mimics itself in a circle");
    const ModelJoint& follower = *chain.leader;
    chain.offset += chain.multiplier * follower.offset;
    chain.multiplier *= follower.multiplier;
    const auto next = joints.find(follower.leader);
    if (next == joints.end()) return refuse("mimics joint " + in_quotes(follower.leader) + ", which is not there");
    chain.leader = next->second;
    if (!has_one_value(*chain.leader)) {
      return refuse("mimics joint " + in_quotes(follower.leader) + ", which is not revolute, continuous or prismatic");
    }
  }
  return chain;
}

}  // namespace

void resolve_leaders(const std::vector<ModelJoint*>& joints, const WrongLeader& wrong) {
  JointsByName by_name;
  for (const ModelJoint* joint : joints) by_name.emplace(joint->name, joint);
  // All chains are followed before any is shortened, so that the order of the joints does not matter.
  std::vector<std::pair<ModelJoint*, std::optional<Chain>>> followers;
  for (ModelJoint* joint : joints) {
    if (!joint->leader.empty()) followers.emplace_back(joint, chain_of(*joint, by_name, wrong));
  }
  for (auto& [joint, chain] : followers) {
    joint->leader = chain ? chain->leader->name : "";
    joint->multiplier = chain ? chain->multiplier : 1;
    joint->offset = chain ? chain->offset : 0;
  }
}

std::optional<std::string> JointCommands::start_warning() const {
  const ModelJoint* first = nullptr;
  std::size_t count = 0;
  for (const auto& [joint, point] : joints_) {
    if (!joint.leader.empty() || !has_one_value(joint) || std::abs(start_of(joint)) <= kStartRounding) continue;
    if (count++ == 0) first = &joint;
  }
  if (first == nullptr) return std::nullopt;
  const double unit = unit_of_value(*first);
  const std::string unit_name = joint_turns(*first) ? " deg" : " m";
  const auto limit = [&](const std::optional<double>& value, const char* open) {
    return value ? format_number(value_of(*value * unit)) : std::string(open);
  };
  return to_string(first->where) + ": joint " + in_quotes(first->name) + " cannot start at 0" + unit_name +
         ", outside of its limits " + limit(first->lower, "-infinity") + " and " + limit(first->upper, "infinity") +
         unit_name + "; it starts at " + format_number(value_of(start_of(*first) * unit)) + unit_name +
         (count > 1 ? ". Joints that start at a limit: " + std::to_string(count) : "");
}

std::vector<std::string> JointCommands::release() {
  std::map<std::string, double, std::less<>> units;
  for (const Placed& each : joints_) units.emplace(each.joint.name, unit_of_value(each.joint));
  std::vector<std::string> commands, followers;
  for (const auto& [joint, point] : joints_) {
    const auto leader = joint.leader.empty() ? units.end() : units.find(joint.leader);
    if (leader != units.end()) {
      followers.push_back(follower_command(joint, point, leader->second));
    } else if (has_one_value(joint)) {
      commands.push_back(simple_command(joint, point));
    } else if (joint.kind == ModelJoint::Kind::planar) {
      add_planar(joint, point, commands);
    } else if (joint.kind != ModelJoint::Kind::fixed) {
      commands.push_back(FileCommand(CommandKind::element, "pose", joint.name, point).text());
    }
  }
  joints_.clear();
  std::ranges::move(followers, std::back_inserter(commands));
  return commands;
}

}  // namespace simvis
