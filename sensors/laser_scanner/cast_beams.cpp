#include "sensors/laser_scanner/cast_beams.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "sensors/laser_scanner/table_order.h"

namespace simvis {

CastBeams cast_order(const ScanBeams& beams, std::vector<std::uint32_t> order) {
  CastBeams cast{.order = order.empty() ? table_order(beams) : std::move(order)};
  for (const std::uint32_t beam : cast.order) cast.directions.push_back(beams.direction(beam));
  if (beams.origin_m.empty()) return cast;
  const auto coordinates = [](const glm::dvec3& p) { return std::tuple(p.x, p.y, p.z); };
  cast.places_m = beams.origin_m;
  std::ranges::sort(cast.places_m, {}, coordinates);
  cast.places_m.erase(std::unique(cast.places_m.begin(), cast.places_m.end()), cast.places_m.end());
  for (const std::uint32_t beam : cast.order) {
    const glm::dvec3& origin_m = beams.origin_m[beam];
    const auto place = std::ranges::lower_bound(cast.places_m, coordinates(origin_m), {}, coordinates);
    cast.origins_m.push_back(origin_m);
    cast.place_of.push_back(static_cast<std::uint32_t>(place - cast.places_m.begin()));
  }
  return cast;
}

// An origin o is transformed to the world as a sum of three products and the sensor's position p, with an error of less
// than d = 12 u (|o| + |p|), u = 2^-53, as in traced_scan.cpp. The caster's bound of a range r is that of corners that
// are displaced by e >= u (28 r + 21 |p + o|) (see ray_caster.h: reach and distance of the mesh are at least r
// together, and the offsets contain that of the ray's own origin), and each of its terms with e grows in proportion. A
// bound that is larger by the factor 1 + d / e therefore covers corners that are displaced by d + e.
void cast_in_order(RayCaster& rays, const glm::dmat4& world_from_sensor, const CastBeams& beams,
                   std::span<const glm::dvec3> directions, std::span<RayHit> hits, const HitsReady& there) {
  if (beams.origins_m.empty()) return rays.cast(world_from_sensor, directions, hits, {}, there);
  rays.cast_from(world_from_sensor, beams.origins_m, directions, hits);
  struct Place {
    double displaced, start_m;
  };
  std::vector<Place> places;
  const double sensor_m = glm::length(glm::dvec3(world_from_sensor[3]));
  for (const glm::dvec3& place_m : beams.places_m) {
    places.push_back(
        {12 * (glm::length(place_m) + sensor_m), glm::length(glm::dvec3(world_from_sensor * glm::dvec4(place_m, 1)))});
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!std::isfinite(hits[i].range_m)) continue;
    const Place& place = places[beams.place_of[i]];
    hits[i].error_bound_m *= 1 + place.displaced / (28 * hits[i].range_m + 21 * place.start_m);
  }
  if (there) there(0, hits.size());
}

}  // namespace simvis
