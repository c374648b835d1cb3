// The effect `blooming`: a retro-reflector looks larger than it is.
//
//   <sensor type="laser_scanner" ... bloom="0.001" bloom_angle="3"/>
//
// Cause    Windows, lenses and mirrors of a scanner scatter a small share of its light around each beam. On matte
//          surfaces nothing of that is seen. A retro-reflector sends back thousands of times as much light, so that
//          beams that pass it at some distance still read its range.
// Model    Each beam has a halo: the share `bloom` of its light lies evenly in a cone of the full angle `bloom_angle`,
//          the rest in the beam itself. The halo is sampled by `bloom_samples` rays of equal shares, in the pattern of
//          beam_divergence. Pulses weaker than `bloom_power` are lost, as those of matte surfaces in the halo are.
// Limit    no light returns by scattering on the way back, which real receivers have too: it acts in the same way, so a
//          measured share contains both.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

class Blooming : public ScanEffect {
 public:
  explicit Blooming(const ScanEffectContext& context);

  bool traces() const override { return true; }
  std::uint32_t rays_per_ray() const override { return 1 + static_cast<std::uint32_t>(samples_.size()); }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;
  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override;

 private:
  double share_, spread_, least_power_, pulse_length_m_;
  std::vector<glm::dvec2> samples_;
  SensorRandom random_;
};

}  // namespace simvis
