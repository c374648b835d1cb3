// Messages from readings: the one place that says which columns and constants of a reading each message uses.
//
//   sensor_msgs/msg/Imu            imu: angular_velocity_{x,y,z}_rad_s, specific_force_{x,y,z}_m_s2;
//                                  angular_velocity_variance, specific_force_variance; of an orientation qx, qy, qz,
//                                  qw and orientation_variance
//   sensor_msgs/msg/NavSatFix      fix: latitude_deg, longitude_deg, altitude_m; horizontal_variance,
//   vertical_variance;
//                                  of a fix by satellites {east,north,up}_variance, east_north_covariance,
//                                  east_up_covariance, north_up_covariance. Status -1 if the latitude is NaN
//   geometry_msgs/msg/TwistWithCovarianceStamped  fix_velocity: velocity_{east,north,up}_m_s; velocity_variance. None
//                                  if the velocity is NaN
//   sensor_msgs/msg/MagneticField  magnetic_field: field_{x,y,z}_t; field_variance
//   sensor_msgs/msg/FluidPressure  pressure: pressure_pa; pressure_variance
//   sensor_msgs/msg/Range          range: range_m; field_of_view_rad, range_min_m, range_max_m, radiation_type,
//                                  range_variance
//   sensor_msgs/msg/JointState     joint_states: JOINT.position_*, JOINT.velocity_*, JOINT.effort_*
//   sensor_msgs/msg/Illuminance    illuminance: illuminance_lx; illuminance_variance
//   nav_msgs/msg/Odometry          odometry: x_m, y_m, z_m, qx, qy, qz, qw, velocity_{x,y,z}_m_s,
//                                  angular_velocity_{x,y,z}_rad_s; of wheels that slip, all columns of covariances
//   geometry_msgs/msg/WrenchStamped  wrench: force_{x,y,z}_n, torque_{x,y,z}_n_m
//   sensor_msgs/msg/PointCloud2    points: a field of float64 for each column of a table; x_m, y_m and z_m are x, y and
//                                  z in float32, as readers of clouds expect them
//
// Each row has the message, the last part of its topic, the columns, and the constants.
// A missing constant is 0, which these messages take for "not known". As REP 117 says, a range that is 0 for
// too near becomes -infinity.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <simvis/measurement.h>
#include "exchange/messages/description.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"

namespace simvis::ros {

/// A message, and the last part of its topic.
struct ReadingMessage {
  std::string_view topic;
  std::variant<Imu, NavSatFix, TwistWithCovarianceStamped, MagneticField, FluidPressure, Range, JointState, Illuminance,
               Odometry, WrenchStamped, PointCloud2>
      message;
};

/// The topic's last part and the type of messages from readings.
struct ReadingTopic {
  std::string_view topic;
  const TypeDescription* type;  ///< valid for the rest of the program
};

/// Empty if this message type is none of those above.
std::optional<ReadingTopic> reading_topic(std::string_view type);

/// The message of this type from a reading with all columns that the type needs (asserted). Empty if there is none of
/// this name, if the reading has no rows, or if the row has nothing for the message.
std::optional<ReadingMessage> message_of(const Reading& reading, std::string_view type, const std::string& frame_id);

}  // namespace simvis::ros
