// Compares the cost of the methods of laser scanners: scenes/marvin with the moving robot, three scanners of 361 beams
// each; and both ray casters with bare Embree (single precision, one flat mesh) on the same rays. The caster by host
// and Embree have one thread; the times of rays are per ray, as wall clock and as processor time of all threads.
//
//   ray_methods [SCENE.xml [FRAMES]]
//
// Prints CSV. Every method is timed in every frame, so that other load on the machine affects all alike: compare
// ratios. A set is a whole frame of three scanners: parameters, flattening, rendering or casting, results in memory.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/bare_embree.h"

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

struct Method {
  const char *name, *max_error_rel;
};
constexpr Method kMethods[] = {{"nearest", ""},    {"planar", ""},     {"hybrid", "3e-4"},
                               {"hybrid", "1e-4"}, {"hybrid", "1e-6"}, {"raycast", ""}};
constexpr std::size_t kMethodCount = std::size(kMethods);
constexpr int kWarmUp = 20, kMinTurns = 30;

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void time_sets(const std::filesystem::path& scene, int frames) {
  std::vector<Simulation> simulations;
  std::vector<double> times_ms[kMethodCount], shares[kMethodCount];
  for (const Method& method : kMethods) {
    SimulationDesc desc;
    desc.overrides = {{"laser_scanner", "method", method.name, "METHOD"}};
    if (*method.max_error_rel != 0) {
      desc.overrides.push_back({"laser_scanner", "max_error_rel", method.max_error_rel, "METHOD"});
    }
    simulations.push_back(Simulation::load(scene, desc));
    for (const SensorInfo& sensor : simulations.back().sensors()) {
      simulations.back().enable(sensor.name, sensor.type == "laser_scanner");
    }
  }
  const Trajectory drive(scene.parent_path() / "drive.csv", simulations.front().parameters());
  for (int frame = 0; frame < kWarmUp + frames; ++frame) {
    for (std::size_t turn = 0; turn < kMethodCount; ++turn) {
      const std::size_t m = (turn + static_cast<std::size_t>(frame)) % kMethodCount;  // no method is always first
      Simulation& simulation = simulations[m];
      drive.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
      const auto start = Clock::now();
      simulation.step();
      if (frame < kWarmUp) continue;
      times_ms[m].push_back(since(start));
      double share = 0, scanners = 0;
      for (const SensorInfo& sensor : simulation.sensors()) {
        if (!sensor.enabled) continue;
        share += sensor.number("cast_share").value_or(0);
        ++scanners;
      }
      shares[m].push_back(share / scanners);
    }
  }
  std::printf("method,max_error_rel,median_ms,ratio_to_nearest,share_cast,passes\n");
  for (std::size_t m = 0; m < kMethodCount; ++m) {
    std::printf("%s,%s,%.4f,%.3f,%.3f,%llu\n", kMethods[m].name, kMethods[m].max_error_rel, median(times_ms[m]),
                median(times_ms[m]) / median(times_ms[0]), median(shares[m]),
                static_cast<unsigned long long>(simulations[m].diagnostics().counters().passes));
  }
}

std::vector<glm::dvec3> directions_of(int samples, double half_width_rad, int rings, double half_height_rad) {
  std::vector<glm::dvec3> directions;
  for (int ring = 0; ring < rings; ++ring) {
    const double e = rings == 1 ? 0 : half_height_rad * (2.0 * ring / (rings - 1) - 1);
    for (int beam = 0; beam < samples; ++beam) {
      const double a = half_width_rad * (2.0 * beam / (samples - 1) - 1);
      directions.push_back(beam_direction(a, e));
    }
  }
  return directions;
}

/// The largest relative error of single-precision ranges against those of the caster.
double worst_error(const std::vector<float>& ranges_m, const std::vector<RayHit>& hits) {
  double worst = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (std::isfinite(hits[i].range_m))
      worst = std::max(worst, std::abs(ranges_m[i] - hits[i].range_m) / hits[i].range_m);
  }
  return worst;
}

