// Simulations in different threads: each gives the bytes that it gives alone, on any number of threads of its own, and
// also while a plug-in is loaded.
#include <doctest/doctest.h>

#include <algorithm>
#include <latch>
#include <optional>
#include <thread>

#include <simvis/plugin.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "tests/support/error_of.h"
#include "tests/support/sensor_bytes.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("public");

namespace simvis {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes";

// The sanitizers make everything ten to twenty times slower.
const int kFrames = sanitized() ? 2 : 6;
const std::vector<unsigned> kThreads = sanitized() ? std::vector{3u} : std::vector{2u, 3u, 8u};

// A hybrid scanner with many beams, so that they are shared out, a camera, and noise.
constexpr std::string_view kSmallScene = R"(
  <sensor type="laser_scanner" name="SCANNER" insert_at="ROOT" method="hybrid" samples="2048"
          vertical_samples="8" vertical_min_angle="-10" vertical_max_angle="10" range_noise="0.01"/>
  <sensor type="camera" name="CAMERA" insert_at="ROOT" width="160" height="120" outputs="color depth"/>
)";

struct Driven {
  std::filesystem::path scene, trajectory;
};

/// Of each frame.
std::vector<std::uint64_t> run(const Driven& driven, unsigned threads, int frames) {
  SimulationDesc desc;
  desc.threads = threads;
  Simulation simulation = Simulation::load(driven.scene, desc);
  std::optional<Trajectory> trajectory;
  if (!driven.trajectory.empty()) trajectory.emplace(driven.trajectory, simulation.parameters());
  std::vector<std::uint64_t> hashes;
  for (int frame = 0; frame < frames; ++frame) {
    const FrameTime time = simulation.next_frame();
    if (trajectory) trajectory->apply(static_cast<double>(time.time_ns) / 1e9, simulation.parameters());
    // Half of the frames are made each way.
    if (frame % 2 == 0) {
      simulation.step();
    } else {
      simulation.step_async();
      simulation.finish();
    }
    hashes.push_back(measured_hash(simulation));
  }
  return hashes;
}

/// Differ from each other in parts, sensors, effects and methods.
std::vector<Driven> different_scenes(const TemporaryFolder& folder) {
  return {{kScenes / "marvin/marvin.xml", kScenes / "marvin/drive.csv"},
          {kScenes / "arm/arm.xml", kScenes / "arm/reach.csv"},
          {kScenes / "showcase/showcase.xml", {}},
          {write_wall_scene(folder.path(), kSmallScene), {}}};
}

}  // namespace

TEST_CASE("scans and pictures are the same bytes on any number of threads") {
  const TemporaryFolder folder;
  for (const Driven& driven : different_scenes(folder)) {
    CAPTURE(driven.scene);
    const std::vector<std::uint64_t> expected = run(driven, 1, 2);
    for (const unsigned threads : kThreads) {
      CAPTURE(threads);
      CHECK(run(driven, threads, 2) == expected);
    }
  }
}

TEST_CASE("simulations of different scenes in four threads give the bytes that each gives alone") {
  const TemporaryFolder folder;
  const std::vector<Driven> scenes = different_scenes(folder);
  std::vector<std::vector<std::uint64_t>> expected;
  for (const Driven& driven : scenes) expected.push_back(run(driven, 0, kFrames));
  std::vector<std::vector<std::uint64_t>> found(scenes.size());
  std::latch together(static_cast<std::ptrdiff_t>(scenes.size()));
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    threads.emplace_back([&, i] {
      together.arrive_and_wait();
      found[i] = run(scenes[i], 0, kFrames);
    });
  }
  threads.clear();
  CHECK(found == expected);
}

TEST_CASE("simulations of one scene hold its content once, and give the same bytes in four threads") {
  const Driven arm{kScenes / "arm/arm.xml", kScenes / "arm/reach.csv"};
  const std::vector<std::uint64_t> expected = run(arm, 1, kFrames);
  Simulation first = Simulation::load(arm.scene);
  first.step();
  Simulation second = Simulation::load(arm.scene);
  second.step();
  // What a simulation counts does not depend on what others have made before.
  CHECK(second.diagnostics().counters() == first.diagnostics().counters());
  CHECK(!second.diagnostics().draw_list().meshes.empty());
  CHECK(second.diagnostics().draw_list().meshes == first.diagnostics().draw_list().meshes);
  CHECK(second.diagnostics().draw_list().materials == first.diagnostics().draw_list().materials);

  std::vector<std::vector<std::uint64_t>> found(4);
  std::latch together(static_cast<std::ptrdiff_t>(found.size()));
  std::vector<std::jthread> threads;
  for (std::vector<std::uint64_t>& mine : found) {
    threads.emplace_back([&] {
      together.arrive_and_wait();
      mine = run(arm, 2, kFrames);
    });
  }
  threads.clear();
  for (const std::vector<std::uint64_t>& each : found) CHECK(each == expected);
}

TEST_CASE("a plug-in is loaded while other threads load and step simulations") {
  const TemporaryFolder folder;
  const Driven small{write_wall_scene(folder.path(), kSmallScene), {}};
  const std::vector<std::uint64_t> expected = run(small, 0, 2);
  std::vector<std::vector<std::uint64_t>> found(2);
  std::latch together(3);
  {
    std::vector<std::jthread> threads;
    for (std::vector<std::uint64_t>& mine : found) {
      threads.emplace_back([&] {
        together.arrive_and_wait();
        mine = run(small, 0, 2);
      });
    }
    together.arrive_and_wait();
    load_plugin(tested_build() + "/lib/libsimvis_example_plugin.so");
    Simulation with_plugin = Simulation::from_string(R"(<scene>
      <element type="plate" name="PLATE" insert_at="ROOT" x="2.5"/>
      <sensor type="distance_probe" name="PROBE" insert_at="ROOT"/>
    </scene>)");
    with_plugin.step();
    CHECK(with_plugin.measured().size() == 1);
  }
  for (const std::vector<std::uint64_t>& each : found) CHECK(each == expected);
}

TEST_CASE("more threads than are allowed are an error") {
  SimulationDesc desc;
  desc.threads = 1025;
  CHECK(error_of([&] { Simulation::from_string("<scene/>", desc); }) ==
        "1025 threads are not allowed, expected 0 (as many as the machine has) to 1024");
}

}  // namespace simvis

TEST_SUITE_END();
