// Compares the predicted and measured times of all methods among which method="auto" of laser scanners chooses.
//
//   auto_choice [SCENE.xml [POSES [REPETITIONS]]]
//
// Prints CSV: for each scanner, tolerance and pose of the drive the predicted and the measured time of each method, and
// at the end how often the chosen method was the fastest, and how much slower than the fastest it was. All methods are
// timed in turn, so that other load on the machine affects all alike; the shortest time of each counts. An object moves
// between any two scans. Costs are measured again in each run and not stored.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/laser_scanner/scan_calibration.h"

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

constexpr double kTolerances_m[] = {0.03, 0.003, 0.0003};
constexpr double kNoLimitRel = std::numeric_limits<double>::infinity();

struct Machine {
  Device device;
  Renderer renderer{device};
  std::unique_ptr<RayCaster> caster = make_host_ray_caster();
  CostModel costs = measure_scan_costs(device, *make_host_ray_caster());
};

double scan_ms(Machine& machine, LaserScanner& scanner, DrawList& list, const glm::dmat4& pose) {
  list.world_from_node.back()[3].z += 1e-6;
  ++list.revisions.transforms;
  FramePlan plan;
  const auto start = Clock::now();
  scanner.plan(pose, list, plan);
  scanner.collect({}, plan, machine.renderer.render(list, plan));
  machine.caster->set_world(list);
  scanner.cast(*machine.caster);
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::vector<ScanCandidate> survey(Machine& machine, const LaserScannerDesc& desc, const DrawList& list,
                                  const glm::dmat4& pose) {
  MethodSurvey survey(desc.pattern, kPlanarResolutions);
  const glm::dmat4 sensor_from_world = rigid_inverse(pose);
  const RangeLimits limits{desc.range_min_m, desc.range_max_m};
  FramePlan plan;
  survey.plan("SCANNER", sensor_from_world, plan);
  survey.collect(plan, machine.renderer.render(list, plan), list.items.size(), VertexRounding(list, sensor_from_world),
                 limits, {desc.max_error_m, desc.max_error_rel});
  std::vector<glm::dvec3> directions;
  for (const double a : azimuths(desc.pattern)) directions.emplace_back(std::cos(a), std::sin(a), 0);
  std::vector<std::uint32_t> order(directions.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<RayHit> hits(directions.size());
  machine.caster->set_world(list);
  survey.cast(*machine.caster, list.items.size(), pose, order, directions, hits);
  std::vector<BeamReading> readings;
  for (const RayHit& hit : hits) readings.push_back(read_range({hit.range_m, hit.error_bound_m}, limits));
  survey.choose(readings, machine.costs);
  return {survey.candidates().begin(), survey.candidates().end()};
}

std::vector<double> time_candidates(Machine& machine, LaserScannerDesc desc, DrawList& list, const glm::dmat4& pose,
                                    const std::vector<ScanCandidate>& candidates, int repetitions) {
  std::vector<LaserScanner> scanners;
  for (const ScanCandidate& candidate : candidates) {
    desc.method = candidate.resolution_px > 0 ? ScanMethod::hybrid : ScanMethod::raycast;
    desc.resolution_px = candidate.resolution_px;
    scanners.emplace_back("SCANNER", desc);
  }
  std::vector<double> least_ms(candidates.size(), 1e18);
  for (int i = 0; i <= repetitions; ++i) {
    for (std::size_t c = 0; c < scanners.size(); ++c) {
      const double took_ms = scan_ms(machine, scanners[c], list, pose);
      if (i > 0) least_ms[c] = std::min(least_ms[c], took_ms);
    }
  }
  return least_ms;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path scene = argc > 1 ? argv[1] : SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const int poses = argc > 2 ? std::atoi(argv[2]) : 5, repetitions = argc > 3 ? std::atoi(argv[3]) : 20;
  Machine machine;
  for (std::size_t i = 0; i < kCostTerms; ++i) {
    std::printf("# %s %.2g ns\n", std::string(to_string(static_cast<CostTerm>(i))).c_str(), machine.costs.of[i]);
  }
  Simulation simulation = Simulation::load(scene);
  for (const SensorInfo& sensor : simulation.sensors()) {
    simulation.enable(sensor.name, sensor.type == "laser_scanner");
  }
  const Trajectory drive(scene.parent_path() / "drive.csv", simulation.parameters());
  int choices = 0, best = 0;
  std::vector<double> losses;
  std::printf("scanner,pose,max_error_m,way,beams_cast,predicted_ms,measured_ms,chosen,quickest\n");
  for (int pose_number = 0; pose_number < poses; ++pose_number) {
    drive.apply(2.0 * pose_number, simulation.parameters());
    simulation.step();
    DrawList list = simulation.diagnostics().draw_list();
    for (const SensorInfo& sensor : simulation.sensors()) {
      glm::dmat4 pose(1.0);
      if (!sensor.enabled || !simulation.sensor_pose(sensor.name, pose)) continue;
      LaserScannerDesc desc;
      desc.pattern = {.beams = 361, .min_azimuth_rad = -std::numbers::pi / 2, .max_azimuth_rad = std::numbers::pi / 2};
      desc.max_error_rel = kNoLimitRel;
      for (const double tolerance_m : kTolerances_m) {
        desc.max_error_m = tolerance_m;
        const std::vector<ScanCandidate> ways = survey(machine, desc, list, pose);
        const std::vector<double> took_ms = time_candidates(machine, desc, list, pose, ways, repetitions);
        const auto chosen = std::ranges::min_element(ways, {}, &ScanCandidate::predicted_ns) - ways.begin();
        const auto quickest = std::ranges::min_element(took_ms) - took_ms.begin();
        for (std::size_t w = 0; w < ways.size(); ++w) {
          std::printf("%s,%d,%g,%s,%llu,%.4f,%.4f,%d,%d\n", sensor.name.c_str(), pose_number, tolerance_m,
                      to_string(ways[w]).c_str(), static_cast<unsigned long long>(ways[w].beams_cast),
                      ways[w].predicted_ns / 1e6, took_ms[w], static_cast<std::ptrdiff_t>(w) == chosen,
                      static_cast<std::ptrdiff_t>(w) == quickest);
        }
        ++choices;
        best += chosen == quickest;
        losses.push_back(took_ms[static_cast<std::size_t>(chosen)] / took_ms[static_cast<std::size_t>(quickest)]);
      }
    }
  }
  std::ranges::sort(losses);
  std::printf("# %d choices, %d of them the quickest; chosen / quickest: median %.2f, worst %.2f\n", choices, best,
              losses[losses.size() / 2], losses.back());
  return 0;
}
