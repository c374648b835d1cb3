// The effect `sweep_motion`: a scan takes time, and the sensor moves during the scan.
//
//   <sensor type="laser_scanner" ... sweep="0.0133" sweep_direction="ccw"/>
//
// The last beam of a sweep leaves at the frame's time, the first one `sweep` seconds earlier, and the others at even
// intervals between them; all rings of one azimuth leave together. With firing="pattern" the beams leave at the times
// that the scanner's beam table says. Each beam leaves from the sensor's pose at its own
// time, on its path since its last measurement: see <simvis/motion_path.h>. If the sweep is longer than the time since
// the last measurement, the same motion is extrapolated backwards. At its first measurement the sensor stands still.
//
// Ranges, angles and x, y, z refer to the sensor frame at the time when the beam left, as in a device without motion
// compensation. The channel "time_s" is the time of each beam. In a CSV file it replaces the frame's time.
//
// Other objects move too, on such paths: each beam meets them where they were when it left, see MovedItems. So what is
// fixed to the sensor stands still for all its beams.
//
// Limit: an object that was not there at the last measurement, or that changes its scale, stands as at the frame's
// time.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>
#include "effects/scanner/firing_times.h"

namespace simvis {

class SweepMotion : public ScanEffect {
 public:
  explicit SweepMotion(const FiringTimes& times) : times_(times) {}

  bool traces() const override { return true; }
  bool uses_previous_pose() const override { return true; }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;
  /// Adds the channel "time_s".
  void finish(const ScanContext& context, std::span<const Echo> detected, Scan& scan) const override;

 private:
  void sort_by_age(const ScanContext& context, std::vector<BeamRay>& rays) const;

  FiringTimes times_;
};

}  // namespace simvis
