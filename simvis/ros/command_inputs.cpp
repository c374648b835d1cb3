#include "simvis/ros/command_inputs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "exchange/messages/cdr.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/std_types.h"
#include "exchange/messages/types/trajectory_types.h"
#include "simvis/element_motion.h"

namespace simvis {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Calls `use(type)` for each message type of a topic's content.
template <typename Use>
void for_types(CommandContent content, const Use& use) {
  switch (content) {
    case CommandContent::velocity:
      use(ros::describe<ros::Twist>());
      use(ros::describe<ros::TwistStamped>());
      break;
    case CommandContent::joints:
      use(ros::describe<ros::JointState>());
      break;
    case CommandContent::joint_values:
      use(ros::describe<ros::Float64MultiArray>());
      break;
    case CommandContent::joint_path:
      use(ros::describe<ros::JointTrajectory>());
      break;
    case CommandContent::wrench:
      use(ros::describe<ros::Wrench>());
      use(ros::describe<ros::WrenchStamped>());
      break;
  }
}

std::int64_t nanoseconds(std::int32_t seconds, std::uint32_t nanoseconds) {
  return std::int64_t{seconds} * kSecond_ns + nanoseconds;
}
std::int64_t stamp_of(const ros::Header& header) { return nanoseconds(header.stamp.sec, header.stamp.nanosec); }

// A stamp of 0 says nothing, as everywhere in ROS.
void check_stamp(const ros::Header& header, std::int64_t now_ns, std::int64_t timeout_ns) {
  const std::int64_t stamp_ns = stamp_of(header);
  if (stamp_ns == 0) return;
  const double late_s = static_cast<double>(now_ns - stamp_ns) / static_cast<double>(kSecond_ns);
  if (std::abs(late_s) * static_cast<double>(kSecond_ns) <= static_cast<double>(timeout_ns)) return;
  throw InputError("its stamp is " + format_number(std::abs(late_s)) + " s " + (late_s > 0 ? "before" : "after") +
                   " the simulated time, expected at most " +
                   format_number(static_cast<double>(timeout_ns) / static_cast<double>(kSecond_ns)) +
                   " s, or a stamp of 0");
}

void check_finite(const std::vector<double>& numbers) {
  if (std::ranges::all_of(numbers, [](double each) { return std::isfinite(each); })) return;
  throw InputError("a number is not finite");
}

VelocityCommand velocity_of(const ros::Twist& twist) {
  const ros::Vector3 &v = twist.linear, &w = twist.angular;
  check_finite({v.x, v.y, v.z, w.x, w.y, w.z});
  return {.forward_m_s = v.x, .turn_rad_s = w.z, .left_m_s = v.y};
}

WrenchCommand wrench_of(const ros::Wrench& wrench) {
  const ros::Vector3 &f = wrench.force, &t = wrench.torque;
  check_finite({f.x, f.y, f.z, t.x, t.y, t.z});
  return {.force_n = {f.x, f.y, f.z}, .torque_nm = {t.x, t.y, t.z}};
}

JointCommand joints_of(ros::JointState&& state) {
  for (const auto* const list : {&state.position, &state.velocity, &state.effort}) check_finite(*list);
  return {.names = std::move(state.name),
          .positions = std::move(state.position),
          .velocities = std::move(state.velocity),
          .efforts = std::move(state.effort)};
}

// A stamp of 0 begins the trajectory now, any other one then.
JointPath path_of(ros::JointTrajectory&& trajectory, std::int64_t now_ns) {
  const std::int64_t stamp_ns = stamp_of(trajectory.header);
  JointPath path{
      .names = std::move(trajectory.joint_names), .start_ns = stamp_ns == 0 ? now_ns : stamp_ns, .points = {}};
  for (ros::JointTrajectoryPoint& point : trajectory.points) {
    for (const auto* const list : {&point.positions, &point.velocities, &point.effort}) check_finite(*list);
    path.points.push_back({.time_ns = nanoseconds(point.time_from_start.sec, point.time_from_start.nanosec),
                           .positions = std::move(point.positions),
                           .velocities = std::move(point.velocities),
                           .efforts = std::move(point.effort)});
  }
  return path;
}

/// The elements that take messages of this topic and type.
std::vector<CommandSource*> takers_of(std::span<CommandSource* const> sources, const CommandInput& input) {
  std::vector<CommandSource*> takers;
  for (CommandSource* const source : sources) {
    for (const CommandTopic& topic : source->command_topics()) {
      bool fits = false;
      for_types(topic.content, [&](const ros::TypeDescription& type) { fits = fits || &type == input.type; });
      if (fits && topic.topic == input.topic) takers.push_back(source);
    }
  }
  return takers;
}

/// The elements that have one of the joints. If none has, all elements: the first one throws why it refuses.
std::vector<CommandSource*> having_any(std::vector<CommandSource*> takers, std::span<const std::string> joints) {
  std::vector<CommandSource*> having;
  std::ranges::copy_if(takers, std::back_inserter(having),
                       [&](const CommandSource* each) { return each->takes_any(joints); });
  return having.empty() ? takers : having;
}

template <typename Command>
std::vector<AcceptedCommand> accepted_by(const std::vector<CommandSource*>& takers, const Command& command,
                                         const ros::Header* header, std::int64_t now_ns) {
  std::vector<AcceptedCommand> accepted;
  for (CommandSource* const source : takers) {
    if (header != nullptr) check_stamp(*header, now_ns, source->timeout_ns());
    accepted.push_back(source->accept(command));
  }
  return accepted;
}

/// The effects of a message on all elements that take it.
std::vector<AcceptedCommand> accepted_of(const std::vector<CommandSource*>& takers, const CommandInput& input,
                                         std::string_view bytes, std::int64_t now_ns) {
  if (input.type == &ros::describe<ros::Twist>()) {
    return accepted_by(takers, velocity_of(ros::decode<ros::Twist>(bytes)), nullptr, now_ns);
  }
  if (input.type == &ros::describe<ros::TwistStamped>()) {
    const auto message = ros::decode<ros::TwistStamped>(bytes);
    return accepted_by(takers, velocity_of(message.twist), &message.header, now_ns);
  }
  if (input.type == &ros::describe<ros::Wrench>()) {
    return accepted_by(takers, wrench_of(ros::decode<ros::Wrench>(bytes)), nullptr, now_ns);
  }
  if (input.type == &ros::describe<ros::WrenchStamped>()) {
    const auto message = ros::decode<ros::WrenchStamped>(bytes);
    return accepted_by(takers, wrench_of(message.wrench), &message.header, now_ns);
  }
  if (input.type == &ros::describe<ros::JointState>()) {
    auto message = ros::decode<ros::JointState>(bytes);
    const ros::Header header = message.header;
    const JointCommand command = joints_of(std::move(message));
    return accepted_by(having_any(takers, command.names), command, &header, now_ns);
  }
  if (input.type == &ros::describe<ros::Float64MultiArray>()) {
    JointValues command{.values = ros::decode<ros::Float64MultiArray>(bytes).data};
    check_finite(command.values);
    return accepted_by(takers, command, nullptr, now_ns);
  }
  auto message = ros::decode<ros::JointTrajectory>(bytes);
  const ros::Header header = message.header;
  const JointPath path = path_of(std::move(message), now_ns);
  return accepted_by(having_any(takers, path.names), path, &header, now_ns);
}

// All values, or none.
void set_all(Parameters& parameters, const std::vector<ParameterSetting>& settings) {
  std::vector<std::pair<std::size_t, double>> values;
  for (const ParameterSetting& each : settings) {
    values.emplace_back(parameters.index(each.element, each.parameter), each.value);
    const std::string wrong = check_number(parameters.spec(values.back().first), each.value);
    if (!wrong.empty()) throw InputError(each.element + "." + each.parameter + ": " + wrong);
  }
  for (const auto& [index, value] : values) parameters.set(index, value);
}

}  // namespace

