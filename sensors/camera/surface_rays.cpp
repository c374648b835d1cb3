#include "sensors/camera/surface_rays.h"

#include <cmath>
#include <numeric>
#include <optional>

#include "engine/draw/solid_cloud.h"
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

  bool is_single_sided(const RayHit& hit) const {
    const DrawItem& item = list_.items[hit.item];
    return !list_.materials[item.material]->double_sided && !is_cloud_of_discs(*list_.meshes[item.mesh]);
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
  number_.resize(directions.size());
  std::iota(number_.begin(), number_.end(), 0u);
  directions_.assign(directions.begin(), directions.end());
  behind_m_.assign(behind_m.begin(), behind_m.end());
  while (!number_.empty()) {
    hits_.resize(number_.size());
    caster.cast(world_from_view, directions_, hits_, behind_m_);
    rays_ += number_.size();
    read_hits(list, world_from_view, seen);
  }
}

// Afterwards those rays are left that have met the back of a single-sided surface.
void SurfaceRays::read_hits(const DrawList& list, const glm::dmat4& world_from_view, std::span<SeenSurface> seen) {
  ItemFaces faces(list, world_from_view);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < number_.size(); ++i) {
    const RayHit& hit = hits_[i];
    const glm::dvec3 direction = directions_[i];
    SeenSurface& surface = seen[number_[i]];
    surface = {};
    if (std::isinf(hit.range_m)) continue;
    const glm::dvec3 normal = faces.normal(hit, direction);
    const bool from_behind = glm::dot(normal, direction) > 0;
    if (from_behind && faces.is_single_sided(hit)) {
      number_[kept] = number_[i];
      directions_[kept] = direction;
      behind_m_[kept] = hit.range_m;
      ++kept;
      continue;
    }
    surface = {hit.item, hit.primitive, hit.range_m, hit.error_bound_m, from_behind ? -normal : normal};
  }
  number_.resize(kept);
  directions_.resize(kept);
  behind_m_.resize(kept);
}

}  // namespace simvis
