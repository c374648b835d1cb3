#include "import/programs/inventor/inventor_round_shapes.h"

#include <Inventor/VRMLnodes/SoVRMLCone.h>
#include <Inventor/VRMLnodes/SoVRMLCylinder.h>
#include <Inventor/VRMLnodes/SoVRMLSphere.h>
#include <Inventor/nodes/SoCone.h>
#include <Inventor/nodes/SoCylinder.h>
#include <Inventor/nodes/SoSphere.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace simvis {
namespace {

constexpr int kAxisOfNodes = 1;  // y

ExactSurface shape_along_y(SurfaceKind kind, float radius, float height) {
  return {.kind = kind, .axis = kAxisOfNodes, .radius_m = radius, .length_m = height};
}

std::optional<ExactSurface> described_by(const SoShape& node) {
  if (const auto* const sphere = dynamic_cast<const SoSphere*>(&node)) {
    return shape_along_y(SurfaceKind::sphere, sphere->radius.getValue(), 0);
  }
  if (const auto* const sphere = dynamic_cast<const SoVRMLSphere*>(&node)) {
    return shape_along_y(SurfaceKind::sphere, sphere->radius.getValue(), 0);
  }
  if (const auto* const cylinder = dynamic_cast<const SoCylinder*>(&node)) {
    if ((cylinder->parts.getValue() & SoCylinder::ALL) != SoCylinder::ALL) return {};
    return shape_along_y(SurfaceKind::cylinder, cylinder->radius.getValue(), cylinder->height.getValue());
  }
  if (const auto* const cylinder = dynamic_cast<const SoVRMLCylinder*>(&node)) {
    if (!cylinder->side.getValue() || !cylinder->top.getValue() || !cylinder->bottom.getValue()) return {};
    return shape_along_y(SurfaceKind::cylinder, cylinder->radius.getValue(), cylinder->height.getValue());
  }
  if (const auto* const cone = dynamic_cast<const SoCone*>(&node)) {
    if ((cone->parts.getValue() & SoCone::ALL) != SoCone::ALL) return {};
    return shape_along_y(SurfaceKind::cone, cone->bottomRadius.getValue(), cone->height.getValue());
  }
  if (const auto* const cone = dynamic_cast<const SoVRMLCone*>(&node)) {
    if (!cone->side.getValue() || !cone->bottom.getValue()) return {};
    return shape_along_y(SurfaceKind::cone, cone->bottomRadius.getValue(), cone->height.getValue());
  }
  return {};
}

// How far a vertex lies off the round surface, or beyond the ends, of which vertices are on either.
double off_surface(const ExactSurface& shape, const glm::dvec3& p) {
  if (shape.kind == SurfaceKind::sphere) return std::abs(glm::length(p) - shape.radius_m);
  const double half = shape.length_m / 2, along = p[kAxisOfNodes], out = std::hypot(p.x, p.z);
  const double radius =
      shape.kind == SurfaceKind::cone ? shape.radius_m * (half - along) / shape.length_m : shape.radius_m;
  // The middle of an end lies inside.
  return std::max({out - radius, std::abs(along) - half, 0.0});
}

// A point of a triangle with corners v and weights w has the squared distance r^2 - sum w_i w_j |v_i - v_j|^2 from the
// middle of the sphere on which the corners lie. With c the longest side, the sum is at most c^2 / 3. Between two lines
// of a cylinder or a cone, c apart at most, it is at most c^2 / 4 in the plane across the axis.
double deviation_of(const ExactSurface& shape, const Mesh& mesh) {
  const bool is_sphere = shape.kind == SurfaceKind::sphere;
  double off_m = 0x1p-22 * (shape.radius_m + shape.length_m), chord_square = 0;  // Coin computes in float32
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::array<glm::dvec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = glm::dvec3(mesh.positions[mesh.indices[i + k]]);
    for (const glm::dvec3& corner : corners) off_m = std::max(off_m, off_surface(shape, corner));
    const auto height = [&](std::size_t k) { return corners[k][kAxisOfNodes]; };
    if (!is_sphere && height(0) == height(1) && height(1) == height(2)) continue;  // of an end
    for (std::size_t k = 0; k < 3; ++k) {
      glm::dvec3 side = corners[(k + 1) % 3] - corners[k];
      if (!is_sphere && height(k) != height((k + 1) % 3) && shape.kind == SurfaceKind::cone) continue;  // to the tip
      if (!is_sphere) side[kAxisOfNodes] = 0;
      chord_square = std::max(chord_square, glm::dot(side, side));
    }
  }
  const double square = shape.radius_m * shape.radius_m - chord_square / (is_sphere ? 3 : 4);
  return off_m + shape.radius_m - std::sqrt(std::max(square, 0.0));
}

}  // namespace

std::optional<ExactSurface> round_shape_of(const SoShape& node, const Mesh& mesh) {
  std::optional<ExactSurface> shape = described_by(node);
  if (!shape || !(shape->radius_m > 0) || !(shape->length_m > 0 || shape->kind == SurfaceKind::sphere)) return {};
  shape->deviation_m = deviation_of(*shape, mesh);
  return shape;
}

}  // namespace simvis
