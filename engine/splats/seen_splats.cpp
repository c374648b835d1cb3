#include "engine/splats/seen_splats.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace simvis {
namespace {

// The splats of one item.
class ItemSplats {
 public:
  ItemSplats(const SplatCloud& cloud, std::uint32_t item, const glm::dmat4& view_from_mesh)
      : cloud_(cloud),
        item_(item),
        linear_(view_from_mesh),
        offset_m_(view_from_mesh[3]),
        camera_m_(glm::inverse(view_from_mesh)[3]) {}

  void add_to(std::vector<SeenSplat>& seen) const {
    const std::size_t coefficients = harmonics_count(cloud_.degree);
    for (std::size_t i = 0; i < cloud_.splats.size(); ++i) {
      const Splat& splat = cloud_.splats[i];
      if (static_cast<double>(splat.opacity) < kMinSplatAlpha) continue;
      SeenSplat& added = seen.emplace_back(place(splat));
      if (!std::isfinite(added.camera.x + added.camera.y + added.camera.z)) {  // its item is flattened
        seen.pop_back();
        continue;
      }
      const glm::dvec3 sight = glm::dvec3(splat.center) - camera_m_;
      const double distance = glm::length(sight);
      added.color = glm::vec3(splat_color(std::span(cloud_.harmonics).subspan(i * coefficients, coefficients),
                                          distance > 0 ? sight / distance : glm::dvec3(0, 0, 1)));
    }
  }

 private:
  SeenSplat place(const Splat& splat) const {
    SeenSplat seen;
    const glm::dvec3 sigma = splat_sigma(splat);
    const glm::dmat3 axes = linear_ * splat_rotation(splat);
    glm::dmat3 view_from_splat;
    for (int i = 0; i < 3; ++i) view_from_splat[i] = axes[i] * sigma[i];
    seen.splat_from_view = glm::inverse(axes);
    for (int i = 0; i < 3; ++i) {
      for (int row = 0; row < 3; ++row) seen.splat_from_view[i][row] /= sigma[row];
    }
    seen.center_m = linear_ * glm::dvec3(splat.center) + offset_m_;
    seen.camera = -(seen.splat_from_view * seen.center_m);
    seen.opacity = splat.opacity;
    seen.square_reach = splat_square_reach(splat);
    seen.encoding = cloud_.encoding;
    seen.item = item_;
    glm::dmat3 half_axes = view_from_splat * std::sqrt(seen.square_reach);
    for (int i = 1; i < 3; ++i) {
      if (glm::length(half_axes[i]) > glm::length(half_axes[0])) std::swap(half_axes[i], half_axes[0]);
    }
    seen.half_axes_m = glm::mat3(half_axes);
    // The plane across the line of sight that touches the ellipsoid from the front.
    const double distance = glm::length(seen.center_m);
    const glm::dvec3 sight = distance > 0 ? seen.center_m / distance : glm::dvec3(0, 0, 1);
    seen.nearest_m = std::max(0.0, (1 - kRounding) * distance - (1 + kMargin) * glm::length(sight * half_axes));
    return seen;
  }

  // Above the rounding of a difference in double, and of lengths of axes in float32.
  static constexpr double kRounding = 1e-14, kMargin = 1e-6;

  const SplatCloud& cloud_;
  std::uint32_t item_;
  glm::dmat3 linear_;               // V from the mesh
  glm::dvec3 offset_m_, camera_m_;  // V; in the mesh
};

}  // namespace

glm::dmat3 splat_rotation(const Splat& splat) {
  const glm::dvec4 q = glm::normalize(glm::dvec4(splat.rotation));
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  return {1 - 2 * (y * y + z * z), 2 * (x * y + w * z),     2 * (x * z - w * y),
          2 * (x * y - w * z),     1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
          2 * (x * z + w * y),     2 * (y * z - w * x),     1 - 2 * (x * x + y * y)};
}

glm::dvec3 splat_sigma(const Splat& splat) {
  const glm::dvec3 s(splat.sigma);
  return glm::max(s, glm::dvec3(kFlattestSplat * std::max({s.x, s.y, s.z})));
}

bool has_splats(const DrawList& list) {
  if (std::ranges::none_of(list.meshes, [](const auto& mesh) { return mesh->splats != nullptr; })) return false;
  return std::ranges::any_of(
      list.items, [&](const DrawItem& item) { return item.visible && list.meshes[item.mesh]->splats != nullptr; });
}

std::vector<SeenSplat> see_splats(const DrawList& list, const glm::dmat4& world_from_view,
                                  std::span<const ItemPlace> places) {
  std::vector<SeenSplat> seen;
  const glm::dmat4 view_from_world = glm::inverse(world_from_view);
  for (std::uint32_t item = 0; item < list.items.size(); ++item) {
    const SplatCloud* const cloud = list.meshes[list.items[item].mesh]->splats.get();
    if (!list.items[item].visible || cloud == nullptr) continue;
    const auto place = std::ranges::lower_bound(places, item, {}, &ItemPlace::item);
    const bool moved = place != places.end() && place->item == item;
    const glm::dmat4& world_from_mesh =
        moved ? place->world_from_mesh : list.world_from_node[list.items[item].transform];
    seen.reserve(seen.size() + cloud->splats.size());
    ItemSplats(*cloud, item, view_from_world * world_from_mesh).add_to(seen);
  }
  return seen;
}

}  // namespace simvis
