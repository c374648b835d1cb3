// Measurements that a caller keeps: they neither move nor change, whatever happens to the sensor.
#include <simvis/simulation.h>

#include <doctest/doctest.h>

#include <optional>
#include <thread>
#include <vector>

#include "simvis/kept_measurements.h"
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

/// A camera of the library's type that shows the number of its last frame. It can fail between its two images.
class CountingCamera : public Sensor {
 public:
  static constexpr std::size_t kBytes = 2 * 6 * sizeof(float);

  void measure(bool fails = false) {
    ++frame_;
    fill(color_);
    if (fails) throw InputError("no depth");
    fill(depth_);
  }
  void plan(const glm::dmat4&, const DrawList&, FramePlan&) override {}
  void collect(const FrameTime&, const FramePlan&, std::span<const PassResult>) override {}
  const Image* color() const override { return &color_; }
  const Image* depth() const override { return &depth_; }
  void write(OutputSink& sink) const override { sink.picture("", &color_, &depth_); }
  std::string method() const override { return "counts"; }

 private:
  void fill(Image& image) const {
    image.pixels.resize(6);
    std::ranges::fill(image.pixels, static_cast<float>(frame_));
  }
  int frame_ = 0;
  Image color_{3, 2, 1, {}}, depth_{3, 2, 1, {}};
};

struct CountingView {
  CountingView() {
    sensor.type = "camera";
    sensor.sensor = std::make_unique<CountingCamera>();
  }
  CountingCamera& camera() { return static_cast<CountingCamera&>(*sensor.sensor); }
  void measure(bool fails = false) {
    KeptMeasurements::Overwriting overwriting(kept, sensor);
    camera().measure(fails);
    overwriting.done();
  }
  BuiltSensor sensor;
  KeptMeasurements kept;
};

void move(Simulation& simulation, double x) {
  simulation.set("P", "x", x);
  simulation.step();
}

TEST_CASE("a measurement that is kept stays where it is, and the next one goes elsewhere") {
  Simulation simulation = by_the_wall();
  move(simulation, 0);
  const Seen<float> ranges(simulation.scan("S").range_m), depth(simulation.depth("C").pixels);
  const Seen<double> intensity(simulation.scan("S").channel("intensity")->values);
  const std::shared_ptr<const void> scan = simulation.keep("S"), images = simulation.keep("C");
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
  std::shared_ptr<const void> last;
  for (int frame = 0; frame < 8; ++frame) {
    move(simulation, 0.1 * frame);
    last = simulation.keep("S");
    addresses.push_back(simulation.scan("S").range_m.data());
  }
  for (std::size_t frame = 4; frame < addresses.size(); ++frame) CHECK(addresses[frame] == addresses[frame - 2]);
}

TEST_CASE("a queue of kept measurements takes their memory, and leaves one measurement behind when it is empty") {
  CountingView view;
  std::vector<std::shared_ptr<const void>> queue;
  for (int frame = 0; frame < 10; ++frame) {
    view.measure();
    queue.push_back(view.kept.keep(view.sensor));
  }
  CHECK(view.kept.bytes() == 9 * CountingCamera::kBytes);  // the last one is in the sensor
  queue.clear();
  view.measure();
  CHECK(view.kept.bytes() == CountingCamera::kBytes);
  for (int frame = 0; frame < 3; ++frame) view.measure();
  CHECK(view.kept.bytes() == CountingCamera::kBytes);
}

TEST_CASE("memory that is used again is not cleared before the sensor writes to it") {
  CountingView view;
  std::vector<std::shared_ptr<const void>> queue;
  for (int frame = 0; frame < 3; ++frame) {
    view.measure();
    queue = {view.kept.keep(view.sensor)};
  }
  const KeptMeasurements::Overwriting overwriting(view.kept, view.sensor);
  CHECK(view.camera().depth()->pixels == std::vector<float>(6, 2));
}

TEST_CASE("a sensor that fails between two images has the last measurement again, whole and in its place") {
  CountingView view;
  view.measure();
  const Seen<float> color(view.camera().color()->pixels), depth(view.camera().depth()->pixels);
  const std::shared_ptr<const void> kept = view.kept.keep(view.sensor);
  CHECK(error_of([&] { view.measure(true); }) == "no depth");
  CHECK(color.is_as_before());
  CHECK(view.camera().color()->pixels.data() == color.address());
  CHECK(view.camera().depth()->pixels.data() == depth.address());
  view.measure();
  CHECK(view.camera().depth()->pixels[0] == 3);
  CHECK(color.is_as_before());
  CHECK(depth.is_as_before());
}

TEST_CASE("a kept measurement outlives its sensor and its simulation") {
  std::optional<Simulation> simulation = by_the_wall();
  move(*simulation, 0);
  const Seen<float> first(simulation->scan("S").range_m);
  const std::shared_ptr<const void> of_first = simulation->keep("S");
  simulation->execute(R"(<remove name="S"/>)");
  CHECK(first.is_as_before());
  const Seen<float> second(simulation->depth("C").pixels);
  const std::shared_ptr<const void> of_second = simulation->keep("C");
  simulation.reset();
  CHECK(first.is_as_before());
  CHECK(second.is_as_before());
}

TEST_CASE("a sensor keeps its measurement through a request that fails and through frames in which it is not due") {
  Simulation simulation = by_the_wall();
  move(simulation, 0);
  const std::vector<float> ranges = simulation.scan("S").range_m;
  const std::shared_ptr<const void> kept = simulation.keep("S");
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
  const std::shared_ptr<const void> kept = simulation.keep("S");
  simulation.set("P", "x", -100);  // half a unit in the last place of a range above 64 m is 4e-6 m
  CHECK(contains(error_of([&] { simulation.step(); }), "cannot be kept by any method"));
  CHECK(ranges.is_as_before());
  CHECK(simulation.scan("S").range_m.data() == ranges.address());
}

TEST_CASE("kept measurements may be released by another thread while the simulation steps") {
  Simulation simulation = by_the_wall();
  for (int frame = 0; frame < 50; ++frame) {
    move(simulation, 0.01 * frame);
    std::thread([kept = simulation.keep("S")] {}).detach();
  }
  CHECK(simulation.scan("S").range_m.size() == 5);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
