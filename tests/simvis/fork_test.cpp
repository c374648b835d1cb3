// A process that was forked while a simulation lives: calls throw where they would wait for threads that are not there.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <simvis/simulation.h>
#include <simvis/vector_simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr const char* kForkSensors =
    "<sensor type='camera' name='CAM' insert_at='ROOT' width='64' height='48'/>"
    "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT'/>";

/// What `work` returns in a forked process, which then ends at once; -1: it hung for 20 s, or a signal ended it.
int in_child(const std::function<int()>& work) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    int status = 99;
    try {
      status = work();
    } catch (...) {
    }
    ::_exit(status);
  }
  int status = 0;
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool is_refused(const std::function<void()>& call) {
  const std::string parent = std::to_string(::getppid());
  return error_of(call).find("was forked from process " + parent + ",") != std::string::npos;
}

TEST_CASE("in a forked process the parent's simulation and new ones are refused, and both processes go on") {
  const TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(folder.path(), kForkSensors);
  std::optional<Simulation> simulation(Simulation::load(scene));
  simulation->step();
  const std::vector<float> before = simulation->scan("SCAN").range_m;
  CHECK(in_child([&] { return is_refused([&] { simulation->step(); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] { return is_refused([&] { simulation->step_async(); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] { return is_refused([&] { simulation->finish(); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] {
          return is_refused([&] { simulation->execute("<part shape='box' name='B' insert_at='ROOT'/>"); }) ? 0 : 1;
        }) == 0);
  CHECK(in_child([&] { return is_refused([&] { simulation->scan("SCAN"); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] { return is_refused([&] { Simulation::load(scene); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] { return is_refused([&] { Simulation::from_string("<scene/>"); }) ? 0 : 1; }) == 0);
  // Neither the end of the simulation nor an assignment waits for its threads.
  CHECK(in_child([&] {
          simulation.reset();
          return 7;
        }) == 7);
  CHECK(in_child([&] {
          Simulation moved = std::move(*simulation);
          moved = Simulation(std::move(moved));
          return is_refused([&] { Simulation::load(scene); }) ? 7 : 1;
        }) == 7);
  simulation->step();
  CHECK(simulation->scan("SCAN").range_m == before);
}

TEST_CASE("in a forked process the parent's environments are refused, and end without a wait") {
  const TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(folder.path(), kForkSensors);
  SimulationDesc desc;
  desc.threads = 2;
  std::optional<VectorSimulation> vector(VectorSimulation::load(scene, 3, desc));
  vector->step();
  const std::shared_ptr<Simulation> held = vector->environment(1);
  CHECK(in_child([&] { return is_refused([&] { vector->step(); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] { return is_refused([&] { vector->output("SCAN", "range_m"); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] { return is_refused([&] { VectorSimulation::load(scene, 2); }) ? 0 : 1; }) == 0);
  CHECK(in_child([&] {
          VectorSimulation moved = std::move(*vector);
          vector.reset();
          moved = VectorSimulation(std::move(moved));
          return 7;
        }) == 7);
  vector->step();
  CHECK(held->last_frame()->index == 1);
}

TEST_CASE("a frame that was under way at the fork belongs to the parent") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kForkSensors));
  simulation.step_async();
  CHECK(in_child([&] { return is_refused([&] { simulation.finish(); }) ? 0 : 1; }) == 0);
  simulation.finish();
  CHECK(simulation.measured().size() == 2);
}

TEST_CASE("a process that is forked when no simulation lives loads its own") {
  const TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(folder.path(), kForkSensors);
  { Simulation::load(scene).step(); }
  CHECK(in_child([&] {
          Simulation simulation = Simulation::load(scene);
          simulation.step();
          return simulation.measured().size() == 2 ? 7 : 1;
        }) == 7);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
