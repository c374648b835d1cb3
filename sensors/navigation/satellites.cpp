#include "sensors/navigation/satellites.h"

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>

#include "engine/base/words.h"

namespace simvis {

namespace {

constexpr double kTurn_rad = 2 * std::numbers::pi;

// Argument of latitude of each slot at the epoch, in degrees, by plane A to F, and the right ascension of its node.
struct OrbitPlane {
  double node_deg, slots_deg[4];
};
constexpr OrbitPlane kGpsPlanes[] = {
    {272.847, {268.126, 161.786, 11.676, 41.806}},  {332.847, {80.956, 173.336, 309.976, 204.376}},
    {32.847, {111.876, 11.796, 339.666, 241.556}},  {92.847, {135.226, 265.446, 35.156, 167.356}},
    {152.847, {197.046, 302.596, 66.066, 333.686}}, {212.847, {238.886, 345.226, 105.206, 135.346}}};
constexpr double kOrbit_m = 26559.7e3, kInclination_rad = glm::radians(55.0);
constexpr double kGreenwich_rad = (18 + 36 / 60.0 + 14.4 / 3600) / 24 * kTurn_rad;
constexpr double kGravity_m3_s2 = 3.986005e14, kEarthTurn_rad_s = 7.2921151467e-5;

glm::dvec3 direction_of(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::sin(azimuth_rad), std::cos(elevation_rad) * std::cos(azimuth_rad),
          std::sin(elevation_rad)};
}

void read_satellites(SatellitesDesc& desc, const AttributeValues& attributes) {
  constexpr std::string_view kName = "satellites";
  if (!attributes.is_set(kName)) return;
  desc.satellites = attributes.text(kName);
  desc.list.clear();
  if (desc.none() || desc.is_gps()) return;
  const auto refuse = [&](std::string_view word) {
    fail_at(attributes.where(kName), "attribute \"satellites\": " + in_quotes(word) +
                                         " is not allowed, expected none, gps, or AZIMUTH:ELEVATION in degrees, from "
                                         "-360 to 360 and from 0 to 90, for each satellite");
  };
  for (const std::string_view word : words_of(desc.satellites)) {
    const std::size_t colon = word.find(':');
    double azimuth_deg = 0, elevation_deg = 0;
    const bool is_pair = colon != word.npos && parse_number(word.substr(0, colon), azimuth_deg) &&
                         parse_number(word.substr(colon + 1), elevation_deg);
    if (!is_pair || !(std::abs(azimuth_deg) <= 360 && elevation_deg >= 0 && elevation_deg <= 90)) refuse(word);
    desc.list.push_back(direction_of(glm::radians(azimuth_deg), glm::radians(elevation_deg)));
  }
  if (desc.list.empty()) refuse(desc.satellites);
  if (desc.list.size() > kMaxSatellites) {
    fail_at(attributes.where(kName), "attribute \"satellites\": " + std::to_string(desc.list.size()) +
                                         " satellites are too many, expected at most " +
                                         std::to_string(kMaxSatellites));
  }
}

/// In the frame of the earth: x to longitude 0 on the equator, z to the north pole.
glm::dvec3 gps_place_m(const OrbitPlane& plane, double slot_deg, double time_s) {
  static const double turn_rad_s = std::sqrt(kGravity_m3_s2 / (kOrbit_m * kOrbit_m * kOrbit_m));
  const double along = glm::radians(slot_deg) + turn_rad_s * time_s,
               node = glm::radians(plane.node_deg) - kGreenwich_rad - kEarthTurn_rad_s * time_s;
  const double x = std::cos(along), y = std::sin(along) * std::cos(kInclination_rad);
  return kOrbit_m * glm::dvec3(x * std::cos(node) - y * std::sin(node), x * std::sin(node) + y * std::cos(node),
                               std::sin(along) * std::sin(kInclination_rad));
}

std::vector<glm::dvec3> gps_directions(const GeodeticOrigin& origin, const glm::dvec3& place_m, double time_s) {
  glm::dvec3 origin_m;
  std::vector<double> rows(9);  // of the matrix from E to the frame of the earth
  GeographicLib::Geocentric::WGS84().Forward(origin.latitude_deg, origin.longitude_deg, origin.elevation_m, origin_m.x,
                                             origin_m.y, origin_m.z, rows);
  const glm::dmat3 east_north_up_from_earth(rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7],
                                            rows[8]);
  std::vector<glm::dvec3> directions;
  for (const OrbitPlane& plane : kGpsPlanes) {
    for (const double slot_deg : plane.slots_deg) {
      const glm::dvec3 from_origin_m = gps_place_m(plane, slot_deg, time_s) - origin_m;
      directions.push_back(glm::normalize(east_north_up_from_earth * from_origin_m - place_m));
    }
  }
  return directions;
}

}  // namespace

AttributeRows<SatellitesDesc> satellites_rows() {
  using Desc = SatellitesDesc;
  return {AttributeRow<Desc>{.spec = {.name = "satellites",
                                      .kind = AttributeKind::text,
                                      .text = "none: a fix is always there; gps: those of the nominal GPS "
                                              "constellation; or their directions in degrees, AZIMUTH:ELEVATION, "
                                              "clockwise from north and above the horizon"},
                             .written = [](const Desc& desc) { return desc.satellites; },
                             .read = read_satellites},
          row(&Desc::constellation_time_s, "constellation_time", "s", {.min = 0, .max = 1e9},
              "with satellites=\"gps\": time since the epoch of the constellation at simulated time 0; it repeats "
              "after a sidereal day, 86164 s")
              .only("with satellites=\"gps\"", &Desc::is_gps),
          row(&Desc::elevation_mask_rad, "elevation_mask", kDegrees, {.min = 0, .max = 90},
              "satellites below this elevation are not received")
              .only(kWithSatellites, std::not_fn(&Desc::none)),
          row(&Desc::reflection, "reflection", "", {.min = 0, .max = 1, .open_max = true},
              "amplitude of signals that walls reflect, as a share of the direct ones; 0: they are not received")
              .only(kWithSatellites, std::not_fn(&Desc::none))};
}

std::vector<Satellite> satellites_in_sky(const SatellitesDesc& desc, const GeodeticOrigin& origin,
                                         const glm::dvec3& place_m, double time_s) {
  const std::vector<glm::dvec3> directions =
      desc.is_gps() ? gps_directions(origin, place_m, desc.constellation_time_s + time_s) : desc.list;
  std::vector<Satellite> sky;
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    const glm::dvec3& to = directions[i];
    const double elevation_rad = std::atan2(to.z, std::hypot(to.x, to.y));
    constexpr double kRounding_rad = 1e-12;  // a satellite of a list may stand at the mask
    if (elevation_rad < desc.elevation_mask_rad - kRounding_rad) continue;
    const double azimuth_rad = std::atan2(to.x, to.y);
    sky.push_back({.number = i + 1,
                   .direction = to,
                   .azimuth_deg = glm::degrees(azimuth_rad < 0 ? azimuth_rad + kTurn_rad : azimuth_rad),
                   .elevation_deg = glm::degrees(elevation_rad)});
  }
  return sky;
}

}  // namespace simvis