const std::vector<CommandSource*>& CommandSources::of(const BuiltScene& scene) {
  if (!is_old(scene)) return sources_;
  changes_ = scene.parameters.changes().size();
  sources_.clear();
  for (const std::unique_ptr<Element>& element : scene.elements) {
    if (auto* const source = dynamic_cast<CommandSource*>(element.get())) sources_.push_back(source);
  }
  return sources_;
}

std::vector<CommandInput> CommandSources::inputs(const BuiltScene& scene) {
  std::vector<CommandInput> inputs;
  for (const CommandSource* const source : of(scene)) {
    for (const CommandTopic& topic : source->command_topics()) {
      for_types(topic.content, [&](const ros::TypeDescription& type) {
        const CommandInput input{topic.topic, &type};
        if (std::ranges::count(inputs, input) == 0) inputs.push_back(input);
      });
    }
  }
  return inputs;
}

void apply_command(std::span<CommandSource* const> sources, Parameters& parameters, const CommandInput& input,
                   std::string_view bytes, std::int64_t now_ns) {
  try {
    const std::vector<CommandSource*> takers = takers_of(sources, input);
    if (takers.empty()) throw InputError("no element takes commands of this topic");
    const std::vector<AcceptedCommand> accepted = accepted_of(takers, input, bytes, now_ns);
    std::vector<ParameterSetting> settings;
    for (const AcceptedCommand& each : accepted) std::ranges::copy(each.settings, std::back_inserter(settings));
    set_all(parameters, settings);
    for (const AcceptedCommand& each : accepted) {
      if (each.begin) each.begin();
    }
  } catch (const InputError& error) {
    throw InputError(input.topic + ": " + error.what());
  }
}

void follow_commands(std::span<CommandSource* const> sources, BuiltScene& scene, std::int64_t begin_ns,
                     std::int64_t end_ns) {
  if (sources.empty()) return;
  update_elements(scene);
  for (CommandSource* const source : sources) {
    try {
      set_all(scene.parameters, source->before_frame(begin_ns, end_ns));
    } catch (const InputError& error) {
      source->give_up();
      scene.scene.warn(std::string("a command was given up: ") + error.what());
      scene.scene.undo().commit();  // the warning belongs to no change of the scene
    }
  }
}

}  // namespace simvis
