#include <simvis/content_pool.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/fnv1a.h"
#include "engine/base/read_fence.h"
#include "engine/base/words.h"
#include "engine/draw/splat_cloud.h"

namespace simvis {
namespace {

// Values are hashed and compared by their bits, so a NaN equals itself and equal values always have equal hashes.
class ContentHash {
 public:
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (; size >= 8; bytes += 8, size -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    std::uint64_t rest = 0;
    if (size > 0) std::memcpy(&rest, bytes, size);
    mix(rest ^ (std::uint64_t{size} << 56));
  }

  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    add_bytes(&value, sizeof value);
  }

  template <class T>
  void add(const std::vector<T>& values) {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(T));
  }

  std::uint64_t value() const { return state_; }

 private:
  // FNV-1a with words of 8 bytes. The shift mixes the high bits, which hold most of the product's information, into the
  // low bits.
  void mix(std::uint64_t word) {
    state_ = fnv1a_step(state_, word);
    state_ ^= state_ >> 29;
  }
  std::uint64_t state_ = kFnv1aStart;
};

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Types that are compared by bits must have no padding.
static_assert(sizeof(VertexAttributes) == 11 * sizeof(float));
static_assert(sizeof(Splat) == 11 * sizeof(float));
static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::mat3x2) == 6 * sizeof(float));

std::uint64_t hash(const Mesh& mesh) {
  ContentHash h;
  h.add(mesh.topology);
  h.add(mesh.positions);
  h.add(mesh.attributes);
  h.add(mesh.indices);
  if (mesh.splats) h.add(mesh.splats->splats);
  return h.value();
}

bool same_splats(const SplatCloud* a, const SplatCloud* b) {
  if (a == b || a == nullptr || b == nullptr) return a == b;
  return a->encoding == b->encoding && a->degree == b->degree && same_bits(a->splats, b->splats) &&
         same_bits(a->harmonics, b->harmonics);
}

bool same(const Mesh& a, const Mesh& b) {
  return a.topology == b.topology && a.surface == b.surface && same_bits(a.bounds_min, b.bounds_min) &&
         same_bits(a.bounds_max, b.bounds_max) && same_bits(a.positions, b.positions) &&
         same_bits(a.attributes, b.attributes) && same_bits(a.indices, b.indices) &&
         same_splats(a.splats.get(), b.splats.get());
}

std::uint64_t hash(const Texture& texture) {
  ContentHash h;
  h.add(texture.width);
  h.add(texture.height);
  h.add(texture.rgba);
  h.add(texture.sampler.wrap_u);
  h.add(texture.sampler.wrap_v);
  h.add(texture.sampler.magnify);
  h.add(texture.sampler.minify);
  h.add(texture.sampler.between_mips);
  h.add(texture.sampler.mipmapped);
  return h.value();
}

bool same(const Texture& a, const Texture& b) {
  return a.width == b.width && a.height == b.height && a.sampler == b.sampler && a.rgba == b.rgba;
}

std::uint64_t hash(const Material& material) {
  ContentHash h;
  h.add_bytes(&material.base_color, sizeof material.base_color);
  h.add_bytes(&material.emissive, sizeof material.emissive);
  h.add(material.alpha_mode);
  h.add(material.alpha_cutoff);
  h.add(material.opacity);
  h.add(material.roughness);
  h.add(material.mirror);
  h.add(material.transmission);
  h.add(material.refractive_index);
  h.add(material.unlit);
  h.add(material.double_sided);
  h.add(std::bit_cast<std::uintptr_t>(material.base_color_texture.get()));
  h.add(material.uv_set);
  h.add(material.reflectance.value_or(-1));
  h.add(material.retro_reflectance);
  h.add_bytes(&material.uv_transform, sizeof material.uv_transform);
  h.add(material.metallic);
  for (const SurfaceMap& map : material.maps) {
    h.add(std::bit_cast<std::uintptr_t>(map.texture.get()));
    h.add(map.uv_set);
    h.add_bytes(&map.uv_transform, sizeof map.uv_transform);
  }
  h.add(material.normal_scale);
  h.add(material.occlusion_strength);
  return h.value();
}

