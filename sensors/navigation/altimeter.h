// The sensor `altimeter`: height above a reference, and its rate.
//
//   <sensor type="altimeter" name="ALT" insert_at="DRONE" reference="1.5" vertical_position_stddev="0.05"/>
//
// Values   vertical_position_m: z of the sensor's origin in the world less `reference`. vertical_velocity_m_s: the mean
//          since the previous frame of the simulation (Motion in <simvis/pose.h>). The names are those of SDF's
//          altimeter.
// Noise    of both: sensors/noise_model.h.
// Message  std_msgs/Float64 for each value.
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

struct AltimeterDesc {
  double reference_m = 0;
  NoiseDesc position{}, velocity{};
  std::uint64_t seed = 0;

  static AttributeRows<AltimeterDesc> rows();
};

class Altimeter : public ReadingSensor {
 public:
  Altimeter(const std::string& name, const AltimeterDesc& desc);

  SensorNeeds needs() const override { return {.motion = true}; }
  void sense(const SensedWorld& world) override { velocity_mps_ = world.motion().velocity_mps.z; }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "height"; }

 private:
  AltimeterDesc desc_;
  NoiseModel position_, velocity_;
  double velocity_mps_ = 0;
};

}  // namespace simvis
