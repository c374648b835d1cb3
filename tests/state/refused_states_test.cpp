// States that are refused change nothing: what the simulation has, also beside its state, stays.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/reading_sensor.h>
#include <simvis/scan.h>
#include <simvis/simulation.h>
#include <simvis/state_archive.h>
#include "elements/sensed_physics.h"
#include "sensors/camera/camera_moment.h"
#include "sensors/event_camera/event_pixels.h"
#include "sensors/sensor_state.h"
#include "simvis/built_scene.h"
#include "tests/state/saved_state.h"
#include "tests/support/error_of.h"
#include "tests/support/moving_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

const std::string kBoxes =
    kPhysics + ground() + body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.4 0 0 0'", "mass='1'") +
    "<sensor type='imu' name='IMU' insert_at='BOX'/><sensor type='odometry' name='ODOM' insert_at='BOX' delay='0.1'/>";

void do_nothing(Simulation& /*simulation*/, std::uint64_t /*frame*/) {}

// Behind the title of an object and the size of its values.
std::size_t values_of(const std::string& state, const std::string& title) {
  const std::size_t at = state.find(title);
  REQUIRE(at != state.npos);
  return at + title.size() + sizeof(std::uint64_t);
}

template <typename Number>
std::string with(std::string state, std::size_t at, Number number) {
  std::memcpy(state.data() + at, &number, sizeof number);
  return with_right_hash(std::move(state));
}

// Its last values are wrong, so that all others have been read before.
std::string wrong_at_the_end(const std::string& state) {
  return with(state, values_of(state, "the motion that sensors follow") - sizeof(std::uint64_t), std::uint64_t{3});
}

TEST_CASE("a refused state leaves what has been measured and the pulls that are under way") {
  const auto pulled = [] {
    Simulation simulation = Simulation::from_string(kBoxes);
    make_frames(simulation, do_nothing, 2);
    const auto physics = find_physics(built_scene(simulation).scene);
    const std::size_t box = physics->drawn_bodies().size() - 1;
    physics->pull(1, BodyPull{.body = box, .body_m = {0, 0, 0}, .target_m = {0.5, 0, 1}});
    make_frames(simulation, do_nothing, 4);
    return simulation;
  };
  Simulation expected = pulled();
  const std::vector<MadeFrame> after = make_frames(expected, do_nothing, 5);
  Simulation simulation = pulled();
  const std::string state = simulation.save_state();
  const std::string foreign = Simulation::from_string(kPhysics + ground()).save_state();
  REQUIRE(simulation.measured().size() == 2);
  for (const std::string& refused : {foreign, wrong_at_the_end(state)}) {
    CHECK_THROWS_AS(simulation.restore_state(refused), InputError);
    CHECK(simulation.measured().size() == 2);
    CHECK(simulation.save_state() == state);
  }
  CHECK(make_frames(simulation, do_nothing, 5) == after);
  simulation.restore_state(state);
  CHECK(simulation.measured().empty());
  CHECK(make_frames(simulation, do_nothing, 5) != after);  // the pull has ended
}

