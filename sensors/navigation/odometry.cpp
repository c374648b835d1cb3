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
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/philox.h>
#include <simvis/pose.h>
#include <simvis/reading_sensor.h>
#include <simvis/state_archive.h>
#include "scenegraph/language/frame_name.h"
#include "scenegraph/motion.h"
#include "scenegraph/pose3.h"
#include "sensors/described_sensor.h"

namespace simvis {
namespace {

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

// Of the pose in its own frame, and of the velocities in the sensor's.
constexpr struct {
  std::string_view name, unit, meaning, frame;
} kOdometryCovariances[] = {
    {"variance_x_m2", "m^2", "variance of x_m", "first measurement"},
    {"covariance_x_y_m2", "m^2", "covariance of x_m and y_m", "first measurement"},
    {"covariance_x_yaw_m_rad", "m rad", "covariance of x_m and the heading", "first measurement"},
    {"variance_y_m2", "m^2", "variance of y_m", "first measurement"},
    {"covariance_y_yaw_m_rad", "m rad", "covariance of y_m and the heading", "first measurement"},
    {"variance_yaw_rad2", "rad^2", "variance of the heading", "first measurement"},
    {"variance_velocity_x_m2_s2", "m^2/s^2", "variance of velocity_x_m_s", "sensor"},
    {"covariance_velocity_x_angular_velocity_z_m_rad_s2", "m rad/s^2",
     "covariance of velocity_x_m_s and angular_velocity_z_rad_s", "sensor"},
    {"variance_angular_velocity_z_rad2_s2", "rad^2/s^2", "variance of angular_velocity_z_rad_s", "sensor"}};

std::vector<TableColumn> odometry_covariance_columns() {
  std::vector<TableColumn> columns;
  for (const auto& each : kOdometryCovariances) {
    columns.push_back({.name = std::string(each.name),
                       .format = "%.12g",
                       .unit = std::string(each.unit),
                       .meaning = std::string(each.meaning) + ", of the wheels' slip",
                       .frame = std::string(each.frame)});
  }
  return columns;
}

std::vector<TableColumn> odometry_motion_columns() {
  return {
      {.name = "x_m",
       .format = "%.12g",
       .unit = "m",
       .meaning = "position since the first measurement, along x",
       .frame = "first measurement"},
      {.name = "y_m",
       .format = "%.12g",
       .unit = "m",
       .meaning = "position since the first measurement, along y",
       .frame = "first measurement"},
      {.name = "z_m",
       .format = "%.12g",
       .unit = "m",
       .meaning = "position since the first measurement, along z",
       .frame = "first measurement"},
      {.name = "qx",
       .format = "%.12g",
       .meaning = "orientation since then: x of a unit quaternion",
       .frame = "first measurement"},
      {.name = "qy",
       .format = "%.12g",
       .meaning = "orientation since then: y of a unit quaternion",
       .frame = "first measurement"},
      {.name = "qz",
       .format = "%.12g",
       .meaning = "orientation since then: z of a unit quaternion",
       .frame = "first measurement"},
      {.name = "qw",
       .format = "%.12g",
       .meaning = "orientation since then: w of a unit quaternion",
       .frame = "first measurement"},
      {.name = "velocity_x_m_s", .format = "%.12g", .unit = "m/s", .meaning = "velocity along x", .frame = "sensor"},
      {.name = "velocity_y_m_s", .format = "%.12g", .unit = "m/s", .meaning = "velocity along y", .frame = "sensor"},
      {.name = "velocity_z_m_s", .format = "%.12g", .unit = "m/s", .meaning = "velocity along z", .frame = "sensor"},
      {.name = "angular_velocity_x_rad_s",
       .format = "%.12g",
       .unit = "rad/s",
       .meaning = "angular velocity about x",
       .frame = "sensor"},
      {.name = "angular_velocity_y_rad_s",
       .format = "%.12g",
       .unit = "rad/s",
       .meaning = "angular velocity about y",
       .frame = "sensor"},
      {.name = "angular_velocity_z_rad_s",
       .format = "%.12g",
       .unit = "rad/s",
       .meaning = "angular velocity about z",
       .frame = "sensor"}};
}

// Wheels that slip have covariances.
std::vector<TableColumn> odometry_columns(const OdometryDesc& desc) {
  std::vector<TableColumn> columns = odometry_motion_columns();
  if (!desc.has_covariances()) return columns;
  for (TableColumn& each : odometry_covariance_columns()) columns.push_back(std::move(each));
  return columns;
}

// What wheels that do not slip do not give follows those that are given.
std::vector<OutputSpec> odometry_outputs(const SensorContext& context) {
  std::vector<TableColumn> columns = odometry_motion_columns();
  for (TableColumn& each : odometry_covariance_columns()) columns.push_back(std::move(each));
  std::vector<OutputSpec> outputs = reading_outputs(context, columns);
  const bool given = read_desc<OdometryDesc>(context).has_covariances();
  for (OutputSpec& each : outputs) {
    if (each.name.find("variance") == each.name.npos) continue;
    each.when = "kind wheel with a slip_stddev above 0";
    each.given = given;
  }
  return outputs;
}

std::unique_ptr<Sensor> create_odometry(const SensorContext& context) {
  if (const CommandAttribute* const frame = context.command.find("odom_frame")) check_frame_name(*frame);
  return create_sensor<OdometrySensor, OdometryDesc>(context);
}

const SensorRegistration kOdometryRegistration(
    {.name = "odometry",
     .summary = "The motion of a vehicle since the start: the true one, or as wheels with errors count it.",
     .notes = "The pose is in the frame of the first measurement, velocities are in the sensor's frame.",
     .message = "nav_msgs/msg/Odometry",
     .attributes = rows_of<OdometryDesc>().table(),
     .create = create_odometry,
     .outputs = odometry_outputs,
     .sees_shapes = false});

/// The pose after a way along an arc in the plane z = 0, as seen from its start.
glm::dmat4 along_arc(double way_m, double turn_rad) {
  const double half = turn_rad / 2, chord = half == 0 ? way_m : way_m * std::sin(half) / half;
  return to_matrix({.position_m = {chord * std::cos(half), chord * std::sin(half), 0}, .yaw_rad = turn_rad});
}

}  // namespace

AttributeRows<OdometryDesc> OdometryDesc::rows() {
  using Desc = OdometryDesc;
  constexpr AttributeLimits kScaleError{.min = -1, .open_min = true};
  return {row(&Desc::wheels, "kind", {{false, "ideal"}, {true, "wheel"}},
              "ideal: the true motion; wheel: the ways of two wheels, added up"),
          row(&Desc::wheel_separation_m, "wheel_separation", "m", kAboveZero, "wheel: distance between the wheels"),
          row(&Desc::left_scale_error, "left_scale_error", "", kScaleError,
              "wheel: share by which the way of the left wheel is counted too long"),
          row(&Desc::right_scale_error, "right_scale_error", "", kScaleError,
              "wheel: share by which the way of the right wheel is counted too long"),
          row(&Desc::slip_stddev_sqrt_m, "slip_stddev", "m/sqrt(m)", kNotNegative,
              "wheel: standard deviation of the counted way of each wheel after one metre; it grows with the square "
              "root"),
          AttributeSpec{.name = "tf",
                        .kind = AttributeKind::choice,
                        .default_value = "none",
                        .text = "what messages have in /tf of the part that carries the sensor: none: its true pose in "
                                "the world; odom: its pose in odom_frame as the sensor measures it; map: that, and the "
                                "true transform from the world to odom_frame",
                        .choices = "none odom map"},
          AttributeSpec{.name = "odom_frame",
                        .kind = AttributeKind::text,
                        .default_value = "odom",
                        .text = "the frame of the pose in messages"},
          kRateAttribute};
}

OdometrySensor::OdometrySensor(const std::string& name, const OdometryDesc& desc)
    : ReadingSensor(odometry_columns(desc)), desc_(desc), random_(desc.seed, name + "/wheels") {}

// The counted ways l and r of the wheels have the variances s^2 |l| and s^2 |r|; the motion is ((l + r) / 2,
// (r - l) / separation), and a pose behind it follows from the pose before by an arc, whose chord stands at half its
// turn.
void OdometrySensor::count_covariances(const glm::dvec2& counted_m, double seconds, State& state) const {
  const double separation_m = desc_.wheel_separation_m, slip2 = desc_.slip_stddev_sqrt_m * desc_.slip_stddev_sqrt_m;
  const double left_m2 = slip2 * std::abs(counted_m[0]), right_m2 = slip2 * std::abs(counted_m[1]);
  glm::dmat2 motion(0);  // of the way and the turn
  motion[0][0] = (left_m2 + right_m2) / 4;
  motion[0][1] = motion[1][0] = (right_m2 - left_m2) / (2 * separation_m);
  motion[1][1] = (left_m2 + right_m2) / (separation_m * separation_m);
  state.velocity_covariance = motion / (seconds * seconds);
  const double way_m = (counted_m[0] + counted_m[1]) / 2, turn_rad = (counted_m[1] - counted_m[0]) / separation_m;
  const glm::dmat4& before = before_.start_from_sensor;
  const double middle_rad = std::atan2(before[0][1], before[0][0]) + turn_rad / 2;
  const double x = std::cos(middle_rad), y = std::sin(middle_rad);
  glm::dmat3 by_pose(1);  // column by column: by x, y and the heading before
  by_pose[2] = {-way_m * y, way_m * x, 1};
  const glm::dvec3 by_way(x, y, 0), by_turn(-way_m * y / 2, way_m * x / 2, 1);
  state.pose_covariance = by_pose * before_.pose_covariance * glm::transpose(by_pose) +
                          motion[0][0] * glm::outerProduct(by_way, by_way) +
                          motion[0][1] * (glm::outerProduct(by_way, by_turn) + glm::outerProduct(by_turn, by_way)) +
                          motion[1][1] * glm::outerProduct(by_turn, by_turn);
}

glm::dvec2 OdometrySensor::count_wheels(const FrameTime& time, double seconds, Twist& twist) const {
  const double forward_m = twist.linear_mps.x * seconds, turn_rad = twist.angular_radps.z * seconds;
  const double errors[] = {desc_.left_scale_error, desc_.right_scale_error};
  glm::dvec2 counted_m(0);
  for (std::uint32_t wheel = 0; wheel < 2; ++wheel) {
    const double side = wheel == 0 ? -1 : 1;
    const double way_m = forward_m + side * turn_rad * desc_.wheel_separation_m / 2;
    counted_m[wheel] = way_m * (1 + errors[wheel]);
    if (desc_.slip_stddev_sqrt_m == 0) continue;
    counted_m[wheel] +=
        desc_.slip_stddev_sqrt_m * std::sqrt(std::abs(way_m)) * random_.gaussian(random_key(time), wheel, 0);
  }
  twist = {.angular_radps = {0, 0, (counted_m[1] - counted_m[0]) / desc_.wheel_separation_m / seconds},
           .linear_mps = {(counted_m[0] + counted_m[1]) / 2 / seconds, 0, 0}};
  return counted_m;
}

void OdometrySensor::advance(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  // A frame that failed is made again, from the measurement before it.
  if (!now_.any || time.time_ns != now_.time_ns) before_ = now_;
  now_.time_ns = time.time_ns;
  now_.world_from_sensor = world_from_sensor;
  now_.any = true;
  if (!before_.any) {
    world_from_start_ = world_from_sensor;
    return;
  }
  const double seconds = static_cast<double>(time.time_ns - before_.time_ns) / 1e9;
  now_.twist = twist_between(before_.world_from_sensor, world_from_sensor, seconds);
  if (!desc_.wheels) {
    now_.start_from_sensor = rigid_inverse(world_from_start_) * world_from_sensor;
    return;
  }
  const glm::dvec2 counted_m = count_wheels(time, seconds, now_.twist);
  if (desc_.has_covariances()) count_covariances(counted_m, seconds, now_);
  now_.start_from_sensor =
      before_.start_from_sensor * along_arc(now_.twist.linear_mps.x * seconds, now_.twist.angular_radps.z * seconds);
}

void OdometrySensor::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  advance(time, world_from_sensor());
  const auto [position, q] = pose_of(now_.start_from_sensor);
  const glm::dvec3 &v = now_.twist.linear_mps, &w = now_.twist.angular_radps;
  std::vector<double> values{position.x, position.y, position.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z};
  if (desc_.has_covariances()) {
    const glm::dmat3& p = now_.pose_covariance;
    const glm::dmat2& m = now_.velocity_covariance;
    values.insert(values.end(), {p[0][0], p[0][1], p[0][2], p[1][1], p[1][2], p[2][2], m[0][0], m[0][1], m[1][1]});
  }
  set_reading(time, std::move(values));
}

}  // namespace simvis
