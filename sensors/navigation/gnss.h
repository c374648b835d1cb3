// The sensor `gnss`: a receiver of satellite navigation (GPS, Galileo, GLONASS, BeiDou).
//
//   <sensor type="gnss" name="GPS" insert_at="ROBOT" latitude="49.44" longitude="7.75" rate="5"
//           horizontal_stddev="0.4" vertical_stddev="0.8"/>
//   <sensor type="gnss" name="SKY" insert_at="ROBOT" latitude="49.44" longitude="7.75" rate="5" satellites="gps"
//           reflection="0.5" pseudorange_stddev="1.5"/>
//
// Frames   sensors/navigation/geodetic_origin.h says how the world stands on the earth.
// Values   latitude_deg, longitude_deg, altitude_m above the ellipsoid, of the sensor's origin; velocity_{east,north,
//          up}_m_s along the axes of the world's origin. GeographicLib's LocalCartesian converts: C. Karney,
//          "Algorithms for geodesics", J. Geodesy 87 (2013); its error is below 10 nm within 1,000 km.
// Noise    of the position, horizontal (east and north) and vertical, and of the velocity:
//          sensors/noise_model.h. It is added in metres, before the conversion. The drift of a receiver without
//          corrections is a Gauss-Markov process of about an hour (Parkinson and Spilker, "GPS: Theory and
//          Applications", 1996): dynamic_bias_correlation_time.
// Satellites  Without `satellites` a fix is always there, also in a tunnel. With it, the position is that of
//          position_fix.h from the pseudoranges of the satellites that satellite_signals.h finds. Each pseudorange has
//          the error of its reflection and noise of its own (`pseudorange_`), whose axis is the number of the
//          satellite. The noise of the position comes on top. The velocity has no errors by reflection.
// No fix   with fewer than four satellites, with a PDOP above max_pdop, and within the range of an element
//          `gnss_jammer`, which jams receivers without `satellites` too: position and velocity are NaN.
// Messages sensor_msgs/NavSatFix, and geometry_msgs/TwistWithCovarianceStamped along east, north and up, both with the
//          variances of the white noise; with satellites the whole covariance of the position. Without a fix, the
//          status of the first is -1, and there is no second.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <array>
#include <optional>
#include <span>
#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/navigation/geodetic_origin.h"
#include "sensors/navigation/position_fix.h"
#include "sensors/navigation/satellite_signals.h"
#include "sensors/noise_model.h"

namespace simvis {

struct GnssDesc {
  GeodeticOrigin origin;
  NoiseDesc horizontal{}, vertical{}, velocity{};
  SatellitesDesc satellites{};
  NoiseDesc pseudorange{};
  double max_pdop = 25;
  std::uint64_t seed = 0;

  static AttributeRows<GnssDesc> rows();
  bool has_satellites() const { return !satellites.none(); }
};

class Gnss : public ReadingSensor {
 public:
  Gnss(std::string name, const GnssDesc& desc);

  SensorNeeds needs() const override {
    return {.motion = true, .gnss_jamming = true, .shapes = desc_.has_satellites()};
  }
  void sense(const SensedWorld& world) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& rays) override;
  std::string method() const override { return desc_.has_satellites() ? "satellites" : "geodetic position"; }

 private:
  double period_s() const { return sample_period_s(rate_hz, time_); }
  std::optional<PositionFix> fix_of(std::span<const SatelliteSignal> received) const;
  void set_variances(const glm::dmat3& of_satellites);
  /// Latitude, longitude, altitude and velocity of a fix with this error, E; NaN without a fix.
  std::array<double, 6> measured(const std::optional<glm::dvec3>& error_m) const;

  std::string name_;
  GnssDesc desc_;
  GeographicLib::LocalCartesian local_;
  NoiseModel horizontal_, vertical_, velocity_, pseudorange_;
  SatelliteSignals signals_;
  Motion motion_;
  bool is_jammed_ = false;          // in this frame
  const DrawList* list_ = nullptr;  // of this frame
  FrameTime time_;
};

}  // namespace simvis
