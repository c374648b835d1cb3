// States of physics: every kind of body, joint, force and attachment goes on to the bit.
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/state/saved_state.h"
#include "tests/support/error_of.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/random_numbers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

// Boxes that fall onto a heap, bounce and come to rest, one that a pose pushes, and one whose air moves in gusts.
std::string heap() {
  std::string xml = kPhysics + ground("restitution='0.5'") +
                    "<element type='wind' name='WIND' insert_at='ROOT' gust='2' gust_time='0.3'/>\n";
  for (int i = 0; i < 6; ++i) {
    const std::string name = "BOX" + std::to_string(i);
    const std::string place = std::to_string(0.07 * (i % 3)) + " 0 " + std::to_string(0.12 + 0.23 * i);
    xml += body(name, "shape='box' size='0.2 0.2 0.2' pose_offset='" + place + " 0 0 " + std::to_string(11 * i) + "'",
                "mass='1' restitution='0.4'");
    xml += "<element type='drag' name='DRAG" + std::to_string(i) + "' insert_at='" + name +
           "' area='0.04' wind='WIND'/>\n";
  }
  xml += body("BALL", "shape='sphere' radius='0.15' pose_offset='1.5 0 0.15 0 0 0'", "mass='0.5' velocity='-3 0.1 0'");
  xml +=
      "<part name='PUSHER' insert_at='ROOT' pose_offset='0 -1 0.1 0 0 0' shape='box' size='0.2 0.2 0.2'/>\n"
      "<element type='body' name='PUSHER_BODY' insert_at='PUSHER' kind='kinematic'/>\n";
  return xml +
         "<sensor type='contact' name='CONTACT' insert_at='BOX0'/>\n"
         "<sensor type='imu' name='IMU' insert_at='BOX3'/>\n";
}

void push(Simulation& simulation, std::uint64_t frame) {
  simulation.set("PUSHER_BODY", "y", std::min(1.0, 0.02 * static_cast<double>(frame)));
  if (frame == 31) simulation.set("BOX5_BODY", "z", 1.5);  // it is put there, at rest
}

// Two craft with rotors, a grip that closes and opens, and a force that a command gives.
std::string craft() {
  std::string xml = kPhysics + ground();
  for (const std::string name : {"A", "B"}) {
    xml += body(
        name, "shape='box' size='0.3 0.3 0.1' pose_offset='0 " + std::string(name == "A" ? "0" : "0.4") + " 0.2 0 0 0'",
        "mass='1.5'");
    xml += "<element type='rotor' name='ROTOR_" + name + "' insert_at='" + name +
           "' thrust_constant='1e-5' torque_constant='2e-7' time_constant='0.2' point='0.01 0 0' speed='40000'/>\n";
    xml += "<element type='thruster' name='JET_" + name + "' insert_at='" + name + "' time_constant='0.3'/>\n";
  }
  return xml +
         "<element type='attachment' name='GRIP' insert_at='A' to='B' attached='0'/>\n"
         "<element type='force' name='FORCE' insert_at='B' timeout='0.2'/>\n";
}

void fly(Simulation& simulation, std::uint64_t frame) {
  simulation.set("ROTOR_A", "speed", frame % 20 < 10 ? 70000 : 60000);
  simulation.set("JET_B", "thrust", frame % 7 < 3 ? 4 : 0);
  simulation.set("GRIP", "attached", frame >= 10 && frame % 16 < 11 ? 1 : 0);
  if (frame % 9 == 4) simulation.set("FORCE", "force_x", 3);
  if (frame % 9 == 4) simulation.set("FORCE", "command", static_cast<double>(frame));
}

// A vehicle that velocity commands drive into a box, and a sensor of its way.
std::string vehicle() {
  return kPhysics + ground() +
         "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.4 0.2' pose_offset='0 0 0.01 0 0 0'/>\n"
         "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='20' clearance='0.05'/>\n"
         "<element type='velocity_command' name='COMMAND' insert_at='CAR' vehicle='DRIVE' timeout='0.3'/>\n" +
         body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='1 0.1 0.1 0 0 0'", "mass='0.5'") +
         "<sensor type='odometry' name='ODOM' insert_at='CAR' kind='wheel' slip_stddev='0.01' "
         "wheel_separation='0.4'/>\n";
}

void drive_car(Simulation& simulation, std::uint64_t frame) {
  if (frame % 8 == 1) {
    simulation.set("COMMAND", "forward", 1);
    simulation.set("COMMAND", "turn", frame % 3 == 0 ? 40 : -20);
    simulation.set("COMMAND", "command", static_cast<double>(frame));
  }
}

struct Motion {
  std::string name, xml;
  Control control;
};

std::vector<Motion> motions() {
  return {{"heap", heap(), push}, {"craft", craft(), fly}, {"vehicle", vehicle(), drive_car}};
}

