// The sensor `imu`: an inertial measurement unit with three gyroscopes and three accelerometers.
//
//   <sensor type="imu" name="IMU" insert_at="ROBOT" rate="200" gyroscope_noise_density="1.7e-4"/>
//
// Frame    the sensor frame: x forward, y left, z up.
// Values   angular_velocity_{x,y,z}_rad_s: of the sensor against the world.
//          specific_force_{x,y,z}_m_s2: acceleration of the sensor's origin less gravity, which is what an
//          accelerometer measures: at rest and upright (0, 0, 9.80665).
// Motion   is that between the frames of the simulation (Motion in <simvis/pose.h>): angular velocities are the mean
//          since the previous frame, so that summing them up gives the exact rotation, as in devices that put out
//          increments. At the first frame the sensor stands still. On a body of physics the acceleration is that of the
//          last step of physics before the frame, at any rate.
//          With orientation="on" also qx, qy, qz, qw: the sensor's orientation in the world.
// Errors   scale, misalignment and g-sensitivity: ImuAxes and ImuDesc. They come before the noise.
// Noise    of both quantities: sensors/noise_model.h. With the prefixes gyroscope_ and accelerometer_ the
//          attributes have the names of Kalibr's imu.yaml.
// Truth    Constants beside the values: of both quantities, in their units, the variance of the white noise, its
//          density per sqrt(Hz), the density of the random walk per s and sqrt(Hz), and the true bias of each axis.
//          That of the orientation is a turn about the axes of the world, in radians, with the prefix orientation_.
// Message  sensor_msgs/Imu. Without an orientation the covariance of this is -1.
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include <simvis/location.h>
#include <simvis/reading_sensor.h>
#include "scenegraph/pose3.h"
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {
namespace {

/// How three axes of one kind measure, without their noise: value i is (1 + scale_error[i]) times what lies along axis
/// i. The axes are orthogonal but for misalignment: axis y leans by misalignment_rad[0] towards x, axis z by [1]
/// towards x and by [2] towards y, to first order. So value y has misalignment_rad[0] times what lies along x, and so
/// on: the lower triangular matrix of Kalibr's model "scale-misalignment".
struct ImuAxes {
  glm::dvec3 scale_error{0}, misalignment_rad{0};

  glm::dvec3 measured(const glm::dvec3& truth) const;
  bool operator==(const ImuAxes&) const = default;
};

struct ImuDesc {
  glm::dvec3 gravity_mps2{0, 0, -9.80665};  ///< in the world: standard gravity, ISO 80000-3
  ImuAxes gyroscope_axes{}, accelerometer_axes{};
  glm::dvec3 g_sensitivity{0};  ///< of the gyroscopes, rad/s for each m/s2 of the specific force along the same axis
  NoiseDesc gyroscope{}, accelerometer{};
  bool orientation = false;
  NoiseDesc orientation_noise{};  ///< with `orientation`
  std::uint64_t seed = 0;

  static AttributeRows<ImuDesc> rows();
  /// Throws InputError at an attribute of the orientation of an IMU that gives none.
  void complete(const SensorContext& context);
};

class Imu : public ReadingSensor {
 public:
  Imu(const std::string& name, const ImuDesc& desc);

  SensorNeeds needs() const override { return {.motion = true}; }
  void sense(const SensedWorld& world) override { motion_ = world.motion(); }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "differences of poses"; }

 private:
  void add_orientation(const FrameTime& time, double period_s, std::vector<double>& values);

  ImuDesc desc_;
  NoiseModel gyroscope_, accelerometer_, orientation_;
  Motion motion_;
};

// The errors of one quantity, beside its values; static text.
struct NoiseNames {
  const char *variance, *density, *walk, *bias[3];
};
constexpr NoiseNames kTurnNames{"angular_velocity_variance",
                                "gyroscope_noise_density",
                                "gyroscope_random_walk",
                                {"gyroscope_bias_x_rad_s", "gyroscope_bias_y_rad_s", "gyroscope_bias_z_rad_s"}};
constexpr NoiseNames kForceNames{
    "specific_force_variance",
    "accelerometer_noise_density",
    "accelerometer_random_walk",
    {"accelerometer_bias_x_m_s2", "accelerometer_bias_y_m_s2", "accelerometer_bias_z_m_s2"}};

constexpr AttributeLimits kAxisErrors{.min = -1, .max = 1};

AttributeRows<ImuAxes> axes_rows(const std::string& prefix, const std::string& quantity) {
  return {row(&ImuAxes::scale_error, keep_text(prefix + "scale_error"), "", kAxisErrors,
              keep_text("share by which each axis of " + quantity + " measures too much")),
          row(&ImuAxes::misalignment_rad, keep_text(prefix + "misalignment"), "rad", kAxisErrors,
              "lean of axis y towards x, of z towards x, of z towards y")};
}

const std::vector<TableColumn> kImuColumns{{.name = "angular_velocity_x_rad_s",
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

std::vector<TableColumn> orientation_columns() {
  std::vector<TableColumn> columns;
  for (const char* const name : {"qx", "qy", "qz", "qw"}) {
    columns.push_back({.name = name, .format = "%.12g", .meaning = "orientation as a quaternion", .frame = "world"});
  }
  return columns;
}

std::vector<TableColumn> imu_columns(bool orientation) {
  std::vector<TableColumn> columns = kImuColumns;
  if (orientation) std::ranges::move(orientation_columns(), std::back_inserter(columns));
  return columns;
}

std::vector<OutputSpec> imu_outputs(const SensorContext& context) {
  std::vector<OutputSpec> outputs = reading_outputs(context, imu_columns(true));
  const bool given = read_desc<ImuDesc>(context).orientation;
  for (std::size_t i = kImuColumns.size(); i < outputs.size(); ++i) {
    outputs[i].when = "orientation on";
    outputs[i].given = given;
  }
  return outputs;
}

// 0.007 deg/s/sqrt(Hz) and 60 ug/sqrt(Hz); 0.01 deg/s/sqrt(Hz) and 60 ug/sqrt(Hz).
constexpr PresetAttribute kMti630[] = {
    {"gyroscope_noise_density", "1.22173048e-4"}, {"accelerometer_noise_density", "5.88399e-4"}, {"rate", "400"}};
constexpr PresetAttribute kMti100[] = {
    {"gyroscope_noise_density", "1.74532925e-4"}, {"accelerometer_noise_density", "5.88399e-4"}, {"rate", "400"}};
// 16 steps for a degree per second, 100 for 1 m/s2.
constexpr PresetAttribute kBno055[] = {
    {"gyroscope_precision", "1.09083078e-3"}, {"accelerometer_precision", "0.01"}, {"rate", "100"}};

constexpr SensorPreset kImuPresets[] = {
    {"xsens_mti_630", "Xsens MTi-630, 400 Hz", "Movella, MTi-630 data sheet, May 2023", kMti630,
     "White noise: the noise densities. Not taken over: the stability of the bias in a run, 8 deg/h and 10 to 15 ug, "
     "which says no random walk. Not stated: turn-on bias, scale and alignment."},
    {"xsens_mti_100", "Xsens MTi 100-series, 400 Hz",
     "Xsens, MTi User Manual, MT0605P, pp. 32 and 33, as cited by rpng/kalibr_allan, SCRIPT_noise_conversion.m",
     kMti100, "White noise: the noise densities. Not found: random walk and bias."},
    {"bno055", "Bosch BNO055, fusion mode, 100 Hz",
     "Bosch Sensortec, BNO055 data sheet, BST-BNO055-DS000-14 rev. 1.4: tables 3-14 (rates), 3-22 and 3-33 (units)",
     kBno055, "Steps are those of the registers in degrees per second and m/s2. Not found: noise and bias."},
};

const SensorRegistration kImuRegistration(
    {.name = "imu",
     .summary = "An inertial measurement unit: angular velocity and specific force, with the noise of gyroscopes and "
                "accelerometers.",
     .notes =
         "The motion is that from frame to frame, and is exact for constant screw motions; on a body of physics the "
         "acceleration is that of the last step. At rest the specific force points upwards.\nErrors of scale, "
         "alignment and g-sensitivity come before the noise; sensors/navigation/imu.cpp has the formulas.\nNoise "
         "densities and random walks are in continuous units, with the names that "
         "Kalibr gives them; the other attributes of the noise are those of SDF.",
     .message = "sensor_msgs/msg/Imu",
     .attributes = rows_of<ImuDesc>().table(),
     .create = create_sensor<Imu, ImuDesc>,
     .presets = kImuPresets,
     .outputs = imu_outputs,
     .sees_shapes = false});

}  // namespace

AttributeRows<ImuDesc> ImuDesc::rows() {
  using Desc = ImuDesc;
  return {row(&Desc::gravity_mps2, "gravity", "m/s2", kAnyNumber, "acceleration of free fall in the world"),
          nested(&Desc::gyroscope_axes, axes_rows("gyroscope_", "the angular velocity")),
          row(&Desc::g_sensitivity, "gyroscope_g_sensitivity", "rad/s per m/s2", kAxisErrors,
              "angular velocity that the specific force along the same axis adds"),
          nested(&Desc::gyroscope, noise_rows("gyroscope_", "the angular velocity", "rad/s")),
          nested(&Desc::accelerometer_axes, axes_rows("accelerometer_", "the specific force")),
          nested(&Desc::accelerometer, noise_rows("accelerometer_", "the specific force", "m/s2")),
          row(&Desc::orientation, "orientation", {{false, "off"}, {true, "on"}},
              "on: also the orientation in the world, as devices with a filter of their own give it"),
          nested(&Desc::orientation_noise, noise_rows("orientation_", "the turn about each axis of the world", "rad")),
          kRateAttribute,
          kPresetAttribute};
}

void ImuDesc::complete(const SensorContext& context) {
  if (orientation) return;
  for (const CommandAttribute& each : context.command.attributes) {
    if (!each.name.starts_with("orientation_")) continue;
    fail_at(each.where, "attribute " + in_quotes(each.name) + " is allowed only with orientation=\"on\"");
  }
}

Imu::Imu(const std::string& name, const ImuDesc& desc)
    : ReadingSensor(imu_columns(desc.orientation)),
      desc_(desc),
      gyroscope_(desc.gyroscope, {desc.seed, name + "/gyroscope"}),
      accelerometer_(desc.accelerometer, {desc.seed, name + "/accelerometer"}),
      orientation_(desc.orientation_noise, {desc.seed, name + "/orientation"}) {}

// Without errors the truth keeps its bits, the sign of a zero too.
glm::dvec3 ImuAxes::measured(const glm::dvec3& truth) const {
  if (*this == ImuAxes()) return truth;
  return (1.0 + scale_error) * truth +
         glm::dvec3(0, misalignment_rad[0] * truth.x, misalignment_rad[1] * truth.x + misalignment_rad[2] * truth.y);
}

void Imu::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor()));
  const glm::dvec3 true_force = sensor_from_world * (motion_.acceleration_mps2 - desc_.gravity_mps2),
                   force = desc_.accelerometer_axes.measured(true_force);
  glm::dvec3 turn = desc_.gyroscope_axes.measured(sensor_from_world * motion_.angular_velocity_radps);
  if (desc_.g_sensitivity != glm::dvec3(0)) turn += desc_.g_sensitivity * true_force;
  const double period_s = sample_period_s(rate_hz, time);
  for (const auto& [names, model] : {std::pair(&kTurnNames, &gyroscope_), {&kForceNames, &accelerometer_}}) {
    const double variance = model->desc().white_variance(period_s);
    set_constant(names->variance, variance);
    set_constant(names->density, std::sqrt(variance * period_s));
    set_constant(names->walk, model->desc().walk_density());
    for (std::uint32_t axis = 0; axis < 3; ++axis) set_constant(names->bias[axis], model->bias(axis, time.time_ns));
  }
  std::vector<double> values;
  values.reserve(10);
  for (int axis = 0; axis < 3; ++axis) {
    values.push_back(gyroscope_.apply(turn[axis], static_cast<std::uint32_t>(axis), time, period_s));
  }
  for (int axis = 0; axis < 3; ++axis) {
    values.push_back(accelerometer_.apply(force[axis], static_cast<std::uint32_t>(axis), time, period_s));
  }
  if (desc_.orientation) add_orientation(time, period_s, values);
  set_reading(time, std::move(values));
}

// The errors are a rotation vector in the axes of the world, as the covariance of sensor_msgs/Imu has them.
void Imu::add_orientation(const FrameTime& time, double period_s, std::vector<double>& values) {
  set_constant("orientation_variance", desc_.orientation_noise.white_variance(period_s));
  glm::dvec3 turn_rad(0);
  for (int axis = 0; axis < 3; ++axis) {
    turn_rad[axis] = orientation_.apply(0, static_cast<std::uint32_t>(axis), time, period_s);
  }
  glm::dquat measured = pose_of(world_from_sensor()).orientation;
  const double angle_rad = glm::length(turn_rad);
  if (angle_rad > 0) measured = glm::angleAxis(angle_rad, turn_rad / angle_rad) * measured;
  values.insert(values.end(), {measured.x, measured.y, measured.z, measured.w});
}

}  // namespace simvis
