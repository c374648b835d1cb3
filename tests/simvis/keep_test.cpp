// Measurements that a caller keeps: they neither move nor change, whatever happens to the sensor.
#include <simvis/simulation.h>

#include <doctest/doctest.h>

#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

const std::string kSensors =
    R"(<element type="pose" name="P" insert_at="ROOT"/>
       <sensor type="laser_scanner" name="S" insert_at="ROOT" samples="5" min_angle="-60" max_angle="60" intensity="on"/>
       <sensor type="camera" name="C" insert_at="ROOT" width="8" height="4" outputs="color depth"/>)";

Simulation by_the_wall() {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  return Simulation::from_string(std::string(kWallPart) + kSensors, {}, folder.path());
}

/// Numbers of a measurement at their address, and a copy of what stood there.
template <typename T>
class Seen {
 public:
  explicit Seen(const std::vector<T>& numbers) : numbers_(numbers), copy_(numbers) {}
  bool is_as_before() const { return std::vector<T>(numbers_.begin(), numbers_.end()) == copy_; }
  const T* address() const { return numbers_.data(); }

 private:
  std::span<const T> numbers_;
  std::vector<T> copy_;
};

void move(Simulation& simulation, double x) {
  simulation.set("P", "x", x);
  simulation.step();
}

TEST_CASE("a measurement that is kept stays where it is, and the next one goes elsewhere") {
  Simulation simulation = by_the_wall();
  move(simulation, 0);
  const Seen<float> ranges(simulation.scan("S").range_m), depth(simulation.depth("C").pixels);
  const Seen<double> intensity(simulation.scan("S").channel("intensity"));
  const Scan scan = simulation.scan("S");
  const Image image = simulation.depth("C");
  CHECK(simulation.scan("S").range_m.data() == ranges.address());
  move(simulation, 1);
  CHECK(ranges.is_as_before());
  CHECK(intensity.is_as_before());
  CHECK(depth.is_as_before());
  CHECK(simulation.scan("S").range_m.data() != ranges.address());
  CHECK(simulation.scan("S").range_m[2] == doctest::Approx(3));
  CHECK(simulation.depth("C").pixels[0] == doctest::Approx(3));
}

TEST_CASE("memory that no view keeps any more is used again") {
  Simulation simulation = by_the_wall();
  std::vector<const float*> addresses;
  Scan last;
  for (int frame = 0; frame < 8; ++frame) {
    move(simulation, 0.1 * frame);
    last = simulation.scan("S");
    addresses.push_back(simulation.scan("S").range_m.data());
  }
  for (std::size_t frame = 4; frame < addresses.size(); ++frame) CHECK(addresses[frame] == addresses[frame - 2]);
}

TEST_CASE("a queue of copies takes memory, and leaves one array behind when it is empty") {
  constexpr std::size_t kNumbers = 6, kBytes = kNumbers * sizeof(float);
  SharedArray<float> measured;
  std::vector<SharedArray<float>> queue;
  for (int frame = 0; frame < 10; ++frame) {
    measured.overwrite().assign(kNumbers, static_cast<float>(frame));
    queue.push_back(measured);
  }
  CHECK(measured.held_bytes() == 9 * kBytes);
  for (int frame = 0; frame < 10; ++frame) {
    CHECK(queue[static_cast<std::size_t>(frame)] == std::vector<float>(kNumbers, static_cast<float>(frame)));
  }
  queue = {measured};
  measured.overwrite().assign(kNumbers, 10);  // one of those that are free is used, and the others are gone
  CHECK(measured.held_bytes() == kBytes);
  queue.clear();
  for (int frame = 0; frame < 3; ++frame) measured.overwrite().assign(kNumbers, 11);
  CHECK(measured.held_bytes() <= kBytes);
}

TEST_CASE("memory of a queue that was emptied is freed at the next measurement, though no caller holds that one") {
  SharedArray<float> measured;
  std::vector<SharedArray<float>> queue;
  for (int frame = 0; frame < 10; ++frame) {
    measured.overwrite().assign(6, static_cast<float>(frame));
    queue.push_back(measured);
  }
  queue.clear();
  measured.overwrite();
  CHECK(measured.held_bytes() == 6 * sizeof(float));
}

TEST_CASE("numbers that are edited are copied if a copy of them exists, and not otherwise") {
  SharedArray<float> mine{1, 2, 3};
  const float* const address = mine.data();
  mine.edit()[0] = 4;
  CHECK(mine.data() == address);
  const SharedArray<float> held = mine;
  CHECK(held.data() == address);
  mine.edit()[1] = 5;
  CHECK(mine.data() != address);
  CHECK(mine == std::vector<float>{4, 5, 3});
  CHECK(held == std::vector<float>{4, 2, 3});
}

TEST_CASE("memory that is used again is not cleared before the sensor writes to it") {
  SharedArray<float> measured;
  std::vector<SharedArray<float>> queue;
  for (int frame = 0; frame < 3; ++frame) {
    measured.overwrite().assign(6, static_cast<float>(frame));
    queue = {measured};
  }
  CHECK(measured.overwrite() == std::vector<float>(6, 1));
}

TEST_CASE("a kept measurement outlives its sensor and its simulation") {
  std::optional<Simulation> simulation = by_the_wall();
  move(*simulation, 0);
  const Seen<float> first(simulation->scan("S").range_m);
  const Scan of_first = simulation->scan("S");
  simulation->execute(R"(<remove name="S"/>)");
  CHECK(first.is_as_before());
  const Seen<float> second(simulation->depth("C").pixels);
  const Image of_second = simulation->depth("C");
  simulation.reset();
  CHECK(first.is_as_before());
  CHECK(second.is_as_before());
}

TEST_CASE("a sensor keeps its measurement through a request that fails and through frames in which it is not due") {
  Simulation simulation = by_the_wall();
  move(simulation, 0);
  const std::vector<float> ranges = simulation.scan("S").range_m;
  const Scan kept = simulation.scan("S");
  CHECK_FALSE(error_of([&] { simulation.execute("<remove name=\"NOBODY\"/>"); }).empty());
  CHECK(simulation.scan("S").range_m == ranges);
  simulation.enable("S", false);
  move(simulation, 1);
  CHECK(simulation.scan("S").range_m == ranges);
}

TEST_CASE("a scanner that cannot keep its tolerance has its last measurement again") {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  const std::string scanner =
      R"(<element type="pose" name="P" insert_at="ROOT"/>
         <sensor type="laser_scanner" name="S" insert_at="ROOT" samples="5" min_angle="-5" max_angle="5" range_max="500"
                 method="hybrid" max_error_m="1e-6"/>)";
  Simulation simulation = Simulation::from_string(std::string(kWallPart) + scanner, {}, folder.path());
  simulation.step();
  const Seen<float> ranges(simulation.scan("S").range_m);
  const Scan kept = simulation.scan("S");
  simulation.set("P", "x", -100);  // half a unit in the last place of a range above 64 m is 4e-6 m
  CHECK(contains(error_of([&] { simulation.step(); }), "cannot be kept by any method"));
  CHECK(ranges.is_as_before());
  CHECK(simulation.scan("S").range_m.data() == ranges.address());
}

TEST_CASE("kept measurements may be released by another thread while the simulation steps") {
  Simulation simulation = by_the_wall();
  for (int frame = 0; frame < 50; ++frame) {
    move(simulation, 0.01 * frame);
    std::thread([kept = simulation.scan("S")] { CHECK(kept.range_m.size() == 5); }).detach();
  }
  CHECK(simulation.scan("S").range_m.size() == 5);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
