// Beams in world coordinates, for peers that know no robot: they measure where it stood at first.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "simvis/simulation.h"

namespace simvis::bench {

/// One scan: its beams in order of ring and azimuth.
struct StillScan {
  glm::dmat4 world_from_sensor{1.0};
  std::vector<double> azimuth_rad;
  std::vector<glm::dvec3> directions;  ///< in the world, unit
};

/// Of scanners that have measured.
inline std::vector<StillScan> still_scans(const Simulation& simulation, const std::vector<std::string>& scanners) {
  std::vector<StillScan> scans;
  for (const std::string& scanner : scanners) {
    StillScan& still = scans.emplace_back();
    simulation.sensor_pose(scanner, still.world_from_sensor);
    const Scan& scan = simulation.scan(scanner);
    still.azimuth_rad = scan.azimuth_rad;
    for (const double e : scan.elevation_rad) {
      for (const double a : scan.azimuth_rad) {
        const glm::dvec3 direction(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        still.directions.push_back(glm::dmat3(still.world_from_sensor) * direction);
      }
    }
  }
  return scans;
}

}  // namespace simvis::bench
