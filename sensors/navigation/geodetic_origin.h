// Where the world stands on the earth, for sensors that need it, and their attributes for it.
//
// Frames   the world's origin stands at a place on the ellipsoid of WGS 84, its z axis along the ellipsoid's normal
//          there. With heading 0 its x axis points east and its y axis north (REP 103); a heading turns them
//          counter-clockwise. The names are those of SDF's <spherical_coordinates>.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/attributes.h>

namespace simvis {

struct GeodeticOrigin {
  double latitude_deg = 0, longitude_deg = 0, elevation_m = 0;
  double heading_rad = 0;

  bool operator==(const GeodeticOrigin&) const = default;

  /// A vector of the world along east, north and up.
  glm::dvec3 to_east_north_up(const glm::dvec3& v) const {
    const double cosine = std::cos(heading_rad), sine = std::sin(heading_rad);
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z};
  }
  /// A vector along east, north and up in the world.
  glm::dvec3 from_east_north_up(const glm::dvec3& v) const {
    const double cosine = std::cos(heading_rad), sine = std::sin(heading_rad);
    return {cosine * v.x + sine * v.y, cosine * v.y - sine * v.x, v.z};
  }
};

inline std::vector<AttributeSpec> geodetic_rows() {
  return {{.name = "latitude",
           .default_value = "0",
           .unit = "deg",
           .text = "latitude of the world's origin, north positive",
           .min = -90,
           .max = 90},
          {.name = "longitude",
           .default_value = "0",
           .unit = "deg",
           .text = "longitude of the world's origin, east positive",
           .min = -180,
           .max = 180},
          {.name = "elevation",
           .default_value = "0",
           .unit = "m",
           .text = "height of the world's origin above the ellipsoid of WGS 84",
           .min = -2e4,
           .max = 1e9},
          {.name = "heading",
           .default_value = "0",
           .unit = "deg",
           .text = "direction of the world's x axis, counter-clockwise from east"}};
}

/// Reads the attributes of geodetic_rows().
inline GeodeticOrigin read_geodetic_origin(const AttributeValues& attributes) {
  return {.latitude_deg = attributes.number("latitude"),
          .longitude_deg = attributes.number("longitude"),
          .elevation_m = attributes.number("elevation"),
          .heading_rad = glm::radians(attributes.number("heading"))};
}

}  // namespace simvis
