// Sensors of their own motion: of an IMU without errors and of an ideal odometry all values.
#include <cmath>
#include <string>

#include "tests/combinations/comparison.h"

namespace simvis::combined {
namespace {

constexpr Real kGravity_mps2 = 9.80665L;

class MotionComparison {
 public:
  explicit MotionComparison(const Comparison& comparison)
      : with_(comparison), now_(comparison.world.sensor(comparison.sensor, 1)) {
    if (with_.frame == 0 || with_.desc().parent == kNoParent) return;  // it stands still
    const auto body = static_cast<std::size_t>(with_.desc().parent);
    turn_radps_ = Real(kRate_hz) * with_.world.turn_per_frame(body);
    velocity_mps_ = Real(kRate_hz) * with_.world.way_per_frame(body, now_.at);
    // The same screw goes on, so that only the part across its axis changes.
    acceleration_mps2_ = glm::cross(turn_radps_, velocity_mps_);
  }

  void imu() const {
    const Real acceleration_rounding =
        turn_rounding() * glm::length(velocity_mps_) + velocity_rounding() * glm::length(turn_radps_);
    check("angular_velocity_", "_rad_s", turn_radps_, turn_rounding());
    check("specific_force_", "_m_s2", acceleration_mps2_ + Vector(0, 0, kGravity_mps2),
          acceleration_rounding + kDoubles * kGravity_mps2);
    check_turn(now_.turn);
  }

  void odometry() const {
    const Frame first = with_.frame == 0 ? now_ : ExactWorld(with_.scene, 0).sensor(with_.sensor, 1);
    const Frame since = inverse(first) * now_;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      value(std::string(1, kAxes[axis]) + "_m", since.at[axis], 2 * with_.world.pose_rounding_m(with_.sensor));
    }
    check_turn(since.turn);
    check("velocity_", "_m_s", velocity_mps_, velocity_rounding());
    check("angular_velocity_", "_rad_s", turn_radps_, turn_rounding());
  }

 private:
  static constexpr char kAxes[] = "xyz";

  // Two poses are wrong by this much each, and differ over a tenth of a second. The logarithm of a turn is worse by up
  // to its angle over its sine, which is below two up to 108 degrees.
  Real turn_rounding() const { return 4 * kDoubles * Real(kRate_hz); }
  Real velocity_rounding() const {
    return 4 * (with_.world.pose_rounding_m(with_.sensor) * Real(kRate_hz) + kDoubles * glm::length(velocity_mps_));
  }

  Real got(const std::string& column) const { return with_.measurement().find(column)->number(0); }

  void value(const std::string& column, Real expected, Real allowed) const {
    with_.count("motion, " + column);
    const Real value = got(column);
    if (!(std::abs(value - expected) <= allowed)) with_.fail("motion, " + column, "value", value, expected, allowed);
  }

  /// A vector of the world in the sensor frame.
  void check(const std::string& before, const std::string& behind, const Vector& world, Real allowed) const {
    const Vector own = glm::transpose(now_.turn) * world;
    for (glm::length_t axis = 0; axis < 3; ++axis) value(before + kAxes[axis] + behind, own[axis], allowed);
  }

  /// The quaternion of a turn, of either sign.
  void check_turn(const Matrix& turn) const {
    const Vector v(got("qx"), got("qy"), got("qz"));
    const Real w = got("qw");
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      Vector unit(0);
      unit[axis] = 1;
      const Vector turned = unit + Real(2) * glm::cross(v, glm::cross(v, unit) + w * unit);
      with_.count("motion, orientation");
      const Real wrong = glm::length(turned - turn[axis]);
      if (!(wrong <= kDoubles)) with_.fail("motion, orientation", std::string(1, kAxes[axis]), wrong, 0, kDoubles);
    }
  }

  const Comparison& with_;
  Frame now_;
  Vector turn_radps_{0}, velocity_mps_{0}, acceleration_mps2_{0};
};

}  // namespace

void compare_motion(const Comparison& comparison) {
  const MotionComparison motion(comparison);
  comparison.desc().kind == SensorKind::imu ? motion.imu() : motion.odometry();
}

}  // namespace simvis::combined
