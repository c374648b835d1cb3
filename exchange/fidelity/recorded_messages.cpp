#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <map>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/location.h>
#include "exchange/fidelity/recordings.h"
#include "exchange/messages/cdr.h"
#include "exchange/messages/mcap_reader.h"
#include "exchange/messages/types/sensor_types.h"

namespace simvis {
namespace {

constexpr double kMaxAngle_rad = 13;                      // two turns and rounding
constexpr std::size_t kMaxPoints = std::size_t{1} << 22;  // of a message, far above the beams of any scanner
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// Reads one field of points as doubles.
class PointNumber {
 public:
  PointNumber(const ros::PointCloud2& cloud, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) {
      for (const ros::PointField& field : cloud.fields) {
        if (field.name != name || field_ != nullptr) continue;
        if (field.offset + std::size_t{bytes_of(field.datatype)} > cloud.point_step) {
          throw InputError("field " + in_quotes(field.name) + " lies outside of its point");
        }
        field_ = &field;
      }
    }
  }

  bool is_there() const { return field_ != nullptr; }

  double of(const std::uint8_t* point) const {
    if (field_ == nullptr) return kNoNumber;
    const std::uint8_t* const at = point + field_->offset;
    switch (field_->datatype) {
      case 1:
        return number<std::int8_t>(at);
      case 2:
        return number<std::uint8_t>(at);
      case 3:
        return number<std::int16_t>(at);
      case 4:
        return number<std::uint16_t>(at);
      case 5:
        return number<std::int32_t>(at);
      case 6:
        return number<std::uint32_t>(at);
      case 7:
        return number<float>(at);
      default:
        return number<double>(at);
    }
  }

 private:
  static std::uint32_t bytes_of(std::uint8_t datatype) {
    constexpr std::uint32_t kBytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    if (datatype == 0 || datatype >= std::size(kBytes)) {
      throw InputError("a field has the type " + std::to_string(datatype) + ", expected from 1 to 8");
    }
    return kBytes[datatype];
  }
  template <typename T>
  static double number(const std::uint8_t* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  }

  const ros::PointField* field_ = nullptr;
};

void check_points(std::size_t points) {
  if (points > kMaxPoints) {
    throw InputError("the scan has " + std::to_string(points) + " points, expected at most " +
                     std::to_string(kMaxPoints));
  }
}

void add_beam(RecordedBeam beam, BeamRecording& recording) {
  recording.rings = std::max(recording.rings, beam.ring + 1);
  recording.beams.push_back(beam);
}

// The beam of the scanner in the scene.
RecordedBeam nominal_beam(const Scan& nominal, std::size_t i) {
  return {.ring = nominal.ring_of(i),
          .azimuth_rad = std::remainder(nominal.azimuth(i), 2 * glm::pi<double>()),
          .elevation_rad = nominal.elevation(i),
          .origin_m = nominal.origin(i)};
}

void add_cloud(const ros::PointCloud2& cloud, const Scan& nominal, BeamRecording& recording) {
  const std::size_t points = std::size_t{cloud.width} * cloud.height;
  if (cloud.is_bigendian) throw InputError("the numbers of the cloud are big-endian, expected little-endian");
  if (cloud.point_step == 0 || cloud.row_step < std::size_t{cloud.point_step} * cloud.width ||
      cloud.data.size() < std::size_t{cloud.row_step} * cloud.height) {
    throw InputError("the cloud has " + std::to_string(cloud.data.size()) + " bytes, expected those of " +
                     std::to_string(points) + " points");
  }
  check_points(points);
  const PointNumber x(cloud, {"x"}), y(cloud, {"y"}), z(cloud, {"z"}), ring(cloud, {"ring", "channel"}),
      intensity(cloud, {"intensity", "reflectivity"});
  if (!x.is_there() || !y.is_there() || !z.is_there()) throw InputError("the cloud has no fields x, y and z");
  const bool has_beams = points == nominal.range_m.size();
  recording.has_lost_beams = has_beams && (recording.scans == 0 || recording.has_lost_beams);  // in all clouds
  for (std::size_t i = 0; i < points; ++i) {
    const std::uint8_t* const point =
        cloud.data.data() + i / cloud.width * cloud.row_step + i % cloud.width * cloud.point_step;
    const glm::dvec3 place(x.of(point), y.of(point), z.of(point));
    const double distance_m = glm::length(place);
    const bool returned = distance_m > 0 && std::isfinite(distance_m);  // some drivers write zeros for lost beams
    if (!has_beams && !returned) continue;
    RecordedBeam beam = has_beams ? nominal_beam(nominal, i) : RecordedBeam{};
    if (const double number = ring.of(point); number >= 0 && number <= kMaxChannel) {
      beam.ring = static_cast<std::uint32_t>(number);
    }
    beam.scan = recording.scans;
    const glm::dvec3 reach = place - beam.origin_m;
    if (returned && glm::length(reach) > 0) {
      beam.range_m = glm::length(reach);
      beam.azimuth_rad = std::atan2(reach.y, reach.x);
      beam.elevation_rad = std::asin(std::clamp(reach.z / beam.range_m, -1.0, 1.0));
      beam.intensity = intensity.of(point);
    }
    add_beam(beam, recording);
  }
}

void add_laser_scan(const ros::LaserScan& scan, BeamRecording& recording) {
  check_points(scan.ranges.size());
  recording.has_lost_beams = true;
  const double last = scan.angle_min + static_cast<double>(scan.ranges.size()) * scan.angle_increment;
  if (!(std::abs(scan.angle_min) <= kMaxAngle_rad && std::abs(last) <= kMaxAngle_rad)) {
    throw InputError("its angles go from " + format_number(scan.angle_min) + " to " + format_number(last) +
                     " radians, expected at most two turns");
  }
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range_m = scan.ranges[i];
    const double azimuth = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    RecordedBeam beam{.scan = recording.scans, .azimuth_rad = std::remainder(azimuth, 2 * glm::pi<double>())};
    if (range_m >= scan.range_min && range_m <= scan.range_max) {
      beam.range_m = range_m;
      if (i < scan.intensities.size()) beam.intensity = scan.intensities[i];
    }
    add_beam(beam, recording);
  }
}

