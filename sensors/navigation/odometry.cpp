#include "sensors/navigation/odometry.h"

#include <cmath>
#include <memory>

#include <simvis/pose.h>
#include "scenegraph/pose3.h"

namespace simvis {

namespace {

constexpr AttributeSpec kOdometryAttributes[] = {
    {.name = "kind",
     .kind = AttributeKind::choice,
     .default_value = "ideal",
     .text = "ideal: the true motion; wheel: the ways of two wheels, added up",
     .choices = "ideal wheel"},
    {.name = "wheel_separation",
     .default_value = "0.5",
     .unit = "m",
     .text = "wheel: distance between the wheels",
     .min = 0,
     .open_min = true},
    {.name = "left_scale_error",
     .default_value = "0",
     .text = "wheel: share by which the way of the left wheel is counted too long",
     .min = -1,
     .open_min = true},
    {.name = "right_scale_error",
     .default_value = "0",
     .text = "wheel: share by which the way of the right wheel is counted too long",
     .min = -1,
     .open_min = true},
    {.name = "slip_stddev",
     .default_value = "0",
     .unit = "m/sqrt(m)",
     .text =
         "wheel: standard deviation of the counted way of each wheel after one metre; it grows with the square root",
     .min = 0},
    kRateAttribute,
};

std::vector<TableColumn> odometry_columns() {
  return {
      {.name = "x_m",
       .format = "%.12g",
       .unit = "m",
       .meaning = "position since the first measurement, along x",
       .frame = "first measurement"},
      {.name = "y_m",
       .format = "%.12g",
       .unit = "m",
       .meaning = "position since the first measurement, along y",
       .frame = "first measurement"},
      {.name = "z_m",
       .format = "%.12g",
       .unit = "m",
       .meaning = "position since the first measurement, along z",
       .frame = "first measurement"},
      {.name = "qx",
       .format = "%.12g",
       .meaning = "orientation since then: x of a unit quaternion",
       .frame = "first measurement"},
      {.name = "qy",
       .format = "%.12g",
       .meaning = "orientation since then: y of a unit quaternion",
       .frame = "first measurement"},
      {.name = "qz",
       .format = "%.12g",
       .meaning = "orientation since then: z of a unit quaternion",
       .frame = "first measurement"},
      {.name = "qw",
       .format = "%.12g",
       .meaning = "orientation since then: w of a unit quaternion",
       .frame = "first measurement"},
      {.name = "velocity_x_m_s", .format = "%.12g", .unit = "m/s", .meaning = "velocity along x", .frame = "sensor"},
      {.name = "velocity_y_m_s", .format = "%.12g", .unit = "m/s", .meaning = "velocity along y", .frame = "sensor"},
      {.name = "velocity_z_m_s", .format = "%.12g", .unit = "m/s", .meaning = "velocity along z", .frame = "sensor"},
      {.name = "angular_velocity_x_rad_s",
       .format = "%.12g",
       .unit = "rad/s",
       .meaning = "angular velocity about x",
       .frame = "sensor"},
      {.name = "angular_velocity_y_rad_s",
       .format = "%.12g",
       .unit = "rad/s",
       .meaning = "angular velocity about y",
       .frame = "sensor"},
      {.name = "angular_velocity_z_rad_s",
       .format = "%.12g",
       .unit = "rad/s",
       .meaning = "angular velocity about z",
       .frame = "sensor"}};
}

std::unique_ptr<Sensor> create_odometry(const SensorContext& context) {
  return std::make_unique<OdometrySensor>(context.name, odometry_desc(context));
}

const SensorRegistration kOdometryRegistration(
    {.name = "odometry",
     .summary = "The motion of a vehicle since the start: the true one, or as wheels with errors count it.",
     .notes = "The pose is in the frame of the first measurement, velocities are in the sensor's frame.",
     .message = "nav_msgs/msg/Odometry",
     .attributes = kOdometryAttributes,
     .create = create_odometry,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, odometry_columns()); }});

/// The pose after a way along an arc in the plane z = 0, as seen from its start.
glm::dmat4 along_arc(double way_m, double turn_rad) {
  const double half = turn_rad / 2, chord = half == 0 ? way_m : way_m * std::sin(half) / half;
  return to_matrix({.position_m = {chord * std::cos(half), chord * std::sin(half), 0}, .yaw_rad = turn_rad});
}

}  // namespace

OdometryDesc odometry_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  return {.wheels = a.choice("kind") == "wheel",
          .wheel_separation_m = a.number("wheel_separation"),
          .left_scale_error = a.number("left_scale_error"),
          .right_scale_error = a.number("right_scale_error"),
          .slip_stddev_sqrt_m = a.number("slip_stddev"),
          .seed = context.seed};
}

OdometrySensor::OdometrySensor(const std::string& name, const OdometryDesc& desc)
    : ReadingSensor(odometry_columns()), desc_(desc), random_(desc.seed, name + "/wheels") {}

void OdometrySensor::count_wheels(const FrameTime& time, double seconds, Twist& twist) const {
  const double forward_m = twist.linear_mps.x * seconds, turn_rad = twist.angular_radps.z * seconds;
  const double errors[] = {desc_.left_scale_error, desc_.right_scale_error};
  double counted_m[2];
  for (std::uint32_t wheel = 0; wheel < 2; ++wheel) {
    const double side = wheel == 0 ? -1 : 1;
    const double way_m = forward_m + side * turn_rad * desc_.wheel_separation_m / 2;
    counted_m[wheel] = way_m * (1 + errors[wheel]);
    if (desc_.slip_stddev_sqrt_m == 0) continue;
    counted_m[wheel] += desc_.slip_stddev_sqrt_m * std::sqrt(std::abs(way_m)) * random_.gaussian(time.index, wheel, 0);
  }
  twist = {.angular_radps = {0, 0, (counted_m[1] - counted_m[0]) / desc_.wheel_separation_m / seconds},
           .linear_mps = {(counted_m[0] + counted_m[1]) / 2 / seconds, 0, 0}};
}

void OdometrySensor::advance(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  // A frame that failed is made again, from the measurement before it.
  if (!now_.any || time.time_ns != now_.time_ns) before_ = now_;
  now_.time_ns = time.time_ns;
  now_.world_from_sensor = world_from_sensor;
  now_.any = true;
  if (!before_.any) {
    world_from_start_ = world_from_sensor;
    return;
  }
  const double seconds = static_cast<double>(time.time_ns - before_.time_ns) / 1e9;
  now_.twist = twist_between(before_.world_from_sensor, world_from_sensor, seconds);
  if (!desc_.wheels) {
    now_.start_from_sensor = rigid_inverse(world_from_start_) * world_from_sensor;
    return;
  }
  count_wheels(time, seconds, now_.twist);
  now_.start_from_sensor =
      before_.start_from_sensor * along_arc(now_.twist.linear_mps.x * seconds, now_.twist.angular_radps.z * seconds);
}

void OdometrySensor::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  advance(time, world_from_sensor());
  const auto [position, q] = pose_of(now_.start_from_sensor);
  const glm::dvec3 &v = now_.twist.linear_mps, &w = now_.twist.angular_radps;
  set_reading(time, {position.x, position.y, position.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z});
}

}  // namespace simvis
