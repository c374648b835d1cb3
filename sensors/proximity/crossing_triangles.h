// Where the triangles of two surfaces cross, in double.
//
// Exactness. Two triangles that are not in one plane cross if and only if an edge of one passes through the other. The
// edge passes through if its ends lie on different sides of the plane and the line passes inside all three edges, each
// decided by the sign of a determinant of differences of vertices. A determinant that is 0 counts as no crossing, so
// surfaces that touch do not cross; rounding decides only within about 1e-15 of the size of the triangles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include <simvis/draw_list.h>

namespace simvis {

/// An axis-aligned box; empty at first.
struct TriangleBox {
  glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void add(const TriangleBox& box) {
    min = glm::min(min, box.min);
    max = glm::max(max, box.max);
  }
  bool overlaps(const TriangleBox& other) const {
    return min.x <= other.max.x && other.min.x <= max.x && min.y <= other.max.y && other.min.y <= max.y &&
           min.z <= other.max.z && other.min.z <= max.z;
  }
};

using Triangle = std::array<glm::dvec3, 3>;

/// The triangles of an item in the frame `frame_from_world`, and the box of them.
struct TriangleSet {
  std::vector<Triangle> triangles;
  TriangleBox box;
};

/// A box in the frame that contains an item.
TriangleBox item_box(const DrawList& list, std::uint32_t item, const glm::dmat4& frame_from_world);

/// The triangles of an item; with `near`, those only whose boxes overlap with it. None of lines and points.
TriangleSet triangles_of(const DrawList& list, std::uint32_t item, const glm::dmat4& frame_from_world,
                         const TriangleBox* near = nullptr);

struct Crossings {
  std::uint64_t count = 0;
  glm::dvec3 sum_m{0};  ///< of the points
};

/// Adds the points where an edge of one surface passes through a triangle of the other. An edge that two triangles
/// share counts for each of them.
void add_crossings(const TriangleSet& a, const TriangleSet& b, Crossings& crossings);

}  // namespace simvis
