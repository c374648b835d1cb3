// Messages of sensor_msgs and stereo_msgs. Metres, radians, seconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct LaserScan {
  static constexpr std::string_view kName = "sensor_msgs/msg/LaserScan";
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
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &LaserScan::header},
                      Field{"angle_min", &LaserScan::angle_min},
                      Field{"angle_max", &LaserScan::angle_max},
                      Field{"angle_increment", &LaserScan::angle_increment},
                      Field{"time_increment", &LaserScan::time_increment},
                      Field{"scan_time", &LaserScan::scan_time},
                      Field{"range_min", &LaserScan::range_min},
                      Field{"range_max", &LaserScan::range_max},
                      Field{"ranges", &LaserScan::ranges},
                      Field{"intensities", &LaserScan::intensities}};
  }
};

struct PointField {
  static constexpr std::string_view kName = "sensor_msgs/msg/PointField";
  std::string name;
  std::uint32_t offset = 0;   ///< in bytes
  std::uint8_t datatype = 0;  ///< 1 INT8, 2 UINT8, 3 INT16, 4 UINT16, 5 INT32, 6 UINT32, 7 FLOAT32, 8 FLOAT64
  std::uint32_t count = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"name", &PointField::name}, Field{"offset", &PointField::offset},
                      Field{"datatype", &PointField::datatype}, Field{"count", &PointField::count}};
  }
};

struct PointCloud2 {
  static constexpr std::string_view kName = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0;  ///< in bytes
  std::uint32_t row_step = 0;    ///< in bytes
  std::vector<std::uint8_t> data;
  bool is_dense = false;  ///< no point is NaN
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &PointCloud2::header},
                      Field{"height", &PointCloud2::height},
                      Field{"width", &PointCloud2::width},
                      Field{"fields", &PointCloud2::fields},
                      Field{"is_bigendian", &PointCloud2::is_bigendian},
                      Field{"point_step", &PointCloud2::point_step},
                      Field{"row_step", &PointCloud2::row_step},
                      Field{"data", &PointCloud2::data},
                      Field{"is_dense", &PointCloud2::is_dense}};
  }
};

struct Image {
  static constexpr std::string_view kName = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;          ///< bytes per row
  std::vector<std::uint8_t> data;  ///< rows from the top
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &Image::header},
                      Field{"height", &Image::height},
                      Field{"width", &Image::width},
                      Field{"encoding", &Image::encoding},
                      Field{"is_bigendian", &Image::is_bigendian},
                      Field{"step", &Image::step},
                      Field{"data", &Image::data}};
  }
};

struct CompressedImage {
  static constexpr std::string_view kName = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;
  std::vector<std::uint8_t> data;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &CompressedImage::header}, Field{"format", &CompressedImage::format},
                      Field{"data", &CompressedImage::data}};
  }
};

struct RegionOfInterest {
  static constexpr std::string_view kName = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;
  static constexpr auto field_table() {
    return std::tuple{Field{"x_offset", &RegionOfInterest::x_offset}, Field{"y_offset", &RegionOfInterest::y_offset},
                      Field{"height", &RegionOfInterest::height}, Field{"width", &RegionOfInterest::width},
                      Field{"do_rectify", &RegionOfInterest::do_rectify}};
  }
};

struct CameraInfo {
  static constexpr std::string_view kName = "sensor_msgs/msg/CameraInfo";
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
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &CameraInfo::header},
                      Field{"height", &CameraInfo::height},
                      Field{"width", &CameraInfo::width},
                      Field{"distortion_model", &CameraInfo::distortion_model},
                      Field{"d", &CameraInfo::d},
                      Field{"k", &CameraInfo::k},
                      Field{"r", &CameraInfo::r},
                      Field{"p", &CameraInfo::p},
                      Field{"binning_x", &CameraInfo::binning_x},
                      Field{"binning_y", &CameraInfo::binning_y},
                      Field{"roi", &CameraInfo::roi}};
  }
};

/// As of ROS 2 Jazzy; Humble has no variance.
struct Range {
  static constexpr std::string_view kName = "sensor_msgs/msg/Range";
  Header header;
  std::uint8_t radiation_type = 0;
  float field_of_view = 0;
  float min_range = 0;
  float max_range = 0;
  float range = 0;
  float variance = 0;  ///< 0: unknown
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &Range::header},
                      Field{"radiation_type", &Range::radiation_type},
                      Field{"field_of_view", &Range::field_of_view},
                      Field{"min_range", &Range::min_range},
                      Field{"max_range", &Range::max_range},
                      Field{"range", &Range::range},
                      Field{"variance", &Range::variance}};
  }
};