TEST_CASE("an exploded simulation cannot be saved, keeps its failure, and goes on from an earlier state") {
  const std::string xml = kPhysics +
                          body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 1 0 0 0'", "mass='1'") +
                          "<element type='force' name='FORCE' insert_at='BOX'/>";
  Simulation simulation = Simulation::from_string(xml);
  make_frames(simulation, do_nothing, 2);
  const std::string state = simulation.save_state();
  const std::vector<MadeFrame> after = make_frames(simulation, do_nothing, 3);
  simulation.set("FORCE", "force_x", 1e9);
  const auto failure_of_step = [&]() -> std::string {
    try {
      simulation.step();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const std::string failure = failure_of_step();
  REQUIRE(contains(failure, "has exploded"));
  const std::string refusal = error_of([&] { static_cast<void>(simulation.save_state()); });
  CHECK(contains(refusal, "the state of element \"PHYSICS\" cannot be saved: "));
  CHECK(contains(refusal, "has exploded"));
  CHECK_THROWS_AS(simulation.restore_state(wrong_at_the_end(state)), InputError);
  CHECK(failure_of_step() == failure);
  simulation.restore_state(state);
  CHECK(make_frames(simulation, do_nothing, 3) == after);
}

TEST_CASE("clocks that no run has are refused, or end soon") {
  Simulation simulation = Simulation::from_string(kBoxes);
  make_frames(simulation, do_nothing, 6);
  const std::string state = simulation.save_state();
  constexpr std::int64_t kNumbers[] = {std::numeric_limits<std::int64_t>::min(), -1, std::int64_t{1} << 62};
  const std::size_t clock = values_of(state, "the clock");
  constexpr std::size_t kStretched = 4 * sizeof(std::uint64_t);  // behind made, last, start and origin
  CHECK_THROWS_AS(simulation.restore_state(with(state, clock + kStretched, std::uint8_t{1})), InputError);
  for (const std::size_t member : {1, 2, 3}) {
    for (const std::int64_t number : kNumbers) {
      CHECK_THROWS_AS(simulation.restore_state(with(state, clock + 8 * member, number)), InputError);
    }
  }
  // Each time in the state, of the clock, physics and sensors, and what follows it: what is left of physics.
  const std::int64_t last_ns = simulation.last_frame()->time_ns;
  const std::string wanted(reinterpret_cast<const char*>(&last_ns), sizeof last_ns);
  int found = 0;
  for (std::size_t at = clock; (at = state.find(wanted, at)) != state.npos; at += sizeof last_ns) {
    for (const std::size_t behind : {0, 8}) {
      for (const std::int64_t number : kNumbers) {
        CAPTURE(at);
        try {
          simulation.restore_state(with(state, at + behind, number));
          simulation.step();
        } catch (const Error&) {
        }
        simulation.restore_state(state);
      }
    }
    ++found;
  }
  CHECK(found >= 6);
}

TEST_CASE("a refused number of constraints leaves the constraints of a new simulation") {
  const TemporaryFolder folder;
  write_equalities(folder.path());
  const auto load = [&] { return Simulation::from_string(kEqualities, {}, folder.path()); };
  Simulation first = load();
  make_frames(first, do_nothing, 3);
  const std::string state = first.save_state();
  const std::vector<MadeFrame> after = make_frames(first, do_nothing, 5);
  Simulation simulation = load();
  const std::size_t physics = values_of(state, "element \"PHYSICS\"");
  int refused = 0;
  for (std::size_t at = physics; at < physics + 96; ++at) {
    try {
      simulation.restore_state(with(state, at, static_cast<std::uint8_t>(state[at] ^ 0x40)));
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused > 40);
  simulation.restore_state(state);
  CHECK(make_frames(simulation, do_nothing, 5) == after);
  Simulation unused = load();
  CHECK_THROWS_AS(unused.restore_state(wrong_at_the_end(state)), InputError);
  unused.restore_state(state);
  CHECK(make_frames(unused, do_nothing, 5) == after);
}

// A reference far from the light makes an event for each threshold in between.
TEST_CASE("references of event cameras that neither light nor leaks can leave are refused") {
  const auto is_taken = [](double leak_hz, double reference, std::int64_t time_ns) {
    EventModelDesc desc;
    desc.refractory_s = 0.01;
    desc.leak_hz = leak_hz;
    EventPixels pixels(desc, 1, 0, "EVENTS");
    pixels.begin(0, 1);
    StateArchive written;
    pixels.archive(written, time_ns);
    std::string bytes = written.bytes();
    std::memcpy(bytes.data(), &reference, sizeof reference);  // the first number
    StateArchive state(bytes);
    try {
      pixels.archive(state, time_ns);
    } catch (const InputError&) {
      return false;
    }
    return true;
  };
  constexpr std::int64_t kTime_ns = 1'000'000'000'000;
  constexpr double kLeak_hz = 20, kLeaked = -3900;  // of the threshold 0.2 in that time
  CHECK(is_taken(0, -150, kTime_ns));
  CHECK_FALSE(is_taken(0, kLeaked, kTime_ns));
  CHECK(is_taken(kLeak_hz, kLeaked, kTime_ns));
  CHECK_FALSE(is_taken(kLeak_hz, kLeaked, 0));
}

// A sensor of someone who has not thought of saved states.
class Forgetful : public ReadingSensor {
 public:
  Forgetful() : ReadingSensor(columns()) {}
  HistoryDependence history_dependence() const override { return HistoryDependence::measurements; }
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override {
    set_reading(time, {++counted_});
  }
  std::string method() const override { return "counts"; }

 private:
  static std::vector<TableColumn> columns() {
    return {{.name = "count", .format = "%.9g", .unit = "1", .meaning = "measurements"}};
  }
  double counted_ = 0;
};

TEST_CASE("a sensor that looks back and has no state is refused while it is on") {
  Forgetful sensor;
  StateArchive state;
  CHECK(contains(error_of([&] { archive_state(state, sensor); }), "expected a type that is Stateful"));
  state.set_on(false);
  CHECK_NOTHROW(archive_state(state, sensor));
  CHECK(state.bytes().empty());
}

TEST_CASE("scans that cannot be drawn are refused, those that hit nothing are taken") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kFar_m = 1e30;
  const auto is_taken = [](double azimuth_rad, double x_m, float range_m) {
    Scan scan(1, 1);
    scan.set_angles(std::vector<double>{azimuth_rad}, std::vector<double>{0.0});
    scan.world_from_sensor[3].x = x_m;
    const Scan::Ranges ranges = scan.overwrite_ranges();
    ranges.range_m[0] = range_m;
    ranges.error_bound_m[0] = 0;
    const StateArchive state{std::string_view()};
    try {
      require_scan(state, scan);
    } catch (const InputError&) {
      return false;
    }
    return true;
  };
  CHECK(is_taken(0, 1, std::numeric_limits<float>::infinity()));
  CHECK(is_taken(0, 1, 0));
  CHECK_FALSE(is_taken(kNan, 1, 1));
  CHECK_FALSE(is_taken(0, kNan, 1));
  CHECK_FALSE(is_taken(0, kFar_m, 1));
  CHECK_FALSE(is_taken(0, 1, 1e30f));
}

// Trails, costs of methods, scenes of flow and scans that are shown: everywhere a number may be that of values to read.
TEST_CASE("a state that names more values than it has is refused before memory is taken for them") {
  const std::string pixels = "width='4' height='3' ";
  const auto load = [&] {
    Simulation simulation = Simulation::from_string(
        "<s><part name='WALL' insert_at='ROOT' shape='box' size='1 9 9' pose_offset='3 0 0 0 0 0'/>"
        "<part name='AT' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='AT'/>"
        "<part name='BALL' insert_at='AT' shape='sphere' radius='0.2' pose_offset='2 0 0 0 0 0'/>"
        "<element type='trail' name='TRAIL' insert_at='ROOT' part='BALL'/>"
        "<sensor type='camera' name='FLOW' insert_at='ROOT' outputs='flow_forward occlusion' row_time='0.001' " +
        pixels + "/><sensor type='stereo_camera' name='TWO' insert_at='ROOT' baseline='0.1' outputs='flow_forward' " +
        pixels +
        "/><sensor type='laser_scanner' name='AUTO' insert_at='ROOT' samples='5' method='auto' max_error_rel='0.01' "
        "resolution='16'/><element type='laser_beams' name='BEAMS' insert_at='ROOT' scanner='AUTO'/>"
        "<sensor type='camera' name='SHOWN' insert_at='ROOT' view='visualization' " +
        pixels + "/></s>");
    for (int frame = 0; frame < 3; ++frame) {
      simulation.set("MOVE", "y", 0.1 * frame);
      simulation.step();
    }
    return simulation;
  };
  Simulation simulation = load();
  const std::string state = simulation.save_state();
  for (const char* const title : {"element \"TRAIL\"", "sensor \"FLOW\"", "sensor \"TWO\"", "sensor \"AUTO\"",
                                  "the scans that are shown", "the motion that sensors follow"}) {
    CAPTURE(title);
    const std::size_t begin = values_of(state, title);
    std::uint64_t size = 0;
    std::memcpy(&size, state.data() + begin - sizeof size, sizeof size);
    int refused = 0;
    for (std::size_t at = begin; at + sizeof size <= begin + size; ++at) {
      CAPTURE(at - begin);
      constexpr std::uint64_t kMany = std::uint64_t{1} << 40;
      const std::string why = error_of([&] { simulation.restore_state(with(state, at, kMany)); });
      REQUIRE(why.find("needs more memory than there is") == why.npos);
      REQUIRE(why.find("a number of values that is not possible") == why.npos);
      refused += why.find("expected") != why.npos || why.find("does not fit") != why.npos;
    }
    CHECK(refused > 0);
  }
  simulation.restore_state(state);
  CHECK(simulation.save_state() == state);
}

// The scene of two eyes is written with the first one.
TEST_CASE("an eye whose scene is that of the other eye is refused if the other eye has none") {
  const DrawList list{};
  CameraMoment moment;
  moment.scene = std::make_shared<const KeptScene>(KeptScene{.list = list, .shape = {}, .moves = {}});
  MomentHistory left, right;
  left.add(moment);
  right.add(moment);
  StateArchive written;
  right.archive(written, &left);
  const auto read_beside = [&](const MomentHistory* beside) {
    StateArchive state(written.bytes());
    MomentHistory restored;
    restored.archive(state, beside);
    return restored.now()->scene;
  };
  const MomentHistory without{};
  CHECK(read_beside(&left) == moment.scene);
  CHECK_THROWS_AS(read_beside(&without), InputError);
  CHECK_THROWS_AS(read_beside(nullptr), InputError);
}

TEST_CASE("memory follows what a state has, not the number of values that it names") {
  constexpr std::uint64_t kBytes = 1 << 20;
  std::string bytes(sizeof kBytes + kBytes, '\0');
  std::memcpy(bytes.data(), &kBytes, sizeof kBytes);
  StateArchive state(bytes);
  std::vector<glm::dmat4> matrices;
  CHECK_THROWS_AS(state(matrices), InputError);
  constexpr std::size_t kGrowth = 2;  // of a vector
  CHECK(matrices.capacity() * sizeof(glm::dmat4) <= kGrowth * kBytes);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
