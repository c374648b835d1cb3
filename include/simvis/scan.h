// Scans of laser scanners: a typed view of their measurements, with which it shares the numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/shared_array.h>

namespace simvis {

struct BeamTable;

/// One more number per beam, which an effect adds. The scan's CSV file has a column of this name.
struct ScanChannel {
  std::string name;             ///< with its unit, if it has one: "intensity", "time_s"
  std::string format = "%.9g";  ///< of printf, for one double
  SharedArray<double> values;   ///< in the shape of Scan::range_m; NaN: no value
  std::string unit{};           ///< "1/m2"; empty: none
};

/// One shape as it stands in the scene, hidden ones included: what the channels `true_item` and `true_primitive` of a
/// scan count.
struct SceneItem {
  std::string part;             ///< the part or link that has it: the name of its insertion point
  std::string mesh;             ///< its name in the part's file, or the name of its shape; may be empty
  std::uint64_t triangles = 0;  ///< 0: lines or points, which no beam hits
  std::uint32_t instance = 0,   ///< the id of its object in all sensors, frames and runs, see ItemIds
      semantic = 0;             ///< the id of its class; 0: it has none
  std::string label{};          ///< the name of its class, as an element of type `label` says; empty: it has none
  std::uint32_t shape = 0;      ///< its own id in all sensors, frames and runs, see ItemIds

  bool operator==(const SceneItem&) const = default;  ///< member by member
};

/// The direction of a beam as a unit vector in the sensor frame: azimuth counter-clockwise from +x about +z, elevation
/// positive upwards.
inline glm::dvec3 beam_direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Ranges of one sweep. Copies share the numbers.
///
/// Frames   S = sensor: x forward, y left, z up. Azimuth is counter-clockwise from +x about +z, elevation positive
///          upwards: see beam_direction().
/// Shape    range_m[ring * beams + beam]. A scanner with an even grid of beams has rings by increasing elevation and
///          beams by increasing azimuth; azimuth_rad is by beam and elevation_rad by ring. A scanner with a beam table
///          has rings and beams in the order of the table, which docs/beam-tables.md says; azimuth_rad and
///          elevation_rad are in the shape of range_m, and may differ from scan to scan. azimuth(), elevation(),
///          direction() and origin() serve both.
/// Units    range along the ray in metres (not the depth along Z of the virtual camera that produced it).
/// Special  +infinity: nothing within range_max; 0: the beam hits a surface nearer than range_min.
/// Bounds   the true range lies within range_m +- error_bound_m. Infinity: a silhouette is so close to the beam that
///          the method cannot decide which surface the beam hits. The bound of a rasterised range covers surfaces that
///          are at least three pixels of the method wide (see sensors/raster_depth/depth_range.h); the bound of a cast
///          range covers all surfaces (see <simvis/ray_caster.h>). Noise is not included: the bound applies to the
///          range before noise is added.
/// Channels those of the effects that the scanner has, in their order; empty without such effects.
/// Time     of the frame that the scan belongs to; an effect that gives beams times of their own adds a channel.
struct Scan {
  std::uint32_t rings = 0,              ///< number of rings
      beams = 0;                        ///< number of beams per ring
  SharedArray<double> azimuth_rad;      ///< by beam; of a beam table by ring and beam
  SharedArray<double> elevation_rad;    ///< by ring; of a beam table by ring and beam
  SharedArray<float> range_m;           ///< range along the ray; +infinity and 0 as above
  SharedArray<float> error_bound_m;     ///< in the shape of range_m
  std::vector<ScanChannel> channels{};  ///< further numbers per beam
  std::int64_t time_ns = 0;             ///< simulated time of the measurement; 0 before the first
  glm::dmat4 world_from_sensor{1.0};    ///< rigid, at that time; the identity before the first measurement
  /// Where beams start, in metres: x, y and z of each beam, in the sensor frame. Empty: at the sensor's origin.
  SharedArray<double> origin_m{};
  /// The number of each beam's ring or channel in the beam table. Empty: i / beams.
  SharedArray<std::uint32_t> ring{};
  /// The beam table whose beams these are, all of them and in its order; null: there is none. For writers of a device's
  /// packets; programs cannot read it.
  std::shared_ptr<const BeamTable> beam_table{};

  /// Of beam i = ring * beams + beam.
  double azimuth(std::size_t i) const { return azimuth_rad[azimuth_rad.size() == beams ? i % beams : i]; }
  /// Of beam i.
  double elevation(std::size_t i) const { return elevation_rad[elevation_rad.size() == rings ? i / beams : i]; }
  /// Of beam i, as a unit vector in the sensor frame.
  glm::dvec3 direction(std::size_t i) const { return beam_direction(azimuth(i), elevation(i)); }
  /// The start of beam i in the sensor frame, in metres.
  glm::dvec3 origin(std::size_t i) const {
    return origin_m.empty() ? glm::dvec3(0) : glm::dvec3(origin_m[3 * i], origin_m[3 * i + 1], origin_m[3 * i + 2]);
  }
  /// The number of the ring or channel of beam i.
  std::uint32_t ring_of(std::size_t i) const { return ring.empty() ? static_cast<std::uint32_t>(i / beams) : ring[i]; }
  /// The point that beam i hit, in the sensor frame: range_m along the beam, noise included. NaN if it hit nothing; the
  /// beam's origin if the range is 0.
  glm::dvec3 point(std::size_t i) const {
    const double range = range_m[i];
    const glm::dvec3 reach = (std::isfinite(range) ? range : std::numeric_limits<double>::quiet_NaN()) * direction(i);
    return origin_m.empty() ? reach : origin(i) + reach;
  }

  /// point() of every beam, in the shape of range_m. Empty before the first measurement.
  std::vector<glm::dvec3> points() const {
    std::vector<glm::dvec3> points;
    points.reserve(range_m.size());
    for (std::size_t i = 0; i < range_m.size(); ++i) points.push_back(point(i));
    return points;
  }
  /// As points(), in the world.
  std::vector<glm::dvec3> world_points() const {
    std::vector<glm::dvec3> points = this->points();
    for (glm::dvec3& point : points) point = glm::dvec3(world_from_sensor * glm::dvec4(point, 1));
    return points;
  }

  /// The channel of this name, or null. The pointer is valid until `channels` changes.
  const ScanChannel* channel(std::string_view name) const {
    const auto found = std::ranges::find(channels, name, &ScanChannel::name);
    return found == channels.end() ? nullptr : &*found;
  }
};

/// One number that a sensor measured.
struct NamedValue {
  std::string_view name;  ///< with its unit, as in "range_m"; static text
  double value = 0;       ///< NaN before the first measurement
};

}  // namespace simvis
