// How the beams of a scan are cast: in which order, and with which bounds.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include "sensors/laser_scanner/scan_beams.h"

namespace simvis {

/// Beams in an order in which those of a packet are neighbours and start close to each other.
struct CastBeams {
  std::vector<std::uint32_t> order{};  ///< beams [ring * beams + beam]
  std::vector<glm::dvec3> directions{},
      origins_m{};                        ///< in that order; origins_m is empty if all start at the sensor's origin
  std::vector<glm::dvec3> places_m{};     ///< the different origins
  std::vector<std::uint32_t> place_of{};  ///< for each of origins_m, its index in places_m
};

/// `order` empty: an order is found.
CastBeams cast_order(const ScanBeams& beams, std::vector<std::uint32_t> order = {});

/// RayCaster::cast(), or for beams with origins RayCaster::cast_from() with bounds that cover the rounding of each
/// origin. `directions` are those of the beams, or if all start at the sensor's origin those of any of them.
void cast_in_order(RayCaster& rays, const glm::dmat4& world_from_sensor, const CastBeams& beams,
                   std::span<const glm::dvec3> directions, std::span<RayHit> hits, const HitsReady& there = {});

}  // namespace simvis
