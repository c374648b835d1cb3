// The effect `sweep_motion`: a scan takes time, and the sensor moves meanwhile.
//
//   <sensor type="laser_scanner" ... sweep="0.0133" sweep_direction="ccw"/>
//
// The last beam of a sweep leaves at the frame's time, the first one `sweep` seconds before, those between evenly; the
// rings of one azimuth leave together. Each beam leaves from where the sensor was at its time. The sensor is taken to
// have moved evenly since it last measured, along a straight line and turning the shortest way (slerp); where the sweep
// is longer than that, evenly the same before. At its first measurement it stands.
//
// Ranges, angles and x, y, z are in the frame that the sensor had when the beam left, which is what a device gives that
// does not know how it moves; the channel "time_s" is the beam's own time. In a CSV it stands in place of the frame's.
//
// The limit: only the sensor moves during the sweep, everything else stands as at the frame's time.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

class SweepMotion : public ScanEffect {
 public:
  SweepMotion(double sweep_s, bool clockwise) : sweep_s_(sweep_s), clockwise_(clockwise) {}

  bool traces() const override { return true; }
  bool uses_previous_pose() const override { return true; }
  void aim(const ScanContext& moment, std::vector<BeamRay>& rays) const override;
  /// Adds the channel "time_s".
  void finish(const ScanContext& moment, std::span<const Echo> detected, Scan& scan) const override;

 private:
  double age_s(std::uint32_t column, std::uint32_t columns) const;

  double sweep_s_;
  bool clockwise_;
};

}  // namespace simvis
