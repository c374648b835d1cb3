// Conditions that must not change results: the order of declarations, the rest of the scene, and earlier steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/ray_caster.h>
#include <simvis/simulation.h>
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/part_file.h"
#include "tests/support/random_room.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

// A simulation is set up about ten times slower under sanitizers: fewer orders, and only the method that does
// everything.
const std::size_t kFewerOrders = sanitized() ? 6 : 1;
const std::vector<std::string_view> kMethods =
    sanitized() ? std::vector<std::string_view>{"hybrid"}
                : std::vector<std::string_view>{"nearest", "planar", "hybrid", "raycast"};

// Each has its own light, so lights are declared in as many orders. Ball and case are transparent.
const std::vector<std::string> kParts = {
    R"(<part file="room.gltf" name="ROOM" insert_at="ROOT" up="z" pose_offset="0 0 1.5 0 0 10"/>
       <element type="light" name="ROOM_LIGHT" insert_at="ROOT" kind="directional" intensity="1.3" elevation="70"/>)",
    R"(<part file="ball.gltf" name="BALL" insert_at="ROOT" up="z" pose_offset="2 0.4 1 0 0 0"/>
       <element type="material" name="BALL_LOOK" insert_at="ROOT" part="BALL" red="0.7" opacity="0.7"/>
       <element type="light" name="BALL_LIGHT" insert_at="ROOT" kind="point" intensity="3.7" x="0.3" z="2.1"/>)",
    R"(<part file="case.gltf" name="CASE" insert_at="ROOT" up="z" pose_offset="1 -1.3 0.9 5 10 15"/>
       <element type="material" name="CASE_LOOK" insert_at="ROOT" part="CASE" green="0.6" opacity="0.6"/>
       <element type="light" name="CASE_LIGHT" insert_at="ROOT" kind="point" intensity="7.1" y="-0.3" z="2.3"/>)"};
const std::vector<std::string> kSensors = {
    R"(<sensor type="laser_scanner" name="LEVEL" insert_at="ROOT" pose_offset="0.1 0 1 0 0 3"/>)",
    R"(<sensor type="laser_scanner" name="TILTED" insert_at="ROOT" pose_offset="0 0.2 1.3 10 20 30" samples="200"
               min_angle="-180" max_angle="180"/>)",
    R"(<sensor type="laser_scanner" name="RINGS" insert_at="ROOT" pose_offset="-0.1 0.1 1.1 0 0 0" samples="91"
               vertical_samples="8" vertical_min_angle="-30" vertical_max_angle="20"/>)",
    R"(<sensor type="camera" name="CAMERA" insert_at="ROOT" pose_offset="0 0 1.2 0 5 0" width="64" height="48"
               outputs="color depth"/>)"};
constexpr const char* kNames[] = {"LEVEL", "TILTED", "RINGS", "CAMERA"};

/// All results of a sensor, bit for bit.
std::vector<float> measured(const Simulation& simulation, const std::string& name) {
  if (name == "CAMERA") {
    std::vector<float> pixels = simulation.color(name).pixels;
    const std::vector<float>& depth = simulation.depth(name).pixels;
    pixels.insert(pixels.end(), depth.begin(), depth.end());
    return pixels;
  }
  const Scan& scan = simulation.scan(name);
  std::vector<float> numbers = scan.range_m;
  numbers.insert(numbers.end(), scan.error_bound_m.begin(), scan.error_bound_m.end());
  return numbers;
}

bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && !a.empty() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

using Readings = std::map<std::string, std::vector<float>>;

Readings readings(const Simulation& simulation) {
  Readings all;
  for (const SensorInfo& sensor : simulation.sensors()) all[sensor.name] = measured(simulation, sensor.name);
  return all;
}

bool same_bytes(const Readings& a, const Readings& b) {
  return std::ranges::equal(
      a, b, [](const auto& x, const auto& y) { return x.first == y.first && same_bytes(x.second, y.second); });
}

std::string with_method(std::string sensor, std::string_view method) {
  constexpr std::string_view kScanner = "<sensor type=\"laser_scanner\"";
  if (!sensor.starts_with(kScanner)) return sensor;
  return sensor.insert(kScanner.size(), ' ' + method_attributes(method));
}

/// The files of the parts, and simulations that use them.
class Stage {
 public:
  Stage() {
    write_part(folder_ / "room.gltf", half_box_mesh({5, 4, 1.5}));
    write_part(folder_ / "ball.gltf", sphere_mesh(0.4, 24));
    write_part(folder_ / "case.gltf", half_box_mesh({0.2, 0.3, 0.4}));
  }
  Simulation make(const std::vector<std::string>& commands, std::string_view method = {}) const {
    std::string xml;
    for (const std::string& command : commands) {
      xml += (method.empty() ? command : with_method(command, method)) + "\n";
    }
    return Simulation::from_string(xml, {}, folder_.path());
  }

 private:
  TemporaryFolder folder_;
};

