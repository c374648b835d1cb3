#include "sensors/camera/surface_rays.h"

#include <cmath>
#include <optional>

#include "engine/raycast/item_shape.h"

namespace simvis {
namespace {

// The triangles of one item in a view, at one time.
class ItemFaces {
 public:
  ItemFaces(const DrawList& list, const glm::dmat4& world_from_view)
      : list_(list), world_from_view_(world_from_view), view_from_world_(glm::transpose(glm::dmat3(world_from_view))) {}

  /// The outward normal of the triangle or the exact shape that a ray along `direction` has met: V, unit length.
  glm::dvec3 normal(const RayHit& hit, const glm::dvec3& direction) {
    const DrawItem& item = list_.items[hit.item];
    if (hit.item != item_) {
      item_ = hit.item;
      view_from_mesh_ = view_from_world_ * glm::dmat3(list_.world_from_node[item.transform]);
      mirrored_ = glm::determinant(view_from_mesh_) < 0;
      shape_ = shape_of_item(list_, hit.item, world_from_view_);
    }
    const Mesh& mesh = *list_.meshes[item.mesh];
    if (shape_) {
      const std::uint32_t face = face_of_hit(*shape_, mesh, hit.primitive);
      return shape_point(*shape_, direction, {hit.range_m, hit.error_bound_m, face}).normal;
    }
    const auto corner = [&](std::size_t k) {
      return glm::dvec3(mesh.positions[mesh.indices[3 * std::size_t{hit.primitive} + k]]);
    };
    const glm::dvec3 a = corner(0);
    const glm::dvec3 across = glm::cross(view_from_mesh_ * (corner(1) - a), view_from_mesh_ * (corner(2) - a));
    return glm::normalize(mirrored_ ? -across : across);
  }

 private:
  const DrawList& list_;
  glm::dmat4 world_from_view_;
  std::optional<SeenShape> shape_;  // of item_
  glm::dmat3 view_from_world_, view_from_mesh_{1.0};
  std::uint32_t item_ = kNoItem;
  bool mirrored_ = false;
};

}  // namespace

void SurfaceRays::cast(RayCaster& caster, const DrawList& list, const glm::dmat4& world_from_view,
                       std::span<const glm::dvec3> directions, std::span<const double> behind_m,
                       std::span<SeenSurface> seen) {
  hits_.resize(directions.size());
  caster.cast(world_from_view, directions, hits_, behind_m, {}, HitSides::front);
  rays_ += directions.size();
  ItemFaces faces(list, world_from_view);
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    const RayHit& hit = hits_[i];
    seen[i] = {};
    if (std::isinf(hit.range_m)) continue;
    const glm::dvec3 normal = faces.normal(hit, directions[i]);
    const bool from_behind = glm::dot(normal, directions[i]) > 0;
    seen[i] = {hit.item, hit.primitive, hit.range_m, hit.error_bound_m, from_behind ? -normal : normal};
  }
}

}  // namespace simvis
