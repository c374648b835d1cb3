#include "program/maps/placed_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/solid_cloud.h"

namespace simvis {
namespace {

// A position is a float32, which has been rounded once; a transform is a product of matrices of double.
constexpr double kFloatRounding = 0x1p-24, kDoubleRounding = 0x1p-48;

// In cells. Coordinates that are rounded by more count as they are: otherwise coarse meshes far from their origin would
// pass through no cell.
constexpr double kMaxRounding = 1.0 / 64;

// A row of the frame of a shape, whose z axis is the shape's, for each axis of the mesh.
glm::dmat3 shape_from_mesh(int axis) {
  glm::dmat3 matrix(0.0);
  for (int row = 0; row < 3; ++row) matrix[(axis + 1 + row) % 3][row] = 1;
  return matrix;
}

class ItemSurfaces {
 public:
  ItemSurfaces(const DrawList& list, const DrawItem& item, const CellFrame& frame, const SurfaceVisitor& visitor)
      : mesh_(*list.meshes[item.mesh]), frame_(frame), visitor_(visitor) {
    const glm::dmat4& world_from_mesh = list.world_from_node[item.transform];
    matrix_m_ = glm::dmat3(world_from_mesh);
    place_m_ = glm::dvec3(world_from_mesh[3]);
    for (int axis = 0; axis < 3; ++axis) cells_from_mesh_[axis] = matrix_m_[axis] / frame.cell_m;
    offset_ = (place_m_ - frame.origin_m) / frame.cell_m;
    const double determinant = glm::determinant(cells_from_mesh_);
    is_mirrored_ = determinant < 0;
    mesh_from_cells_ = glm::inverse(cells_from_mesh_);
    is_flat_ = determinant == 0 || !std::isfinite(glm::dot(mesh_from_cells_[0], glm::dvec3(1)));
  }

  void visit() {
    if (is_solid_cloud(mesh_) && !is_flat_) return visit_cloud();
    if (mesh_.topology != Topology::triangles) return;
    if (!mesh_.surface || is_flat_) return visit_triangles();
    mesh_.surface->kind == SurfaceKind::plane ? visit_plane(*mesh_.surface) : visit_solid(*mesh_.surface, {});
  }

 private:
  // Largest error of a place, by the rounding of the transform alone.
  glm::dvec3 transform_rounding(const glm::dvec3& position) const {
    const glm::dvec3 size_m = glm::abs(matrix_m_[0] * position.x) + glm::abs(matrix_m_[1] * position.y) +
                              glm::abs(matrix_m_[2] * position.z) + glm::abs(place_m_) + glm::abs(frame_.origin_m);
    return kDoubleRounding * size_m / frame_.cell_m;
  }

  glm::dvec3 float_rounding(const glm::dvec3& position) const {
    return kFloatRounding * (glm::abs(cells_from_mesh_[0] * position.x) + glm::abs(cells_from_mesh_[1] * position.y) +
                             glm::abs(cells_from_mesh_[2] * position.z));
  }

  glm::dvec3 in_cells(const glm::dvec3& position) const { return cells_from_mesh_ * position + offset_; }

  void visit_triangles() {
    for (std::size_t i = 0; i + 2 < mesh_.indices.size(); i += 3) {
      std::array<glm::dvec3, 3> positions;
      glm::dvec3 rounding(0);
      for (std::size_t k = 0; k < 3; ++k) {
        positions[k] = glm::dvec3(mesh_.positions[mesh_.indices[i + k]]);
        rounding = glm::max(rounding, float_rounding(positions[k]) + transform_rounding(positions[k]));
      }
      visit_triangle(positions, rounding);
    }
  }

  void visit_triangle(const std::array<glm::dvec3, 3>& positions, glm::dvec3 rounding) {
    rounding = glm::min(rounding, kMaxRounding);
    CellTriangle placed{.rounding = rounding};
    for (std::size_t k = 0; k < 3; ++k) placed.corners[k] = in_cells(positions[k]);
    if (is_mirrored_) std::swap(placed.corners[1], placed.corners[2]);
    const std::optional<CellTriangle> settled = settle(placed);
    if (!settled) return;
    const auto& [a, b, c] = settled->corners;
    CellBox around{glm::min(a, glm::min(b, c)) + rounding, glm::max(a, glm::max(b, c)) - rounding};
    around.low = glm::min(around.low, around.high);
    visitor_.triangle(*settled, around);
  }

  void visit_plane(const ExactSurface& plane) {
    const int u = (plane.axis + 1) % 3, v = (plane.axis + 2) % 3;
    glm::dvec2 low = -plane.half_size_m, high = plane.half_size_m;
    if (std::isinf(high.x) || std::isinf(high.y)) {
      if (frame_.size.x == 0) return;
      cut(u, v, low, high);
    }
    const auto corner = [&](double along_u, double along_v) {
      glm::dvec3 position(0);
      position[u] = along_u;
      position[v] = along_v;
      return position;
    };
    const std::array corners = {corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y),
                                corner(low.x, high.y)};
    glm::dvec3 rounding(0);
    for (const glm::dvec3& each : corners) rounding = glm::max(rounding, transform_rounding(each));
    visit_triangle({corners[0], corners[1], corners[2]}, rounding);
    visit_triangle({corners[0], corners[2], corners[3]}, rounding);
  }

