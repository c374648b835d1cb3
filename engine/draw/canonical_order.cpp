#include "engine/draw/canonical_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <compare>
#include <cstring>
#include <numeric>
#include <tuple>

#include "engine/draw/splat_cloud.h"

namespace simvis {
namespace {

int sign(std::strong_ordering order) { return order < 0 ? -1 : order > 0 ? 1 : 0; }

template <typename T>
int compare_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.empty() ? 0 : std::memcmp(a.data(), b.data(), a.size() * sizeof(T));
}

// Bit patterns give a total order of numbers, including NaN and both zeros.
std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }
std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }
template <glm::length_t L, typename T>
auto bits(const glm::vec<L, T>& v) {
  std::array<decltype(bits(v[0])), L> all;
  for (glm::length_t i = 0; i < L; ++i) all[static_cast<std::size_t>(i)] = bits(v[i]);
  return all;
}

// The bindings name every member, so that this code does not compile when a member is added to a struct.
auto row_of(const Texture& texture) {
  const auto& [name, width, height, rgba, sampler] = texture;
  const auto& [wrap_u, wrap_v, magnify, minify, between_mips, mipmapped] = sampler;
  return std::tuple(width, height, wrap_u, wrap_v, magnify, minify, between_mips, mipmapped);
}

auto row_of(const Light& light) {
  const auto& [kind, color, intensity, range_m, inner_cone_rad, outer_cone_rad, direction, shadow_px, lamp_points,
               lamp_point, lamp_shape, lamp_radius, lamp_middle] = light;
  return std::tuple(kind, bits(color), bits(intensity), bits(range_m), bits(inner_cone_rad), bits(outer_cone_rad),
                    bits(direction), shadow_px, lamp_points, lamp_point, lamp_shape, bits(lamp_radius),
                    bits(lamp_middle));
}

auto bits(const glm::mat3x2& m) { return std::array{bits(m[0]), bits(m[1]), bits(m[2])}; }

// All members except the textures.
auto row_of(const SurfaceMap& map) {
  const auto& [texture, uv_set, uv_transform] = map;
  return std::tuple(uv_set, bits(uv_transform));
}

auto row_of(const Material& material) {
  const auto& [name, base_color, emissive, alpha_mode, alpha_cutoff, opacity, roughness, metallic, unlit, double_sided,
               reflectance, retro_reflectance, texture, uv_set, uv_transform, maps, normal_scale, occlusion_strength,
               mirror, transmission, refractive_index] = material;
  std::array<decltype(row_of(maps[0])), kMapKinds> map_rows;
  std::ranges::transform(maps, map_rows.begin(), [](const SurfaceMap& map) { return row_of(map); });
  return std::tuple(bits(base_color), bits(emissive), alpha_mode, bits(alpha_cutoff), bits(opacity), bits(roughness),
                    bits(metallic), unlit, double_sided, reflectance.has_value(), bits(reflectance.value_or(0)),
                    bits(retro_reflectance), uv_set, bits(uv_transform), map_rows, bits(normal_scale),
                    bits(occlusion_strength), bits(mirror), bits(transmission), bits(refractive_index));
}

int canonical_compare(const Texture* a, const Texture* b) {
  if (a == b) return 0;
  if (!a || !b) return a ? 1 : -1;
  const int rows = sign(row_of(*a) <=> row_of(*b));
  return rows != 0 ? rows : compare_bytes(a->rgba, b->rgba);
}

int canonical_compare(const SplatCloud* a, const SplatCloud* b) {
  static_assert(sizeof(Splat) == 11 * sizeof(float), "bytes are compared: there may be no padding");
  if (a == b) return 0;
  if (!a || !b) return a ? 1 : -1;
  if (const int order = sign(std::tuple(a->encoding, a->degree) <=> std::tuple(b->encoding, b->degree))) return order;
  if (const int order = compare_bytes(a->splats, b->splats)) return order;
  return compare_bytes(a->harmonics, b->harmonics);
}

std::vector<std::uint32_t> numbers_to(std::size_t end) {
  std::vector<std::uint32_t> numbers(end);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

template <typename T>
std::vector<std::uint32_t> ranks_of(std::span<const std::shared_ptr<const T>> all) {
  std::vector<std::uint32_t> order = numbers_to(all.size()), ranks(all.size());
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return canonical_compare(*all[a], *all[b]) < 0; });
  for (std::size_t i = 1; i < order.size(); ++i) {
    ranks[order[i]] = ranks[order[i - 1]] + (canonical_compare(*all[order[i - 1]], *all[order[i]]) != 0);
  }
  return ranks;
}

}  // namespace

int canonical_compare(const Mesh& a, const Mesh& b) {
  if (&a == &b) return 0;
  static_assert(sizeof(VertexAttributes) == 11 * sizeof(float), "bytes are compared: there may be no padding");
  if (a.topology != b.topology) return a.topology < b.topology ? -1 : 1;
  if (const int order = compare_bytes(a.positions, b.positions)) return order;
  if (const int order = compare_bytes(a.indices, b.indices)) return order;
  if (const int order = compare_bytes(a.attributes, b.attributes)) return order;
  return canonical_compare(a.splats.get(), b.splats.get());
}

int canonical_compare(const Material& a, const Material& b) {
  if (&a == &b) return 0;
  if (const int order = canonical_compare(a.base_color_texture.get(), b.base_color_texture.get())) return order;
  for (std::size_t kind = 0; kind < kMapKinds; ++kind) {
    if (const int order = canonical_compare(a.maps[kind].texture.get(), b.maps[kind].texture.get())) return order;
  }
  return sign(row_of(a) <=> row_of(b));
}

int compare_places(const glm::dmat4& world_from_a, const glm::dmat4& world_from_b) {
  return std::memcmp(&world_from_a, &world_from_b, sizeof world_from_a);
}

int canonical_compare(const DrawList& list, const DrawItem& a, const DrawItem& b) {
  if (const int order = canonical_compare(*list.meshes[a.mesh], *list.meshes[b.mesh])) return order;
  if (const int order = canonical_compare(*list.materials[a.material], *list.materials[b.material])) return order;
  return compare_places(list.world_from_node[a.transform], list.world_from_node[b.transform]);
}

std::vector<std::uint32_t> canonical_ranks(std::span<const std::shared_ptr<const Mesh>> meshes) {
  return ranks_of(meshes);
}

std::vector<std::uint32_t> canonical_ranks(std::span<const std::shared_ptr<const Material>> materials) {
  return ranks_of(materials);
}

std::vector<std::uint32_t> item_order(const DrawList& list) {
  std::vector<std::uint32_t> order = numbers_to(list.items.size());
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return canonical_compare(list, list.items[a], list.items[b]) < 0;
  });
  return order;
}

std::vector<std::uint32_t> light_order(const DrawList& list) {
  std::vector<std::uint32_t> order = numbers_to(list.lights.size());
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const auto row_a = row_of(list.lights[a].light), row_b = row_of(list.lights[b].light);
    if (row_a != row_b) return row_a < row_b;
    return compare_places(list.world_from_node[list.lights[a].transform],
                          list.world_from_node[list.lights[b].transform]) < 0;
  };
  std::ranges::sort(order, before);
  return order;
}

}  // namespace simvis
