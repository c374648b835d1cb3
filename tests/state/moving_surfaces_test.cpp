// States of surfaces that move while their shapes stay, and of drives between two steps of physics.
#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/state/saved_state.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

constexpr std::chrono::nanoseconds kStep = std::chrono::milliseconds(1);  // of physics

struct Surface {
  std::string name, xml;
  Control control;
};

std::vector<Surface> surfaces() {
  const auto run_belt = [](Simulation& simulation, std::uint64_t frame) {
    simulation.set("BELT_BODY", "belt_speed", frame < 35 ? 0.0004 : 0.3);
  };
  const auto strafe = [](Simulation& simulation, std::uint64_t frame) {
    for (const char* const wheel : {"front_right", "rear_left"}) {
      simulation.set("DRIVE", wheel, frame < 35 ? 20 : 60);
    }
  };
  return {{"belt",
           body("BELT", "shape='box' size='4 1 0.2' pose_offset='0 3 0.1 0 0 0'",
                "kind='static' shape='box' belt='1 0 0'") +
               body("CARTON", "shape='box' size='0.2 0.2 0.2' pose_offset='-1 3 0.3 0 0 0'", "mass='1'"),
           run_belt},
          {"mecanum",
           "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.3 0.2' pose_offset='0 3 0 0 0 0'/>\n"
           "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' clearance='0.05' drive='mecanum' "
           "axle='-0.25' wheelbase='0.5' track='0.4'/>\n",
           strafe}};
}

// The sleeper is asleep from frame 25 on.
TEST_CASE("a surface that moves goes on to the bit beside a body that sleeps, and wakes nothing") {
  constexpr std::size_t kFrames = 45;
  for (const Surface& each : surfaces()) {
    CAPTURE(each.name);
    const std::string xml = kPhysics + ground() + each.xml +
                            body("SLEEPER", "shape='box' size='0.2 0.2 0.2' pose_offset='0 -3 0.1 0 0 0'", "mass='1'");
    Simulation simulation = Simulation::from_string(xml);
    std::vector<std::string> states{simulation.save_state()};
    for (std::size_t i = 0; i < kFrames; ++i) {
      make_frame(simulation, each.control);
      states.push_back(simulation.save_state());
    }
    for (const std::size_t from : {0, 1, 10, 30, 34, 35, 36, 44}) {
      CAPTURE(from);
      Simulation fresh = Simulation::from_string(xml);
      for (Simulation* const restored : {&simulation, &fresh}) {
        restored->restore_state(states[from]);
        CHECK(restored->save_state() == states[from]);
        make_frame(*restored, each.control);
        CHECK(restored->save_state() == states[from + 1]);
      }
    }
  }
}

// The joint stands before the physics: its value is restored before the world is made.
TEST_CASE("a wheel that a vehicle turns goes on to the bit, also if its value has been set and not been taken over") {
  const std::string xml =
      "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.3 0.2' pose_offset='0 3 0 0 0 0'/>\n"
      "<part name='WHEEL' insert_at='CAR' pose_offset='0 0.2 0.1 0 0 0'/>\n"
      "<element type='joint' name='SPIN' insert_at='WHEEL' axis='0 1 0'/>\n" +
      kPhysics + ground() +
      "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' clearance='0.05' left='90' right='80' "
      "left_joints='SPIN'/>\n<sensor type='joint_state' name='JOINTS' insert_at='ROOT'/>";
  for (const std::chrono::nanoseconds last : {kStep / 4, 10 * kStep}) {  // without a step of physics, and with some
    CAPTURE(last.count());
    Simulation simulation = Simulation::from_string(xml);
    for (int i = 0; i < 3; ++i) simulation.step(10 * kStep);
    simulation.set("SPIN", "value", 1000);
    simulation.step(last);
    const std::string state = simulation.save_state();
    const auto go_on = [](Simulation& each) {
      std::vector<std::uint64_t> hashes;
      for (int i = 0; i < 4; ++i) {
        each.step(3 * kStep / 4);
        hashes.push_back(measured_hash(each));
      }
      return hashes;
    };
    const std::vector<std::uint64_t> expected = go_on(simulation);
    Simulation fresh = Simulation::from_string(xml);
    for (Simulation* const restored : {&simulation, &fresh}) {
      restored->restore_state(state);
      CHECK(restored->save_state() == state);
      CHECK(go_on(*restored) == expected);
    }
  }
}

TEST_CASE("the effort of a drive is there in a frame between two steps") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "arm.urdf")
      << "<robot name='a'><link name='a'>" + inertial(1, "0 0 0", 0.1) + "</link><link name='b'>" +
             inertial(1, "0 0 0", 0.1) +
             "</link><joint name='elbow' type='revolute'><parent link='a'/><child link='b'/>"
             "<limit lower='-3' upper='3' effort='50' velocity='10'/></joint></robot>";
  for (const std::string control : {"effort", "servo", "velocity"}) {
    CAPTURE(control);
    const std::string xml = kPhysics +
                            "<part name='ARM' insert_at='ROOT' file='arm.urdf'/>"
                            "<element type='robot' name='ROBOT' insert_at='ARM' base='fixed' control='" +
                            control + (control == "servo" ? "' stiffness='0.5' damping='0.01" : "") +
                            "'/><sensor type='joint_state' name='JOINTS' insert_at='ARM'/>";
    Simulation simulation = Simulation::from_string(xml, {}, folder.path());
    simulation.set("ROBOT", "target_elbow", 2);
    simulation.step(kStep);
    simulation.step(kStep);
    const std::string state = simulation.save_state();
    const auto between = [](Simulation& each) {
      each.step(kStep / 4);
      return measured_hash(each);
    };
    const std::uint64_t expected = between(simulation);
    Simulation fresh = Simulation::from_string(xml, {}, folder.path());
    fresh.restore_state(state);
    CHECK(between(fresh) == expected);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