struct Imu {
  static constexpr std::string_view kName = "sensor_msgs/msg/Imu";
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};  ///< by rows; -1 first: there is no estimate
  Vector3 angular_velocity;
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;  ///< specific force: a device at rest has +9.8 upwards
  std::array<double, 9> linear_acceleration_covariance{};
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &Imu::header},
                      Field{"orientation", &Imu::orientation},
                      Field{"orientation_covariance", &Imu::orientation_covariance},
                      Field{"angular_velocity", &Imu::angular_velocity},
                      Field{"angular_velocity_covariance", &Imu::angular_velocity_covariance},
                      Field{"linear_acceleration", &Imu::linear_acceleration},
                      Field{"linear_acceleration_covariance", &Imu::linear_acceleration_covariance}};
  }
};

struct NavSatStatus {
  static constexpr std::string_view kName = "sensor_msgs/msg/NavSatStatus";
  std::int8_t status = 0;     ///< -1: no fix, 0: fix
  std::uint16_t service = 0;  ///< 1: GPS
  static constexpr auto field_table() {
    return std::tuple{Field{"status", &NavSatStatus::status}, Field{"service", &NavSatStatus::service}};
  }
};

struct NavSatFix {
  static constexpr std::string_view kName = "sensor_msgs/msg/NavSatFix";
  Header header;
  NavSatStatus status;
  double latitude = 0;                          ///< degrees north
  double longitude = 0;                         ///< degrees east
  double altitude = 0;                          ///< metres above the ellipsoid of WGS 84
  std::array<double, 9> position_covariance{};  ///< east, north, up; square metres
  std::uint8_t position_covariance_type = 0;    ///< 0 unknown, 2 known diagonal
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &NavSatFix::header},
                      Field{"status", &NavSatFix::status},
                      Field{"latitude", &NavSatFix::latitude},
                      Field{"longitude", &NavSatFix::longitude},
                      Field{"altitude", &NavSatFix::altitude},
                      Field{"position_covariance", &NavSatFix::position_covariance},
                      Field{"position_covariance_type", &NavSatFix::position_covariance_type}};
  }
};

struct MagneticField {
  static constexpr std::string_view kName = "sensor_msgs/msg/MagneticField";
  Header header;
  Vector3 magnetic_field;  ///< tesla
  std::array<double, 9> magnetic_field_covariance{};
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &MagneticField::header}, Field{"magnetic_field", &MagneticField::magnetic_field},
                      Field{"magnetic_field_covariance", &MagneticField::magnetic_field_covariance}};
  }
};

struct FluidPressure {
  static constexpr std::string_view kName = "sensor_msgs/msg/FluidPressure";
  Header header;
  double fluid_pressure = 0;  ///< pascal, absolute
  double variance = 0;        ///< 0: unknown
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &FluidPressure::header}, Field{"fluid_pressure", &FluidPressure::fluid_pressure},
                      Field{"variance", &FluidPressure::variance}};
  }
};

struct JointState {
  static constexpr std::string_view kName = "sensor_msgs/msg/JointState";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;  ///< rad or m
  std::vector<double> velocity;  ///< rad/s or m/s
  std::vector<double> effort;    ///< N m or N; empty: not measured
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &JointState::header}, Field{"name", &JointState::name},
                      Field{"position", &JointState::position}, Field{"velocity", &JointState::velocity},
                      Field{"effort", &JointState::effort}};
  }
};

struct Illuminance {
  static constexpr std::string_view kName = "sensor_msgs/msg/Illuminance";
  Header header;
  double illuminance = 0;  ///< lux
  double variance = 0;     ///< 0: unknown
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &Illuminance::header}, Field{"illuminance", &Illuminance::illuminance},
                      Field{"variance", &Illuminance::variance}};
  }
};

struct DisparityImage {
  static constexpr std::string_view kName = "stereo_msgs/msg/DisparityImage";
  Header header;
  Image image;
  float f = 0;  ///< focal length in pixels
  float t = 0;  ///< baseline
  RegionOfInterest valid_window;
  float min_disparity = 0;
  float max_disparity = 0;
  float delta_d = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &DisparityImage::header},
                      Field{"image", &DisparityImage::image},
                      Field{"f", &DisparityImage::f},
                      Field{"t", &DisparityImage::t},
                      Field{"valid_window", &DisparityImage::valid_window},
                      Field{"min_disparity", &DisparityImage::min_disparity},
                      Field{"max_disparity", &DisparityImage::max_disparity},
                      Field{"delta_d", &DisparityImage::delta_d}};
  }
};

}  // namespace simvis::ros
