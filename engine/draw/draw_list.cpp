#include <simvis/draw_list.h>

#include <cstring>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>

#include "engine/base/fnv1a.h"
#include "engine/draw/splat_cloud.h"
#include "engine/draw/topology_name.h"

namespace simvis {
namespace {

class ListHash {
 public:
  void bytes(const void* data, std::size_t size) { hash_ = fnv1a(data, size, hash_); }
  template <typename T>
  void bits(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes(&value, sizeof value);
  }
  // Adding zero turns -0 into 0, so that values that compare equal have equal hashes.
  void number(float value) { bits(value + 0.0f); }
  void number(double value) { bits(value + 0.0); }
  template <glm::length_t L, typename T>
  void vector(const glm::vec<L, T>& value) {
    for (glm::length_t i = 0; i < L; ++i) number(value[i]);
  }
  void text(const std::string& value) {
    bits(value.size());
    bytes(value.data(), value.size());
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = kFnv1aStart;
};

void add(ListHash& hash, const SplatCloud& cloud) {
  hash.text("splats");
  hash.bits(cloud.encoding);
  hash.bits(cloud.degree);
  hash.bits(cloud.splats.size());
  for (const Splat& splat : cloud.splats) {
    hash.vector(splat.center);
    hash.vector(splat.sigma);
    hash.vector(splat.rotation);
    hash.number(splat.opacity);
  }
  for (const glm::vec3& coefficient : cloud.harmonics) hash.vector(coefficient);
}

void add(ListHash& hash, const Mesh& mesh) {
  hash.text(mesh.name);
  hash.bits(mesh.topology);
  hash.bits(mesh.positions.size());
  for (const glm::vec3& position : mesh.positions) hash.vector(position);
  hash.bits(mesh.attributes.size());
  for (const VertexAttributes& a : mesh.attributes) {
    hash.vector(a.normal);
    hash.vector(a.uv[0]);
    hash.vector(a.uv[1]);
    hash.vector(a.color);
  }
  hash.bits(mesh.indices.size());
  hash.bytes(mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  hash.vector(mesh.bounds_min);
  hash.vector(mesh.bounds_max);
  if (mesh.splats) add(hash, *mesh.splats);
  if (!mesh.surface) return;
  hash.text("surface");
  hash.bits(mesh.surface->kind);
  hash.bits(mesh.surface->axis);
  for (const double length_m :
       {mesh.surface->radius_m, mesh.surface->length_m, mesh.surface->deviation_m, mesh.surface->half_size_m.x,
        mesh.surface->half_size_m.y, mesh.surface->drawn_m.x, mesh.surface->drawn_m.y}) {
    hash.number(length_m);
  }
}

void add(ListHash& hash, const Texture* texture) {
  hash.bits(texture != nullptr);
  if (!texture) return;
  hash.text(texture->name);
  hash.bits(texture->width);
  hash.bits(texture->height);
  hash.bits(texture->rgba.size());
  hash.bytes(texture->rgba.data(), texture->rgba.size());
  const Sampler& s = texture->sampler;
  hash.bits(s.wrap_u);
  hash.bits(s.wrap_v);
  hash.bits(s.magnify);
  hash.bits(s.minify);
  hash.bits(s.between_mips);
  hash.bits(s.mipmapped);
}

void add(ListHash& hash, const Material& material) {
  hash.text(material.name);
  hash.vector(material.base_color);
  hash.vector(material.emissive);
  hash.bits(material.alpha_mode);
  hash.number(material.alpha_cutoff);
  hash.number(material.opacity);
  hash.number(material.roughness);
  const Material matte;
  if (material.mirror != matte.mirror || material.transmission != matte.transmission ||
      material.refractive_index != matte.refractive_index) {
    hash.number(material.mirror);
    hash.number(material.transmission);
    hash.number(material.refractive_index);
  }
  hash.bits(material.unlit);
  hash.bits(material.double_sided);
  add(hash, material.base_color_texture.get());
  hash.bits(material.uv_set);
  for (glm::length_t c = 0; c < 3; ++c) hash.vector(material.uv_transform[c]);
  if (material.reflectance) {
    hash.text("reflectance");
    hash.number(*material.reflectance);
  }
  if (material.retro_reflectance != 0) {
    hash.text("retro_reflectance");
    hash.number(material.retro_reflectance);
  }
  if (material.metallic != 0) hash.number(material.metallic);
  for (std::size_t kind = 0; kind < kMapKinds; ++kind) {
    const SurfaceMap& map = material.maps[kind];
    if (map == SurfaceMap{}) continue;
    hash.bits(kind);
    add(hash, map.texture.get());
    hash.bits(map.uv_set);
    for (glm::length_t c = 0; c < 3; ++c) hash.vector(map.uv_transform[c]);
  }
  if (material.normal_scale != 1) hash.number(material.normal_scale);
  if (material.occlusion_strength != 1) hash.number(material.occlusion_strength);
}

void add(ListHash& hash, const LightItem& item) {
  const Light& light = item.light;
  hash.bits(light.kind);
  hash.vector(light.color);
  hash.number(light.intensity);
  hash.number(light.range_m);
  hash.number(light.inner_cone_rad);
  hash.number(light.outer_cone_rad);
  hash.vector(light.direction);
  hash.bits(item.transform);
  if (light.shadow_px > 0) hash.bits(light.shadow_px);
}

// Pointers are compared first, because shared content is the common case.
template <typename T>
bool same_value(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b) {
  return a == b || (a && b && *a == *b);
}

bool same_mesh(const std::shared_ptr<const Mesh>& a, const std::shared_ptr<const Mesh>& b) {
  if (same_value(a, b)) return true;
  if (!a || !b || a->splats == nullptr || !same_value(a->splats, b->splats)) return false;
  Mesh other = *b;
  other.splats = a->splats;
  return *a == other;
}

bool same_material(const std::shared_ptr<const Material>& a, const std::shared_ptr<const Material>& b) {
  if (a == b) return true;
  if (!a || !b || !same_value(a->base_color_texture, b->base_color_texture)) return false;
  Material other = *b;
  other.base_color_texture = a->base_color_texture;
  for (std::size_t kind = 0; kind < kMapKinds; ++kind) {
    if (!same_value(a->maps[kind].texture, b->maps[kind].texture)) return false;
    other.maps[kind].texture = a->maps[kind].texture;
  }
  return *a == other;
}

template <typename T, typename Same>
bool same_tables(const std::vector<T>& a, const std::vector<T>& b, Same same) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!same(a[i], b[i])) return false;
  }
  return true;
}

bool same_bits(const glm::dmat4& a, const glm::dmat4& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

struct Printed {
  glm::dvec3 v;
};

std::ostream& operator<<(std::ostream& out, const Printed& p) {
  return out << '(' << p.v.x << ' ' << p.v.y << ' ' << p.v.z << ')';
}

const char* name_of(AlphaMode mode) {
  switch (mode) {
    case AlphaMode::opaque:
      return "opaque";
    case AlphaMode::mask:
      return "mask";
    case AlphaMode::blend:
      return "blend";
  }
  return "?";
}

const char* name_of(LightKind kind) {
  switch (kind) {
    case LightKind::directional:
      return "directional";
    case LightKind::point:
      return "point";
    case LightKind::spot:
      return "spot";
  }
  return "?";
}

void print_material(std::ostream& out, const Material& m) {
  out << '"' << m.name << "\" " << name_of(m.alpha_mode) << ", base " << Printed{glm::dvec3(m.base_color)} << " alpha "
      << m.base_color.a;
  if (m.emissive != glm::vec3(0)) out << ", emissive " << Printed{glm::dvec3(m.emissive)};
  if (m.alpha_mode == AlphaMode::mask) out << ", cutoff " << m.alpha_cutoff;
  if (m.opacity != 1) out << ", opacity " << m.opacity;
  if (m.roughness != 1) out << ", roughness " << m.roughness;
  if (m.reflectance) out << ", reflectance " << *m.reflectance;
  if (m.retro_reflectance != 0) out << ", retro-reflectance " << m.retro_reflectance;
  if (m.mirror != 0) out << ", mirror " << m.mirror;
  if (m.transmission != 0) out << ", transmission " << m.transmission << " by index " << m.refractive_index;
  if (m.metallic != 0) out << ", metallic " << m.metallic;
  if (m.unlit) out << ", unlit";
  if (m.double_sided) out << ", double-sided";
  if (m.base_color_texture) {
    const Texture& t = *m.base_color_texture;
    out << ", texture \"" << t.name << "\" " << t.width << " x " << t.height << ", uv set " << m.uv_set;
  }
  constexpr std::string_view kMapNames[kMapKinds] = {"normal", "metallic-roughness", "occlusion", "emissive"};
  for (std::size_t kind = 0; kind < kMapKinds; ++kind) {
    if (!m.maps[kind].texture) continue;
    const Texture& t = *m.maps[kind].texture;
    out << ", " << kMapNames[kind] << " map \"" << t.name << "\" " << t.width << " x " << t.height << ", uv set "
        << m.maps[kind].uv_set;
  }
}

void print_transform(std::ostream& out, const glm::dmat4& m) {
  for (int column = 0; column < 3; ++column) out << Printed{glm::dvec3(m[column])} << ' ';
  out << "at " << Printed{glm::dvec3(m[3])};
}

bool same_sky(const SkyView& a, const SkyView& b) {
  SkyView b_of_a = b;
  b_of_a.picture = a.picture;
  if (a != b_of_a || (a.picture == nullptr) != (b.picture == nullptr)) return false;
  return a.picture == b.picture || (a.picture->width == b.picture->width && a.picture->radiance == b.picture->radiance);
}

void add(ListHash& hash, const SkyView& sky) {
  if (sky.picture == nullptr) return;
  hash.number(sky.factor);
  hash.bits(sky.transform);
  hash.bits(sky.picture->width);
  hash.bytes(sky.picture->radiance.data(), sky.picture->radiance.size() * sizeof(glm::vec3));
}

}  // namespace

bool same_content(const DrawList& a, const DrawList& b) {
  return a.items == b.items && a.lights == b.lights && a.environment == b.environment && same_sky(a.sky, b.sky) &&
         a.medium == b.medium && same_tables(a.world_from_node, b.world_from_node, same_bits) &&
         same_tables(a.meshes, b.meshes, same_mesh) && same_tables(a.materials, b.materials, same_material);
}

std::uint64_t content_hash(const DrawList& list) {
  ListHash hash;
  hash.bits(list.items.size());
  for (const DrawItem& item : list.items) {
    hash.bits(item.mesh);
    hash.bits(item.material);
    hash.bits(item.transform);
    if (!item.visible) hash.bits(item.visible);
  }
  hash.bits(list.lights.size());
  for (const LightItem& light : list.lights) add(hash, light);
  hash.bits(list.world_from_node.size());
  for (const glm::dmat4& m : list.world_from_node) hash.bytes(&m, sizeof m);
  hash.bits(list.meshes.size());
  for (const auto& mesh : list.meshes) add(hash, *mesh);
  hash.bits(list.materials.size());
  for (const auto& material : list.materials) add(hash, *material);
  hash.vector(list.environment.ambient);
  hash.vector(list.environment.background);
  add(hash, list.sky);
  if (list.medium != Medium{}) {
    for (const double number :
         {list.medium.extinction_per_m, list.medium.laser_extinction_per_m, list.medium.backscatter_per_m_sr,
          list.medium.particles_per_m3, list.medium.particle_diameter_m}) {
      hash.number(number);
    }
    hash.vector(list.medium.airlight);
  }
  return hash.value();
}

std::ostream& operator<<(std::ostream& out, const DrawList& list) {
  out << "draw list: " << list.items.size() << " items, " << list.lights.size() << " lights, "
      << list.world_from_node.size() << " transforms, " << list.meshes.size() << " meshes, " << list.materials.size()
      << " materials\n";
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    out << "  item " << i << ": mesh " << item.mesh << ", material " << item.material << ", transform "
        << item.transform << (item.visible ? "\n" : ", hidden\n");
  }
  for (std::size_t i = 0; i < list.lights.size(); ++i) {
    const Light& light = list.lights[i].light;
    out << "  light " << i << ": " << name_of(light.kind) << ", colour " << Printed{glm::dvec3(light.color)}
        << ", intensity " << light.intensity << ", direction " << Printed{light.direction} << ", transform "
        << list.lights[i].transform;
    if (light.shadow_px > 0) out << ", shadows of " << light.shadow_px << " texels";
    out << '\n';
  }
  for (std::size_t i = 0; i < list.world_from_node.size(); ++i) {
    out << "  transform " << i << ": ";
    print_transform(out, list.world_from_node[i]);
    out << '\n';
  }
  for (std::size_t i = 0; i < list.meshes.size(); ++i) {
    const Mesh& m = *list.meshes[i];
    out << "  mesh " << i << ": \"" << m.name << "\" " << name_of(m.topology) << ", " << m.positions.size()
        << " vertices, " << m.indices.size() << " indices, bounds " << Printed{glm::dvec3(m.bounds_min)} << " to "
        << Printed{glm::dvec3(m.bounds_max)};
    if (m.splats) out << ", " << m.splats->splats.size() << " splats";
    out << '\n';
  }
  for (std::size_t i = 0; i < list.materials.size(); ++i) {
    out << "  material " << i << ": ";
    print_material(out, *list.materials[i]);
    out << '\n';
  }
  if (list.medium != Medium{}) {
    out << "  medium: extinction " << list.medium.extinction_per_m << " 1/m, of lasers "
        << list.medium.laser_extinction_per_m << " 1/m, backscatter " << list.medium.backscatter_per_m_sr
        << " 1/(m sr), " << list.medium.particles_per_m3 << " particles per m3 of " << list.medium.particle_diameter_m
        << " m, airlight " << Printed{glm::dvec3(list.medium.airlight)} << '\n';
  }
  if (list.sky.picture) {
    out << "  sky: picture of " << list.sky.picture->width << " x " << list.sky.picture->height << ", factor "
        << list.sky.factor << ", transform " << list.sky.transform << '\n';
  }
  return out << "  ambient " << Printed{glm::dvec3(list.environment.ambient)} << ", background "
             << Printed{glm::dvec3(list.environment.background)} << '\n';
}

}  // namespace simvis
