// The effect `crosstalk`: pulses of other scanners of the same wavelength are taken for echoes.
//
//   <sensor type="laser_scanner" ... sweep="0.025" crosstalk="OTHER_*"/>
//
// Others   stand at the insertion points that the pattern `crosstalk` names, with their axes, and are of the same type:
//          they have the beams of this scan, which leave in the same order at the same intervals, turn after turn. A
//          turn takes the time of the scan and one interval more. Two clocks run apart, so that in each scan each other
//          scanner begins its turn at a time of its own, evenly distributed over a turn. A scanner nearer than a beam
//          is wide is left out: it is this one.
// Window   A beam that leaves at t hears pulses from t to t + 2 range_max / c. A pulse that left the other scanner at u
//          and has gone the way L arrives at u + L / c, and reads the range (c (u - t) + L) / 2.
// By a surface  A ray of the beam meets a surface at P. If the other scanner's beam has P in its cone and nothing
//          stands between, its light returns from P as the beam's own does, with the power of the ray's own echo times
//          (w / v)^2: the ratio of the areas of both beams at P, where w and v are their diameters. L is the way from
//          the other scanner to P and from there to this one.
// Directly  Each scanner stands in the other's beam, and no surface in between. The power is 4 / v^2: a pulse that
//          lights up a disc of the diameter v, where a white wall returns the share 1 / (pi r^2) to each square metre.
// Beams    have the diameter `beam_diameter` where they leave and grow by `divergence`. The air dims light by
//          exp(-extinction L).
// Limits   a housing that is drawn around the other scanner hides it from direct light and hides what it lights up. No
//          light comes by mirrors or by Gaussian splats: a cloud has no surface that says which of its splats hide the
//          other scanner. All scanners stand as at the frame's time.
// Reference  G. B. Popko, T. K. Gaylord, C. R. Valenta, Geometric approximation model of inter-lidar interference, Opt.
//            Eng. 59 (3), 033104, 2020: beams that cross at a target, and direct light.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <simvis/location.h>
#include <simvis/scan_effect.h>
#include "effects/scanner/beam_axes.h"
#include "effects/scanner/firing_times.h"

namespace simvis {

class Crosstalk : public ScanEffect {
 public:
  /// Throws InputError if all beams leave at the same time. aim() throws it if they leave within the time that light
  /// takes to range_max and back.
  explicit Crosstalk(const ScanEffectContext& context);

  bool traces() const override { return true; }
  std::string others() const override { return others_; }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;
  void meet(const ScanContext& context, const BeamRay& ray, const SurfacePoint& surface, Echo& echo,
            std::vector<BeamRay>& onward) const override;
  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override;

 private:
  struct Other {
    glm::dmat4 sensor_from_other{1.0};
    double begins_s = 0;  // its turn, after the beginning of the scan
  };
  // The echo of a pulse of another scanner, unless something stands in its way.
  struct Pulse {
    std::uint32_t beam = 0;
    Echo echo;
    double way_m = 0;  // from the surface to the other scanner
    bool hidden = false;
  };
  // A beam of another scanner, in the frame of this one.
  struct Fired {
    glm::dvec3 origin_m, direction;
    double time_s;  // after the beginning of the scan
  };

  void order_firings(const ScanContext& context) const;
  void hear(const Other& other, std::uint32_t beam, double way_m, const std::function<void(const Fired&)>& heard) const;
  double range_m(std::uint32_t beam, const Fired& fired, double way_m) const;
  void add_direct(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const;
  double diameter_m(double range_m) const { return beam_diameter_m_ + spread_ * range_m; }
  bool lights_up(const glm::dvec3& origin_m, const glm::dvec3& direction, const glm::dvec3& point_m) const;

  std::string others_;
  Location where_;
  FiringTimes times_;
  double beam_diameter_m_, spread_, range_max_m_;
  SensorRandom random_;
  // These are of the scan that is being taken.
  mutable std::vector<double> fired_s_;          // by beam, after the beginning of the scan
  mutable std::vector<std::uint32_t> in_order_;  // beams by fired_s_
  mutable double turn_s_ = 0;
  mutable std::vector<Other> seen_;
  mutable std::vector<BeamAxis> axes_;
  mutable std::vector<double> nearest_m_;  // by beam: the first surface
  mutable std::vector<Pulse> pulses_;      // by question, from receive() on by beam
  mutable bool sorted_ = false;            // whether they are by beam
};

}  // namespace simvis
