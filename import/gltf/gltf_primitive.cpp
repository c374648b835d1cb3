#include "import/gltf/gltf_primitive.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "import/gltf/gltf_accessors.h"
#include "import/gltf/gltf_splats.h"

namespace simvis {
namespace {

constexpr int kVec2[] = {TINYGLTF_TYPE_VEC2};
constexpr int kColorTypes[] = {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4};

constexpr GltfUse kIndices{"indices", kGltfScalar, kGltfU8 | kGltfU16 | kGltfU32};
constexpr GltfUse kPosition{"POSITION", kGltfVec3, kGltfF32,
                            kGltfI8 | kGltfU8 | kGltfI16 | kGltfU16 | kGltfI8n | kGltfU8n | kGltfI16n | kGltfU16n};
constexpr GltfUse kNormal{"NORMAL", kGltfVec3, kGltfF32, kGltfI8n | kGltfI16n};
constexpr unsigned kUvFormats = kGltfF32 | kGltfU8n | kGltfU16n;
constexpr unsigned kQuantizedUvFormats = kGltfI8 | kGltfU8 | kGltfI16 | kGltfU16 | kGltfI8n | kGltfI16n;
constexpr GltfUse kUv[] = {{"TEXCOORD_0", kVec2, kUvFormats, kQuantizedUvFormats},
                           {"TEXCOORD_1", kVec2, kUvFormats, kQuantizedUvFormats}};
constexpr GltfUse kColor{"COLOR_0", kColorTypes, kGltfF32 | kGltfU8n | kGltfU16n};

// Reads an attribute if the primitive has it.
bool read_attribute(const GltfDocument& document, const tinygltf::Primitive& source, const GltfUse& use,
                    std::size_t vertices, GltfFloats& floats) {
  const auto found = source.attributes.find(use.name);
  if (found == source.attributes.end()) return false;
  floats = read_vertex_floats(document, found->second, use, vertices);
  return true;
}

void read_attributes(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive& primitive) {
  std::vector<VertexAttributes>& attributes = primitive.mesh.attributes;
  GltfFloats floats;
  primitive.has_normals = read_attribute(document, source, kNormal, attributes.size(), floats);
  const bool is_points = source.mode == TINYGLTF_MODE_POINTS;
  for (std::size_t i = 0; is_points && i < attributes.size(); ++i) attributes[i].normal = glm::vec3(0);
  for (std::size_t i = 0; primitive.has_normals && i < attributes.size(); ++i) {
    const glm::dvec3 normal(floats[i][0], floats[i][1], floats[i][2]);
    const double length = glm::length(normal);
    if (length > 0) {
      attributes[i].normal = glm::vec3(normal / length);
    } else if (!is_points) {
      document.warn("normals of length zero are taken as (0, 0, 1)");
    }
  }
  for (int set = 0; set < 2; ++set) {
    if (!read_attribute(document, source, kUv[set], attributes.size(), floats)) continue;
    for (std::size_t i = 0; i < attributes.size(); ++i) attributes[i].uv[set] = {floats[i][0], floats[i][1]};
  }
  if (read_attribute(document, source, kColor, attributes.size(), floats)) {
    for (std::size_t i = 0; i < attributes.size(); ++i) {
      const float* rgba = floats[i];
      attributes[i].color = {rgba[0], rgba[1], rgba[2], floats.components == 4 ? rgba[3] : 1.0f};
    }
  }
}

std::vector<std::uint32_t> read_indices(const GltfDocument& document, const tinygltf::Primitive& source,
                                        std::size_t vertices) {
  const auto found = source.attributes.find(kGltfIndices);
  if (found == source.attributes.end()) {
    std::vector<std::uint32_t> indices(vertices);
    std::iota(indices.begin(), indices.end(), 0u);
    return indices;
  }
  std::vector<std::uint32_t> indices = read_integers(document, found->second, kIndices);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < vertices) continue;
    document.fail("accessors/" + std::to_string(found->second) + " (indices) has the index " +
                  std::to_string(indices[i]) + " in element " + std::to_string(i) + ", but there are " +
                  std::to_string(vertices) + " vertices");
  }
  return indices;
}

using Indices = std::vector<std::uint32_t>;

Indices triangle_list_of_strip(const Indices& strip) {
  Indices list;
  list.reserve(strip.size() * 3);
  // Every second triangle is reversed, so that all have the same winding order. The order is the one of the glTF
  // specification.
  for (std::size_t i = 0; i + 2 < strip.size(); ++i) {
    list.insert(list.end(), {strip[i], strip[i + 1 + i % 2], strip[i + 2 - i % 2]});
  }
  return list;
}

Indices triangle_list_of_fan(const Indices& fan) {
  Indices list;
  list.reserve(fan.size() * 3);
  for (std::size_t i = 1; i + 1 < fan.size(); ++i) list.insert(list.end(), {fan[i], fan[i + 1], fan[0]});
  return list;
}

Indices line_list_of_strip(const Indices& strip, bool closed) {
  Indices list;
  list.reserve(strip.size() * 2);
  for (std::size_t i = 0; i + 1 < strip.size(); ++i) list.insert(list.end(), {strip[i], strip[i + 1]});
  if (closed && strip.size() > 1) list.insert(list.end(), {strip.back(), strip.front()});
  return list;
}

void set_topology(GltfDocument& document, int mode, Indices&& indices, Mesh& mesh) {
  const auto drop_incomplete = [&](std::size_t per_primitive) {
    const std::size_t rest = indices.size() % per_primitive;
    if (rest != 0) document.warn("incomplete triangles or lines at the end of a primitive are left out");
    indices.resize(indices.size() - rest);
    return std::move(indices);
  };
  switch (mode) {
    case TINYGLTF_MODE_POINTS:
      mesh.topology = Topology::points;
      mesh.indices = std::move(indices);
      return;
    case TINYGLTF_MODE_LINE:
      mesh.topology = Topology::lines;
      mesh.indices = drop_incomplete(2);
      return;
    case TINYGLTF_MODE_LINE_LOOP:
    case TINYGLTF_MODE_LINE_STRIP:
      mesh.topology = Topology::lines;
      mesh.indices = line_list_of_strip(indices, mode == TINYGLTF_MODE_LINE_LOOP);
      return;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      mesh.indices = triangle_list_of_strip(indices);
      return;
    case TINYGLTF_MODE_TRIANGLE_FAN:
      mesh.indices = triangle_list_of_fan(indices);
      return;
    default:
      mesh.indices = drop_incomplete(3);
  }
}

}  // namespace

bool read_primitive(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive& primitive) {
  const auto position = source.attributes.find(kPosition.name);
  if (position == source.attributes.end()) {
    document.warn("primitives without POSITION are left out");
    return false;
  }
  const GltfFloats floats = read_floats(document, position->second, kPosition);
  Mesh& mesh = primitive.mesh;
  mesh.positions.resize(floats.count);
  mesh.attributes.resize(floats.count);
  for (std::size_t i = 0; i < floats.count; ++i) mesh.positions[i] = {floats[i][0], floats[i][1], floats[i][2]};
  if (has_known_splats(document, source)) {
    Mesh of_splats;
    of_splats.splats = read_splats(document, source, mesh.positions);
    mesh = std::move(of_splats);
    return true;
  }
  read_attributes(document, source, primitive);
  set_topology(document, source.mode, read_indices(document, source, floats.count), mesh);
  return true;
}

}  // namespace simvis
