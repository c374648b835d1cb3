#include "sensors/proximity/contact.h"

#include <memory>
#include <utility>

#include <simvis/pose.h>
#include "sensors/without_physics.h"

namespace simvis {

namespace {

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
