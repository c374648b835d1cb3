// The sensor `gnss_satellites`: the signals that a `gnss` receiver with these attributes uses, satellite by satellite.
//
//   <sensor type="gnss_satellites" name="SKY" insert_at="ROBOT" latitude="49.44" longitude="7.75" reflection="0.5"/>
//
// Values   a table with a row for each satellite at or above the elevation mask, by its number: satellite, azimuth_deg
//          (clockwise from north) and elevation_deg; direct, 1 if its direct signal is received; extra_path_m, of the
//          shortest reflected signal, NaN if there is none; error_m, what reflection adds to the pseudorange, NaN if
//          nothing is received; used, 1 if the receiver measures it: it is received and not jammed.
//          satellites.h and satellite_signals.h have the model.
// Message  sensor_msgs/PointCloud2.
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/navigation/satellite_signals.h"

namespace simvis {

struct GnssSatellitesDesc {
  GeodeticOrigin origin;
  SatellitesDesc satellites{.satellites = "gps"};

  static AttributeRows<GnssSatellitesDesc> rows();
  /// Throws InputError at `satellites` if there are none.
  void complete(const SensorContext& context) const;
};

class GnssSatellites : public ReadingSensor {
 public:
  GnssSatellites(std::string name, const GnssSatellitesDesc& desc);

  SensorNeeds needs() const override { return {.gnss_jamming = true}; }
  void sense(const SensedWorld& world) override { is_jammed_ = world.gnss_is_jammed(); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { time_ = time; }
  void cast(RayCaster& rays) override;
  std::string method() const override { return "raycast"; }

 private:
  std::string name_;
  GnssSatellitesDesc desc_;
  SatelliteSignals signals_;
  bool is_jammed_ = false;          // in this frame
  const DrawList* list_ = nullptr;  // of this frame
  FrameTime time_;
};

}  // namespace simvis
