// The reference for scans: a ray cast in double precision over the triangles of a DrawList.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include <simvis/draw_list.h>

namespace simvis::reference {

struct Hit {
  double range_m = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;
};

/// Opaque triangles of a list in the frame of a sensor, with a bounding volume hierarchy over them.
/// What lets a laser pass (blended below one half) is left out; masked textures are not handled and must not occur.
class RayCaster {
 public:
  RayCaster(const DrawList& list, const glm::dmat4& sensor_from_world);

  std::size_t triangle_count() const { return triangles_.size(); }

  /// Nearest hit along a unit direction from the sensor's origin, either side of a triangle.
  Hit cast(const glm::dvec3& direction) const;

  /// Where the plane of a triangle is met in this direction; not finite or negative where it is not.
  double range_of_plane(std::uint32_t triangle, const glm::dvec3& direction) const;

  /// The result of cast() without the hierarchy, which tests the reference itself.
  Hit cast_all(const glm::dvec3& direction) const;

 private:
  struct Box {
    glm::dvec3 low, high;
    std::uint32_t first, second, count;  // count 0: first and second are the children
  };

  // The range of the triangle found, again and in long double: on slivers double leaves some hundred roundings.
  Hit refined(Hit hit, const glm::dvec3& direction) const;

  // Slabs, widened by what the divisions may round away.
  static bool crosses(const Box& box, const glm::dvec3& direction, double limit);

  // Moeller and Trumbore 1997, from the origin. Edges belong to both neighbours within 1e-12 of the barycentrics.
  void intersect(std::uint32_t index, const glm::dvec3& direction, Hit& hit) const;

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  double centre(std::uint32_t t, int axis) const;

  std::vector<std::array<glm::dvec3, 3>> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> nodes_;
};

}  // namespace simvis::reference
