// The sensor `imu`: an inertial measurement unit with three gyroscopes and three accelerometers.
//
//   <sensor type="imu" name="IMU" insert_at="ROBOT" rate="200" gyroscope_noise_density="1.7e-4"/>
//
// Frame    the sensor frame: x forward, y left, z up.
// Values   angular_velocity_{x,y,z}_rad_s: of the sensor against the world.
//          specific_force_{x,y,z}_m_s2: acceleration of the sensor's origin less gravity, which is what an
//          accelerometer measures: at rest and upright (0, 0, 9.80665).
// Motion   is that between the frames of the simulation (Motion in <simvis/pose.h>): velocities are the mean since the
//          previous frame, so that summing them up gives the exact rotation, as in devices that put out increments. At
//          the first frame the sensor stands still.
// Noise    of both quantities: sensors/noise_model.h. With the prefixes gyroscope_ and accelerometer_ the
//          attributes have the names of Kalibr's imu.yaml.
// Message  sensor_msgs/Imu without an orientation: its covariance is -1.
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/noise_model.h"

namespace simvis {

struct ImuDesc {
  glm::dvec3 gravity_mps2{0, 0, -9.80665};  ///< in the world: standard gravity, ISO 80000-3
  NoiseDesc gyroscope{}, accelerometer{};
  std::uint64_t seed = 0;

  bool operator==(const ImuDesc&) const = default;
};

/// Reads the attributes of an imu. Throws InputError.
ImuDesc imu_desc(const SensorContext& context);

class Imu : public ReadingSensor {
 public:
  Imu(const std::string& name, const ImuDesc& desc);

  SensorNeeds needs() const override { return {.motion = true}; }
  void sense(const SensedWorld& world) override { motion_ = world.motion(); }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "differences of poses"; }

 private:
  ImuDesc desc_;
  NoiseModel gyroscope_, accelerometer_;
  Motion motion_;
};

}  // namespace simvis
