#include "exchange/messages/from_reading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/assert.h"
#include "exchange/messages/cloud.h"
#include "exchange/messages/from_pose.h"

namespace simvis::ros {

namespace {

constexpr std::uint8_t kKnownDiagonal = 2, kKnown = 3;
constexpr std::int8_t kNoFix = -1, kFix = 0;
constexpr std::uint16_t kGps = 1;
/// REP 105: the frame in which a robot's own motion is added up.
constexpr std::string_view kOdometryFrame = "odom";

double value_of(const Reading& reading, std::string_view column) {
  const std::optional<double> value = reading.find(column);
  SIMVIS_ASSERT(value);
  return *value;
}

Vector3 vector_of(const Reading& reading, const std::string& stem, const std::string& unit) {
  return {value_of(reading, stem + "_x_" + unit), value_of(reading, stem + "_y_" + unit),
          value_of(reading, stem + "_z_" + unit)};
}

double constant_of(const Reading& reading, std::string_view name) { return reading.constant(name).value_or(0); }

std::array<double, 9> diagonal(double x, double y, double z) { return {x, 0, 0, 0, y, 0, 0, 0, z}; }
std::array<double, 9> diagonal(double all) { return diagonal(all, all, all); }

Imu to_imu(const Reading& reading, const Header& header) {
  Imu message;
  message.header = header;
  if (reading.find("qw")) {
    message.orientation = {value_of(reading, "qx"), value_of(reading, "qy"), value_of(reading, "qz"),
                           value_of(reading, "qw")};
    message.orientation_covariance = diagonal(constant_of(reading, "orientation_variance"));
  } else {
    message.orientation.w = 1;
    message.orientation_covariance[0] = -1;
  }
  message.angular_velocity = vector_of(reading, "angular_velocity", "rad_s");
  message.angular_velocity_covariance = diagonal(constant_of(reading, "angular_velocity_variance"));
  message.linear_acceleration = vector_of(reading, "specific_force", "m_s2");
  message.linear_acceleration_covariance = diagonal(constant_of(reading, "specific_force_variance"));
  return message;
}

NavSatFix to_fix(const Reading& reading, const Header& header) {
  NavSatFix message;
  message.header = header;
  message.latitude = value_of(reading, "latitude_deg");
  message.longitude = value_of(reading, "longitude_deg");
  message.altitude = value_of(reading, "altitude_m");
  message.status = {std::isnan(message.latitude) ? kNoFix : kFix, kGps};
  if (message.status.status == kNoFix) return message;
  if (const double east = constant_of(reading, "east_variance"); east > 0) {
    const double east_north = constant_of(reading, "east_north_covariance"),
                 east_up = constant_of(reading, "east_up_covariance"),
                 north_up = constant_of(reading, "north_up_covariance");
    message.position_covariance = {east,
                                   east_north,
                                   east_up,
                                   east_north,
                                   constant_of(reading, "north_variance"),
                                   north_up,
                                   east_up,
                                   north_up,
                                   constant_of(reading, "up_variance")};
    message.position_covariance_type = kKnown;
    return message;
  }
  const double horizontal = constant_of(reading, "horizontal_variance");
  message.position_covariance = diagonal(horizontal, horizontal, constant_of(reading, "vertical_variance"));
  message.position_covariance_type = horizontal > 0 ? kKnownDiagonal : 0;
  return message;
}

// Receivers measure no turn: -1, as ublox_gps has it.
TwistWithCovarianceStamped to_twist(const Reading& reading, const Header& header) {
  constexpr std::size_t kRow = 6;
  TwistWithCovarianceStamped message;
  message.header = header;
  message.twist.twist.linear = {value_of(reading, "velocity_east_m_s"), value_of(reading, "velocity_north_m_s"),
                                value_of(reading, "velocity_up_m_s")};
  for (std::size_t i = 0; i < 3; ++i) {
    message.twist.covariance[i * (kRow + 1)] = constant_of(reading, "velocity_variance");
  }
  message.twist.covariance[3 * (kRow + 1)] = -1;
  return message;
}

MagneticField to_field(const Reading& reading, const Header& header) {
  return {header, vector_of(reading, "field", "t"), diagonal(constant_of(reading, "field_variance"))};
}

FluidPressure to_pressure(const Reading& reading, const Header& header) {
  return {header, value_of(reading, "pressure_pa"), constant_of(reading, "pressure_variance")};
}

Range to_range(const Reading& reading, const Header& header) {
  Range message;
  message.header = header;
  message.radiation_type = static_cast<std::uint8_t>(constant_of(reading, "radiation_type"));
  message.field_of_view = static_cast<float>(constant_of(reading, "field_of_view_rad"));
  message.min_range = static_cast<float>(constant_of(reading, "range_min_m"));
  message.max_range = static_cast<float>(constant_of(reading, "range_max_m"));
  const double range_m = value_of(reading, "range_m");
  message.range = range_m == 0 ? -std::numeric_limits<float>::infinity() : static_cast<float>(range_m);
  message.variance = static_cast<float>(constant_of(reading, "range_variance"));
  return message;
}

// A joint without an effort has NaN if another one has an effort.
JointState to_joints(const Reading& reading, const Header& header) {
  constexpr double kNoEffort = std::numeric_limits<double>::quiet_NaN();
  JointState message;
  message.header = header;
  for (const MeasuredArray& column : reading.arrays) {
    const std::size_t dot = column.name.rfind('.');
    if (dot == column.name.npos) continue;
    const std::string name = column.name.substr(0, dot), what = column.name.substr(dot + 1);
    if (std::ranges::find(message.name, name) == message.name.end()) message.name.push_back(name);
    if (what.starts_with("position")) message.position.push_back(column.number(0));
    if (what.starts_with("velocity")) message.velocity.push_back(column.number(0));
    if (!what.starts_with("effort")) continue;
    message.effort.resize(message.name.size() - 1, kNoEffort);
    message.effort.push_back(column.number(0));
  }
  if (!message.effort.empty()) message.effort.resize(message.name.size(), kNoEffort);
  return message;
}

Illuminance to_illuminance(const Reading& reading, const Header& header) {
  return {header, value_of(reading, "illuminance_lx"), constant_of(reading, "illuminance_variance")};
}

// Wheels measure x, y and yaw only: the other variances are kUnmeasured.
void set_covariances(const Reading& reading, Odometry& message) {
  constexpr std::size_t kX = 0, kY = 1, kZ = 2, kRoll = 3, kPitch = 4, kYaw = 5;
  const auto set = [&](std::array<double, 36>& covariance, std::size_t row, std::size_t column, double value) {
    covariance[row * 6 + column] = covariance[column * 6 + row] = value;
  };
  std::array<double, 36>&pose = message.pose.covariance, &twist = message.twist.covariance;
  for (const std::size_t i : {kZ, kRoll, kPitch}) set(pose, i, i, kUnmeasured);
  for (const std::size_t i : {kY, kZ, kRoll, kPitch}) set(twist, i, i, kUnmeasured);
  set(pose, kX, kX, value_of(reading, "variance_x_m2"));
  set(pose, kX, kY, value_of(reading, "covariance_x_y_m2"));
  set(pose, kX, kYaw, value_of(reading, "covariance_x_yaw_m_rad"));
  set(pose, kY, kY, value_of(reading, "variance_y_m2"));
  set(pose, kY, kYaw, value_of(reading, "covariance_y_yaw_m_rad"));
  set(pose, kYaw, kYaw, value_of(reading, "variance_yaw_rad2"));
  set(twist, kX, kX, value_of(reading, "variance_velocity_x_m2_s2"));
  set(twist, kX, kYaw, value_of(reading, "covariance_velocity_x_angular_velocity_z_m_rad_s2"));
  set(twist, kYaw, kYaw, value_of(reading, "variance_angular_velocity_z_rad2_s2"));
}

Odometry to_odometry(const Reading& reading, const Header& header) {
  Odometry message;
  message.header = header;
  message.child_frame_id = header.frame_id;
  message.header.frame_id = kOdometryFrame;
  message.pose.pose = {
      {value_of(reading, "x_m"), value_of(reading, "y_m"), value_of(reading, "z_m")},
      {value_of(reading, "qx"), value_of(reading, "qy"), value_of(reading, "qz"), value_of(reading, "qw")}};
  message.twist.twist = {vector_of(reading, "velocity", "m_s"), vector_of(reading, "angular_velocity", "rad_s")};
  if (reading.find("variance_x_m2")) set_covariances(reading, message);
  return message;
}

WrenchStamped to_wrench(const Reading& reading, const Header& header) {
  return {header, {vector_of(reading, "force", "n"), vector_of(reading, "torque", "n_m")}};
}

bool is_coordinate(const MeasuredArray& column) {
  return column.name == "x_m" || column.name == "y_m" || column.name == "z_m";
}

// x, y and z are float32, the only type in which readers of clouds, such as those of PCL, take them.
PointCloud2 to_cloud(const Reading& reading, const Header& header) {
  PointCloud2 cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(reading.rows());
  const std::size_t columns = reading.arrays.size();
  std::vector<bool> are_places;  // by column
  for (const MeasuredArray& column : reading.arrays) {
    const bool is_place = is_coordinate(column);
    are_places.push_back(is_place);
    cloud.fields.push_back(
        {is_place ? column.name.substr(0, 1) : column.name, cloud.point_step, is_place ? kFloat32 : kFloat64, 1});
    cloud.point_step += is_place ? sizeof(float) : sizeof(double);
  }
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(std::size_t{cloud.point_step} * reading.rows());
  const std::vector<double>& values = reading.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint8_t* const point = cloud.data.data() + i / columns * cloud.point_step;
    const std::uint32_t offset = cloud.fields[i % columns].offset;
    if (are_places[i % columns]) {
      put(point, offset, static_cast<float>(values[i]));
    } else {
      put(point, offset, values[i]);
    }
  }
  cloud.is_dense = std::ranges::none_of(values, [](double value) { return std::isnan(value); });
  return cloud;
}

template <typename M, M (*make)(const Reading&, const Header&)>
ReadingMessage made(std::string_view topic, const Reading& reading, const Header& header) {
  return {topic, make(reading, header)};
}

struct ReadingMessageType {
  std::string_view type, topic;
  ReadingMessage (*make)(std::string_view topic, const Reading& reading, const Header& header);
  const TypeDescription& (*describe)();
};
template <typename M, M (*make)(const Reading&, const Header&)>
constexpr ReadingMessageType row(std::string_view topic) {
  return {M::kName, topic, made<M, make>, describe<M>};
}
constexpr ReadingMessageType kReadingMessages[] = {
    row<Imu, to_imu>("imu"),
    row<NavSatFix, to_fix>("fix"),
    row<TwistWithCovarianceStamped, to_twist>("fix_velocity"),
    row<MagneticField, to_field>("magnetic_field"),
    row<FluidPressure, to_pressure>("pressure"),
    row<Range, to_range>("range"),
    row<JointState, to_joints>("joint_states"),
    row<Illuminance, to_illuminance>("illuminance"),
    row<Odometry, to_odometry>("odometry"),
    row<WrenchStamped, to_wrench>("wrench"),
    row<PointCloud2, to_cloud>("points"),
};

const ReadingMessageType* find_type(std::string_view type) {
  const auto found = std::ranges::find(kReadingMessages, type, &ReadingMessageType::type);
  return found == std::end(kReadingMessages) ? nullptr : found;
}

}  // namespace

std::optional<ReadingTopic> reading_topic(std::string_view type) {
  const ReadingMessageType* const found = find_type(type);
  return found == nullptr ? std::nullopt : std::optional(ReadingTopic{found->topic, &found->describe()});
}

std::optional<ReadingMessage> message_of(const Reading& reading, std::string_view type, const std::string& frame_id) {
  const ReadingMessageType* const found = find_type(type);
  if (found == nullptr || (reading.rows() == 0 && type != PointCloud2::kName)) return std::nullopt;
  const bool has_no_velocity =
      type == TwistWithCovarianceStamped::kName && std::isnan(value_of(reading, "velocity_east_m_s"));
  if (has_no_velocity) return std::nullopt;
  return found->make(found->topic, reading, header_of(reading.time_ns, frame_id));
}

}  // namespace simvis::ros