bool is_read_type(std::string_view type) { return type == ros::PointCloud2::kName || type == ros::LaserScan::kName; }

std::string topic_to_read(const std::filesystem::path& file, const std::string& topic) {
  std::map<std::string, std::string, std::less<>> types;
  bool is_there = false;  // the rest of the file is not read then
  ros::read_mcap(file, [&](const ros::RecordedMessage& message) {
    if (message.topic == topic && is_read_type(message.type)) is_there = true;
    types.emplace(message.topic, message.type);
    return !is_there;
  });
  if (is_there) return topic;
  std::string names, scans, only;
  std::size_t count = 0;
  for (const auto& [name, type] : types) {
    names += (names.empty() ? "" : ", ") + name;
    if (!is_read_type(type)) continue;
    ++count;
    only = name;
    scans += (scans.empty() ? "" : ", ") + name;
  }
  const auto fail = [&](const std::string& what) { throw InputError(file.string() + ": error: " + what); };
  if (count == 0) {
    fail("has no topic with PointCloud2 or LaserScan" + (names.empty() ? "" : ", but " + names) +
         ", expected the scans of a laser scanner");
  }
  if (topic.empty() && count > 1) fail("has several topics with scans, expected --compare-topic with one of: " + scans);
  if (topic.empty()) return only;
  throw InputError(file.string() + ": error: has no scans in the topic " + in_quotes(topic) +
                   ", expected one of: " + scans);
}

}  // namespace

BeamRecording read_cloud_messages(const std::filesystem::path& file, const std::string& topic, const Scan& nominal,
                                  std::uint32_t scans) {
  const std::string read = topic_to_read(file, topic);
  BeamRecording recording{.source = "topic " + read};
  ros::read_mcap(file, [&](const ros::RecordedMessage& message) {
    if (message.topic != read || !is_read_type(message.type)) return true;
    try {
      if (message.encoding != "cdr")
        throw InputError("its messages are encoded as " + in_quotes(message.encoding) + ", expected cdr");
      if (message.type == ros::PointCloud2::kName) {
        add_cloud(ros::decode<ros::PointCloud2>(message.bytes), nominal, recording);
      } else {
        add_laser_scan(ros::decode<ros::LaserScan>(message.bytes), recording);
      }
    } catch (const InputError& error) {
      throw InputError(file.string() + ": error: topic " + read + ", message " + std::to_string(recording.scans) +
                       ": " + error.what());
    }
    return ++recording.scans < scans;
  });
  // Drivers hand on the bytes of devices as floats.
  const bool whole = std::ranges::all_of(recording.beams, [](const RecordedBeam& beam) {
    return !std::isfinite(beam.intensity) || beam.intensity == std::round(beam.intensity);
  });
  if (whole) recording.intensity_unit = 1;
  return recording;
}

}  // namespace simvis
