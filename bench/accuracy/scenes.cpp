#include "bench/accuracy/scenes.h"

#include <filesystem>

namespace simvis::bench {

namespace {

const std::filesystem::path kScenes = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes";

std::optional<Simulation> load_marvin() { return Simulation::load(kScenes / "marvin/marvin.xml"); }
std::optional<Simulation> load_ravon() { return Simulation::load(kScenes / "ravon/ravon.xml"); }

// Stations along scenes/marvin/drive.csv, clear of the robot's own position; its scanners are 10 cm above the floor.
const std::vector<glm::dvec3> kMarvin_m = {{-0.890, -2.348, 0.1}, {0.917, -2.259, 0.1}, {2.573, -1.814, 0.1},
                                           {2.754, -0.023, 0.1},  {2.424, 1.734, 0.1},  {0.816, 2.381, 0.1},
                                           {-1.879, 2.161, 0.1},  {-2.763, 0.748, 0.1}};

// Stations along scenes/ravon/drive.csv, 74 cm above the contact points of the wheels, the height of the front scanner.
const std::vector<glm::dvec3> kRavon_m = {{14.125, 1.041, 0.04}, {18.273, 0.550, 0.25}, {22.407, -0.040, 0.58}};

const std::vector<glm::dvec3> kCorridor_m = {{-29, 0.3, 0.2},  {-21.3, -0.6, 0.2}, {-12.1, 0.1, 0.2}, {-4.4, 0.8, 0.2},
                                             {3.7, -0.2, 0.2}, {11.9, 0.5, 0.2},   {20.2, -0.8, 0.2}, {28.4, 0, 0.2}};

const std::vector<glm::dvec3> kPoles_m = {{0, 0, 0.3},      {0.7, 0.2, 0.3},  {-0.4, 0.9, 0.3}, {-1.1, -0.3, 0.3},
                                          {0.3, -1.2, 0.3}, {1.3, -0.8, 0.3}, {0.9, 1.1, 0.3},  {-1.2, 0.8, 0.3}};

const std::vector<glm::dvec3> kHouse_m = {{-8, -2.9, 0.31},  {-6.1, -3.1, 0.31}, {-4.4, -3.4, 0.31}, {-3.9, 0.2, 0.31},
                                          {-0.4, 1.6, 0.31}, {1.2, 1.1, 0.31},   {3.9, -2.1, 0.31},  {6.1, -2.4, 0.31}};

}  // namespace

std::vector<AccuracyScene> accuracy_scenes() {
  return {{"marvin", load_marvin, kMarvin_m, 1.1, 40, 2, 8},
          {"ravon", load_ravon, kRavon_m, 1.1, 4, 2, 1},  // a lidar scan takes a second
          {"corridor", load_corridor, kCorridor_m, 0.9, 40, 2, 8},
          {"poles", load_poles, kPoles_m, 1.2, 40, 2, 8},
          {"house", load_house, kHouse_m, 0.9, 40, 2, 8}};
}

}  // namespace simvis::bench
