#include "exchange/packets/driver_clouds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/assert.h"
#include "exchange/messages/cloud.h"
#include "exchange/messages/from_pose.h"
#include "exchange/messages/from_scan.h"
#include "exchange/packets/device_packet.h"

namespace simvis::ros {
namespace {

/// What drivers say of beams beside their points.
class DriverBeams {
 public:
  explicit DriverBeams(const Scan& scan)
      : scan_(scan),
        first_ns_(first_beam_ns(scan)),
        times_s_(scan.channel("time_s")),
        intensity_(scan.channel("intensity")),
        reflectivity_(scan.channel("reflectivity")) {}

  /// Nanoseconds behind the first beam.
  double age_ns(std::size_t i) const {
    if (times_s_.empty()) return 0;
    return std::max(std::round(times_s_[i] * 1e9 - static_cast<double>(first_ns_)), 0.0);
  }
  std::uint8_t reflectivity(std::size_t i) const {
    if (reflectivity_.empty()) return quantised_reflectivity(scan_, intensity_, i);
    return reflectivity_[i] > 0 ? static_cast<std::uint8_t>(std::min(reflectivity_[i], 255.0)) : std::uint8_t{0};
  }
  std::uint16_t signal(std::size_t i) const { return quantised_signal(intensity_, i); }
  std::uint32_t range_mm(std::size_t i) const { return quantised_range(scan_.range_m[i], 0.001, ~std::uint32_t{0}); }
  std::uint32_t ring(std::size_t i) const { return scan_.ring_of(i); }

 private:
  const Scan& scan_;
  std::int64_t first_ns_;
  SharedNumbers<double> times_s_, intensity_, reflectivity_;
};

constexpr CloudField kVelodyneFields[] = {{"intensity", kFloat32, 12}, {"ring", kUint16, 16}, {"time", kFloat32, 18}};
constexpr std::uint32_t kVelodyneStep = 22;
constexpr CloudField kOusterFields[] = {{"intensity", kFloat32, 16},   {"t", kUint32, 20},
                                        {"reflectivity", kUint16, 24}, {"ring", kUint16, 26},
                                        {"ambient", kUint16, 28},      {"range", kUint32, 32}};
constexpr std::uint32_t kOusterStep = 48;
constexpr CloudField kLivoxFields[] = {
    {"intensity", kFloat32, 12}, {"tag", kUint8, 16}, {"line", kUint8, 17}, {"timestamp", kFloat64, 18}};
constexpr std::uint32_t kLivoxStep = 26;

}  // namespace

PointCloud2 driver_cloud(std::string_view driver, const Scan& scan, const std::string& frame_id, bool dense) {
  const Header header = header_of(stamp_ns(scan), frame_id);
  const DriverBeams beams(scan);
  const std::vector<glm::dvec3> points = returned_points(scan);
  PointCloud2 cloud;
  if (driver == "velodyne") {
    cloud = empty_cloud(header, kVelodyneFields, kVelodyneStep);
    fill_cloud(cloud, points, 1, true, [&](std::size_t i, std::uint8_t* point) {
      put(point, 12, static_cast<float>(beams.reflectivity(i)));
      put(point, 16, static_cast<std::uint16_t>(beams.ring(i)));
      put(point, 18, static_cast<float>(beams.age_ns(i) / 1e9));
    });
  } else if (driver == "ouster") {
    cloud = empty_cloud(header, kOusterFields, kOusterStep);
    fill_cloud(cloud, points, scan.rings, dense, [&](std::size_t i, std::uint8_t* point) {
      put(point, 16, static_cast<float>(beams.signal(i)));
      put(point, 20, static_cast<std::uint32_t>(beams.age_ns(i)));
      put(point, 24, static_cast<std::uint16_t>(beams.reflectivity(i)));
      put(point, 26, static_cast<std::uint16_t>(beams.ring(i)));
      put(point, 32, beams.range_mm(i));
    });
  } else {
    SIMVIS_ASSERT(driver == "livox");
    const auto stamp = static_cast<double>(stamp_ns(scan));
    cloud = empty_cloud(header, kLivoxFields, kLivoxStep);
    fill_cloud(cloud, points, 1, true, [&](std::size_t i, std::uint8_t* point) {
      put(point, 12, static_cast<float>(beams.reflectivity(i)));
      put(point, 17, static_cast<std::uint8_t>(beams.ring(i)));
      put(point, 18, stamp + beams.age_ns(i));
    });
  }
  return cloud;
}

CustomMsg livox_message(const Scan& scan, const std::string& frame_id) {
  const DriverBeams beams(scan);
  const std::vector<glm::dvec3> points = returned_points(scan);
  CustomMsg message;
  message.header = header_of(stamp_ns(scan), frame_id);
  message.timebase = static_cast<std::uint64_t>(stamp_ns(scan));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(points[i].x)) continue;
    message.points.push_back({.offset_time = static_cast<std::uint32_t>(beams.age_ns(i)),
                              .x = static_cast<float>(points[i].x),
                              .y = static_cast<float>(points[i].y),
                              .z = static_cast<float>(points[i].z),
                              .reflectivity = beams.reflectivity(i),
                              .tag = 0,
                              .line = static_cast<std::uint8_t>(beams.ring(i))});
  }
  message.point_num = static_cast<std::uint32_t>(message.points.size());
  return message;
}

}  // namespace simvis::ros