TEST_CASE("physics goes on to the bit from any frame, in this simulation and in a new one") {
  constexpr int kFrames = 60, kAfter = 15;
  int compared = 0;
  for (const Motion& each : motions()) {
    CAPTURE(each.name);
    Simulation simulation = Simulation::from_string(each.xml);
    std::vector<std::string> states{simulation.save_state()};
    std::vector<MadeFrame> frames;
    for (int i = 0; i < kFrames; ++i) {
      frames.push_back(make_frame(simulation, each.control));
      states.push_back(simulation.save_state());
    }
    Simulation unsaved = Simulation::from_string(each.xml);
    CHECK(make_frames(unsaved, each.control, kFrames) == frames);  // saving changes nothing
    Simulation fresh = Simulation::from_string(each.xml);
    Random random;
    for (int i = 0; i < 60; ++i) {
      const std::size_t from = random.below(kFrames - kAfter);
      CAPTURE(from);
      Simulation& restored = i % 2 == 0 ? simulation : fresh;
      restored.restore_state(states[from]);
      CHECK(restored.save_state() == states[from]);
      const std::vector<MadeFrame> after = make_frames(restored, each.control, kAfter);
      const auto expected = frames.begin() + static_cast<std::ptrdiff_t>(from);
      REQUIRE(std::equal(after.begin(), after.end(), expected));
      compared += kAfter;
    }
  }
  CHECK(compared == 3 * 60 * kAfter);
}

TEST_CASE("1,000 restores at random frames, from memory and from files") {
  constexpr int kFrames = 50;
  const int restores = sanitized() ? 50 : 1000;  // which are twenty times as slow
  const TemporaryFolder folder;
  const auto file = [&](std::size_t frame) { return folder / ("state" + std::to_string(frame)); };
  Simulation simulation = Simulation::from_string(heap());
  std::vector<std::string> states;
  std::vector<MadeFrame> frames;
  for (std::size_t i = 0; i < kFrames; ++i) {
    states.push_back(simulation.save_state());
    write_text(file(i), states.back());
    frames.push_back(make_frame(simulation, push));
  }
  Random random;
  int equal = 0;
  for (int i = 0; i < restores; ++i) {
    const std::size_t from = random.below(kFrames);
    simulation.restore_state(i % 2 == 0 ? states[from] : read_text(file(from)));
    equal += make_frame(simulation, push) == frames[from];
  }
  CHECK(equal == restores);
}

TEST_CASE("bodies that requests add and remove go on to the bit") {
  const std::string more = body("MORE", "shape='box' size='0.2 0.2 0.2' pose_offset='0.05 0 1.5 0 0 0'", "mass='2'");
  const std::string less = "<remove name='BOX1'/>";
  const auto changed = [&] {
    Simulation simulation = Simulation::from_string(heap());
    make_frames(simulation, push, 5);
    simulation.execute(more);
    make_frames(simulation, push, 3);
    simulation.execute(less);
    make_frames(simulation, push, 10);
    return simulation;
  };
  Simulation simulation = changed();
  const std::string state = simulation.save_state();
  const std::vector<MadeFrame> after = make_frames(simulation, push, 20);
  // Bodies have other ids here: both requests come at once.
  Simulation other = Simulation::from_string(heap());
  CHECK(contains(error_of([&] { other.restore_state(state); }), "the state is of another scene: command"));
  other.execute(more);
  other.execute(less);
  other.restore_state(state);
  CHECK(make_frames(other, push, 20) == after);
  simulation.restore_state(state);
  CHECK(make_frames(simulation, push, 20) == after);
  Simulation before = Simulation::from_string(heap());
  CHECK(contains(error_of([&] { simulation.restore_state(before.save_state()); }), "another scene"));
}

