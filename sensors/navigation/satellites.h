// Where the satellites of a navigation system stand in the sky, and the attributes of sensors that receive them.
//
//   satellites="gps"                         the 24 slots of the nominal GPS constellation
//   satellites="0:80 90:45 180:45 270:45"    AZIMUTH:ELEVATION in degrees, clockwise from north and above the horizon
//
// List     The satellites stand still, and are infinitely far away.
// GPS      Circular orbits of the reference slots: GPS Standard Positioning Service Performance Standard, 2001, table
//          3-1, with the Greenwich hour angle of its epoch, 0 h UTC on 1 July 1993. The gravity of the earth and its
//          rotation are those of WGS 84 (IS-GPS-200). Orbits are not perturbed: it is a typical sky, not that of a
//          date. It repeats every sidereal day but for the two turns of the satellites, which differ by some seconds.
//          `constellation_time` is the time since the epoch at simulated time 0.
// Frames   E = east, north, up at the world's origin, as GeodeticOrigin has it: up is taken as the same everywhere in
//          the scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor_type.h>
#include "scenegraph/language/attribute_rows.h"
#include "sensors/navigation/geodetic_origin.h"

namespace simvis {

/// The largest number of directions of a list. Each may have a reflected signal at each wall of some hundreds.
inline constexpr std::size_t kMaxSatellites = 1024;

struct SatellitesDesc {
  std::string satellites = "none";
  std::vector<glm::dvec3> list{};  ///< of a list: directions to the satellites, E, unit length
  double constellation_time_s = 0;
  double elevation_mask_rad = glm::radians(5.0);
  double reflection = 0;  ///< amplitude of a reflected signal, as a share of the direct one; 0: none is received

  bool none() const { return satellites == "none"; }
  bool is_gps() const { return satellites == "gps"; }
};

/// The condition of rows that have no effect without satellites.
inline constexpr std::string_view kWithSatellites = "with satellites=\"gps\" or their directions";

/// Reading them throws InputError at `satellites` for a word that is neither a system nor a direction and for more
/// than kMaxSatellites directions, and at an attribute that has no effect: constellation_time without the GPS
/// constellation, and all others without satellites.
AttributeRows<SatellitesDesc> satellites_rows();

/// A satellite above the horizon.
struct Satellite {
  std::uint32_t number = 0;  ///< its place in the list or among the slots A1, A2 to F4, from 1 on
  glm::dvec3 direction{0};   ///< E, unit length, from the receiver
  double azimuth_deg = 0,    ///< clockwise from north, from 0 to 360
      elevation_deg = 0;     ///< above the horizon
};

/// The satellites at or above the elevation mask, in the order of their numbers. `place_m` is that of the receiver, E;
/// `time_s` is simulated time.
std::vector<Satellite> satellites_in_sky(const SatellitesDesc& desc, const GeodeticOrigin& origin,
                                         const glm::dvec3& place_m, double time_s);

}  // namespace simvis
