// The sensor `sonar`: an ultrasonic range sensor in air. It sends a pulse into a cone and reports the range at which
// the returned sound first reaches a threshold.
//
//   <sensor type="sonar" name="SONAR_3" insert_at="ROBOT" opening="25" range_max="5" threshold="0.002"/>
//
// Frame    the axis of the cone is +x of the sensor frame.
// Model    The cone is divided into `rays` rays of equal solid angle. A ray that meets a surface at range r, at an
//          angle of incidence a, returns the echo
//              e = 1 / rays * cos(a)^lobe_exponent / (r / 1 m)^2,
//          so that a wall across the axis that fills the cone returns about 1 at 1 m, and a small target of solid angle
//          A / r^2 falls with r^4. Smooth walls reflect sound like mirrors, because they are smooth against the wave
//          length of 7 mm at 50 kHz: the exponent says how narrow the lobe around the mirror direction is (Kuc and
//          Siegel, "Physically Based Simulation Model for Acoustic Sensor Robot Navigation", IEEE PAMI 9(6), 1987;
//          Bozma and Kuc, PAMI 13(12), 1991, for rough surfaces).
//          Echoes that come within `pulse_length` of range add up. The sensor reports the range of the first echo at
//          which the sum of those of the last `pulse_length` reaches `threshold` (first crossing). So small and slanted
//          surfaces near the sensor are missed, and the near edge of a wide cone is reported, not its axis.
// Rays     A target that fills less than one ray may be missed: the strength of its echo is wrong by up to 1 / rays.
// Values   range_m: +infinity if no crossing lies within range_max; 0 if the first one is nearer than range_min (the
//          transducer still rings). echo: the sum at the crossing, in units of the wall at 1 m; 0 without one.
// Noise    of the range: sensors/noise_model.h. A noisy range is at least 0.
// Message  sensor_msgs/Range, ultrasound.
#pragma once

#include <string>
#include <vector>

#include <simvis/sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/proximity/ray_sensor.h"

namespace simvis {

struct SonarDesc {
  double opening_rad = glm::radians(25.0);  ///< full angle of the cone, (0, pi)
  std::uint32_t rays = 512;
  MeasuredLimits limits{0.15, 5};
  double lobe_exponent = 30;
  double threshold = 0.002;      ///< echo, in units of a wall at 1 m
  double pulse_length_m = 0.02;  ///< in range
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<SonarDesc> rows();
};

/// Directions of equal solid angle in a cone about +x, as unit vectors: a Fibonacci spiral.
std::vector<glm::dvec3> cone_directions(double opening_rad, std::uint32_t count);

/// An echo of one ray.
struct SonarEcho {
  double range_m = 0, strength = 0;
};

/// The first crossing of the threshold: its range, and the sum there. The echoes are in any order. +infinity and 0 if
/// there is none.
SonarEcho first_crossing(std::vector<SonarEcho> echoes, double threshold, double pulse_length_m);

class Sonar : public RaySensor {
 public:
  Sonar(std::string name, const SonarDesc& desc);

  void cast(RayCaster& rays) override;

 private:
  SonarDesc desc_;
};

}  // namespace simvis
