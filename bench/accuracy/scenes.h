// The scenes in which accuracy is measured, and the stations in them.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>

namespace simvis::bench {

/// A scene and the poses of scanners in it: level at each station, with several headings evenly around.
struct AccuracyScene {
  std::string name;
  std::optional<Simulation> (*load)() = nullptr;  ///< empty if the scene's files are missing
  std::vector<glm::dvec3> stations_m;             ///< of the planar scanner
  double lidar_above_m = 0;                       ///< height of the lidar above the station
  int planar_headings = 0, lidar_headings = 0;    ///< at each station
  std::size_t lidar_stations = 0;                 ///< the lidar uses this many of the first stations
};

/// In the order in which they are measured and printed.
std::vector<AccuracyScene> accuracy_scenes();

/// Sixty metres of corridor, two metres wide, with doors in niches: beams hit its walls at grazing angles. The origin
/// is in its middle on the floor, x along it.
std::optional<Simulation> load_corridor();

/// Two hundred poles, 2 mm to 200 mm thick, 2 m to 40 m from the origin, on a floor.
std::optional<Simulation> load_poles();

/// The furnished house of the shared data, with 87 parts by other authors.
std::optional<Simulation> load_house();

}  // namespace simvis::bench
