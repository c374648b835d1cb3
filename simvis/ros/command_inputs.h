// Commands of robots: messages of ROS 2 become values of parameters.
//
//   geometry_msgs/Twist, TwistStamped    an element velocity_command
//   sensor_msgs/JointState               an element joint_command
//   std_msgs/Float64MultiArray           an element joint_command
//   trajectory_msgs/JointTrajectory      an element joint_command
//   geometry_msgs/Wrench, WrenchStamped  an element force
//
// DDS and Foxglove pass on what they receive; shared memory writes the same parameters itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/parameters.h>
#include "elements/command_source.h"
#include "exchange/messages/description.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// A topic on which elements of the scene take messages of a type.
struct CommandInput {
  std::string topic;
  const ros::TypeDescription* type = nullptr;  ///< valid for the rest of the program

  bool operator==(const CommandInput&) const = default;  ///< member by member
};

/// The elements of a scene that take commands.
class CommandSources {
 public:
  /// As the scene stands. They are looked for only if it has changed since the last call.
  const std::vector<CommandSource*>& of(const BuiltScene& scene);
  /// All topics of these elements, each once.
  std::vector<CommandInput> inputs(const BuiltScene& scene);
  /// Whether the scene has changed since the last call of of() or inputs().
  bool is_old(const BuiltScene& scene) const { return changes_ != scene.parameters.changes().size(); }

 private:
  std::size_t changes_ = 0;  // of the scene, that `sources_` follow
  std::vector<CommandSource*> sources_;
};

/// Sets what a message commands; `bytes` are a stranger's CDR. `now_ns` is the time of the last frame. Where several
/// elements take the topic, a message with names of joints is for those that have one of them, and all of these take it
/// or none. Throws InputError, and nothing is set: no element takes this, the message is not of its type, names a joint
/// that is not there, has a number that is not finite or out of range, or a stamp that differs from now by more than
/// the element's timeout.
void apply_command(std::span<CommandSource* const> sources, Parameters& parameters, const CommandInput& input,
                   std::string_view bytes, std::int64_t now_ns);

/// Sets what elements that take commands set in the frame from `begin_ns` to `end_ns`, with all values that were set
/// for the frame. Does nothing if there are no such elements. An element whose settings are refused gives up the
/// command under way, with a warning. Throws InputError: the scene is strict, so that a warning is an error.
void follow_commands(std::span<CommandSource* const> sources, BuiltScene& scene, std::int64_t begin_ns,
                     std::int64_t end_ns);

}  // namespace simvis
