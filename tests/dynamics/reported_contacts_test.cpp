// Contacts that users reported as wrong, as whole scenes at 1,000 frames per second.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <string>

#include <simvis/simulation.h>

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kRate_hz = 1000, kGravity_m_s2 = 9.80665;

std::string with_floor(const std::string& floor_body, const std::string& part, const std::string& moving_body,
                       const std::string& physics = "") {
  return "<simvis><element type='physics' name='PH' insert_at='ROOT' " + physics +
         "/><part name='FLOOR' insert_at='ROOT' shape='box' size='40 40 1' pose_offset='0 0 -0.5 0 0 0'/>"
         "<element type='body' name='FB' insert_at='FLOOR' kind='static' " +
         floor_body + "/><part name='B' insert_at='ROOT' " + part + "/><element type='body' name='BB' insert_at='B' " +
         moving_body + "/></simvis>";
}

SimulationDesc at_rate() {
  SimulationDesc desc;
  desc.rate_hz = kRate_hz;
  return desc;
}

class Reported {
 public:
  explicit Reported(const std::string& scene) : simulation_(Simulation::from_string(scene, at_rate())) {}

  void step() { simulation_.step(); }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * kRate_hz; ++frame) step();
  }
  /// How far the body has moved from its start.
  glm::dvec3 way_m() const { return {get("x"), get("y"), get("z")}; }
  double tilt_deg() const { return std::max(std::abs(get("roll")), std::abs(get("pitch"))); }

 private:
  double get(const char* parameter) const { return simulation_.get("BB", parameter); }

  Simulation simulation_;
};

TEST_CASE("what is dropped without restitution does not jump, tumble or wander") {
  constexpr double kRebound_m = 1e-3, kTilt_deg = 0.1;  // a thousandth of the lowest drop; it was 10 to 151 degrees
  struct Drop {
    std::string floor, part, body;
    double height_m;
  };
  const Drop drops[] = {
      {"shape='box'", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 1.1 0 0 0'", "shape='box' mass='0.5'", 1},
      {"", "shape='sphere' radius='0.1' pose_offset='0 0 1.1 0 0 0'", "shape='sphere' mass='0.5'", 1},
      {"", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 5.1 0 0 0'", "shape='box' mass='0.5'", 5}};
  for (const Drop& drop : drops) {
    CAPTURE(drop.part);
    Reported scene(with_floor(drop.floor, drop.part, drop.body));
    scene.run(1.05 * std::sqrt(2 * drop.height_m / kGravity_m_s2));
    double highest_m = -drop.height_m, aside_m = 0, tilt_deg = 0;
    for (int frame = 0; frame < 500; ++frame) {
      scene.step();
      const glm::dvec3 way_m = scene.way_m();
      highest_m = std::max(highest_m, way_m.z);
      aside_m = std::max(aside_m, glm::length(glm::dvec2(way_m)));
      tilt_deg = std::max(tilt_deg, scene.tilt_deg());
    }
    CHECK(highest_m + drop.height_m < kRebound_m);
    CHECK(aside_m < kRebound_m);
    CHECK(tilt_deg < kTilt_deg);
  }
}

TEST_CASE("a cube of 1 cm with the hull of its mesh rests on the floor, not above it") {
  constexpr double kRest_m = 1e-6;  // a thousandth of Bullet's margin, which stood between them
  Reported scene(
      with_floor("shape='box'", "shape='box' size='0.01 0.01 0.01' pose_offset='0 0 0.005 0 0 0'", "mass='0.001'"));
  scene.run(1);
  CHECK(std::abs(scene.way_m().z) < kRest_m);
}

TEST_CASE("a hull slides down a slope as far as friction lets it") {
  // The slope of atan(0.5) + 2 degrees is in the direction of gravity: (sin - 0.5 cos) g t^2 / 2 after 3 s.
  constexpr double kTime_s = 3, kFriction = 0.5, kAlong_m_s2 = 4.689110733, kAcross_m_s2 = 8.612933574;
  constexpr double kWay_m = (kAlong_m_s2 - kFriction * kAcross_m_s2) * kTime_s * kTime_s / 2;
  constexpr double kSlope_rel = 2e-3;  // a step of 1 ms moves the start of the slide by 2 * 1 ms / 3 s of the way
  Reported scene(with_floor("shape='box' friction='1'", "shape='box' size='0.4 0.4 0.2' pose_offset='0 0 0.1 0 0 0'",
                            "mass='2' friction='0.5'", "gravity='4.689110733 0 -8.612933574'"));
  scene.run(kTime_s);
  CHECK(std::abs(scene.way_m().x / kWay_m - 1) < kSlope_rel);
  CHECK(std::abs(scene.way_m().y) < kSlope_rel * kWay_m);
}

TEST_CASE("an elastic box with friction never rises above its start") {
  // The least height of the centre at which the potential energy alone is that of the start. A step moves the top of a
  // flight by at most g dt^2 / 2, which is below a micrometre.
  constexpr double kAbove_m = kGravity_m_s2 / kRate_hz / kRate_hz;
  Reported scene(with_floor("shape='box' friction='1' restitution='1'",
                            "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 1.1 1 2 0'",
                            "shape='box' mass='0.5' restitution='1'"));
  double highest_m = -1;
  for (int frame = 0; frame < 5 * kRate_hz; ++frame) {
    scene.step();
    if (frame > kRate_hz / 2) highest_m = std::max(highest_m, scene.way_m().z);
  }
  CHECK(highest_m < kAbove_m);
  CHECK(highest_m > -0.9);  // it bounces
}

TEST_CASE("a ball of 4 cm at 50 m/s does not pass a wall of 2 cm") {
  Reported scene(
      "<simvis><element type='physics' name='PH' insert_at='ROOT' gravity='0 0 0'/><part name='W' insert_at='ROOT' "
      "shape='box' size='0.02 4 4'/><element type='body' name='WB' insert_at='W' kind='static'/><part name='B' "
      "insert_at='ROOT' shape='sphere' radius='0.02' pose_offset='-2 0.3 0.2 0 0 0'/><element type='body' name='BB' "
      "insert_at='B' shape='sphere' mass='0.1' velocity='50 0 0'/></simvis>");
  scene.run(0.1);
  CHECK(scene.way_m().x < 1.97 + 1e-4);  // where it touches, and the 0.05 mm of fast_bodies_test twice
  CHECK(scene.way_m().x > 1.5);
}

}  // namespace
}  // namespace simvis::test