bool same_map(const SurfaceMap& a, const SurfaceMap& b) {
  return a.texture == b.texture && a.uv_set == b.uv_set && same_bits(a.uv_transform, b.uv_transform);
}

bool same(const Material& a, const Material& b) {
  return same_bits(a.base_color, b.base_color) && same_bits(a.emissive, b.emissive) && a.alpha_mode == b.alpha_mode &&
         same_bits(a.alpha_cutoff, b.alpha_cutoff) && same_bits(a.opacity, b.opacity) &&
         same_bits(a.roughness, b.roughness) && same_bits(a.mirror, b.mirror) &&
         same_bits(a.transmission, b.transmission) && same_bits(a.refractive_index, b.refractive_index) &&
         a.unlit == b.unlit && a.double_sided == b.double_sided && a.base_color_texture == b.base_color_texture &&
         a.uv_set == b.uv_set && same_bits(a.uv_transform, b.uv_transform) && a.reflectance == b.reflectance &&
         a.retro_reflectance == b.retro_reflectance && same_bits(a.metallic, b.metallic) &&
         std::ranges::equal(a.maps, b.maps, same_map) && same_bits(a.normal_scale, b.normal_scale) &&
         same_bits(a.occlusion_strength, b.occlusion_strength);
}

template <class T>
using Table = std::unordered_multimap<std::uint64_t, std::weak_ptr<const T>>;

// Removes expired entries when the table is about to grow, so that each entry is checked a bounded number of times.
template <class T>
void forget_expired(Table<T>& table) {
  const double room = static_cast<double>(table.bucket_count()) * static_cast<double>(table.max_load_factor());
  if (static_cast<double>(table.size() + 1) <= room) return;
  std::erase_if(table, [](const auto& entry) { return entry.second.expired(); });
}

template <class T, class Equal>
std::shared_ptr<const T> find(const Table<T>& table, std::uint64_t key, const Equal& equal) {
  const auto [first, last] = table.equal_range(key);
  for (auto entry = first; entry != last; ++entry) {
    std::shared_ptr<const T> known = entry->second.lock();
    if (known && equal(*known)) return known;
  }
  return nullptr;
}

template <class T>
void add(Table<T>& table, std::uint64_t key, const std::shared_ptr<const T>& content) {
  forget_expired(table);
  table.emplace(key, content);
}

// Names stand in messages, so that content with another name is other content to another pool.
bool identical(const Mesh& a, const Mesh& b) {
  return a.name == b.name && same(a, b) && same_bits(a.longest_edge, b.longest_edge);
}
bool identical(const Texture& a, const Texture& b) { return a.name == b.name && same(a, b); }
bool identical(const Material& a, const Material& b) { return a.name == b.name && same(a, b); }

// The content of all pools of the process: simulations of the same parts hold them once.
template <class T>
std::shared_ptr<const T> shared_by_pools(std::uint64_t key, T&& content) {
  static std::mutex mutex;
  static Table<T> table;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const T> known = find(table, key, [&](const T& other) { return identical(other, content); });
  if (known) return known;
  known = std::make_shared<const T>(std::forward<T>(content));
  add(table, key, known);
  return known;
}

template <class T>
std::shared_ptr<const T> find_or_add(Table<T>& table, T&& content) {
  const std::uint64_t key = hash(content);
  std::shared_ptr<const T> known = find(table, key, [&](const T& other) { return same(other, content); });
  if (known) return known;
  known = shared_by_pools(key, std::forward<T>(content));
  add(table, key, known);
  return known;
}

