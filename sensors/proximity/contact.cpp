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
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/without_physics.h"

namespace simvis {
namespace {

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

const std::vector<TableColumn> kContactColumns{
    {.name = "x_m", .format = "%.9g", .unit = "m", .meaning = "point of contact, x", .frame = "sensor"},
    {.name = "y_m", .format = "%.9g", .unit = "m", .meaning = "point of contact, y", .frame = "sensor"},
    {.name = "z_m", .format = "%.9g", .unit = "m", .meaning = "point of contact, z", .frame = "sensor"},
    {.name = "normal_x", .format = "%.9g", .meaning = "unit normal of the contact, x", .frame = "sensor"},
    {.name = "normal_y", .format = "%.9g", .meaning = "unit normal of the contact, y", .frame = "sensor"},
    {.name = "normal_z", .format = "%.9g", .meaning = "unit normal of the contact, z", .frame = "sensor"},
    {.name = "depth_m", .format = "%.9g", .unit = "m", .meaning = "how far the bodies overlap"},
    {.name = "force_n",
     .format = "%.9g",
     .unit = "N",
     .meaning = "mean force along the normal in the last step of physics"},
    {.name = "own_instance",
     .format = "%lld",
     .integer = true,
     .meaning = "id of the part or link that senses, as in objects.csv"},
    {.name = "other_instance",
     .format = "%lld",
     .integer = true,
     .meaning = "id of the part or link that touches it, as in objects.csv; 0: none has this body"}};

const SensorRegistration kContactRegistration(
    {.name = "contact",
     .summary = "Where a body of physics touches others: points, normals, depths and forces.",
     .notes =
         "The part has an element body, robot or vehicle, or is a link of such a robot. A table has a row for each "
         "point of contact, with the mean force of the last step of physics.",
     .message = "sensor_msgs/msg/PointCloud2",
     .attributes = rows_of<ContactSensorDesc>().table(),
     .create = create_sensor<ContactSensor, ContactSensorDesc>,
     .outputs = column_outputs_of<kContactColumns, false>,
     .sees_shapes = false});

}  // namespace

AttributeRows<ContactSensorDesc> ContactSensorDesc::rows() {
  using Desc = ContactSensorDesc;
  return {row(&Desc::part, AttributeKind::object, "part",
              "the part whose body senses; default: that of insert_at, which may be a link of a robot"),
          without_physics_row(&Desc::needs_physics), kRateAttribute};
}

void ContactSensorDesc::complete(const SensorContext& context) {
  if (!context.attributes.is_set("part")) part = context.insertion_point();
}

ContactSensor::ContactSensor(std::string name, ContactSensorDesc desc)
    : ReadingSensor(kContactColumns, false), name_(std::move(name)), desc_(std::move(desc)) {}

void ContactSensor::sense(const SensedWorld& world) {
  std::optional<std::vector<Contact>> contacts = world.contacts();
  if (!contacts && desc_.needs_physics) {
    throw InputError("sensor " + in_quotes(name_) + ": no body of physics stands at " + in_quotes(desc_.part) +
                     ", expected a part with an element body, robot or vehicle, or a link of such a robot");
  }
  contacts_ = std::move(contacts).value_or(std::vector<Contact>());
}

void ContactSensor::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const glm::dmat4 sensor_from_world = rigid_inverse(world_from_sensor());
  std::vector<double> values;
  for (const Contact& contact : contacts_) {
    const glm::dvec3 point_m(sensor_from_world * glm::dvec4(contact.point_m, 1)),
        normal = glm::dmat3(sensor_from_world) * contact.normal;
    values.insert(values.end(),
                  {point_m.x, point_m.y, point_m.z, normal.x, normal.y, normal.z, contact.depth_m, contact.force_n,
                   static_cast<double>(contact.own_instance), static_cast<double>(contact.other_instance)});
  }
  set_reading(time, std::move(values));
}

}  // namespace simvis
