// How long an item is, wherever it is seen from.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// Lengths in the world, in metres, none too short.
struct ItemExtent {
  double reach_m = 0;   ///< from the mesh's origin to its farthest corner
  double radius_m = 0;  ///< from the middle of the mesh's box to its corners
  double edge_m = 0;    ///< the longest of a triangle
  double away_m = 0;    ///< from the world's origin to the mesh's

  bool operator==(const ItemExtent&) const = default;
};

ItemExtent extent_of(const Mesh& mesh, const glm::dmat4& world_from_mesh);

/// Of each length the longest; what is not a number in `b` does not count.
ItemExtent longest(const ItemExtent& a, const ItemExtent& b);

/// Columns are orthogonal if the cosines between them are no larger.
inline constexpr double kOrthogonal = 1e-6;
bool is_orthogonal(const glm::dmat3& m);

/// Of the columns.
glm::dvec3 lengths_of(const glm::dmat3& m);

}  // namespace simvis
