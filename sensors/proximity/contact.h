// The sensor `contact`: where a body of physics touches others.
//
//   <sensor type="contact" name="FOOT_CONTACT" insert_at="FOOT"/>
//
// Body     that of the element body, robot or vehicle at `part`. Where `part` is a link of a robot: the link, with what
//          fixed joints hold on it. Contacts between two of its own pieces do not count.
// Table    one row for each point where the surfaces touch, in the sensor frame: x_m, y_m, z_m midway between both
//          surfaces; normal_x, normal_y, normal_z of unit length, towards the part; depth_m by which they overlap,
//          below 0 where the force acts across a gap; force_n along the normal; own_instance and other_instance, the
//          ids of the parts or links that touch.
// Forces   are the mean of the last step of physics. The number of points is that of the engine: it divides the load
//          among up to four of them for each pair of surfaces, so that their sum and its place mean more than each.
//          Friction is not among them.
// Source   the names and meanings of the values are those of SDF's sensor "contact".
// Message  sensor_msgs/PointCloud2 with a field for each column.
#pragma once

#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"

namespace simvis {

struct ContactSensorDesc {
  std::string part = "ROOT";  ///< insertion point
  bool needs_physics = true;

  static AttributeRows<ContactSensorDesc> rows();
  /// Its part by default is that of insert_at.
  void complete(const SensorContext& context);
};

class ContactSensor : public ReadingSensor {
 public:
  ContactSensor(std::string name, ContactSensorDesc desc);

  SensorNeeds needs() const override { return {.contacts_of = desc_.part}; }
  /// Throws InputError if no body of physics stands at the part, and one has to.
  void sense(const SensedWorld& world) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "contacts of physics"; }

 private:
  std::string name_;
  ContactSensorDesc desc_;
  std::vector<Contact> contacts_;  // of this frame
};

}  // namespace simvis
