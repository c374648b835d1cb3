// Elements that take commands of robots from messages and from clients, and set the parameters of what they drive.
//
// A new value of the element's parameter `command` is a command: its other parameters count from then on, for a limited
// time. A file, a client in shared memory and a message command in this one way, so recordings, followers and logs have
// every command.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/element.h>
#include <simvis/location.h>
#include <simvis/state_archive.h>

namespace simvis {

/// A value for a parameter of the scene, in the unit of its element's table.
struct ParameterSetting {
  std::string element, parameter;
  double value = 0;
};

/// The wanted motion of a vehicle in its own frame.
struct VelocityCommand {
  double forward_m_s = 0, turn_rad_s = 0;
  double left_m_s = 0;  ///< of a vehicle that moves sideways; others leave it out
};

/// Wanted states of joints; an empty list says nothing of that kind. SI units: rad or m, and N m or N.
struct JointCommand {
  std::vector<std::string> names;
  /// As many as names, or as many as joints that are driven so, or none.
  std::vector<double> positions{}, velocities{}, efforts{};
};

/// Wanted positions, velocities or efforts of the joints that the element lists. SI units.
struct JointValues {
  std::vector<double> values;
};

/// A motion of joints. Lists of a point have as many numbers as names, or none.
struct JointPath {
  struct Point {
    std::int64_t time_ns = 0;  ///< since the start; ascending
    std::vector<double> positions{}, velocities{}, efforts{};
    void archive(StateArchive& state) { state(time_ns, positions, velocities, efforts); }
  };
  std::vector<std::string> names;
  std::int64_t start_ns = 0;  ///< simulated time
  void archive(StateArchive& state) {
    state(names, start_ns, points);
    state.require(start_ns >= 0);
  }
  std::vector<Point> points;  ///< empty: the motion that is under way ends, and the joints stay where they are
};

/// A wanted force and torque, along the axes that the element says.
struct WrenchCommand {
  glm::dvec3 force_n{0}, torque_nm{0};
};

/// What a topic of commands brings.
enum class CommandContent : std::uint8_t { velocity, joints, joint_values, joint_path, wrench };

struct CommandTopic {
  std::string topic;
  Location where{};         ///< of the attribute that names it, or of the element
  bool is_default = false;  ///< no attribute names it
  CommandContent content = CommandContent::velocity;
};

/// The effect of a message that an element has accepted but not applied yet.
struct AcceptedCommand {
  std::vector<ParameterSetting> settings;  ///< values to set; the element's own parameter `command` is the first
  std::function<void()> begin{};           ///< the caller calls it after the settings of all elements; may be empty
};

class CommandSource {
 public:
  virtual ~CommandSource() = default;

  virtual std::vector<CommandTopic> command_topics() const = 0;
  /// How long a command holds, and how old one may be.
  virtual std::int64_t timeout_ns() const = 0;

  /// True if the element has at least one of these joints, or if `joints` is empty. It selects the elements that take a
  /// message where several elements share its topic.
  virtual bool takes_any(std::span<const std::string> /*joints*/) const { return true; }
  /// Checks a message and returns its effect. The element does not change before AcceptedCommand::begin() is called.
  /// Throws InputError: a joint does not exist or has another drive, lists have different lengths, or the element takes
  /// no commands of this kind.
  virtual AcceptedCommand accept(const VelocityCommand& command);
  virtual AcceptedCommand accept(const JointCommand& command);
  virtual AcceptedCommand accept(const JointValues& values);
  virtual AcceptedCommand accept(const JointPath& path);
  virtual AcceptedCommand accept(const WrenchCommand& command);

  /// What the element sets in the frame from `begin_ns` to `end_ns`, after all values have been set for it, and before
  /// anything moves.
  virtual std::vector<ParameterSetting> before_frame(std::int64_t begin_ns, std::int64_t end_ns) = 0;
  /// Ends the trajectory under way. The caller calls it if settings of before_frame() were refused.
  virtual void give_up() {}
};

/// The topic that an attribute of an element gives, or "/NAME/WHAT" of the element's name. Throws InputError at the
/// attribute.
CommandTopic command_topic(const ElementContext& context, std::string_view attribute, std::string_view what,
                           CommandContent content = CommandContent::velocity);

}  // namespace simvis
