// Scans of laser scanners: their measurements, with typed views of the arrays.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/export.h>
#include <simvis/measurement.h>
#include <simvis/output_spec.h>
#include <simvis/shared_array.h>

namespace simvis {

struct BeamTable;

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

/// The measurement of a laser scanner, with typed views of its arrays. The arrays are the only store: what is written
/// through the functions below lies in them, and copies share the numbers. Arrays must not be changed in other ways.
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
/// Arrays   "range_m", "error_bound_m", "azimuth_rad", "elevation_rad"; "azimuth_deg", "elevation_deg", "ring" and
///          "origin_m" if they are set; then the channels: further numbers per beam, those of the effects that the
///          scanner has, in their order. What else the table of a scan has is derived from these, see scan_outputs().
/// Time     of the frame that the scan belongs to; an effect that gives beams times of their own adds a channel.
struct SIMVIS_API Scan : Measurement {
  Scan() = default;  ///< no beams, and no arrays
  /// Beams that have not measured yet.
  Scan(std::uint32_t rings, std::uint32_t beams);
  /// A view of a measurement, whose arrays may come in any order. It must have ranges and bounds as f32 and angles as
  /// f64 in the shapes above (asserted).
  explicit Scan(Measurement measurement);

  std::uint32_t rings = 0,              ///< number of rings
      beams = 0;                        ///< number of beams per ring
  SharedNumbers<double> azimuth_rad;    ///< by beam; of a beam table by ring and beam
  SharedNumbers<double> elevation_rad;  ///< by ring; of a beam table by ring and beam
  SharedNumbers<float> range_m;         ///< range along the ray; +infinity and 0 as above; none before a measurement
  SharedNumbers<float> error_bound_m;   ///< in the shape of range_m
  SharedNumbers<double> origin_m;  ///< where beams start: x, y and z of each, metres, S; empty: at the sensor's origin
  SharedNumbers<std::uint32_t> ring;  ///< number of each beam's ring or channel in the beam table; empty: i / beams
  /// The beam table whose beams these are, all of them and in its order; null: there is none. For writers of a device's
  /// packets; programs cannot read it.
  std::shared_ptr<const BeamTable> beam_table{};

  /// The ranges and bounds to write, each rings * beams numbers. Valid until the scan is copied or its next function
  /// that is not const.
  struct Ranges {
    std::span<float> range_m,  ///< as Scan::range_m
        error_bound_m;         ///< as Scan::error_bound_m
  };
  /// To change some; those that a copy holds are copied first. Before the first measurement all are 0.
  Ranges edit_ranges();
  /// To replace all: they have any values. Memory that no copy holds is used again.
  Ranges overwrite_ranges();
  /// Sets azimuth_rad and elevation_rad, and the arrays "azimuth_deg" and "elevation_deg" if the angles are given in
  /// degrees too, from which radians do not follow to the last bit.
  void set_angles(SharedArray<double> azimuths_rad, SharedArray<double> elevations_rad,
                  SharedArray<double> azimuths_deg = {}, SharedArray<double> elevations_deg = {});
  /// Sets origin_m.
  void set_origins(SharedArray<double> origins_m);
  /// Sets ring.
  void set_rings(SharedArray<std::uint32_t> rings_of_beams);
  /// Adds a channel behind the others: one number per beam, NaN: no value.
  void add_channel(const TableColumn& column, std::vector<double> values);
  /// Removes all channels.
  void clear_channels();
  /// All channels, in the shape of range_m; valid until one is added or removed.
  std::span<const MeasuredArray> channels() const { return std::span(arrays).subspan(first_channel_); }
  /// The numbers of the channel of this name; empty if there is none.
  SharedNumbers<double> channel(std::string_view name) const;

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

 private:
  void put(std::string_view name, const OutputShape& shape, MeasuredNumbers numbers);
  void view_arrays();
  Ranges write_ranges(std::vector<float>& (SharedArray<float>::*access)());

  std::size_t first_channel_ = 0;  // in `arrays`
};

/// The scan of a scanner's measurement; empty if it has no ranges, or if its arrays do not fit together.
SIMVIS_API std::optional<Scan> to_scan(Measurement measurement);

}  // namespace simvis
