#include "sensors/raster_depth/shape_deviation.h"

#include <algorithm>

#include "engine/geometry/item_extent.h"

namespace simvis {

ShapeDeviation::ShapeDeviation(const DrawList& list, const glm::dmat4& sensor_from_world) {
  constexpr double kRoom = 1e-6;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (!item.visible || !mesh.surface || mesh.surface->deviation_m == 0) continue;
    const glm::dmat4& world_from_mesh = list.world_from_node[item.transform];
    const glm::dvec3 centre = 0.5 * (glm::dvec3(mesh.bounds_min) + glm::dvec3(mesh.bounds_max));
    const double distance_m = glm::length(glm::dvec3(sensor_from_world * (world_from_mesh * glm::dvec4(centre, 1))));
    const double radius_m = extent_of(mesh, world_from_mesh).radius_m;
    const double deviation_m = stretch_of(glm::dmat3(world_from_mesh)) * mesh.surface->deviation_m;
    const int last = VertexRounding::bin((distance_m + radius_m) * (1 + kRoom));
    for (int b = VertexRounding::bin(std::max(distance_m - radius_m, 0.0) * (1 - kRoom)); b <= last; ++b) {
      deviation_m_[static_cast<std::size_t>(b)] = std::max(deviation_m_[static_cast<std::size_t>(b)], deviation_m);
    }
    any_ = true;
  }
}

}  // namespace simvis
