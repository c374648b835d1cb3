// The effect `beam_divergence`: a beam is a cone of light and illuminates a patch, not a point.
//
//   <sensor type="laser_scanner" ... divergence="0.17" divergence_samples="32"/>
//
// The cone is sampled: a beam is split into `divergence_samples` rays with equal shares of its energy, through the
// middles of equal areas of a disc across the beam. The light is uniform within the full angle of the cone and zero
// outside. At an edge some rays hit the surface in front and some the surface behind: mixed ranges result from the
// width of the beam, never from interpolation. effects/scanner/returns.h says how echoes become a range.
//
// Ray pattern: rays come in opposite pairs, and each pair has its own radius. The angles of the pairs follow the golden
// ratio; if the count is odd, one ray lies on the axis. Because the pattern is symmetric, the range of a slanted plane
// has no first-order error for any number of rays. Each beam rotates the pattern by its own angle, which depends on
// seed, sensor and beam. Sampling errors along a long edge therefore show no pattern and average out over the beams.
// The rotation does not depend on the frame, so a static scene keeps its ranges.
#pragma once

#include <span>
#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

/// Points on the unit disc that represent equal areas.
std::vector<glm::dvec2> disc_samples(std::uint32_t count);

/// Rays around another one, whose shares of its energy are equal.
struct DivergenceCone {
  std::span<const glm::dvec2> samples;  ///< of disc_samples()
  double spread = 0;                    ///< tangent of half the angle
  double turn_rad = 0;                  ///< of the pattern, about the axis
  double share = 1;                     ///< of the ray's energy, for all of them together
};

/// Appends the rays of the cone around `ray` to `rays`.
void add_cone(const BeamRay& ray, const DivergenceCone& cone, std::vector<BeamRay>& rays);

class BeamDivergence : public ScanEffect {
 public:
  /// `full_angle_rad` is the angle from side to side, below pi.
  BeamDivergence(double full_angle_rad, std::uint32_t samples, SensorRandom random);

  bool traces() const override { return true; }
  std::uint32_t rays_per_ray() const override { return static_cast<std::uint32_t>(samples_.size()); }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;

 private:
  double spread_;  // tangent of half the angle
  std::vector<glm::dvec2> samples_;
  SensorRandom random_;
};

}  // namespace simvis
