// The effect `beam_divergence`: a beam is a cone of light, and what it meets is a patch, not a point.
//
//   <sensor type="laser_scanner" ... divergence="0.17" divergence_samples="32"/>
//
// The cone is sampled: a beam goes out as `divergence_samples` rays of equal shares of its energy, through the middles
// of equal areas of a disc across it. Light is even within the cone's full angle and ends there. At an edge some rays
// meet what is in front and some what is behind: mixed ranges come of the beam's width, never of interpolation. How
// echoes become a range: see effects/returns.h.
//
// The rays. A pair of them, opposite of each other, has a radius of its own; the pairs' turns follow the golden ratio;
// an odd one goes along the axis. As the pattern is symmetric, a slanted plane's range has no error of the first order,
// whatever the number of rays. Each beam's pattern is turned by an angle of its own, which depends on seed, sensor and
// beam: so errors of sampling at a long edge do not come as a pattern along it, but average out over beams. It does not
// depend on the frame: what stands still keeps its ranges.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

/// Places on the unit disc, which stand for equal areas.
std::vector<glm::dvec2> disc_samples(std::uint32_t count);

class BeamDivergence : public ScanEffect {
 public:
  /// `full_angle_rad` from side to side, below pi.
  BeamDivergence(double full_angle_rad, std::uint32_t samples, SensorRandom random);

  bool traces() const override { return true; }
  std::uint32_t rays_per_ray() const override { return static_cast<std::uint32_t>(samples_.size()); }
  void aim(const ScanContext& moment, std::vector<BeamRay>& rays) const override;

 private:
  double spread_;  // tangent of half the angle
  std::vector<glm::dvec2> samples_;
  SensorRandom random_;
};

}  // namespace simvis
