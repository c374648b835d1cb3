// Where the world stands on the earth, for sensors that need it, and their attributes for it.
//
// Frames   the world's origin stands at a place on the ellipsoid of WGS 84, its z axis along the ellipsoid's normal
//          there. With heading 0 its x axis points east and its y axis north (REP 103); a heading turns them
//          counter-clockwise. The names are those of SDF's <spherical_coordinates>.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct GeodeticOrigin {
  double latitude_deg = 0, longitude_deg = 0, elevation_m = 0;
  double heading_rad = 0;

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

inline AttributeRows<GeodeticOrigin> geodetic_rows() {
  using Origin = GeodeticOrigin;
  return {row(&Origin::latitude_deg, "latitude", "deg", {.min = -90, .max = 90},
              "latitude of the world's origin, north positive"),
          row(&Origin::longitude_deg, "longitude", "deg", {.min = -180, .max = 180},
              "longitude of the world's origin, east positive"),
          row(&Origin::elevation_m, "elevation", "m", {.min = -2e4, .max = 1e9},
              "height of the world's origin above the ellipsoid of WGS 84"),
          row(&Origin::heading_rad, "heading", kDegrees, kAnyNumber,
              "direction of the world's x axis, counter-clockwise from east")};
}

}  // namespace simvis
