// Compares methods for a set of scans over the size of the scene and the number of beams: the methods of SimVis, bare
// Embree, and those of the 2009 paper, Coin's ray pick and its scene drawn by OpenGL with depth read back.
//
//   scan_curves [SECONDS [MOST_TRIANGLES]]
//
// Prints CSV, one line for each method at each point. SECONDS (10) is the time for each point; labs have at most
// MOST_TRIANGLES (10^7). A set is a whole frame of all scanners, from parameters to ranges in the caller's memory, with
// the moving robot. Embree casts the same beams from the robot's current pose in a static scene, Coin from its first
// pose. `caller_cpu_ms` is processor time of the calling thread. `error_rel` is the median difference to the ranges of
// `raycast`, without beams that hit nothing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include <simvis/trajectory.h>
#include "bench/scan_curves/coin_peers.h"
#include "bench/scan_curves/embree_peers.h"
#include "bench/scan_curves/methods.h"
#include "bench/scan_curves/peer_scans.h"
#include "bench/scenes/finer_part.h"
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"

namespace {

using namespace simvis;
using namespace simvis::bench;

constexpr std::size_t kMaxOfCoin = 1'000'000;  // triangles; with more, one set of picks takes minutes

struct Pattern {
  const char* name;
  int rings, samples;
};
constexpr Pattern kBeams[] = {
    {"beams", 1, 361}, {"beams", 1, 2048}, {"beams", 16, 1024}, {"beams", 64, 2048}, {"beams", 256, 4096}};
constexpr Pattern kLidar = {"lidar", 64, 2048};

struct Point {
  std::string curve;
  int rings = 1, samples = 361;
  std::vector<std::string> scanners;
  PeerScans::Drive drive;
  bool coin = false;
};

double median_error(const std::vector<float>& ranges_m, const std::vector<float>& truth_m) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < std::min(ranges_m.size(), truth_m.size()); ++i) {
    if (std::isfinite(truth_m[i]) && truth_m[i] > 0) errors.push_back(std::abs(ranges_m[i] / truth_m[i] - 1.0));
  }
  return errors.empty() ? 0 : median(errors);
}

void print(const Point& point, std::size_t triangles, const std::vector<Method>& methods,
           const std::vector<double>& errors) {
  double best_ms = INFINITY;
  for (const Method& method : methods) {
    if (method.threads == 0) best_ms = std::min(best_ms, median(method.took).wall_ms);
  }
  const std::size_t beams = point.scanners.size() * static_cast<std::size_t>(point.rings * point.samples);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const Took took = median(methods[i].took);
    std::printf("%s,%zu,%zu,%d,%d,%zu,%s,%s,%d,%zu,%.4f,%.4f,%.3f,%.2g\n", point.curve.c_str(), triangles,
                point.scanners.size(), point.rings, point.samples, beams, methods[i].name.c_str(),
                methods[i].max_error_rel.c_str(), methods[i].threads, methods[i].took.size(), took.wall_ms,
                took.caller_ms, took.wall_ms / best_ms, errors[i]);
  }
  std::fflush(stdout);
}

void measure(const Point& point, Simulation& simulation, double seconds) {
  std::vector<Method> methods =
      simvis_methods(simulation, point.scanners, [&](int frame) { point.drive(simulation, frame); });
  const auto raycast = std::ranges::find(methods, "raycast", &Method::name) - methods.begin();
  PeerScans scans(simulation, point.scanners, point.drive);
  for (Method& method : embree_methods(simulation.diagnostics().draw_list(), scans))
    methods.push_back(std::move(method));
  const std::size_t triangles = triangles_of(simulation.diagnostics().draw_list());
  if (point.coin) {
    for (Method& method : coin_methods(simulation.diagnostics().draw_list(), scans.scans()))
      methods.push_back(std::move(method));
  }
  time_methods(methods, seconds);

  std::vector<std::vector<float>> ranges_m;
  for (Method& method : methods) {
    method.begin_turn();
    if (method.move) {
      method.move(0);
      method.set();
    }
    ranges_m.push_back(method.ranges_m());
  }
  std::vector<double> errors;
  for (const std::vector<float>& r : ranges_m) {
    errors.push_back(median_error(r, ranges_m[static_cast<std::size_t>(raycast)]));
  }
  print(point, triangles, methods, errors);
}

void measure_three(const std::filesystem::path& folder, std::size_t triangles, double seconds) {
  Simulation simulation = Simulation::load(write_lab(folder, triangles));
  measure({.curve = "triangles",
           .scanners = {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"},
           .drive = drive_lab,
           .coin = triangles <= kMaxOfCoin},
          simulation, seconds);
}

void measure_pattern(const std::filesystem::path& folder, std::size_t triangles, const Pattern& pattern,
                     double seconds) {
  std::string sensor =
      "<sensor type=\"laser_scanner\" name=\"LIDAR\" insert_at=\"ROBOT\" pose_offset=\"0 0 1.2 0 0 0\" "
      "samples=\"" +
      std::to_string(pattern.samples) + "\"";
  if (pattern.rings > 1) {
    sensor += " min_angle=\"-180\" max_angle=\"179.8\" vertical_samples=\"" + std::to_string(pattern.rings) +
              "\" vertical_min_angle=\"-15\" vertical_max_angle=\"15\"";
  }
  Simulation simulation = Simulation::load(write_lab(folder, triangles, sensor + "/>"));
  measure({.curve = pattern.name,
           .rings = pattern.rings,
           .samples = pattern.samples,
           .scanners = {"LIDAR"},
           .drive = drive_lab},
          simulation, seconds);
}

void measure_marvin(const char* name, const std::filesystem::path& scene, double seconds) {
  Simulation simulation = Simulation::load(scene);
  const Trajectory drive(scene.parent_path() / "drive.csv", simulation.parameters());
  measure({.curve = name,
           .scanners = {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"},
           .drive = [&](Simulation& s, int frame) { drive.apply(frame / 15.0, s.parameters()); },
           .coin = true},
          simulation, seconds);
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10;
  const double most = argc > 2 ? std::atof(argv[2]) : 1e7;
  const SceneFolder folder;
  std::printf(
      "curve,triangles,scanners,rings,samples,beams,way,max_error_rel,threads,sets,median_ms,caller_cpu_ms,"
      "ratio_to_best,error_rel\n");
  measure_marvin("marvin", SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml", seconds);
  if (most >= 1e6) measure_marvin("marvin 1M", write_finer_marvin(folder.path()), seconds);
  for (double triangles = 1e3; triangles <= most; triangles *= 10) {
    measure_three(folder.path(), static_cast<std::size_t>(triangles), seconds);
  }
  for (const double triangles : {1e5, 1e6}) {
    if (triangles <= most) measure_pattern(folder.path(), static_cast<std::size_t>(triangles), kLidar, seconds);
  }
  if (most >= 1e5) {
    for (const Pattern& pattern : kBeams) measure_pattern(folder.path(), 100'000, pattern, seconds);
  }
  return 0;
}
