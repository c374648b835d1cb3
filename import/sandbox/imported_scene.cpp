#include "import/sandbox/imported_scene.h"

#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <simvis/error.h>
#include "engine/draw/splat_cloud.h"

namespace simvis {
namespace {

// Hands over the bytes of a scene in order. Small ones are collected.
class Packer {
 public:
  explicit Packer(const PackedBytes& write) : write_(write) {}

  template <class T>
  void plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add({reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
  }
  template <class T>
  void choice(const T& value, T) {
    plain(value);
  }
  void flag(bool value) { plain(static_cast<std::uint8_t>(value)); }
  template <class Array>  // a vector or string of trivially copyable values
  void array(const Array& values) {
    static_assert(std::is_trivially_copyable_v<typename Array::value_type>);
    plain(std::uint64_t{values.size()});
    add({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(typename Array::value_type)});
  }
  template <class T, class Walk>
  void list(std::vector<T>& values, Walk walk_one) {
    plain(std::uint64_t{values.size()});
    for (T& value : values) walk_one(*this, value);
  }

  void flush() {
    write_(bytes_);
    bytes_.clear();
  }

 private:
  void add(std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kMaxCollected = std::size_t{1} << 16;
    if (bytes_.size() + bytes.size() > kMaxCollected) flush();
    if (bytes.size() > kMaxCollected) return write_(bytes);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

  const PackedBytes& write_;
  std::vector<std::uint8_t> bytes_;
};

class Unpacker {
 public:
  Unpacker(std::span<const std::uint8_t> bytes, const std::string& subject) : bytes_(bytes), subject_(subject) {}

  template <class T>
  void plain(T& value) {
    std::memcpy(&value, take(sizeof value), sizeof value);
  }
  template <class T>
  void choice(T& value, T last) {
    std::underlying_type_t<T> number;
    plain(number);
    if (number > static_cast<std::underlying_type_t<T>>(last)) fail();
    value = static_cast<T>(number);
  }
  void flag(bool& value) {
    std::uint8_t number = 0;
    plain(number);
    value = number != 0;
  }
  template <class Array>
  void array(Array& values) {
    constexpr std::size_t kSize = sizeof(typename Array::value_type);
    std::uint64_t count = 0;
    plain(count);
    if (count > bytes_.size() / kSize) fail();
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), take(count * kSize), count * kSize);
  }
  template <class T, class Walk>
  void list(std::vector<T>& values, Walk walk_one) {
    std::uint64_t count = 0;
    plain(count);
    // The vector grows one by one, so that a wrong count runs out of bytes before it runs out of memory.
    for (std::uint64_t i = 0; i < count; ++i) walk_one(*this, values.emplace_back());
  }
  void expect_end() const {
    if (!bytes_.empty()) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw InputError(subject_ + "the helper program that read it returned a malformed answer");
  }

  const std::uint8_t* take(std::size_t size) {
    if (size > bytes_.size()) fail();
    const std::uint8_t* const first = bytes_.data();
    bytes_ = bytes_.subspan(size);
    return first;
  }

