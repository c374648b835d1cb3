// The beams of a real laser scanner: where each one starts, where it points and when it fires.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "sensors/beam_tables/scanner_device.h"

namespace simvis {

/// The largest number of beams of a table, and the largest number of a channel: messages have 16 bits for it.
inline constexpr std::size_t kMaxTableBeams = std::size_t{1} << 22;
inline constexpr std::uint32_t kMaxChannel = 65535;

/// The largest distance of a beam's origin from the sensor's, along each axis.
inline constexpr double kMaxBeamOrigin_m = 10;

/// Frames   the sensor's: x forward, y left, z up. Azimuth is counter-clockwise from +x about +z, elevation positive
///          upwards. The direction of a beam is that of glm::radians() of both.
/// Shape    arrays by beam are [ring * beams + beam]. Beams of a ring stand in the order in which they fire.
/// Range    azimuth from -360 to 360 degrees, elevation from -90 to 90, origins within kMaxBeamOrigin_m.
struct BeamTable {
  std::uint32_t rings = 0, beams = 0;             ///< beams of each ring; rings * beams from 1 to kMaxTableBeams
  std::vector<double> azimuth_deg{},              ///< by beam
      elevation_deg{};                            ///< by beam
  std::vector<glm::dvec3> origin_m{};             ///< by beam; empty: all beams start at the sensor's origin
  std::vector<std::int64_t> time_ns{};            ///< by beam, since the first one fires; empty: not known
  std::vector<std::uint32_t> channel{};           ///< by beam, at most kMaxChannel; empty: the ring
  std::shared_ptr<const ScannerDevice> device{};  ///< the device whose packets can hold these beams; null: none

  std::size_t size() const { return azimuth_deg.size(); }  ///< rings * beams
};

/// One beam that was read, in the order of a file.
struct TableBeam {
  double azimuth_deg = 0, elevation_deg = 0;
  glm::dvec3 origin_m{0};
  std::optional<std::int64_t> time_ns{};   ///< all beams of a table have one, or none
  std::optional<std::uint32_t> channel{};  ///< all beams of a table have one, or none
};

/// The table of these beams, of which there is at least one. If all channels have equally many beams, each channel is a
/// ring, by increasing number; otherwise, and without channels, the table has one ring, in the order given.
BeamTable make_beam_table(const std::vector<TableBeam>& beams);

}  // namespace simvis
