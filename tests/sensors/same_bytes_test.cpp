// What a sensor measures does not depend on how its scene is run: one table over all types of sensors, each with all
// the noise that its table of attributes has, and all ways to run a scene.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/device.h>
#include <simvis/sensor.h>
#include <simvis/simulation.h>
#include "scenegraph/array_bytes.h"
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

enum class Stepping : std::uint8_t { at_once, in_two_parts, read_between };

/// A way to run the scene of a sensor.
struct Way {
  const char* name;
  Surroundings around{};
  Stepping stepping = Stepping::at_once;
};

SimulationDesc on_threads(unsigned threads) {
  SimulationDesc desc;
  desc.threads = threads;
  return desc;
}

const std::string kOtherSensors =
    "<sensor type='psd' name='A' insert_at='ROOT' noise='0.01'/>"
    "<sensor type='camera' name='Z' insert_at='ROOT' width='8' height='6'/>"
    "<sensor type='laser_scanner' name='Y' insert_at='ROOT' samples='5' method='planar'/>";

/// All are compared with the first.
const std::vector<Way>& ways() {
  static const std::vector<Way> all = {
      {"on one thread", {.desc = on_threads(1)}},
      {"on one thread again", {.desc = on_threads(1)}},
      {"on two threads", {.desc = on_threads(2)}},
      {"on seven threads", {.desc = on_threads(7)}},
      {"behind other sensors", {.before = kOtherSensors}},
      {"in front of other sensors", {.after = kOtherSensors}},
      {"with what only people see", {.after = "<element type='frame_axes' name='AXES' insert_at='ROOT'/>"}},
      {"by step_async() and finish()", {}, Stepping::in_two_parts},
      {"read after each frame, with copies that stay", {}, Stepping::read_between}};
  return all;
}

// A drift that tends to a mean needs a second attribute.
bool is_noise(std::string_view attribute) {
  if (attribute.find("dynamic_bias") != attribute.npos) return false;
  return attribute == "noise" || attribute.ends_with("stddev") || attribute.ends_with("_noise") ||
         attribute.ends_with("noise_density") || attribute.ends_with("random_walk");
}

/// All noise of a type; empty: it has none. That of paths of light is a wanted error, see every_sensor.h.
std::string noise_of(const SensorType& type) {
  std::string attributes;
  if (type.name == "camera") return attributes;
  for (const AttributeSpec& each : all_attributes(type)) {
    if (each.kind == AttributeKind::number && is_noise(each.name)) attributes += std::string(each.name) + "='0.01' ";
  }
  if (attributes.find("orientation_") != attributes.npos) attributes += "orientation='on' ";
  return attributes;
}

/// All that a pixel of an event camera does, beside what every_sensor.h has.
const std::string kEvents =
    "width='16' height='10' threshold_noise='0.03' refractory='0.002' leak='2' brownian='0.01' brownian_dark='0.02' "
    "shot_noise='40' latency='0.001' latency_noise='0.0005'";

/// Names, shapes and numbers of all arrays, of each frame.
std::vector<std::string> bytes_of(const SensorType& type, const std::string& attributes, const Way& way) {
  Simulation simulation = scene_of(type.name, attributes, way.around);
  const std::vector<ElementDescriptor>& elements = simulation.parameters().elements();
  const bool moves = std::ranges::count(elements, "MOVE", &ElementDescriptor::name) == 1;
  std::vector<Measurement> kept;
  std::vector<std::string> frames;
  for (int frame = 0; frame < 3; ++frame) {
    if (moves) simulation.set("MOVE", "x", 0.1 * frame);
    if (way.stepping == Stepping::in_two_parts) {
      simulation.step_async();
      simulation.finish();
    } else {
      simulation.step();
    }
    const Measurement measurement = simulation.measurement(kSensor);
    if (way.stepping == Stepping::read_between) kept.push_back(measurement);
    std::string& bytes = frames.emplace_back();
    for (const MeasuredArray& each : measurement.arrays) {
      bytes += each.name + " " + to_string(each.shape) + "\n";
      const std::vector<std::uint8_t> numbers = own_bytes(each);
      bytes.append(numbers.begin(), numbers.end());
    }
  }
  return frames;
}

TEST_CASE("each sensor measures the same bytes in all ways to run its scene, with noise and without") {
  const Device shared;  // all simulations use it, which is not opened again for each
  std::size_t rows = 0, noisy = 0;
  for (const SensorType* type : sensor_types()) {
    CAPTURE(type->name);
    std::vector<std::string> sets = attributes_of(type->name);
    const std::string noise = noise_of(*type), noisy_set = sets.back() + " " + noise;
    if (!noise.empty()) sets.push_back(noisy_set);
    if (type->name == "event_camera") sets.push_back(kEvents);
    for (const std::string& attributes : sets) {
      CAPTURE(attributes);
      const std::vector<std::string> expected = bytes_of(*type, attributes, ways().front());
      for (const std::string& bytes : expected) CHECK_FALSE(bytes.empty());
      for (std::size_t way = 1; way < ways().size(); ++way) {
        CAPTURE(ways()[way].name);
        CHECK(bytes_of(*type, attributes, ways()[way]) == expected);
      }
      ++rows;
    }
    if (noise.empty()) continue;
    // The noise is there: another seed gives other bytes.
    Way seeded;
    seeded.around.desc.seed = 8;
    CHECK(bytes_of(*type, noisy_set, seeded) != bytes_of(*type, noisy_set, ways().front()));
    ++noisy;
  }
  CHECK(rows > 40);
  CHECK(noisy > 10);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
