#include <simvis/mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {

namespace {

// The nearest float32 that is not inside of a box whose side is at `value`.
float outwards(double value, float way) {
  const auto rounded = static_cast<float>(value);
  return way * rounded < way * value ? std::nextafter(rounded, way * std::numeric_limits<float>::infinity()) : rounded;
}

void include_shape(Mesh& mesh, const ExactSurface& shape) {
  if (shape.kind == SurfaceKind::plane) return;
  const bool has_ends = shape.kind == SurfaceKind::cylinder || shape.kind == SurfaceKind::cone;
  const double along_m =
      shape.kind == SurfaceKind::sphere ? shape.radius_m : shape.length_m / 2 + (has_ends ? 0 : shape.radius_m);
  for (int axis = 0; axis < 3; ++axis) {
    const double reach_m = axis == shape.axis ? along_m : shape.radius_m;
    mesh.bounds_min[axis] = std::min(mesh.bounds_min[axis], outwards(-reach_m, -1));
    mesh.bounds_max[axis] = std::max(mesh.bounds_max[axis], outwards(reach_m, 1));
  }
}

// The sphere around each point, which also holds its disc.
void include_spheres(Mesh& mesh, double radius_m) {
  for (int axis = 0; axis < 3; ++axis) {
    mesh.bounds_min[axis] = outwards(static_cast<double>(mesh.bounds_min[axis]) - radius_m, -1);
    mesh.bounds_max[axis] = outwards(static_cast<double>(mesh.bounds_max[axis]) + radius_m, 1);
  }
}

}  // namespace

void compute_bounds(Mesh& mesh) {
  mesh.bounds_min = mesh.bounds_max = glm::vec3(0);
  mesh.longest_edge = 0;
  if (mesh.indices.empty()) return;
  mesh.bounds_min = mesh.bounds_max = mesh.positions[mesh.indices.front()];
  for (const std::uint32_t index : mesh.indices) {
    mesh.bounds_min = glm::min(mesh.bounds_min, mesh.positions[index]);
    mesh.bounds_max = glm::max(mesh.bounds_max, mesh.positions[index]);
  }
  if (mesh.surface && mesh.topology == Topology::points) {
    include_spheres(mesh, mesh.surface->radius_m);
  } else if (mesh.surface) {
    include_shape(mesh, *mesh.surface);
  }
  if (mesh.topology != Topology::triangles) return;
  double square = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
        c(mesh.positions[mesh.indices[i + 2]]);
    square = std::max({square, glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  }
  mesh.longest_edge = std::sqrt(square);
}

}  // namespace simvis