TEST_CASE("robots go on to the bit with drives, limits and a restart") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "arm.urdf")
      << "<robot name='a'><link name='base'>" + inertial(1, "0 0 0", 0.02) + "</link><link name='upper'>" +
             inertial(1, "0.2 0 0", 0.02) + "</link><link name='lower'>" + inertial(0.5, "0.1 0 0", 0.01) +
             "</link><joint name='shoulder' type='revolute'><parent link='base'/><child link='upper'/>"
             "<axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='50' velocity='2'/>"
             "<dynamics damping='0.5' friction='0.1'/></joint>"
             "<joint name='elbow' type='revolute'><parent link='upper'/><child link='lower'/>"
             "<origin xyz='0.4 0 0'/><axis xyz='0 1 0'/><limit lower='-2' upper='2' effort='20' velocity='3'/></joint>"
             "</robot>";
  for (const std::string control : {"position", "servo", "velocity", "effort", "none"}) {
    CAPTURE(control);
    const std::string stiff = control == "servo" ? " stiffness='200' damping='5'" : "";
    const std::string xml = kPhysics +
                            "<part name='ARM' insert_at='ROOT' file='arm.urdf'/>"
                            "<element type='robot' name='ROBOT' insert_at='ARM' base='fixed' control='" +
                            control + "'" + stiff +
                            "/>"
                            "<sensor type='force_torque' name='LOAD' insert_at='ARM' joint='shoulder'/>"
                            "<sensor type='joint_state' name='JOINTS' insert_at='ARM'/>";
    const auto move = [&](Simulation& simulation, std::uint64_t frame) {
      if (control != "none") simulation.set("ROBOT", "target_shoulder", frame % 10 < 5 ? 20 : -20);
      if (frame == 25) simulation.set("elbow", "value", 10);
      if (frame == 35) simulation.set("PHYSICS", "restarts", 1);
    };
    Simulation simulation = Simulation::from_string(xml, {}, folder.path());
    Simulation fresh = Simulation::from_string(xml, {}, folder.path());
    std::vector<std::string> states;
    std::vector<MadeFrame> frames;
    for (int i = 0; i < 45; ++i) {
      states.push_back(simulation.save_state());
      frames.push_back(make_frame(simulation, move));
    }
    if (control == "effort") {  // a frame without a step of physics shows the efforts of the last one
      constexpr std::chrono::nanoseconds kShort(1000);
      simulation.restore_state(states[20]);
      simulation.step(kShort);
      const std::uint64_t expected = measured_hash(simulation);
      Simulation another = Simulation::from_string(xml, {}, folder.path());
      another.restore_state(states[20]);
      another.step(kShort);
      CHECK(measured_hash(another) == expected);
    }
    Random random;
    for (int i = 0; i < 20; ++i) {
      const std::size_t from = random.below(35);
      CAPTURE(from);
      Simulation& restored = i % 2 == 0 ? simulation : fresh;
      restored.restore_state(states[from]);
      const std::vector<MadeFrame> after = make_frames(restored, move, 10);
      REQUIRE(std::equal(after.begin(), after.end(), frames.begin() + static_cast<std::ptrdiff_t>(from)));
    }
  }
}

// Frames and states that follow a state, in a new simulation as in the one that saved it.
void check_goes_on(const std::function<Simulation()>& load, const Control& control, int before, int after) {
  Simulation simulation = load();
  make_frames(simulation, control, before);
  const std::string state = simulation.save_state();
  std::vector<MadeFrame> frames;
  std::vector<std::string> states;
  for (int i = 0; i < after; ++i) {
    frames.push_back(make_frame(simulation, control));
    states.push_back(simulation.save_state());
  }
  Simulation fresh = load();
  for (Simulation* const restored : {&simulation, &fresh}) {
    restored->restore_state(state);
    CHECK(restored->save_state() == state);
    for (int i = 0; i < after; ++i) {
      CAPTURE(i);
      REQUIRE(make_frame(*restored, control) == frames[static_cast<std::size_t>(i)]);
      REQUIRE(restored->save_state() == states[static_cast<std::size_t>(i)]);
    }
  }
}

TEST_CASE("bodies that sleep go on to the bit when another one wakes them") {
  const std::string xml =
      kPhysics + ground() + body("LOWER", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='1'") +
      body("UPPER", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.3 0 0 0'", "mass='1'") +
      body("BALL", "shape='sphere' radius='0.1' pose_offset='1 0 5 0 0 0'", "mass='1' velocity='0 0 -0.1'") +
      "<sensor type='contact' name='CONTACT' insert_at='LOWER'/><sensor type='imu' name='IMU' insert_at='UPPER'/>";
  constexpr std::uint64_t kThrown = 64;
  const auto hit = [](Simulation& simulation, std::uint64_t frame) {
    if (frame != kThrown) return;
    simulation.set("BALL_BODY", "x", 0.05);
    simulation.set("BALL_BODY", "z", 0.6);
  };
  check_goes_on([&] { return Simulation::from_string(xml); }, hit, 62, 30);
}

TEST_CASE("constraints of models and pairs that do not collide go on to the bit") {
  const TemporaryFolder folder;
  write_equalities(folder.path());
  const auto leave = [](Simulation&, std::uint64_t) {};
  for (const int before : {1, 10, 25}) {
    check_goes_on([&] { return Simulation::from_string(kEqualities, {}, folder.path()); }, leave, before, 10);
  }
}

TEST_CASE("belts go on to the bit and wake nobody") {
  const std::string belt = body("BELT", "shape='box' size='4 1 0.2' pose_offset='0 0 0.1 0 0 0'",
                                "kind='static' belt='1 0 0' belt_speed='0.2'");
  const std::string xml = kPhysics + ground() + belt +
                          body("CARRIED", "shape='box' size='0.2 0.2 0.2' pose_offset='-1.5 0 0.3 0 0 0'", "mass='1'") +
                          body("ASLEEP", "shape='box' size='0.2 0.2 0.2' pose_offset='0 5 0.1 0 0 0'", "mass='1'") +
                          "<sensor type='imu' name='IMU' insert_at='CARRIED'/>";
  const auto drive = [](Simulation& simulation, std::uint64_t frame) {
    if (frame == 65) simulation.set("BELT_BODY", "belt_speed", 0.1);
  };
  check_goes_on([&] { return Simulation::from_string(xml); }, drive, 62, 10);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
