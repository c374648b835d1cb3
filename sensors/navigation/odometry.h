// The sensor `odometry`: where a vehicle has moved since the start, by its own account.
//
//   <sensor type="odometry" name="ODOM" insert_at="ROBOT" kind="wheel" wheel_separation="0.4" left_scale_error="0.01"/>
//
// Frame    the pose is in the frame in which the sensor stood at its first measurement; velocities are in the sensor's
//          own frame (the conventions of nav_msgs/Odometry).
// Kinds    ideal: the true motion.
//          wheel: two wheels at (0, +-wheel_separation / 2, 0), whose counted ways are added up along arcs (dead
//          reckoning of a differential drive: Siegwart and Nourbakhsh, "Introduction to Autonomous Mobile Robots",
//          section 5.2.4). The true way of each wheel between two measurements follows from the constant twist between
//          the poses: forward -+ turn about z times half the separation. It is counted as
//              way (1 + scale error) + slip_stddev sqrt(|way|) g,   g normal with variance 1.
//          Sideways and vertical motion, roll and pitch are not counted.
// Values   x_m, y_m, z_m; the orientation as a unit quaternion qx, qy, qz, qw; velocity_{x,y,z}_m_s and
//          angular_velocity_{x,y,z}_rad_s, the mean since the last measurement; 0 at the first.
// Slip     gives covariances: those of the ways, s^2 |way|, are carried through the same arcs to first order (Siegwart
//          and Nourbakhsh, section 5.2.4). Scale errors are no noise and have no part in them.
// Skipped  frames are counted too: the result is that of a run that makes all frames.
// Message  nav_msgs/Odometry of the part that carries the sensor, in the frame "odom" (REP 105) or odom_frame.
#pragma once

#include <string>

#include <simvis/philox.h>
#include <simvis/reading_sensor.h>
#include <simvis/state_archive.h>
#include "scenegraph/motion.h"
#include "sensors/described_sensor.h"

namespace simvis {

struct OdometryDesc {
  bool wheels = false;
  double wheel_separation_m = 0.5;
  double left_scale_error = 0, right_scale_error = 0;
  double slip_stddev_sqrt_m = 0;  ///< standard deviation of the counted way after one metre
  std::uint64_t seed = 0;

  bool has_covariances() const { return wheels && slip_stddev_sqrt_m > 0; }
  static AttributeRows<OdometryDesc> rows();
};

class OdometrySensor : public ReadingSensor, public Stateful {
 public:
  OdometrySensor(const std::string& name, const OdometryDesc& desc);

  HistoryDependence history_dependence() const override { return HistoryDependence::poses; }
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override {
    advance(time, world_from_sensor);
  }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void archive(StateArchive& state) override {
    state.finite(world_from_start_);
    state(before_, now_);
    state.require(!before_.any || (now_.any && before_.time_ns < now_.time_ns));
  }
  std::string method() const override { return desc_.wheels ? "wheel" : "ideal"; }

 private:
  // After a measurement.
  struct State {
    std::int64_t time_ns = 0;
    glm::dmat4 world_from_sensor{1.0};
    glm::dmat4 start_from_sensor{1.0};  // as counted
    Twist twist;                        // as counted
    glm::dmat3 pose_covariance{0};      // of x, y and the heading, in the frame of the first measurement
    glm::dmat2 velocity_covariance{0};  // of the speed forward and the turn rate
    bool any = false;

    void archive(StateArchive& state) {
      state(time_ns, any);
      state.require_past(time_ns);
      state.finite(world_from_sensor, start_from_sensor, twist.angular_radps, twist.linear_mps, pose_covariance,
                   velocity_covariance);
    }
  };
  void advance(const FrameTime& time, const glm::dmat4& world_from_sensor);
  glm::dvec2 count_wheels(const FrameTime& time, double seconds, Twist& twist) const;
  void count_covariances(const glm::dvec2& counted_m, double seconds, State& state) const;

  OdometryDesc desc_;
  SensorRandom random_;
  glm::dmat4 world_from_start_{1.0};
  State before_, now_;
};

}  // namespace simvis
