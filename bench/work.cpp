// Counts the work of frames: what a frame draws, shades, uploads and tests. Counts do not depend on the machine's speed
// or load, so that they show a regression where times cannot.
//
//   work
//
// Prints CSV: the sum of each count over the frames of each case, after a first frame that makes pipelines and uploads
// meshes. bench/compare_work.py compares it with the committed results; the test `work_test` does so.
#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"

namespace {

using namespace simvis;

constexpr int kFrames = 5;

const std::string kCamera =
    R"(<sensor type="camera" name="CAMERA" insert_at="ROBOT" width="640" height="480" pose_offset="0.3 0 1 0 0 0"/>)";

/// The counters of drawing and of ray casting, as columns of the table.
constexpr std::array kDrawn = {"draws",       "triangles",      "vertex_invocations", "fragment_invocations",
                               "shadow_maps", "pipelines_made", "bytes_uploaded",     "bytes_read_back"};
constexpr std::array kCast = {"rays", "ray_item_tests", "ray_triangle_tests", "ray_trees_built", "ray_trees_refitted"};
using Drawn = std::array<std::uint64_t, kDrawn.size()>;
using Cast = std::array<std::uint64_t, kCast.size()>;

Drawn drawn_in_step(const Simulation& simulation) {
  const Diagnostics diagnostics = simulation.diagnostics();
  std::uint64_t vertex_invocations = 0, fragment_invocations = 0;
  for (const PassCost& pass : diagnostics.frame_costs()->passes) {
    for (const ViewCost& view : pass.views) {
      vertex_invocations += view.statistics.vertex_invocations;
      fragment_invocations += view.statistics.fragment_invocations;
    }
  }
  const FrameCounters& of = diagnostics.counters();
  return {of.draws,       of.triangles,      vertex_invocations, fragment_invocations,
          of.shadow_maps, of.pipelines_made, of.bytes_uploaded,  of.bytes_read_back};
}

Cast cast_so_far(const Simulation& simulation) {
  const RayCounters of = simulation.diagnostics().ray_counters();
  return {of.rays, of.item_tests, of.triangle_tests, of.item_trees_built, of.item_trees_refitted};
}

/// A row of the table. It counts the work of one sensor, or of all sensors of one type in a scene.
struct Case {
  std::string name, way;
  std::filesystem::path scene;
  std::string sensors,  ///< the name of a sensor, or a type of sensors
      method;           ///< of laser scanners; empty: the scene's own
  std::function<void(Simulation&, int frame)> drive;
};

void print(const Case& of) {
  SimulationDesc desc;
  desc.device.instrumented = true;
  if (!of.method.empty()) desc.overrides = {{"laser_scanner", "method", of.method, "METHOD"}};
  Simulation simulation = Simulation::load(of.scene, desc);
  for (const SensorInfo& sensor : simulation.sensors()) {
    simulation.enable(sensor.name, sensor.type == of.sensors || sensor.name == of.sensors);
  }
  of.drive(simulation, 0);
  simulation.step();
  Drawn drawn{};
  const Cast before = cast_so_far(simulation);
  for (int frame = 1; frame <= kFrames; ++frame) {
    of.drive(simulation, frame);
    simulation.step();
    std::ranges::transform(drawn, drawn_in_step(simulation), drawn.begin(), std::plus());
  }
  Cast cast = cast_so_far(simulation);
  std::ranges::transform(cast, before, cast.begin(), std::minus());
  std::printf("\"%s\",%s,%s", simulation.diagnostics().device()->name.c_str(), of.name.c_str(), of.way.c_str());
  for (const std::uint64_t count : drawn) std::printf(",%" PRIu64, count);
  for (const std::uint64_t count : cast) std::printf(",%" PRIu64, count);
  std::printf("\n");
}

void print_marvin() {
  const std::filesystem::path scene = SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const auto drive = [&](Simulation& simulation, int) {
    const Trajectory path(scene.parent_path() / "drive.csv", simulation.parameters());
    path.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
  };
  for (const char* const method : {"raycast", "planar"}) {
    print({"marvin", method, scene, "laser_scanner", method, drive});
  }
  for (const char* const camera : {"ROBOT_CAM", "ROOM_CAM"}) print({"marvin", camera, scene, camera, "", drive});
}

void print_lab() {
  const std::string lidar =
      R"(<sensor type="laser_scanner" name="LIDAR" insert_at="ROBOT" samples="512" vertical_samples="64" )"
      R"(min_angle="-180" max_angle="179" vertical_min_angle="-25" vertical_max_angle="15" pose_offset="0 0 1 0 0 0"/>)";
  const bench::SceneFolder folder;
  const std::filesystem::path lab = bench::write_lab(folder.path(), 100'000, kCamera + lidar);
  print({"lab 100k", "camera", lab, "camera", "", bench::drive_lab});
  print({"lab 100k", "lidar raycast", lab, "laser_scanner", "raycast", bench::drive_lab});
}

void print_store() {
  const bench::SceneFolder folder;
  const std::filesystem::path store = bench::write_store(folder.path(), 10'000, kCamera);
  print({"store 10k", "camera", store, "camera", "", bench::drive_lab});
}

}  // namespace

int main() {
  std::printf("device,scene,way");
  for (const char* const column : kDrawn) std::printf(",%s", column);
  for (const char* const column : kCast) std::printf(",%s", column);
  std::printf("\n");
  print_marvin();
  print_lab();
  print_store();
  return 0;
}