// Of all pictures of a pool, decoded.
std::size_t most_picture_bytes() {
  constexpr std::size_t kUsual_mib = 4096;
  const char* const text = std::getenv("SIMVIS_PICTURE_MIB");
  const std::optional<std::size_t> mib = text == nullptr ? kUsual_mib : as_number<std::size_t>(text);
  if (!mib) {
    throw InputError("variable SIMVIS_PICTURE_MIB: " + in_quotes(text) +
                     " is not allowed, expected a whole number of MiB");
  }
  return std::min(*mib, SIZE_MAX >> 20) << 20;
}

// What is read later has the fence of now.
PictureSource within_fence(PictureSource source) {
  std::optional<ReadScope> scope = read_scope();
  if (!scope) return source;
  source.read = [scope = std::move(*scope), read = std::move(source.read)](std::vector<std::string>& warnings) {
    const ReadFence fence(scope);
    return read(warnings);
  };
  return source;
}

}  // namespace

std::shared_ptr<const Texture> ContentPool::picture(PictureSource source, std::vector<std::string>& warnings) {
  if (postpones_ && source.use == PictureUse::color) {
    source = within_fence(std::move(source));
    Texture white{.name = {}, .width = 1, .height = 1, .rgba = {255, 255, 255, 255}, .sampler = {}};
    postponed_.push_back({std::make_shared<const Texture>(std::move(white)), std::move(source)});
    return postponed_.back().stand_in;
  }
  std::optional<Texture> texture = source.read(warnings);
  return texture ? intern(std::move(*texture)) : nullptr;
}

std::unordered_map<const Texture*, std::shared_ptr<const Texture>> ContentPool::read_pictures(
    std::vector<std::string>& warnings) {
  std::unordered_map<const Texture*, std::shared_ptr<const Texture>> pictures;
  for (const Postponed& each : postponed_) {
    if (each.stand_in.use_count() == 1) continue;
    std::optional<Texture> texture = each.source.read(warnings);
    pictures[each.stand_in.get()] = texture ? intern(std::move(*texture)) : nullptr;
  }
  return pictures;
}

std::shared_ptr<const Material> ContentPool::completed(
    const Material& material, const std::unordered_map<const Texture*, std::shared_ptr<const Texture>>& pictures) {
  Material complete = material;
  std::vector<const Texture*> missing;
  bool changed = false;
  // Returns false if the picture cannot be had.
  const auto complete_texture = [&](std::shared_ptr<const Texture>& texture) {
    const auto found = pictures.find(texture.get());
    if (texture == nullptr || found == pictures.end()) return true;
    changed = true;
    if (found->second == nullptr) missing.push_back(texture.get());
    texture = found->second;
    return texture != nullptr;
  };
  complete_texture(complete.base_color_texture);
  for (SurfaceMap& map : complete.maps) {
    if (!complete_texture(map.texture)) map = SurfaceMap{};
  }
  if (!changed) return nullptr;
  for (const Postponed& each : postponed_) {
    if (each.source.without && std::ranges::count(missing, each.stand_in.get()) > 0) each.source.without(complete);
  }
  return intern(std::move(complete));
}

std::shared_ptr<const Mesh> ContentPool::intern(Mesh&& mesh) { return find_or_add(meshes_, std::move(mesh)); }

std::shared_ptr<const Texture> ContentPool::intern(Texture&& texture) {
  std::shared_ptr<const Texture> pooled = find_or_add(textures_, std::move(texture));
  check_picture_bytes();
  return pooled;
}

// A limit is no fault of the file that reaches it, so it never becomes a warning.
void ContentPool::check_picture_bytes() const {
  const std::size_t most = most_picture_bytes();
  std::size_t bytes = 0;
  for (const auto& [key, texture] : textures_) {
    if (const auto alive = texture.lock()) bytes += alive->rgba.size();
  }
  if (bytes <= most) return;
  throw MachineError("the pictures of the scene take more than " + std::to_string(most >> 20) +
                     " MiB when they are decoded, which is the limit; the variable SIMVIS_PICTURE_MIB sets another");
}

std::shared_ptr<const Material> ContentPool::intern(Material&& material) {
  return find_or_add(materials_, std::move(material));
}

}  // namespace simvis
