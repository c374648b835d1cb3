// A scene gives the same bytes on other machines and in other builds: compared with literal hashes.
//
// Draw lists. Everything that comes from files goes into the hash to the bit: meshes, textures, materials, structure.
// So do values that are computed in double and rounded to float32 once: another libm, or a compiler that contracts a *
// b + c, deviates by about 1e-16, which changes one such number in 10^8. Transforms and directions of lights stay
// double and are rounded to 1e-6 for the hash: a deviation of 1e-16 times several metres changes one number in 10^9.
//
// Scans. Ranges go in to the bit, error bounds rounded to 1e-6 m: the bound of a cast beam is the small difference
// between its range in double and in float32, and shows every 1e-16. Cast ranges do not depend on the Vulkan device:
// one hash for all. Rendered ranges are the driver's float32 arithmetic: one hash for each driver that is known here.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "engine/base/fnv1a.h"

TEST_SUITE_BEGIN("simvis");

using namespace simvis;

namespace {

// The expected hashes. After an intended change, copy the values from the message of the failing check.

struct DrawListHash {
  const char *scene, *trajectory;
  std::uint64_t hash;
};
constexpr DrawListHash kDrawLists[] = {
    {"marvin", "drive.csv", 0x1c8ff897666c1467},
    {"ravon", "drive.csv", 0x73fdfa547aa09a72},
    {"arm", "reach.csv", 0xcb13288443c746ed},
};

/// The three scanners of marvin, by method.
struct ScanHash {
  std::string_view device, driver, method;  ///< empty: any
  std::uint64_t hash;
};
constexpr std::string_view kDevice = "llvmpipe (LLVM 15.0.6, 256 bits)", kDriver = "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)";
constexpr ScanHash kScans[] = {
    {kDevice, kDriver, "nearest", 0x39cf15241d8f566d},
    {kDevice, kDriver, "planar", 0xeb749b6e0849e51b},
    {kDevice, kDriver, "hybrid", 0x4b4f327459aa0345},
    {{}, {}, "raycast", 0xad5a17f77265b4d5},
};

/// Of a drive at 15 Hz.
constexpr int kComparedFrames[] = {0, 37, 151};
constexpr double kRate_hz = 15;

class Hash {
 public:
  template <typename T>
  void add(const std::vector<T>& values) {
    value_ = fnv1a(values.data(), values.size() * sizeof(T), value_);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = kFnv1aStart;
};

std::string hex(std::uint64_t hash) {
  char text[32];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::string advice(const std::string& what, std::uint64_t found, const std::string& table) {
  return what + " now hash to " + hex(found) + ". If what changed them was meant to, write that into " + table +
         " of tests/determinism_test.cpp; if not, find out what did";
}

double rounded(double value) { return static_cast<double>(std::llround(value * 1e6)); }

/// Whole micrometres; -1 for infinite values.
std::vector<std::int64_t> in_micrometres(const std::vector<float>& lengths_m) {
  std::vector<std::int64_t> whole;
  for (const float length_m : lengths_m) {
    whole.push_back(std::isinf(length_m) ? -1 : std::llround(length_m * 1e6));
  }
  return whole;
}

/// The same list with its numbers in double as multiples of 1e-6.
DrawList rounded(DrawList list) {
  for (glm::dmat4& m : list.world_from_node) {
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) m[c][r] = rounded(m[c][r]);
    }
  }
  for (LightItem& item : list.lights) {
    for (int axis = 0; axis < 3; ++axis) item.light.direction[axis] = rounded(item.light.direction[axis]);
  }
  return list;
}

std::filesystem::path scene_file(const std::string& scene) {
  return std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes" / scene / (scene + ".xml");
}

void drive(Simulation& simulation, const Trajectory& trajectory, int frame) {
  trajectory.apply(frame / kRate_hz, simulation.parameters());
  simulation.step();
}

}  // namespace

TEST_CASE("draw lists of the scenes that come with SimVis") {
  for (const DrawListHash& expected : kDrawLists) {
    Simulation simulation = Simulation::load(scene_file(expected.scene));
    for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
    const Trajectory trajectory(scene_file(expected.scene).parent_path() / expected.trajectory,
                                simulation.parameters());
    Hash hash;
    for (const int frame : kComparedFrames) {
      drive(simulation, trajectory, frame);
      hash.add(std::vector{content_hash(rounded(simulation.diagnostics().draw_list()))});
    }
    CHECK_MESSAGE(hash.value() == expected.hash,
                  advice("the draw lists of " + std::string(expected.scene), hash.value(), "kDrawLists"));
  }
}

TEST_CASE("scans of marvin by each method") {
  for (const ScanHash& expected : kScans) {
    const std::string method(expected.method);
    SimulationDesc desc;
    desc.overrides = {{"laser_scanner", "method", method, "this test"}};
    // So that it renders, and casts.
    if (method == "hybrid") desc.overrides.push_back({"laser_scanner", "max_error_rel", "1e-4", "this test"});
    Simulation simulation = Simulation::load(scene_file("marvin"), desc);
    for (const SensorInfo& sensor : simulation.sensors()) {
      simulation.enable(sensor.name, sensor.type == "laser_scanner");
    }
    const Trajectory trajectory(scene_file("marvin").parent_path() / "drive.csv", simulation.parameters());
    Hash hash;
    for (const int frame : kComparedFrames) {
      drive(simulation, trajectory, frame);
      for (const std::string& name : simulation.measured()) {
        const Scan& scan = simulation.scan(name);
        hash.add(scan.range_m.numbers());
        hash.add(in_micrometres(scan.error_bound_m));
      }
    }
    const DeviceInfo* const opened = simulation.diagnostics().device();
    const DeviceInfo device = opened == nullptr ? DeviceInfo() : *opened;  // rays need none
    const std::string found = "marvin's scans by " + method + " on " + device.name + ", " + device.driver;
    if (!expected.device.empty() && (device.name != expected.device || device.driver != expected.driver)) {
      MESSAGE(found << " hash to " << hex(hash.value()) << ". No hash is known for this driver: not compared");
      continue;
    }
    CHECK_MESSAGE(hash.value() == expected.hash, advice(found, hash.value(), "kScans"));
  }
}

TEST_SUITE_END();
