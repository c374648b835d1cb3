#include "sensors/navigation/imu.h"

#include <memory>

namespace simvis {

namespace {

AttributeTable imu_attributes() {
  static const AttributeTable table = join_tables({{{.name = "gravity",
                                                     .kind = AttributeKind::vector,
                                                     .default_value = "0 0 -9.80665",
                                                     .unit = "m/s2",
                                                     .text = "acceleration of free fall in the world"}},
                                                   noise_rows("gyroscope_", "the angular velocity", "rad/s"),
                                                   noise_rows("accelerometer_", "the specific force", "m/s2"),
                                                   {kRateAttribute}});
  return table;
}

std::vector<TableColumn> imu_columns() {
  return {{.name = "angular_velocity_x_rad_s",
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
           .frame = "sensor"},
          {.name = "specific_force_x_m_s2",
           .format = "%.12g",
           .unit = "m/s2",
           .meaning = "specific force along x",
           .frame = "sensor"},
          {.name = "specific_force_y_m_s2",
           .format = "%.12g",
           .unit = "m/s2",
           .meaning = "specific force along y",
           .frame = "sensor"},
          {.name = "specific_force_z_m_s2",
           .format = "%.12g",
           .unit = "m/s2",
           .meaning = "specific force along z",
           .frame = "sensor"}};
}

std::unique_ptr<Sensor> create_imu(const SensorContext& context) {
  return std::make_unique<Imu>(context.name, imu_desc(context));
}

const SensorRegistration kImuRegistration(
    {.name = "imu",
     .summary = "An inertial measurement unit: angular velocity and specific force, with the noise of gyroscopes and "
                "accelerometers.",
     .notes = "The motion is that from frame to frame, and is exact for constant screw motions. At rest the specific "
              "force points upwards.\nNoise densities and random walks are in continuous units, with the names that "
              "Kalibr gives them; the other attributes of the noise are those of SDF.",
     .message = "sensor_msgs/msg/Imu",
     .attributes = imu_attributes(),
     .create = create_imu,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, imu_columns()); }});

}  // namespace

ImuDesc imu_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const auto& gravity = a.vector("gravity");
  return {.gravity_mps2 = {gravity[0], gravity[1], gravity[2]},
          .gyroscope = NoiseDesc::read(a, "gyroscope_"),
          .accelerometer = NoiseDesc::read(a, "accelerometer_"),
          .seed = context.seed};
}

Imu::Imu(const std::string& name, const ImuDesc& desc)
    : ReadingSensor(imu_columns()),
      desc_(desc),
      gyroscope_(desc.gyroscope, {desc.seed, name + "/gyroscope"}),
      accelerometer_(desc.accelerometer, {desc.seed, name + "/accelerometer"}) {}

void Imu::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor()));
  const glm::dvec3 turn = sensor_from_world * motion_.angular_velocity_radps,
                   force = sensor_from_world * (motion_.acceleration_mps2 - desc_.gravity_mps2);
  const double period_s = sample_period_s(rate_hz, time);
  set_constant("angular_velocity_variance", desc_.gyroscope.white_variance(period_s));
  set_constant("specific_force_variance", desc_.accelerometer.white_variance(period_s));
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.push_back(gyroscope_.apply(turn[axis], static_cast<std::uint32_t>(axis), time, period_s));
  }
  for (int axis = 0; axis < 3; ++axis) {
    values.push_back(accelerometer_.apply(force[axis], static_cast<std::uint32_t>(axis), time, period_s));
  }
  set_reading(time, std::move(values));
}

}  // namespace simvis
