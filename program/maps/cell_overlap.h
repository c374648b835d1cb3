// Whether a surface passes through a box of cells. All lengths are in cells: the box of cell (i, j, k) reaches from
// (i, j, k) to (i + 1, j + 1, k + 1).
//
// A surface passes through a box if it has a point inside. One that only touches the box from outside does not, even
// where rounding has moved it: it must come farther in than its rounding, which shrinks the box by as much. A flat
// piece in the boundary between two cells belongs to the cell behind it, on the side of its back, where solids are: the
// surface of a box whose sides lie in boundaries passes through the outer cells of the box, and through no others.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <simvis/exact_surface.h>

namespace simvis {

/// A box along the axes, without its boundary.
struct CellBox {
  glm::dvec3 low{0}, high{0};
};

/// A triangle, counter-clockwise seen from its front.
struct CellTriangle {
  std::array<glm::dvec3, 3> corners{};
  glm::dvec3 rounding{0};  ///< largest error of a coordinate of a corner, along each axis
};

/// Moves a triangle that lies in the boundary between two layers of cells into the middle of those behind it. Empty if
/// the triangle has no area: nothing meets it.
std::optional<CellTriangle> settle(CellTriangle triangle);

/// Whether the triangle passes through the box, by separating axes (Akenine-Moller 2001).
bool overlaps(const CellTriangle& triangle, const CellBox& box);

/// A sphere, a cylinder, a cone or a capsule under any transform that can be inverted.
struct CellSolid {
  SurfaceKind kind = SurfaceKind::sphere;
  double radius = 0, half_length = 0;  ///< in the frame of the shape, whose axis is z
  glm::dmat3 shape_from_cells{1.0};
  glm::dvec3 offset{0};  ///< shape = shape_from_cells * cells + offset
  double rounding = 0;   ///< of a coordinate of its surface, along each axis
};

/// Whether the surface of the solid passes through the box: a part of the box is inside of the solid, and not all of it
/// with its boundary.
bool overlaps(const CellSolid& solid, const CellBox& box);

/// A disc without thickness, such as a point of a cloud.
struct CellDisc {
  double radius = 0;                ///< in the frame of its mesh
  glm::dmat3 mesh_from_cells{1.0};  ///< as above
  glm::dvec3 offset{0};             ///< of the disc's centre: mesh - centre = mesh_from_cells * cells + offset
  glm::dvec3 normal{0, 0, 1};       ///< unit length, in the frame of the mesh
  double rounding = 0;              ///< of a coordinate, along each axis
};

/// As settle() of a triangle.
CellDisc settle(CellDisc disc);
bool overlaps(const CellDisc& disc, const CellBox& box);

}  // namespace simvis
