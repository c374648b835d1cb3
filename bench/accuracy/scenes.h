// The scenes that accuracy is measured in, and where in them.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>

namespace simvis::bench {

/// A scene and where scanners stand in it: at each station, level, with several headings evenly around.
///
/// Frames   world: x forward, y left, z up, metres.
struct AccuracyScene {
  std::string name;
  std::optional<Simulation> (*load)() = nullptr;  ///< empty where the scene's files are not there
  std::vector<glm::dvec3> stations_m;             ///< of the planar scanner
  double lidar_above_m = 0;                       ///< how far above it the lidar stands
  int planar_headings = 0, lidar_headings = 0;    ///< at each station
  std::size_t lidar_stations = 0;                 ///< the first of them: a lidar has enough beams at a few
};

/// In the order in which they are measured and printed.
std::vector<AccuracyScene> accuracy_scenes();

/// Sixty metres of corridor, two metres wide, with doors in niches: beams graze its walls. Origin in its middle, on
/// the floor; x along it.
std::optional<Simulation> load_corridor();

/// Two hundred poles, 2 mm to 200 mm thick, 2 m to 40 m from the origin, on a floor.
std::optional<Simulation> load_poles();

/// The furnished house of the shared data, 87 parts made by others.
std::optional<Simulation> load_house();

}  // namespace simvis::bench
