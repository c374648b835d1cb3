// Canonical order of meshes, materials, items and lights by content, independent of names and of the order of
// declaration. The order of drawing is visible in results: among surfaces at one depth the first is visible, and sums
// of light are rounded. With a canonical order, images and scans do not depend on how the parts of a scene are
// declared.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/draw_list.h>

namespace simvis {

/// Negative, positive or 0 if `a` comes before, after or at the same place as `b`. This is a total order; equal objects
/// look the same to every sensor. The comparison of meshes and textures stops at the first difference.
int canonical_compare(const Mesh& a, const Mesh& b);
/// Materials are compared by their textures first.
int canonical_compare(const Material& a, const Material& b);
int compare_places(const glm::dmat4& world_from_a, const glm::dmat4& world_from_b);
/// Items are compared by their meshes, then by their materials, then by their places.
int canonical_compare(const DrawList& list, const DrawItem& a, const DrawItem& b);

/// For each mesh or material, the number of different ones that come before it.
std::vector<std::uint32_t> canonical_ranks(std::span<const std::shared_ptr<const Mesh>> meshes);
std::vector<std::uint32_t> canonical_ranks(std::span<const std::shared_ptr<const Material>> materials);

/// The indices of the items in canonical order.
std::vector<std::uint32_t> item_order(const DrawList& list);

/// The indices of the lights in canonical order.
std::vector<std::uint32_t> light_order(const DrawList& list);

}  // namespace simvis
