// Messages of sensor_msgs and stereo_msgs. Metres, radians, seconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct LaserScan {
  SIMVIS_MESSAGE("sensor_msgs/msg/LaserScan", header, angle_min, angle_max, angle_increment, time_increment, scan_time,
                 range_min, range_max, ranges, intensities);
  Header header;
  float angle_min = 0;
  float angle_max = 0;
  float angle_increment = 0;
  float time_increment = 0;
  float scan_time = 0;
  float range_min = 0;
  float range_max = 0;
  std::vector<float> ranges;
  std::vector<float> intensities;
};

struct PointField {
  SIMVIS_MESSAGE("sensor_msgs/msg/PointField", name, offset, datatype, count);
  static constexpr std::string_view kConstants =
      "uint8 INT8=1\n"
      "uint8 UINT8=2\n"
      "uint8 INT16=3\n"
      "uint8 UINT16=4\n"
      "uint8 INT32=5\n"
      "uint8 UINT32=6\n"
      "uint8 FLOAT32=7\n"
      "uint8 FLOAT64=8\n";
  std::string name;
  std::uint32_t offset = 0;   ///< in bytes
  std::uint8_t datatype = 0;  ///< 1 INT8, 2 UINT8, 3 INT16, 4 UINT16, 5 INT32, 6 UINT32, 7 FLOAT32, 8 FLOAT64
  std::uint32_t count = 0;
};

struct PointCloud2 {
  SIMVIS_MESSAGE("sensor_msgs/msg/PointCloud2", header, height, width, fields, is_bigendian, point_step, row_step, data,
                 is_dense);
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0;  ///< in bytes
  std::uint32_t row_step = 0;    ///< in bytes
  std::vector<std::uint8_t> data;
  bool is_dense = false;  ///< no point is NaN
};

struct Image {
  SIMVIS_MESSAGE("sensor_msgs/msg/Image", header, height, width, encoding, is_bigendian, step, data);
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;          ///< bytes per row
  std::vector<std::uint8_t> data;  ///< rows from the top
};

struct CompressedImage {
  SIMVIS_MESSAGE("sensor_msgs/msg/CompressedImage", header, format, data);
  Header header;
  std::string format;
  std::vector<std::uint8_t> data;
};

struct RegionOfInterest {
  SIMVIS_MESSAGE("sensor_msgs/msg/RegionOfInterest", x_offset, y_offset, height, width, do_rectify);
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;
};

struct CameraInfo {
  SIMVIS_MESSAGE("sensor_msgs/msg/CameraInfo", header, height, width, distortion_model, d, k, r, p, binning_x,
                 binning_y, roi);
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};
  std::array<double, 9> r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi;
};

/// As of ROS 2 Jazzy; Humble has no variance.
struct Range {
  SIMVIS_MESSAGE("sensor_msgs/msg/Range", header, radiation_type, field_of_view, min_range, max_range, range, variance);
  static constexpr std::string_view kConstants =
      "uint8 ULTRASOUND=0\n"
      "uint8 INFRARED=1\n";
  Header header;
  std::uint8_t radiation_type = 0;
  float field_of_view = 0;
  float min_range = 0;
  float max_range = 0;
  float range = 0;
  float variance = 0;  ///< 0: unknown
};

struct Imu {
  SIMVIS_MESSAGE("sensor_msgs/msg/Imu", header, orientation, orientation_covariance, angular_velocity,
                 angular_velocity_covariance, linear_acceleration, linear_acceleration_covariance);
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};  ///< by rows; -1 first: there is no estimate
  Vector3 angular_velocity;
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;  ///< specific force: a device at rest has +9.8 upwards
  std::array<double, 9> linear_acceleration_covariance{};
};

struct NavSatStatus {
  SIMVIS_MESSAGE("sensor_msgs/msg/NavSatStatus", status, service);
  static constexpr std::string_view kConstants =
      "int8 STATUS_UNKNOWN=-2\n"
      "int8 STATUS_NO_FIX=-1\n"
      "int8 STATUS_FIX=0\n"
      "int8 STATUS_SBAS_FIX=1\n"
      "int8 STATUS_GBAS_FIX=2\n"
      "uint16 SERVICE_UNKNOWN=0\n"
      "uint16 SERVICE_GPS=1\n"
      "uint16 SERVICE_GLONASS=2\n"
      "uint16 SERVICE_COMPASS=4\n"
      "uint16 SERVICE_GALILEO=8\n";
  std::int8_t status = 0;     ///< -1: no fix, 0: fix
  std::uint16_t service = 0;  ///< 1: GPS
};

struct NavSatFix {
  SIMVIS_MESSAGE("sensor_msgs/msg/NavSatFix", header, status, latitude, longitude, altitude, position_covariance,
                 position_covariance_type);
  static constexpr std::string_view kConstants =
      "uint8 COVARIANCE_TYPE_UNKNOWN=0\n"
      "uint8 COVARIANCE_TYPE_APPROXIMATED=1\n"
      "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n"
      "uint8 COVARIANCE_TYPE_KNOWN=3\n";
  Header header;
  NavSatStatus status;
  double latitude = 0;                          ///< degrees north
  double longitude = 0;                         ///< degrees east
  double altitude = 0;                          ///< metres above the ellipsoid of WGS 84
  std::array<double, 9> position_covariance{};  ///< east, north, up; square metres
  std::uint8_t position_covariance_type = 0;    ///< 0 unknown, 2 known diagonal, 3 known
};

struct MagneticField {
  SIMVIS_MESSAGE("sensor_msgs/msg/MagneticField", header, magnetic_field, magnetic_field_covariance);
  Header header;
  Vector3 magnetic_field;  ///< tesla
  std::array<double, 9> magnetic_field_covariance{};
};

struct FluidPressure {
  SIMVIS_MESSAGE("sensor_msgs/msg/FluidPressure", header, fluid_pressure, variance);
  Header header;
  double fluid_pressure = 0;  ///< pascal, absolute
  double variance = 0;        ///< 0: unknown
};

struct JointState {
  SIMVIS_MESSAGE("sensor_msgs/msg/JointState", header, name, position, velocity, effort);
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;  ///< rad or m
  std::vector<double> velocity;  ///< rad/s or m/s
  std::vector<double> effort;    ///< N m or N; empty: not measured
};

struct Illuminance {
  SIMVIS_MESSAGE("sensor_msgs/msg/Illuminance", header, illuminance, variance);
  Header header;
  double illuminance = 0;  ///< lux
  double variance = 0;     ///< 0: unknown
};

struct DisparityImage {
  SIMVIS_MESSAGE("stereo_msgs/msg/DisparityImage", header, image, f, t, valid_window, min_disparity, max_disparity,
                 delta_d);
  Header header;
  Image image;
  float f = 0;  ///< focal length in pixels
  float t = 0;  ///< baseline
  RegionOfInterest valid_window;
  float min_disparity = 0;
  float max_disparity = 0;
  float delta_d = 0;
};

}  // namespace simvis::ros
