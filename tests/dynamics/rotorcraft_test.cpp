// A craft with four rotors that a small controller of the test holds in the air, as a user's would.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "tests/support/moved_body.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kCraft_kg = 1.5, kLift_n_s2 = 1e-5, kDrag_nm_s2 = 2e-7, kLever_m = 0.2, kMotor_s = 0.02;
constexpr double kFrame_s = 0.005;

// Front left, back right turn counter-clockwise, the others clockwise.
struct Mounted {
  std::string name;
  double x, y, spin;
};
const std::array<Mounted, 4> kRotors{{{"FL", 1, 1, 1}, {"FR", 1, -1, -1}, {"BL", -1, 1, -1}, {"BR", -1, -1, 1}}};

double hover_deg_s() { return glm::degrees(std::sqrt(kCraft_kg * kGravity_m_s2 / (4 * kLift_n_s2))); }

std::string craft(const std::string& pose, const std::string& more = "") {
  std::string xml = kPhysics + body("CRAFT", "shape='box' size='0.3 0.3 0.1' pose_offset='" + pose + "'",
                                    "mass='1.5' shape='box' inertia='0.02 0.02 0.04'");
  for (const Mounted& rotor : kRotors) {
    xml += "<element type='rotor' name='" + rotor.name + "' insert_at='CRAFT' point='" +
           format_number(kLever_m * rotor.x) + " " + format_number(kLever_m * rotor.y) + " 0.05' turns='" +
           (rotor.spin > 0 ? "ccw" : "cw") + "' thrust_constant='1e-5' torque_constant='2e-7' time_constant='" +
           format_number(kMotor_s) + "' speed='" + format_number(hover_deg_s()) + "'/>\n";
  }
  return xml + more;
}

// Sets the speeds that give this thrust and these torques about the axes of the craft.
void command(MovingScene& scene, double thrust, const glm::dvec3& torque) {
  for (const Mounted& rotor : kRotors) {
    const double lift = thrust / 4 + rotor.y * torque.x / (4 * kLever_m) - rotor.x * torque.y / (4 * kLever_m);
    const double square = lift / kLift_n_s2 - rotor.spin * torque.z / (4 * kDrag_nm_s2);
    scene.set(rotor.name, "speed", glm::degrees(std::sqrt(std::max(0.0, square))));
  }
}

// Position and its integral want an acceleration, which wants an attitude, which wants torques.
class Controller {
 public:
  explicit Controller(const glm::dvec3& target) : target_(target) {}
  void act(MovedBody& craft) {
    const StepMotion::At at = craft.motion();
    const glm::dvec3 away = target_ - at.center_m;
    sum_ += away * kFrame_s;
    const glm::dvec3 wanted = glm::dvec3(0, 0, kGravity_m_s2) + 12.0 * away + 8.0 * sum_ - 6.0 * at.velocity_m_s;
    const glm::dmat3 turn(at.world_from_body);
    const double thrust = kCraft_kg * glm::dot(wanted, turn[2]);
    const glm::dvec3 tilt = glm::transpose(turn) * glm::cross(turn[2], glm::normalize(wanted));
    const glm::dvec3 heading(0, 0, -std::atan2(turn[0].y, turn[0].x));
    const glm::dvec3 spin = glm::transpose(turn) * at.angular_velocity_rad_s;
    command(craft.scene, thrust, glm::dvec3(0.02, 0.02, 0.04) * (120.0 * tilt + 60.0 * heading - 18.0 * spin));
  }

 private:
  glm::dvec3 target_, sum_{0};
};

TEST_CASE("four rotors that carry the weight hover without a controller, and one that is faster lifts") {
  MovedBody still(craft("0 0 1 0 0 0"), "CRAFT");
  still.scene.run(0, 2, 0.05);
  // The speed is written in degrees with 17 digits: its square carries the weight to 1e-15, for 2 s.
  CHECK(glm::length(still.motion().center_m - glm::dvec3(0, 0, 1)) < 1e-12);
  CHECK(glm::length(still.motion().angular_velocity_rad_s) < 1e-12);
  for (const Mounted& rotor : kRotors) still.scene.set(rotor.name, "speed", 1.1 * hover_deg_s());
  still.scene.run(2, 3, 0.05);
  // After the lag the thrust is 1.21 of the weight.
  const double lag = 2 * 1.1 * 0.1 * kMotor_s - 0.01 * kMotor_s / 2;
  CHECK(std::abs(still.motion().velocity_m_s.z / (kGravity_m_s2 * (0.21 - lag)) - 1) < 1e-9);
}

TEST_CASE("a rotor craft rights itself, goes to a point and hovers there, in gusts too") {
  for (const bool gusty : {false, true}) {
    CAPTURE(gusty);
    const std::string air = gusty ? "<element type='wind' name='WIND' insert_at='ROOT' x='3' gust='0.5'/>"
                                    "<element type='drag' name='AIR' insert_at='CRAFT' area='0.05' wind='WIND'/>"
                                  : "";
    MovedBody flown(craft("0.3 -0.2 0.5 15 -10 40", air), "CRAFT");
    Controller controller({0, 0, 1});
    flown.scene.go_to(kFrame_s);
    double worst_m = 0;
    for (int frame = 2; frame * kFrame_s < 20; ++frame) {
      controller.act(flown);
      flown.scene.go_to(frame * kFrame_s);
      if (frame * kFrame_s > 15)
        worst_m = std::max(worst_m, glm::length(flown.motion().center_m - glm::dvec3(0, 0, 1)));
    }
    const glm::dmat4 pose = flown.scene.pose("CRAFT");
    // The position has three poles at 2 / s: (2 t)^2 e^-2t / 2 of 0.6 m is left, which is 3e-11 m after 15 s, and
    // more with the lag of the motors. In gusts of
    // four deviations the air moves at (3 + 2 sqrt(3) 1) m/s at most, which pushes by less than 1.3 N; the integral
    // holds the mean of 0.28 N, and the gain of 12 / s^2 the rest within 1.1 / (1.5 * 12) m.
    CHECK(worst_m < (gusty ? 0.06 : 1e-8));
    CHECK(std::abs(std::atan2(pose[0].y, pose[0].x)) < (gusty ? 0.02 : 1e-8));
    CHECK(pose[2].z > 0.98);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