/// The method of a scanner in the order with this number. Over all orders, each scanner has each method.
std::string_view method_in(std::size_t order, std::size_t sensor) {
  return kMethods[(order / kFewerOrders + sensor) % std::size(kMethods)];
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

// Each of the 24 orders of the sensors, each of the 6 orders of the parts four times, with sensors before, after and
// between the parts. From order to order each scanner changes its method, and is compared with the first order in which
// it had the same one.
TEST_CASE("parts and sensors declared in any order give the same bytes") {
  const Stage stage;
  std::array<std::size_t, 4> sensors{0, 1, 2, 3};
  std::array<std::size_t, 3> parts{0, 1, 2};
  Readings first;
  std::size_t number = 0, orders = 0;
  do {
    std::vector<std::string> commands;
    for (const std::size_t part : parts) commands.push_back(kParts[part]);
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const std::size_t places[] = {commands.size(), i, std::min(2 * i, commands.size())};
      commands.insert(commands.begin() + static_cast<std::ptrdiff_t>(places[number % 3]),
                      with_method(kSensors[sensors[i]], method_in(number, sensors[i])));
    }
    std::ranges::next_permutation(parts);
    if (number++ % kFewerOrders != 0) continue;
    CAPTURE(number);
    Simulation simulation = stage.make(commands);
    simulation.step();
    for (const SensorInfo& sensor : simulation.sensors()) {
      const std::vector<float> now = measured(simulation, sensor.name);
      CHECK(same_bytes(first.emplace(sensor.name + " " + sensor.method, now).first->second, now));
    }
    ++orders;
  } while (std::ranges::next_permutation(sensors).found);
  CHECK(first.size() == 1 + 3 * std::min(std::size(kMethods), orders));
  add_line("orders of declaring 3 parts, 3 lights, 3 scanners and a camera",
           std::to_string(orders) + ", the same bytes");
}

TEST_CASE("other sensors in the scene change no byte of a sensor") {
  const Stage stage;
  for (const std::string_view method : kMethods) {
    CAPTURE(method);
    Simulation together = stage.make(joined(kParts, kSensors), method);
    together.step();
    const Readings all = readings(together);
    for (std::size_t i = 0; i < kSensors.size(); ++i) {
      CAPTURE(kNames[i]);
      Simulation alone = stage.make(joined(kParts, {kSensors[i]}), method);
      alone.step();
      CHECK(same_bytes(measured(alone, kNames[i]), all.at(kNames[i])));
      // A sensor that is off equals a missing one.
      for (const char* name : kNames) together.enable(name, name == kNames[i]);
      together.step();
      CHECK(same_bytes(measured(together, kNames[i]), all.at(kNames[i])));
    }
  }
  add_line("each of 4 sensors alone and beside the others", "the same bytes");
}

TEST_CASE("a single frame equals frame k of a run") {
  constexpr int kFrames = 12;
  const std::vector<std::string> moving = {
      kParts[0],
      R"(<element type="pose" name="ROLL" insert_at="ROOT"/>)",
      kParts[1],
      R"(<element type="visibility" name="SHOW" insert_at="ROOT"/>)",
      kParts[2],
      R"(<part file="case.gltf" name="ROBOT" insert_at="ROOT" up="z" pose_offset="0 0 -9 0 0 0"/>)",
      R"(<element type="pose" name="DRIVE" insert_at="ROBOT" z="9"/>)",
      R"(<sensor type="laser_scanner" name="LEVEL" insert_at="ROBOT" pose_offset="0.1 0 1 0 0 3"/>)",
      R"(<sensor type="laser_scanner" name="RINGS" insert_at="ROBOT" pose_offset="-0.1 0.1 1.1 0 0 0" samples="91"
                 vertical_samples="8" vertical_min_angle="-30" vertical_max_angle="20"/>)",
      R"(<sensor type="camera" name="CAMERA" insert_at="ROBOT" pose_offset="0 0 1.2 0 5 0" width="64" height="48"
                 outputs="color depth"/>)"};
  const auto set = [](Simulation& simulation, int frame) {
    simulation.set("ROLL", "yaw", 7.3 * frame);
    simulation.set("ROLL", "x", 0.03 * frame);
    simulation.set("SHOW", "visible", frame % 3 == 1 ? 0 : 1);
    simulation.set("DRIVE", "yaw", -11.9 * frame);
    simulation.set("DRIVE", "y", 0.02 * frame);
  };
  const Stage stage;
  for (const std::string_view method : kMethods) {
    CAPTURE(method);
    Simulation run = stage.make(moving, method);
    for (int frame = 0; frame < kFrames; ++frame) {
      set(run, frame);
      run.enable("RINGS", frame % 4 == 3);
      run.step();
      if (frame % 4 != 3) continue;
      CAPTURE(frame);
      Simulation alone = stage.make(moving, method);
      set(alone, frame);
      alone.step();
      CHECK(same_bytes(readings(alone), readings(run)));
    }
  }
  add_line("one frame alone and frame k of a run", "the same bytes");
}

TEST_SUITE_END();
