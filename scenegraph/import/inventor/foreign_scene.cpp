#include "scenegraph/import/inventor/foreign_scene.h"

#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include <simvis/error.h>

namespace simvis {
namespace {

class Packer {
 public:
  template <class T>
  void plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
  }
  template <class T>
  void choice(const T& value, T) {
    plain(value);
  }
  void flag(bool value) { plain(static_cast<std::uint8_t>(value)); }
  template <class Array>  // a vector or a string of what can be copied byte by byte
  void array(const Array& values) {
    static_assert(std::is_trivially_copyable_v<typename Array::value_type>);
    plain(std::uint64_t{values.size()});
    const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes.insert(bytes.end(), first, first + values.size() * sizeof(typename Array::value_type));
  }
  template <class T, class Walk>
  void list(std::vector<T>& values, Walk walk_one) {
    plain(std::uint64_t{values.size()});
    for (T& value : values) walk_one(*this, value);
  }

  std::vector<std::uint8_t> bytes;
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
    // It grows one by one, so that a wrong count runs out of bytes, not of memory.
    for (std::uint64_t i = 0; i < count; ++i) walk_one(*this, values.emplace_back());
  }
  void expect_end() const {
    if (!bytes_.empty()) fail();
  }

 private:
  [[noreturn]] void fail() const { throw InputError(subject_ + "the process that read it left a malformed result"); }

  const std::uint8_t* take(std::size_t size) {
    if (size > bytes_.size()) fail();
    const std::uint8_t* const first = bytes_.data();
    bytes_ = bytes_.subspan(size);
    return first;
  }

  std::span<const std::uint8_t> bytes_;
  const std::string& subject_;
};

// One description of the layout serves both ways.
template <class Archive>
void walk_mesh(Archive& a, Mesh& mesh) {
  a.choice(mesh.topology, Topology::points);
  a.array(mesh.positions);
  a.array(mesh.attributes);
  a.array(mesh.indices);
}

template <class Archive>
void walk_texture(Archive& a, Texture& texture) {
  a.plain(texture.width);
  a.plain(texture.height);
  a.array(texture.rgba);
  a.choice(texture.sampler.wrap_u, Wrap::clamp_to_edge);
  a.choice(texture.sampler.wrap_v, Wrap::clamp_to_edge);
}

template <class Archive>
void walk_material(Archive& a, ForeignMaterial& material) {
  Material& m = material.material;
  a.plain(m.base_color);
  a.plain(m.emissive);
  a.choice(m.alpha_mode, AlphaMode::blend);
  a.flag(m.unlit);
  a.flag(m.double_sided);
  a.plain(m.uv_transform);
  a.plain(material.texture);
}

template <class Archive>
void walk_shape(Archive& a, ForeignShape& shape) {
  a.array(shape.name);
  a.plain(shape.part_from_shape);
  a.plain(shape.mesh);
  a.plain(shape.material);
}

template <class Archive>
void walk_light(Archive& a, ForeignLight& light) {
  a.array(light.name);
  a.plain(light.part_from_light);
  a.choice(light.light.kind, LightKind::spot);
  a.plain(light.light.color);
  a.plain(light.light.intensity);
  a.plain(light.light.range_m);
  a.plain(light.light.inner_cone_rad);
  a.plain(light.light.outer_cone_rad);
  a.plain(light.light.direction);
}

template <class Archive>
void walk_scene(Archive& a, ForeignScene& scene) {
  const auto text = [](Archive& archive, std::string& t) { archive.array(t); };
  a.list(scene.meshes, walk_mesh<Archive>);
  a.list(scene.textures, walk_texture<Archive>);
  a.list(scene.materials, walk_material<Archive>);
  a.list(scene.shapes, walk_shape<Archive>);
  a.list(scene.lights, walk_light<Archive>);
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

// What is wrong with the mesh, or nothing.
std::string fault_of(const Mesh& mesh) {
  constexpr std::size_t kCorners[] = {3, 2, 1};
  if (mesh.attributes.size() != mesh.positions.size()) return "vertices without attributes";
  if (mesh.indices.size() % kCorners[static_cast<std::size_t>(mesh.topology)] != 0) return "half a primitive";
  for (const std::uint32_t index : mesh.indices) {
    if (index >= mesh.positions.size()) return "an index beyond the last vertex";
  }
  for (const glm::vec3& position : mesh.positions) {
    if (!is_finite(position)) return "a vertex position that is not finite";
  }
  for (const VertexAttributes& attributes : mesh.attributes) {
    if (!is_finite(attributes)) return "a normal, texture coordinate or colour that is not finite";
  }
  return {};
}

std::string fault_of(const ForeignScene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    if (std::string fault = fault_of(mesh); !fault.empty()) return fault;
  }
  for (const Texture& texture : scene.textures) {
    const std::uint64_t pixels = std::uint64_t{texture.width} * texture.height;
    if (pixels == 0 || texture.rgba.size() % 4 != 0 || texture.rgba.size() / 4 != pixels) return "a torn texture";
  }
  for (const ForeignMaterial& m : scene.materials) {
    if (m.texture != kNoForeignTexture && m.texture >= scene.textures.size()) return "a material without its texture";
    if (!is_finite(m.material.base_color) || !is_finite(m.material.emissive)) return "a colour that is not finite";
    if (!is_finite(m.material.uv_transform)) return "a texture transform that is not finite";
  }
  for (const ForeignShape& shape : scene.shapes) {
    if (shape.mesh >= scene.meshes.size() || shape.material >= scene.materials.size()) return "a shape without content";
    if (!is_affine(shape.part_from_shape)) return "a transform that is not finite or not affine";
  }
  for (const ForeignLight& light : scene.lights) {
    if (!is_affine(light.part_from_light) || !is_finite(light.light))
      return "a light with a number or a place that is not finite";
  }
  return {};
}

}  // namespace

std::vector<std::uint8_t> pack_foreign_scene(ForeignScene scene) {
  Packer packer;
  walk_scene(packer, scene);
  return std::move(packer.bytes);
}

ForeignScene unpack_foreign_scene(std::span<const std::uint8_t> bytes, const std::string& subject) {
  Unpacker unpacker(bytes, subject);
  ForeignScene scene;
  walk_scene(unpacker, scene);
  unpacker.expect_end();
  const std::string fault = fault_of(scene);
  if (!fault.empty()) throw InputError(subject + "there is " + fault);
  return scene;
}

}  // namespace simvis