/// A way to cast the rays, with its times per turn.
struct Engine {
  std::string name;
  std::function<void()> cast;
  std::function<double()> difference;  // the largest relative one to the hits of the caster by host
  std::vector<double> wall_ms, processor_ms;
};

Engine embree_engine(const char* name, const bench::BareEmbree& embree, decltype(&bench::BareEmbree::cast_singly) cast,
                     const std::vector<glm::vec3>& directions, const std::vector<RayHit>& hits) {
  const auto ranges_m = std::make_shared<std::vector<float>>(directions.size());
  return {.name = name,
          .cast = [&embree, cast, &directions, ranges_m] { (embree.*cast)(directions, *ranges_m, glm::vec3(0)); },
          .difference = [&hits, ranges_m] { return worst_error(*ranges_m, hits); },
          .wall_ms = {},
          .processor_ms = {}};
}

/// Processor time of all threads of the process.
double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

void time_turn(Engine& engine) {
  const double processor = processor_ms();
  const auto start = Clock::now();
  engine.cast();
  engine.wall_ms.push_back(since(start));
  engine.processor_ms.push_back(processor_ms() - processor);
}

void time_rays(const char* name, Simulation& simulation, const std::vector<glm::dvec3>& directions, int repetitions) {
  glm::dmat4 world_from_sensor(1.0);
  simulation.sensor_pose("FRONT_SCANNER", world_from_sensor);
  const DrawList& list = simulation.diagnostics().draw_list();
  std::vector<RayHit> hits(directions.size()), shader_hits(directions.size());
  const std::unique_ptr<RayCaster> caster = make_host_ray_caster({}, 1);
  caster->set_world(list);
  Device vulkan;
  const std::unique_ptr<RayCaster> shader = make_device_ray_caster(vulkan);
  shader->set_world(list);
  const bench::BareEmbree embree(list, rigid_inverse(world_from_sensor));
  const bench::BareEmbree avx2(list, rigid_inverse(world_from_sensor), "isa=avx2");
  const std::vector<glm::vec3> single(directions.begin(), directions.end());
  using bench::BareEmbree;
  std::vector<Engine> engines{{.name = "caster by host",
                               .cast = [&] { caster->cast(world_from_sensor, directions, hits); },
                               .difference = [] { return 0.0; },
                               .wall_ms = {},
                               .processor_ms = {}},
                              {.name = "caster by compute shader",
                               .cast = [&] { shader->cast(world_from_sensor, directions, shader_hits); },
                               .difference = [&] { return shader_hits == hits ? 0.0 : INFINITY; },
                               .wall_ms = {},
                               .processor_ms = {}},
                              embree_engine("embree 1", embree, &BareEmbree::cast_singly, single, hits),
                              embree_engine("embree 16", embree, &BareEmbree::cast_in_packets, single, hits),
                              embree_engine("embree 1 avx2", avx2, &BareEmbree::cast_singly, single, hits),
                              embree_engine("embree 16 avx2", avx2, &BareEmbree::cast_in_packets, single, hits)};
  for (int r = 0; r < repetitions; ++r) {
    for (Engine& engine : engines) time_turn(engine);
  }
  const double per_ray = 1e6 / static_cast<double>(directions.size());
  const auto packets = std::ranges::find(engines, "embree 16", &Engine::name);
  for (const Engine& engine : engines) {
    std::printf("%s,%s,%.1f,%.1f,%.3f,%.3g\n", name, engine.name.c_str(), per_ray * median(engine.wall_ms),
                per_ray * median(engine.processor_ms), median(engine.processor_ms) / median(packets->processor_ms),
                engine.difference());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path scene = argc > 1 ? argv[1] : SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 300;
  time_sets(scene, frames);
  Simulation simulation = Simulation::load(scene);
  simulation.step();
  std::printf("rays,engine,wall_ns,processor_ns,ratio_to_packets,worst_relative_difference\n");
  time_rays("361", simulation, directions_of(361, std::numbers::pi / 2, 1, 0), frames);
  time_rays("64 x 2048", simulation, directions_of(2048, std::numbers::pi, 64, std::numbers::pi / 12),
            std::max(frames / 30, kMinTurns));
  return 0;
}
