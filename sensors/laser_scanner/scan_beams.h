// The beams of one scan: where they start and point, and when they fire.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "sensors/beam_tables/beam_table.h"
#include "sensors/laser_scanner/scan_layout.h"

namespace simvis {

/// What a scan says of its beams. Of an even grid, azimuths are by beam and elevations by ring, and the last three are
/// empty; of a beam table all are by beam [ring * beams + beam], or empty as in the table.
struct ScanBeams {
  std::uint32_t rings = 0, beams = 0;
  std::vector<double> azimuth_deg{}, elevation_deg{};  ///< the numbers of which the following are glm::radians()
  std::vector<double> azimuth_rad{}, elevation_rad{};
  std::vector<glm::dvec3> origin_m{};
  std::vector<double> age_s{};  ///< how long before the scan's time each beam fires
  std::vector<std::uint32_t> ring{};

  std::size_t size() const { return std::size_t{rings} * beams; }
  glm::dvec3 direction(std::size_t i) const;  ///< of beam i = ring * beams + beam
};

ScanBeams grid_beams(const ScanPattern& pattern);

/// All beams of the table. The last one fires at the scan's time.
ScanBeams table_beams(const BeamTable& table);

/// A beam table that is longer than a scan and runs on from scan to scan: a scan has the last `count` beams that fire
/// before its time or at it, in the order in which they fire. The pattern begins at time 0 and starts again after the
/// time of its last beam and one mean step.
class RunningBeams {
 public:
  /// The table has at least two beams, which differ in time, and at least `count`.
  RunningBeams(const BeamTable& table, std::uint32_t count);

  ScanBeams at(std::int64_t time_ns) const;

  std::int64_t period_ns() const { return period_ns_; }

 private:
  BeamTable table_;  // in one ring, in the order of time
  std::uint32_t count_;
  std::int64_t period_ns_;
};

}  // namespace simvis
