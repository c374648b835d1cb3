// The element `force`: a force and a torque on a body, by parameters or messages of geometry_msgs/Wrench.
//
//   <element type="force" name="PUSH" insert_at="BOX" point="0.1 0 0" frame="body" force_x="5"/>
//
// Frames      point is in the frame of the insertion point; force and torque in that or in the world, as `frame` says.
// Parameters  force_x force_y force_z (N), torque_x torque_y torque_z (N m), which hold until they change; command:
//             each new value is a command, whose force and torque become 0 after `timeout`.
#pragma once

#include <string>

#include "elements/command_source.h"
#include "elements/dynamics/command_timer.h"
#include "elements/dynamics/forces/wrench_element.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct ForceDesc {
  glm::dvec3 point_m{0};
  bool in_world = true;
  double force_x_n = 0, force_y_n = 0, force_z_n = 0, torque_x_nm = 0, torque_y_nm = 0, torque_z_nm = 0;

  static AttributeRows<ForceDesc> rows();
};

class ForceElement : public WrenchElement, public Stateful, public CommandSource {
 public:
  /// Throws InputError: what WrenchElement throws, or the topic is no topic of ROS.
  explicit ForceElement(const ElementContext& context);
  void update(ParameterView values) override;
  void archive(StateArchive& state) override { state(timer_); }
  Wrench wrench(const PushedBody& body, const PhysicsStep& step) override;

  std::vector<CommandTopic> command_topics() const override { return {topic_}; }
  std::int64_t timeout_ns() const override { return timer_.timeout_ns(); }
  using CommandSource::accept;
  AcceptedCommand accept(const WrenchCommand& command) override;
  std::vector<ParameterSetting> before_frame(std::int64_t begin_ns, std::int64_t end_ns) override;

 private:
  std::vector<ParameterSetting> settings_of(const WrenchCommand& command) const;

  ForceDesc desc_;
  CommandTopic topic_;
  CommandTimer timer_;
};

}  // namespace simvis
