// The sensor `beacon`: which beacons it receives, and where they are: RFID tags, infrared or radio beacons, markers.
//
//   <sensor type="beacon" name="RFID" insert_at="ROBOT" beacons="TAG_*" range_max="3" line_of_sight="no"/>
//
// Beacons  are the insertion points whose names match the pattern `beacons`, in which * stands for any text and ? for
//          any character; each part has one. A beacon that is switched off is not received.
// Received is a beacon whose origin is within range_max of the sensor and within the cone of `opening` about +x of the
//          sensor frame, and, with line_of_sight, that no surface hides. Surfaces within `radius` of the beacon's
//          origin belong to it and hide nothing.
// Values   a table with a row for each received beacon, in the order of their names: beacon, its number; range_m,
//          azimuth_rad (counter-clockwise about +z), elevation_rad; strength, 1 at 1 m and falling with the square of
//          the range. The number is the beacon's place by name among all that match the pattern, from 0 on; run.json
//          has the names of those that were received last.
// Noise    of the range: sensors/noise_model.h; the axis of the random numbers is the beacon's number. A noisy range is
//          at least 0.
// Message  sensor_msgs/PointCloud2.
#pragma once

#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

struct BeaconDesc {
  std::string beacons = "*";
  double range_max_m = 10, opening_rad = glm::radians(360.0), radius_m = 0.05;
  bool line_of_sight = true;
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<BeaconDesc> rows();
};

class BeaconSensor : public ReadingSensor {
 public:
  BeaconSensor(std::string name, const BeaconDesc& desc);

  SensorNeeds needs() const override { return {.points = desc_.beacons}; }
  void sense(const SensedWorld& world) override { points_ = world.points(); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { time_ = time; }
  void cast(RayCaster& rays) override;
  std::string method() const override { return desc_.line_of_sight ? "raycast" : "distance"; }
  SensorReport report() const override;

 private:
  std::string name_;
  BeaconDesc desc_;
  NoiseModel noise_;
  std::vector<SensedPoint> points_;  // of this frame; from cast() on, those that are received
  FrameTime time_;
};

}  // namespace simvis
