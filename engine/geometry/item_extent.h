// Upper bounds of an item's size that do not depend on the view.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// Upper bounds of lengths in the world frame, in metres.
struct ItemExtent {
  double reach_m = 0;   ///< from the mesh's origin to its farthest corner
  double radius_m = 0;  ///< from the middle of the mesh's box to its corners
  double edge_m = 0;    ///< the longest edge of a triangle
  double away_m = 0;    ///< from the world's origin to the mesh's origin

  bool operator==(const ItemExtent&) const = default;
};

ItemExtent extent_of(const Mesh& mesh, const glm::dmat4& world_from_mesh);

/// The larger value of each length; a NaN in `b` is ignored.
ItemExtent longest(const ItemExtent& a, const ItemExtent& b);

/// The largest cosine between two columns that count as orthogonal.
inline constexpr double kOrthogonal = 1e-6;
bool is_orthogonal(const glm::dmat3& m);

/// An upper bound of the largest factor by which a matrix stretches a vector; exact if its columns are orthogonal.
double stretch_of(const glm::dmat3& m);

/// The lengths of the columns.
glm::dvec3 lengths_of(const glm::dmat3& m);

}  // namespace simvis
