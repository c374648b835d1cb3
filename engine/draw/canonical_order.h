// Which comes first of what a draw list holds, by what it is: not by its name, nor by where it stands. Where the order
// of drawing shows (of surfaces at one depth the first is seen; sums of light round), pictures and scans are so the
// same however the parts of a scene are declared.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/draw_list.h>

namespace simvis {

/// Below, above or equal to 0 as `a` comes before, after or at the place of `b`: a total order, of which equal ones
/// look the same to every sensor. Meshes and textures are compared only as far as they are equal.
int canonical_compare(const Mesh& a, const Mesh& b);
/// By their textures first.
int canonical_compare(const Material& a, const Material& b);
int compare_places(const glm::dmat4& world_from_a, const glm::dmat4& world_from_b);
/// Of two items: meshes, materials, places.
int canonical_compare(const DrawList& list, const DrawItem& a, const DrawItem& b);

/// For each mesh or material how many different ones come before it.
std::vector<std::uint32_t> canonical_ranks(std::span<const std::shared_ptr<const Mesh>> meshes);
std::vector<std::uint32_t> canonical_ranks(std::span<const std::shared_ptr<const Material>> materials);

/// The numbers of the lights, in their order.
std::vector<std::uint32_t> light_order(const DrawList& list);

}  // namespace simvis