  // Cuts what lies outside of all cells, seen along the axis of a plane.
  void cut(int u, int v, glm::dvec2& low, glm::dvec2& high) const {
    glm::dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
    for (unsigned i = 0; i < 8; ++i) {
      const glm::dvec3 cell = glm::dvec3((i & 1) != 0, (i & 2) != 0, (i & 4) != 0) * glm::dvec3(frame_.size);
      const glm::dvec3 position = mesh_from_cells_ * (cell - offset_);
      least = glm::min(least, glm::dvec2(position[u], position[v]));
      most = glm::max(most, glm::dvec2(position[u], position[v]));
    }
    const glm::dvec2 margin = 0.01 * (most - least);  // so that the cut itself lies outside
    low = glm::max(low, least - margin);
    high = glm::min(high, most + margin);
  }

  // `middle` is that of the shape, in the frame of the mesh.
  void visit_solid(const ExactSurface& shape, const glm::dvec3& middle) {
    const glm::dmat3 turn = shape_from_mesh(shape.axis), cells_from_shape = cells_from_mesh_ * glm::transpose(turn);
    const glm::dvec3 center = in_cells(middle);
    CellSolid solid{.kind = shape.kind, .radius = shape.radius_m, .half_length = 0.5 * shape.length_m};
    if (shape.kind == SurfaceKind::sphere) solid.half_length = 0;
    solid.shape_from_cells = turn * mesh_from_cells_;
    solid.offset = -(solid.shape_from_cells * center);
    const glm::dvec3 reach = reach_of(solid, cells_from_shape);
    solid.rounding = largest_rounding(float_rounding(middle) + transform_rounding(middle) +
                                      kDoubleRounding * (reach + glm::dvec3(frame_.size)));
    const glm::dvec3 inner = glm::max(reach - solid.rounding, glm::dvec3(0));
    visitor_.solid(solid, {center - inner, center + inner});
  }

  // Half the size of the box around a solid.
  static glm::dvec3 reach_of(const CellSolid& solid, const glm::dmat3& cells_from_shape) {
    const glm::dvec3 x = cells_from_shape[0], y = cells_from_shape[1], z = glm::abs(cells_from_shape[2]);
    const bool is_round_at_ends = solid.kind == SurfaceKind::sphere || solid.kind == SurfaceKind::capsule;
    const glm::dvec3 across = is_round_at_ends ? x * x + y * y + z * z : x * x + y * y;
    return solid.radius * glm::sqrt(across) + solid.half_length * z;
  }

  static double largest_rounding(const glm::dvec3& v) { return std::min(std::max({v.x, v.y, v.z}), kMaxRounding); }

  void visit_cloud() {
    for (const std::uint32_t vertex : mesh_.indices) {
      const glm::dvec3 position(mesh_.positions[vertex]);
      if (mesh_.surface->kind == SurfaceKind::sphere) {
        visit_solid(*mesh_.surface, position);
      } else {
        visit_disc(position, glm::dvec3(mesh_.attributes[vertex].normal));
      }
    }
  }

  void visit_disc(const glm::dvec3& position, const glm::dvec3& normal) {
    const double length = glm::length(normal), radius = mesh_.surface->radius_m;
    if (!(length > 0)) return;
    CellDisc disc{.radius = radius, .mesh_from_cells = mesh_from_cells_, .normal = normal / length};
    disc.offset = -(mesh_from_cells_ * in_cells(position));
    disc.rounding = largest_rounding(float_rounding(position) + transform_rounding(position));
    disc = settle(disc);
    const glm::dvec3 center = -(cells_from_mesh_ * disc.offset);
    const glm::dvec3 x = cells_from_mesh_[0], y = cells_from_mesh_[1], z = cells_from_mesh_[2];
    const glm::dvec3 reach = radius * glm::sqrt(x * x + y * y + z * z);
    visitor_.disc(disc, {center - reach, center + reach});
  }

  const Mesh& mesh_;
  const CellFrame& frame_;
  const SurfaceVisitor& visitor_;
  glm::dmat3 matrix_m_{1.0}, cells_from_mesh_{1.0}, mesh_from_cells_{1.0};
  glm::dvec3 place_m_{0}, offset_{0};
  bool is_mirrored_ = false, is_flat_ = false;
};

}  // namespace

void visit_surfaces(const DrawList& list, const DrawItem& item, const CellFrame& frame, const SurfaceVisitor& visitor) {
  if (!item.visible || list.materials[item.material]->opacity == 0) return;
  ItemSurfaces(list, item, frame, visitor).visit();
}

}  // namespace simvis
