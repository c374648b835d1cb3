#include "sensors/raster_depth/shape_deviation.h"

#include <algorithm>

#include "engine/draw/solid_cloud.h"
#include "engine/geometry/item_extent.h"
#include "engine/geometry/round_levels.h"

namespace simvis {

namespace {

// A view that draws a shape at the limit of a level may compute a limit that differs by some roundings in double.
constexpr double kLimitRoom = 1 + 1e-9;

const glm::dmat4& place_in(const View& view, const DrawList& list, std::uint32_t item) {
  const auto found = std::ranges::lower_bound(view.places, item, {}, &ItemPlace::item);
  const bool is_moved = found != view.places.end() && found->item == item;
  return is_moved ? found->world_from_mesh : list.world_from_node[list.items[item].transform];
}

// By how much what is drawn may be off, in metres of the view's frame.
double drawn_deviation(const Mesh& mesh, const View& view, const ViewProjection& projection, const WorldBox& box,
                       const glm::dmat4& world_from_mesh) {
  // A square shows the depth of the middle of its sphere.
  if (is_solid_cloud(mesh)) return stretch_of(glm::dmat3(world_from_mesh)) * mesh.surface->radius_m;
  const ProjectedError error(view, projection, box, world_from_mesh);
  return choose_round_level(*mesh.surface, error, round_limit_px(view) * kLimitRoom).error_m;
}

}  // namespace

ShapeDeviation::ShapeDeviation(const DrawList& list, const View& view) {
  constexpr double kRoom = 1e-6;
  const ViewProjection projection = make_projection(view);
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const Mesh& mesh = *list.meshes[list.items[i].mesh];
    if (!list.items[i].visible || !(has_round_levels(mesh) || is_solid_cloud(mesh))) continue;
    const glm::dmat4& world_from_mesh = place_in(view, list, i);
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    const WorldBox box = make_box(world_from_mesh, (low + high) * 0.5, (high - low) * 0.5);
    if (outside(projection, box)) continue;
    const double distance_m = glm::length(glm::dvec3(view.view_from_world * glm::dvec4(box.center, 1)));
    const double radius_m = extent_of(mesh, world_from_mesh).radius_m;
    const double deviation_m = drawn_deviation(mesh, view, projection, box, world_from_mesh);
    const int last = VertexRounding::bin((distance_m + radius_m) * (1 + kRoom));
    for (int b = VertexRounding::bin(std::max(distance_m - radius_m, 0.0) * (1 - kRoom)); b <= last; ++b) {
      const auto at = static_cast<std::size_t>(b);
      deviation_m_[at] = std::max(deviation_m_[at], deviation_m);
      size_m_[at] = std::max(size_m_[at], 2 * radius_m);
    }
    any_ = true;
  }
}

}  // namespace simvis
