// The effect `angular_noise`: the actual direction of a beam differs from the reported direction.
//
//   <sensor type="laser_scanner" ... angular_noise="0.05"/>
//
// In every scan the azimuth and the elevation of each beam get independent errors with a normal distribution. The scan
// reports the nominal angles, as a device does that reads them from its motor encoder, and the range measured along the
// actual direction.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

class AngularNoise : public ScanEffect {
 public:
  AngularNoise(double deviation_rad, SensorRandom random) : deviation_rad_(deviation_rad), random_(random) {}

  bool traces() const override { return true; }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;

 private:
  double deviation_rad_;
  SensorRandom random_;
};

}  // namespace simvis
