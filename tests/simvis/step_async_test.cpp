// step_async(): the same frames as step() to the byte while the caller continues; calls that are allowed during the
// frame; errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "tests/support/error_of.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using Bytes = std::vector<float>;

Bytes joined(std::initializer_list<const std::vector<float>*> parts) {
  Bytes all;
  for (const std::vector<float>* part : parts) all.insert(all.end(), part->begin(), part->end());
  return all;
}

/// Results of the sensors that measured, by name.
std::map<std::string, Bytes> results(const Simulation& simulation, const std::vector<std::string>& cameras) {
  std::map<std::string, Bytes> all;
  for (const std::string& name : simulation.measured()) {
    if (std::ranges::find(cameras, name) == cameras.end()) {
      all[name] = joined({&simulation.scan(name).range_m.numbers(), &simulation.scan(name).error_bound_m.numbers()});
    } else {
      all[name] = joined({&simulation.color(name).pixels.numbers(), &simulation.depth(name).pixels.numbers()});
    }
  }
  return all;
}

/// Runs both ways, the second with every call that is allowed during a frame.
template <typename Load, typename Drive>
void check_same_frames(int frames, const std::vector<std::string>& cameras, const Load& load, const Drive& drive) {
  Simulation together = load();
  std::vector<std::map<std::string, Bytes>> expected;
  for (int frame = 0; frame < frames; ++frame) {
    drive(together, together.next_frame());
    together.step();
    expected.push_back(results(together, cameras));
  }
  Simulation apart = load();
  for (int frame = 0; frame < frames; ++frame) {
    CAPTURE(frame);
    CHECK(apart.next_frame().index == static_cast<std::uint64_t>(frame));
    drive(apart, apart.next_frame());
    apart.step_async();
    if (frame == 0) {
      CHECK(apart.measured().empty());
    } else {
      CHECK(results(apart, cameras) == expected[static_cast<std::size_t>(frame) - 1]);
    }
  }
  apart.finish();
  CHECK(results(apart, cameras) == expected.back());
  apart.finish();  // no frame is in progress
  CHECK(results(apart, cameras) == expected.back());
  CHECK(together.diagnostics().counters() == apart.diagnostics().counters());
}

TEST_CASE("twenty frames of marvin while it drives, by each method") {
  const std::filesystem::path scene = SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  for (const std::string method : {"planar", "hybrid", "raycast"}) {
    CAPTURE(method);
    const auto load = [&] {
      SimulationDesc desc;
      desc.overrides = {{"laser_scanner", "method", method, "this test"}};
      // So that it renders, and casts.
      if (method == "hybrid") desc.overrides.push_back({"laser_scanner", "max_error_rel", "1e-4", "this test"});
      Simulation simulation = Simulation::load(scene, desc);
      for (const SensorInfo& sensor : simulation.sensors()) {
        simulation.enable(sensor.name, sensor.type == "laser_scanner");
      }
      return simulation;
    };
    const Trajectory trajectory(scene.parent_path() / "drive.csv", load().parameters());
    check_same_frames(20, {}, load, [&](Simulation& simulation, const FrameTime& time) {
      trajectory.apply(static_cast<double>(time.time_ns) / 1e9, simulation.parameters());
    });
  }
}

const std::string kMixed = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" outputs="color depth" row_time="0.001"/>
<sensor type="laser_scanner" name="CAST" insert_at="ROOT" samples="31" method="raycast" range_noise="0.01"/>
<sensor type="laser_scanner" name="DRAWN" insert_at="ROOT" samples="31" method="planar" rate="5"/>
<sensor type="laser_scanner" name="KEEPS" insert_at="ROOT" samples="31" method="hybrid" max_error_m="1e-6"/>
<element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="DRAWN"/>
<sensor type="camera" name="VIEW" insert_at="ROOT" width="16" height="12" outputs="color depth"
        view="visualization"/>)";

Simulation mixed() {
  static const TemporaryFolder folder;
  return Simulation::load(write_wall_scene(folder.path(), kMixed));
}

TEST_CASE("cameras, scanners that cast and that draw, and a visualization of them") {
  check_same_frames(7, {"CAM", "VIEW"}, mixed, [](Simulation& simulation, const FrameTime& time) {
    simulation.set("MOVE", "x", 0.1 * static_cast<double>(time.index));
    simulation.set("MOVE", "yaw", 3 * static_cast<double>(time.index));
  });
}

TEST_CASE("during a frame: the available results, and the calls that require finish()") {
  Simulation simulation = mixed();
  simulation.step();
  simulation.step_async();
  CHECK(simulation.next_frame().index == 2);
  CHECK(simulation.scan("CAST").range_m.size() == 31);
  CHECK(simulation.color("CAM").width == 32);
  simulation.set("MOVE", "x", 1);
  CHECK(simulation.get("MOVE", "x") == 1);
  const auto refused = [](const auto& action) {
    return error_of(action).find("a frame is under way, expected finish() before this") != std::string::npos;
  };
  CHECK(refused([&] { simulation.execute(""); }));
  CHECK(refused([&] { simulation.enable("CAM", false); }));
  CHECK(refused([&] { simulation.skip_frame(); }));
  CHECK(refused([&] { simulation.value("CAM", "depth_error_bound_m"); }));
  CHECK(refused([&] { simulation.sensors(); }));
  CHECK(refused([&] { simulation.diagnostics().counters(); }));
  CHECK(refused([&] { simulation.diagnostics().frame_plan(); }));
  CHECK(refused([&] { simulation.diagnostics().draw_list(); }));
  glm::dmat4 pose;
  CHECK(refused([&] { simulation.sensor_pose("CAM", pose); }));

  // Values set meanwhile apply to the next frame.
  const std::size_t forward = 15;
  simulation.finish();
  CHECK(std::abs(simulation.scan("DRAWN").range_m[forward] - 4) <= 1e-6);
  simulation.enable("DRAWN", true);
  for (int frame = 2; frame < 4; ++frame) simulation.step_async();
  simulation.finish();
  CHECK(std::abs(simulation.scan("DRAWN").range_m[forward] - 3) <= 1e-6);

  // A simulation can be destroyed or replaced during a frame.
  simulation.step_async();
  simulation = mixed();
  simulation.step_async();
}

// At 64 m half an ulp of a float32 is 3.8e-6 m, more than the tolerance of KEEPS.
TEST_CASE("an error of a frame in progress is thrown by the call that finishes it, and the simulation still works") {
  Simulation simulation = mixed(), other = mixed();
  simulation.step();
  simulation.set("MOVE", "x", -60);
  simulation.step_async();
  simulation.set("MOVE", "x", 0.5);
  CHECK(error_of([&] { simulation.step_async(); }).find("KEEPS") != std::string::npos);
  CHECK(simulation.measured().empty());
  CHECK(simulation.next_frame().index == 1);
  simulation.step_async();
  simulation.finish();
  CHECK(simulation.next_frame().index == 2);

  other.step();
  other.set("MOVE", "x", 0.5);
  other.step();
  CHECK(simulation.scan("KEEPS").range_m == other.scan("KEEPS").range_m);
  CHECK(simulation.depth("CAM").pixels == other.depth("CAM").pixels);

  simulation.set("MOVE", "x", -60);
  simulation.step_async();
  CHECK(error_of([&] { simulation.finish(); }).find("KEEPS") != std::string::npos);
  simulation.finish();  // no longer in progress
  CHECK(simulation.next_frame().index == 2);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