  std::span<const std::uint8_t> bytes_;
  const std::string& subject_;
};

// The walk_ functions describe the layout once, for packing and for unpacking.
template <class Archive>
void walk_surface(Archive& a, std::optional<ExactSurface>& surface) {
  bool has_surface = surface.has_value();
  a.flag(has_surface);
  if (!has_surface) return;
  if (!surface) surface.emplace();
  a.choice(surface->kind, SurfaceKind::plane);
  a.plain(surface->axis);
  a.plain(surface->radius_m);
  a.plain(surface->length_m);
  a.plain(surface->deviation_m);
}

// A packed mesh is not changed, though the walk takes it for one that may be.
template <class Archive>
void walk_splats(Archive& a, std::shared_ptr<const SplatCloud>& splats) {
  bool is_there = splats != nullptr;
  a.flag(is_there);
  if (!is_there) return;
  const auto cloud = splats ? std::const_pointer_cast<SplatCloud>(splats) : std::make_shared<SplatCloud>();
  a.choice(cloud->encoding, SplatEncoding::linear);
  a.plain(cloud->degree);
  a.array(cloud->splats);
  a.array(cloud->harmonics);
  splats = cloud;
}

template <class Archive>
void walk_mesh(Archive& a, Mesh& mesh) {
  a.array(mesh.name);
  a.choice(mesh.topology, Topology::points);
  a.array(mesh.positions);
  a.array(mesh.attributes);
  a.array(mesh.indices);
  walk_surface(a, mesh.surface);
  walk_splats(a, mesh.splats);
}

template <class Archive>
void walk_texture(Archive& a, ImportedTexture& texture) {
  a.array(texture.file);
  a.array(texture.texture.name);
  a.plain(texture.texture.width);
  a.plain(texture.texture.height);
  a.array(texture.texture.rgba);
  a.choice(texture.texture.sampler.wrap_u, Wrap::clamp_to_edge);
  a.choice(texture.texture.sampler.wrap_v, Wrap::clamp_to_edge);
}

template <class Archive>
void walk_material(Archive& a, ImportedMaterial& material) {
  Material& m = material.material;
  a.array(m.name);
  a.plain(m.base_color);
  a.plain(m.emissive);
  a.choice(m.alpha_mode, AlphaMode::blend);
  a.flag(m.unlit);
  a.flag(m.double_sided);
  a.plain(m.uv_set);
  a.plain(m.uv_transform);
  a.flag(material.is_fallback);
  a.plain(material.texture);
  a.flag(material.textured_emission);
}

template <class Archive>
void walk_shape(Archive& a, ImportedShape& shape) {
  a.plain(shape.mesh);
  a.plain(shape.material);
}

template <class Archive>
void walk_light(Archive& a, std::optional<Light>& light) {
  bool is_there = light.has_value();
  a.flag(is_there);
  if (!is_there) return;
  if (!light) light.emplace();
  a.choice(light->kind, LightKind::spot);
  a.plain(light->color);
  a.plain(light->intensity);
  a.plain(light->range_m);
  a.plain(light->inner_cone_rad);
  a.plain(light->outer_cone_rad);
  a.plain(light->direction);
}

template <class Archive>
void walk_node(Archive& a, ImportedNode& node) {
  a.array(node.name);
  a.plain(node.parent);
  a.plain(node.parent_from_node);
  a.list(node.shapes, walk_shape<Archive>);
  walk_light(a, node.light);
}

template <class Archive>
void walk_scene(Archive& a, ImportedScene& scene) {
  const auto text = [](Archive& archive, std::string& t) { archive.array(t); };
  a.list(scene.meshes, walk_mesh<Archive>);
  a.list(scene.textures, walk_texture<Archive>);
  a.list(scene.materials, walk_material<Archive>);
  a.list(scene.nodes, walk_node<Archive>);
  a.list(scene.commands, text);
  a.list(scene.warnings, text);
}

bool is_finite(double value) { return std::isfinite(value); }

template <glm::length_t L, class T>
bool is_finite(const glm::vec<L, T>& v) {
  for (glm::length_t i = 0; i < L; ++i) {
    if (!std::isfinite(v[i])) return false;
  }
  return true;
}

template <glm::length_t C, glm::length_t R, class T>
bool is_finite(const glm::mat<C, R, T>& m) {
  for (glm::length_t i = 0; i < C; ++i) {
    if (!is_finite(m[i])) return false;
  }
  return true;
}

bool is_affine(const glm::dmat4& m) {
  return is_finite(m) && m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1;
}

bool is_finite(const VertexAttributes& a) {
  return is_finite(a.normal) && is_finite(a.uv[0]) && is_finite(a.uv[1]) && is_finite(a.color);
}

bool is_finite(const Light& l) {
  return is_finite(l.color) && is_finite(l.intensity) && is_finite(l.range_m) && is_finite(l.inner_cone_rad) &&
         is_finite(l.outer_cone_rad) && is_finite(l.direction);
}

// Only closed shapes come out of files that programs read.
bool is_closed_shape(const ExactSurface& s) {
  const bool has_length = s.kind != SurfaceKind::sphere;
  return s.kind != SurfaceKind::plane && s.axis >= 0 && s.axis < 3 && is_finite(s.radius_m) && s.radius_m > 0 &&
         is_finite(s.length_m) && (s.length_m > 0 || !has_length) && is_finite(s.deviation_m) && s.deviation_m >= 0;
}

// What splats of all importers keep, see splat_cloud.h.
bool is_splat(const Splat& splat) {
  const glm::vec3& s = splat.sigma;
  const double length = glm::length(glm::dvec4(splat.rotation));
  return is_finite(splat.center) && is_finite(s) && s.x >= 0 && s.y >= 0 && s.z >= 0 && s != glm::vec3(0) &&
         std::abs(length - 1) < 1e-3 && splat.opacity >= 0 && splat.opacity <= 1;
}

std::string fault_of(const SplatCloud& cloud) {
  if (cloud.degree > kMaxHarmonicsDegree) return "a degree of spherical harmonics above 3";
  if (cloud.splats.size() > kMaxSplats) return "a cloud of too many splats";
  if (cloud.harmonics.size() != cloud.splats.size() * harmonics_count(cloud.degree)) return "splats without colours";
  for (const Splat& splat : cloud.splats) {
    if (!is_splat(splat)) return "a splat with a number that it may not have";
  }
  for (const glm::vec3& coefficient : cloud.harmonics) {
    if (!is_finite(coefficient)) return "a colour that is not finite";
  }
  return {};
}

// Returns the error in the mesh, or an empty string.
std::string fault_of(const Mesh& mesh) {
  constexpr std::size_t kCorners[] = {3, 2, 1};
  if (mesh.attributes.size() != mesh.positions.size()) return "vertices without attributes";
  if (mesh.indices.size() % kCorners[static_cast<std::size_t>(mesh.topology)] != 0) return "an incomplete primitive";
  for (const std::uint32_t index : mesh.indices) {
    if (index >= mesh.positions.size()) return "an index beyond the last vertex";
  }
  for (const glm::vec3& position : mesh.positions) {
    if (!is_finite(position)) return "a vertex position that is not finite";
  }
  for (const VertexAttributes& attributes : mesh.attributes) {
    if (!is_finite(attributes)) return "a normal, texture coordinate or colour that is not finite";
  }
  if (mesh.surface && !is_closed_shape(*mesh.surface)) return "a shape whose size is not above 0 and finite";
  if (mesh.splats) return fault_of(*mesh.splats);
  return {};
}

std::string fault_of(const ImportedTexture& texture) {
  const Texture& t = texture.texture;
  const std::uint64_t pixels = std::uint64_t{t.width} * t.height;
  if (!texture.file.empty()) return t.width == 0 && t.height == 0 && t.rgba.empty() ? "" : "a texture with two images";
  return pixels == 0 || t.rgba.size() % 4 != 0 || t.rgba.size() / 4 != pixels
             ? "a texture whose bytes do not match its size"
             : "";
}

std::string fault_of(const ImportedMaterial& m, const ImportedScene& scene) {
  if (m.texture != kNoTexture && m.texture >= scene.textures.size()) return "a material with an unknown texture";
  if (m.material.uv_set != 0 && m.material.uv_set != 1) return "a material with a third set of texture coordinates";
  if (!is_finite(m.material.base_color) || !is_finite(m.material.emissive)) return "a colour that is not finite";
  if (!is_finite(m.material.uv_transform)) return "a texture transform that is not finite";
  return {};
}

// Parents must come before their children, so that there are no cycles.
std::string fault_of(const ImportedNode& node, std::size_t number, const ImportedScene& scene) {
  if (node.parent != kNoParent && node.parent >= number) return "a node before its parent";
  for (const ImportedShape& shape : node.shapes) {
    if (shape.mesh >= scene.meshes.size() || shape.material >= scene.materials.size())
      return "a shape with an unknown mesh or material";
  }
  const bool is_placed = is_affine(node.parent_from_node);
  if (node.light && (!is_placed || !is_finite(*node.light))) {
    return "a light with a value or a position that is not finite";
  }
  return is_placed ? "" : "a transform that is not finite or not affine";
}

std::string fault_of(const ImportedScene& scene) {
  std::string fault;
  for (const Mesh& mesh : scene.meshes) {
    if (fault = fault_of(mesh); !fault.empty()) return fault;
  }
  for (const ImportedTexture& texture : scene.textures) {
    if (fault = fault_of(texture); !fault.empty()) return fault;
  }
  for (const ImportedMaterial& material : scene.materials) {
    if (fault = fault_of(material, scene); !fault.empty()) return fault;
  }
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (fault = fault_of(scene.nodes[i], i, scene); !fault.empty()) return fault;
  }
  return {};
}

}  // namespace

void pack_imported_scene(ImportedScene& scene, const PackedBytes& write) {
  Packer packer(write);
  walk_scene(packer, scene);
  packer.flush();
}

std::uint64_t packed_size(ImportedScene& scene) {
  std::uint64_t size = 0;
  pack_imported_scene(scene, [&](std::span<const std::uint8_t> bytes) { size += bytes.size(); });
  return size;
}

std::vector<std::uint8_t> pack_imported_scene(ImportedScene scene) {
  std::vector<std::uint8_t> packed;
  pack_imported_scene(
      scene, [&](std::span<const std::uint8_t> bytes) { packed.insert(packed.end(), bytes.begin(), bytes.end()); });
  return packed;
}

ImportedScene unpack_imported_scene(std::span<const std::uint8_t> bytes, const std::string& subject) {
  Unpacker unpacker(bytes, subject);
  ImportedScene scene;
  walk_scene(unpacker, scene);
  unpacker.expect_end();
  const std::string fault = fault_of(scene);
  if (!fault.empty()) throw InputError(subject + "there is " + fault);
  return scene;
}

}  // namespace simvis
