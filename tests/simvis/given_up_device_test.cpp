// Devices that are lost or do not end their work: the exception, what is kept, and the simulation that is loaded next.
// tests/fault_layer makes the calls fail.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "engine/vulkan/fence_wait.h"
#include "tests/support/error_of.h"
#include "tests/support/faulty_devices.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// The picture takes the device tens of milliseconds, so it is still drawn when a wait for it fails at once.
constexpr const char* kDrawnSensors =
    "<sensor type='camera' name='CAM' insert_at='ROOT' width='320' height='240' supersampling='4' "
    "outputs='color depth'/>"
    "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' method='planar' samples='91'/>";

class FaultyScene {
 public:
  FaultyScene() : file_(write_wall_scene(folder_.path(), kDrawnSensors)) {}
  Simulation load(bool instrumented = false) const {
    SimulationDesc desc;
    desc.device.cache_dir = (folder_ / "cache").string();
    desc.device.instrumented = instrumented;
    return Simulation::load(file_, desc);
  }
  const std::filesystem::path& file() const { return file_; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path file_;
};

std::vector<float> measured_by(Simulation& simulation) {
  simulation.step();
  std::vector<float> all = simulation.color("CAM").pixels;
  all.insert(all.end(), simulation.scan("SCAN").range_m.begin(), simulation.scan("SCAN").range_m.end());
  return all;
}

/// The message of the MachineError that something throws; empty: it throws none.
template <typename Action>
std::string machine_failure_of(const Action& action) {
  try {
    action();
  } catch (const MachineError& error) {
    return error.what();
  }
  return {};
}

/// The message of the first of three steps that fails; empty: none does.
std::string first_failure(Simulation& simulation) {
  for (int step = 0; step < 3; ++step) {
    const std::string error = machine_failure_of([&] { simulation.step(); });
    if (!error.empty()) return error;
  }
  return {};
}

struct MadeFault {
  const char *function, *result;
  bool lasts;
};

TEST_CASE("a device that fails is given up, nothing in use is destroyed, and the next simulation works") {
  const FaultyScene scene;
  std::vector<float> expected;
  {
    Simulation simulation = scene.load();
    expected = measured_by(simulation);
  }
  const FaultyDevices devices;
  std::size_t tried = 0;
  for (const MadeFault& fault : {MadeFault{"vkWaitForFences", "VK_ERROR_DEVICE_LOST", false},
                                 {"vkWaitForFences", "VK_ERROR_OUT_OF_HOST_MEMORY", false},
                                 {"vkWaitForFences", "VK_TIMEOUT", true},
                                 {"vkQueueSubmit", "VK_ERROR_DEVICE_LOST", false},
                                 {"vkGetQueryPoolResults", "VK_ERROR_DEVICE_LOST", false}}) {
    for (int call = 1; call <= 2; ++call, ++tried) {
      const std::string text =
          std::string(fault.function) + ":" + std::to_string(call) + (fault.lasts ? "+:" : ":") + fault.result;
      CAPTURE(text);
      const bool instrumented = fault.function == std::string("vkGetQueryPoolResults");
      devices.fault(text, fault.lasts ? "0.02" : "600");
      std::optional<Simulation> failing(scene.load(instrumented));
      Simulation neighbour = scene.load(instrumented);
      CHECK(devices.open() == 1);
      const std::string error = first_failure(*failing);
      CHECK(error.find(std::string(fault.function) + ": " + fault.result) != std::string::npos);
      CHECK(error.find("was given up") != std::string::npos);
      CHECK((error.find("the drawing of a frame on ") != std::string::npos) == !instrumented);
      CHECK((error.find("0.02 s (SIMVIS_MAX_WAIT_S)") != std::string::npos) == fault.lasts);
      // The device stays given up, for all who share it.
      CHECK(machine_failure_of([&] { failing->step(); }) == error);
      CHECK(machine_failure_of([&] { neighbour.step(); }) == error);

      // The new simulation is loaded while the failed ones live.
      devices.none();
      Simulation next = scene.load(instrumented);
      CHECK(devices.open() == 2);
      CHECK(measured_by(next) == expected);
      failing.reset();
      CHECK(measured_by(next) == expected);
    }
  }
  CHECK(tried == 10);
}

// A driver may report VK_TIMEOUT once, or need longer than the limit: what is kept is destroyed when it has ended.
TEST_CASE("a device that was too slow is closed when its work has ended") {
  const FaultyScene scene;
  const FaultyDevices devices;
  devices.fault("vkWaitForFences:1+:VK_TIMEOUT", "0.02");
  {
    Simulation simulation = scene.load();
    CHECK(first_failure(simulation).find("VK_TIMEOUT") != std::string::npos);
  }
  {
    // Destroyed with a frame under way, which is not waited for beyond the limit.
    Simulation simulation = scene.load();
    simulation.step_async();
  }
  devices.none();
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  std::size_t open = 0;
  do {
    const Simulation simulation = scene.load();
    open = devices.open();
  } while (open > 1 && std::chrono::steady_clock::now() < patience);
  CHECK(open == 1);
}

TEST_CASE("a wait that times out once goes on") {
  const FaultyScene scene;
  const FaultyDevices devices;
  devices.fault("vkWaitForFences:1:VK_TIMEOUT", "600");
  Simulation simulation = scene.load();
  CHECK(first_failure(simulation).empty());
}

TEST_CASE("memory that is short for a submission ends the frame and not the device") {
  const FaultyScene scene;
  const FaultyDevices devices;
  devices.fault("vkQueueSubmit:2:VK_ERROR_OUT_OF_DEVICE_MEMORY", "600");
  Simulation simulation = scene.load();
  const std::vector<float> expected = measured_by(simulation);
  const std::string error = machine_failure_of([&] { simulation.step(); });
  CHECK(error.find("vkQueueSubmit: VK_ERROR_OUT_OF_DEVICE_MEMORY") != std::string::npos);
  CHECK(error.find("given up") == std::string::npos);
  CHECK(measured_by(simulation) == expected);
}

TEST_CASE("the limit of waits is read from the environment") {
  CHECK(max_wait() == kMaxWait);
  const FaultyDevices devices;
  devices.fault("vkQueueSubmit:1:VK_TIMEOUT", "0.02");
  CHECK(max_wait() == std::chrono::milliseconds(20));
  for (const char* wrong : {"", "0", "-1", "1e7", "nan", "inf", "5 s", "0.0001"}) {
    ::setenv("SIMVIS_MAX_WAIT_S", wrong, 1);
    CHECK(error_of([] { max_wait(); }).find("SIMVIS_MAX_WAIT_S") != std::string::npos);
  }
}

TEST_CASE("simvis-run ends with exit code 1 when its device is lost or hangs") {
  const FaultyScene scene;
  const TemporaryFolder out;
  for (const std::string fault : {"vkQueueSubmit:2:VK_ERROR_DEVICE_LOST", "vkWaitForFences:2+:VK_TIMEOUT"}) {
    CAPTURE(fault);
    const ProcessResult result =
        run_simvis({scene.file().string(), "--frames", "3", "--out", (out / "out").string()},
                   {"VK_ADD_LAYER_PATH=" + kFaultLayers, std::string("VK_INSTANCE_LAYERS=") + kFaultLayer,
                    "SIMVIS_FAULT=" + fault, "SIMVIS_MAX_WAIT_S=0.02"});
    CHECK(result.exit_code == 1);
    CHECK(result.err.find("was given up") != std::string::npos);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
