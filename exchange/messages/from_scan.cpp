#include "exchange/messages/from_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exchange/messages/cloud.h"
#include "exchange/messages/from_pose.h"

namespace simvis::ros {

namespace {

// Azimuths count as evenly spaced if none lies further than this from its even place: far below the width of any beam,
// far above rounding.
constexpr double kEvenAngle_rad = 1e-9;
// The same limit for the times of beams: a time_s is computed in double from numbers of at most days.
constexpr double kEvenTime_s = 1e-9;

/// The step from one value to the next, if all are `step` apart within `tolerance`.
template <typename Values>
std::optional<double> even_step(const Values& values, double tolerance) {
  if (values.size() < 2) return 0.0;
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values[i] - (values.front() + static_cast<double>(i) * step)) <= tolerance)) return std::nullopt;
  }
  return step;
}

/// As REP 117 says it of a range that is 0 for too near.
float reported(double range_m) {
  return range_m == 0 ? -std::numeric_limits<float>::infinity() : static_cast<float>(range_m);
}

struct CloudColumn {
  CloudField field;
  const MeasuredArray* channel;
  double minus = 0;
};

/// The columns behind x, y, z, error_bound_m and ring.
std::vector<CloudColumn> channel_columns(const Scan& scan, std::uint32_t& step) {
  std::vector<CloudColumn> columns;
  for (const MeasuredArray& channel : scan.channels()) {
    const bool time = channel.name == "time_s", speed = channel.name == kTrueRadialSpeed;
    const bool single = time || speed || channel.name == "intensity";
    columns.push_back({{time    ? "time"
                        : speed ? "radial_speed"
                                : std::string_view(channel.name),
                        single ? kFloat32 : kFloat64, step},
                       &channel,
                       time ? static_cast<double>(first_beam_ns(scan)) / 1e9 : 0});
    step += single ? sizeof(float) : sizeof(double);
  }
  return columns;
}

/// The same scan in the opposite order of beams. Those of a clockwise sweep stand in the order in which they fire.
void turn_around(LaserScan& message) {
  std::swap(message.angle_min, message.angle_max);
  message.angle_increment = -message.angle_increment;
  std::ranges::reverse(message.ranges);
  std::ranges::reverse(message.intensities);
}

}  // namespace

std::int64_t first_beam_ns(const Scan& scan) {
  const SharedNumbers<double> times_s = scan.channel("time_s");
  if (times_s.empty()) return scan.time_ns;
  return static_cast<std::int64_t>(std::floor(*std::ranges::min_element(times_s) * 1e9));
}

std::int64_t stamp_ns(const Scan& scan) { return std::max<std::int64_t>(first_beam_ns(scan), 0); }

std::vector<glm::dvec3> returned_points(const Scan& scan) {
  std::vector<glm::dvec3> points = scan.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (scan.range_m[i] == 0) points[i] = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  }
  return points;
}

std::optional<LaserScan> laser_scan(const Scan& scan, const std::string& frame_id, const RangeLimits& limits,
                                    double scan_time_s) {
  if (scan.rings != 1 || scan.beams == 0 || !scan.origin_m.empty()) return std::nullopt;
  if (std::ranges::any_of(scan.elevation_rad, [](double elevation) { return elevation != 0; })) return std::nullopt;
  const std::optional<double> increment = even_step(scan.azimuth_rad, kEvenAngle_rad);
  if (!increment || *increment < 0) return std::nullopt;
  LaserScan message;
  message.header = header_of(stamp_ns(scan), frame_id);
  message.angle_min = static_cast<float>(scan.azimuth_rad.front());
  message.angle_max = static_cast<float>(scan.azimuth_rad.back());
  message.angle_increment = static_cast<float>(*increment);
  message.scan_time = static_cast<float>(scan_time_s);
  message.range_min = static_cast<float>(limits.min_m);
  message.range_max = static_cast<float>(limits.max_m);
  message.ranges.reserve(scan.range_m.size());
  for (const float range : scan.range_m) message.ranges.push_back(reported(range));
  const SharedNumbers<double> intensities = scan.channel("intensity"), times_s = scan.channel("time_s");
  message.intensities.assign(intensities.begin(), intensities.end());
  const double step_s = even_step(times_s, kEvenTime_s).value_or(0);
  message.time_increment = static_cast<float>(std::abs(step_s));
  if (step_s < 0) turn_around(message);
  return message;
}

PointCloud2 point_cloud(const Scan& scan, const std::string& frame_id, bool dense) {
  constexpr std::uint32_t kBoundAt = 3 * sizeof(float), kRingAt = 4 * sizeof(float);
  std::uint32_t step = kRingAt + sizeof(std::uint16_t);
  const std::vector<CloudColumn> columns = channel_columns(scan, step);
  std::vector<CloudField> fields = {{"error_bound_m", kFloat32, kBoundAt}, {"ring", kUint16, kRingAt}};
  for (const CloudColumn& column : columns) fields.push_back(column.field);
  PointCloud2 cloud = empty_cloud(header_of(stamp_ns(scan), frame_id), fields, step);
  fill_cloud(cloud, returned_points(scan), scan.rings, dense, [&](std::size_t i, std::uint8_t* point) {
    put(point, kBoundAt, scan.error_bound_m[i]);
    put(point, kRingAt, static_cast<std::uint16_t>(scan.ring_of(i)));
    for (const CloudColumn& column : columns) {
      const double value = column.channel->number(i) - column.minus;
      if (column.field.datatype == kFloat64) put(point, column.field.offset, value);
      if (column.field.datatype == kFloat32) put(point, column.field.offset, static_cast<float>(value));
    }
  });
  return cloud;
}

}  // namespace simvis::ros
