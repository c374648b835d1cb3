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
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

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

}  // namespace simvis
