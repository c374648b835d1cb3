// The sensor `gnss`: a receiver of satellite navigation (GPS, Galileo, GLONASS, BeiDou).
//
//   <sensor type="gnss" name="GPS" insert_at="ROBOT" latitude="49.44" longitude="7.75" rate="5"
//           horizontal_stddev="0.4" vertical_stddev="0.8"/>
//
// Frames   sensors/navigation/geodetic_origin.h says how the world stands on the earth.
// Values   latitude_deg, longitude_deg, altitude_m above the ellipsoid, of the sensor's origin; velocity_{east,north,
//          up}_m_s along the axes of the world's origin. GeographicLib's LocalCartesian converts: C. Karney,
//          "Algorithms for geodesics", J. Geodesy 87 (2013); its error is below 10 nm within 1,000 km.
// Noise    of the position, horizontal (east and north) and vertical, and of the velocity:
//          sensors/noise_model.h. It is added in metres, before the conversion. The drift of a receiver without
//          corrections is a Gauss-Markov process of about an hour (Parkinson and Spilker, "GPS: Theory and
//          Applications", 1996): dynamic_bias_correlation_time.
// Messages sensor_msgs/NavSatFix, and geometry_msgs/TwistWithCovarianceStamped along east, north and up, both with the
//          variances of the white noise.
// Limit    satellites are not simulated: the receiver has a fix in tunnels too.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/navigation/geodetic_origin.h"
#include "sensors/noise_model.h"

namespace simvis {

struct GnssDesc {
  GeodeticOrigin origin;
  NoiseDesc horizontal{}, vertical{}, velocity{};
  std::uint64_t seed = 0;

  static AttributeRows<GnssDesc> rows();
};

class Gnss : public ReadingSensor {
 public:
  Gnss(const std::string& name, const GnssDesc& desc);

  SensorNeeds needs() const override { return {.motion = true}; }
  void sense(const SensedWorld& world) override { motion_ = world.motion(); }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "geodetic position"; }

 private:
  GnssDesc desc_;
  GeographicLib::LocalCartesian local_;
  NoiseModel horizontal_, vertical_, velocity_;
  Motion motion_;
};

}  // namespace simvis
