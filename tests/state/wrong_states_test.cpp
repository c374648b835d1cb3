// States that do not fit: cut off, damaged, of another version or scene, and made by a stranger.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/state/saved_state.h"
#include "tests/support/error_of.h"
#include "tests/support/long_count.h"
#include "tests/support/moving_scene.h"
#include "tests/support/random_numbers.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

// Two bodies that touch, a wheel that a vehicle turns, an attachment, delayed measurements, and a scanner that sweeps.
const std::string kTouchingScene =
    kPhysics + ground() + body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='1'") +
    body("TOP", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.3 0 0 0'", "mass='1'") +
    "<element type='attachment' name='GRIP' insert_at='TOP' to='BOX'/>"
    "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.4 0.2' pose_offset='2 0 0.01 0 0 0'/>"
    "<part name='WHEEL' insert_at='CAR' pose_offset='0 0.2 0.1 0 0 0'/>"
    "<element type='joint' name='SPIN' insert_at='WHEEL' axis='0 1 0'/>"
    "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='20' clearance='0.05' left='90' left_joints='SPIN'/>"
    "<sensor type='laser_scanner' name='SCAN' insert_at='CAR' samples='5' sweep='0.05'/>"
    "<sensor type='odometry' name='ODOM' insert_at='CAR' delay='0.1'/>"
    "<sensor type='imu' name='IMU' insert_at='TOP'/>";

void leave_alone(Simulation& /*simulation*/, std::uint64_t /*frame*/) {}

// A stranger's clock may ask for years of physics, which the report of progress ends.
SimulationDesc impatient() {
  SimulationDesc desc;
  desc.progress = [](const Progress& progress) {
    if (progress.work == "physics" && progress.total > 10'000) throw Error("this takes too long");
  };
  return desc;
}

struct Saved {
  Simulation simulation = Simulation::from_string(kTouchingScene, impatient());
  std::string state{};
  std::vector<MadeFrame> after{};
  Saved() {
    make_frames(simulation, leave_alone, 6);
    state = simulation.save_state();
    after = make_frames(simulation, leave_alone, 2);
  }
};

TEST_CASE("a state that is cut off anywhere is refused, and the simulation stays as it is") {
  Saved saved;
  const std::string present = saved.simulation.save_state();
  for (std::size_t size = 0; size < saved.state.size(); ++size) {
    CAPTURE(size);
    CHECK_THROWS_AS(saved.simulation.restore_state(std::string_view(saved.state).substr(0, size)), InputError);
  }
  CHECK_THROWS_AS(saved.simulation.restore_state(saved.state + "x"), InputError);
  CHECK(saved.simulation.save_state() == present);
}

TEST_CASE("a state with any byte changed is refused, and the simulation stays as it is") {
  Saved saved;
  const std::string present = saved.simulation.save_state();
  for (std::size_t at = 0; at < saved.state.size(); ++at) {
    CAPTURE(at);
    std::string changed = saved.state;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    CHECK_THROWS_AS(saved.simulation.restore_state(changed), InputError);
  }
  CHECK(saved.simulation.save_state() == present);
}

TEST_CASE("a state of a stranger is refused, or makes frames, and does no harm") {
  Saved saved;
  const std::size_t begin = begin_of_content(saved.state);
  const std::string present = saved.simulation.save_state();
  Random random;
  int refused = 0, taken = 0;
  const auto try_state = [&](const std::string& changed) {
    try {
      saved.simulation.restore_state(with_right_hash(changed));
      ++taken;
    } catch (const InputError&) {
      ++refused;
      CHECK(saved.simulation.save_state() == present);
      return;
    }
    try {
      saved.simulation.step();
    } catch (const Error&) {  // a body that is too fast
    }
    saved.simulation.restore_state(present);
  };
  const int tries = count_of("SIMVIS_TEST_INPUTS", 1500);
  for (int i = 0; i < tries; ++i) {
    std::string changed = saved.state;
    const std::size_t at = begin + random.below(changed.size() - begin);
    changed[at] = static_cast<char>(changed[at] ^ (1 << random.below(8)));
    try_state(changed);
  }
  for (int i = 0; i < tries / 5; ++i) {  // 8 bytes that are large, not finite or negative
    static constexpr std::uint64_t kNumbers[] = {~0ull,      0x7ff8000000000000, 0x7fefffffffffffff,
                                                 1ull << 40, 1u << 31,           0};
    std::string changed = saved.state;
    const std::size_t at = begin + random.below(changed.size() - begin - 8);
    std::memcpy(changed.data() + at, &kNumbers[random.below(6)], 8);
    try_state(changed);
  }
  CHECK(refused > tries / 20);
  CHECK(taken > tries / 20);
  saved.simulation.restore_state(saved.state);
  CHECK(make_frames(saved.simulation, leave_alone, 2) == saved.after);
}

TEST_CASE("errors say what does not fit") {
  Saved saved;
  CHECK(contains(error_of([&] { saved.simulation.restore_state("PNG"); }),
                 "these bytes are no state of a simulation, expected those of save_state() or --save-state"));
  std::string later = saved.state;
  later[later.find('\n') + 1] = 2;
  CHECK(contains(error_of([&] { saved.simulation.restore_state(later); }),
                 "the state is of format 2 of SimVis " + std::string(version()) + ", expected format 1 of SimVis "));
  Simulation other = Simulation::from_string(kPhysics + ground());
  CHECK(contains(error_of([&] { other.restore_state(saved.state); }),
                 "the state is of another scene: command 4 is missing here, expected a scene of the same commands and "
                 "requests in the same order"));
  SimulationDesc desc;
  desc.seed = 1;
  Simulation seeded = Simulation::from_string(kTouchingScene, desc);
  CHECK(contains(error_of([&] { seeded.restore_state(saved.state); }),
                 "the state is of a simulation with another seed, rate or override of attributes"));
}

TEST_CASE("an asynchronous frame is finished, skipped frames and sensors that are off count") {
  Saved saved;
  saved.simulation.restore_state(saved.state);
  saved.simulation.step_async();
  const std::string during = saved.simulation.save_state();
  Simulation other = Simulation::from_string(kTouchingScene);
  other.restore_state(saved.state);
  other.step();
  CHECK(other.save_state() == during);
  other.enable("IMU", false);
  const std::string off = other.save_state();
  saved.simulation.restore_state(off);
  const auto is_on = [&] {
    const std::vector<SensorInfo> sensors = saved.simulation.sensors();
    return std::ranges::find(sensors, std::string("IMU"), &SensorInfo::name)->enabled;
  };
  CHECK(!is_on());
  saved.simulation.restore_state(saved.state);
  CHECK(is_on());
  CHECK(saved.simulation.measured().empty());
  CHECK(make_frames(saved.simulation, leave_alone, 2) == saved.after);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
