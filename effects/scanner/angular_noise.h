// The effect `angular_noise`: beams do not go quite where the scanner says.
//
//   <sensor type="laser_scanner" ... angular_noise="0.05"/>
//
// Azimuth and elevation of each beam are off by numbers of their own in every scan, normally distributed. The scan
// reports the angles that were meant, as a device does that reads them off its motor, and the range that was met.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

class AngularNoise : public ScanEffect {
 public:
  AngularNoise(double deviation_rad, SensorRandom random) : deviation_rad_(deviation_rad), random_(random) {}

  bool traces() const override { return true; }
  void aim(const ScanContext& moment, std::vector<BeamRay>& rays) const override;

 private:
  double deviation_rad_;
  SensorRandom random_;
};

}  // namespace simvis
