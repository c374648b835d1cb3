#include "program/live/glb_file.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include <simvis/error.h>
#include <simvis/version.h>
#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "program/live/glb_buffer.h"
#include "program/live/glb_materials.h"
#include "program/live/glb_matrix.h"

namespace simvis::live {
namespace {

using Json = GlbBuffer::Json;
using Use = GlbBuffer::Use;

constexpr int kFloat32 = 5126, kUint32 = 5125;            // numbers of OpenGL, which glTF uses
constexpr double kWidestCone_rad = std::numbers::pi / 2;  // of KHR_lights_punctual

/// The importer turns it back.
const glm::dmat4 kGltfFromWorld(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);

Json matrix_json(const glm::dmat4& m) {
  Json json = Json::array();
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) json.push_back(m[column][row]);
  }
  return json;
}

class GlbWriter {
 public:
  GlbWriter(const DrawList& list, std::span<const SceneItem> items)
      : list_(list), items_(items), materials_(buffer_), uv_sets_(list.meshes.size()) {
    for (const DrawItem& item : list.items) {
      if (!item.visible) continue;
      const Material& material = *list.materials[item.material];
      // glTF counts sets without a gap.
      if (reads_uv(material, 0)) uv_sets_[item.mesh] |= 1;
      if (reads_uv(material, 1)) uv_sets_[item.mesh] |= 3;
    }
  }

  std::string take() {
    nodes_.push_back({{"name", "world, z up"}, {"matrix", matrix_json(kGltfFromWorld)}});
    for (std::size_t i = 0; i < list_.items.size(); ++i) add_item(i);
    for (std::size_t i = 0; i < list_.lights.size(); ++i) add_light(i);
    if (!top_.empty()) nodes_[0]["children"] = std::move(top_);
    Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "SimVis " + std::string(version())}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", std::move(nodes_)}};
    if (!meshes_.empty()) gltf["meshes"] = std::move(meshes_);
    materials_.take(gltf, extensions_);
    if (!lights_.empty()) {
      extensions_.insert("KHR_lights_punctual");
      gltf["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lights_);
    }
    if (!extensions_.empty()) gltf["extensionsUsed"] = extensions_;
    std::string bytes = buffer_.take(gltf);
    return join(gltf.dump(-1, ' ', false, Json::error_handler_t::replace), bytes);
  }

 private:
  struct MeshAccessors {
    std::size_t position = 0, normal = 0, indices = 0;
    std::optional<std::size_t> uv[2], color;
  };

  void add_item(std::size_t index) {
    const DrawItem& item = list_.items[index];
    if (!item.visible || list_.meshes[item.mesh]->indices.empty()) return;
    Json extras = {{"item", index}, {"transform", item.transform}, {"material", item.material}, {"mesh", item.mesh}};
    Json node;
    if (!items_.empty() && !items_[index].part.empty()) {
      node["name"] = items_[index].part;
      extras["part"] = items_[index].part;
    }
    const std::vector<glm::dmat4> matrices = gltf_nodes_of(list_.world_from_node[item.transform]);
    if (matrices.empty()) return;
    node["mesh"] = mesh_of(item);
    node["extras"] = std::move(extras);
    add_node(std::move(node), matrices);
  }

  // The innermost node of the chain has the content.
  void add_node(Json node, const std::vector<glm::dmat4>& matrices) {
    top_.push_back(nodes_.size());
    for (std::size_t i = 0; i + 1 < matrices.size(); ++i) {
      nodes_.push_back({{"matrix", matrix_json(matrices[i])}, {"children", {nodes_.size() + 1}}});
    }
    if (matrices.back() != glm::dmat4(1)) node["matrix"] = matrix_json(matrices.back());
    nodes_.push_back(std::move(node));
  }

  std::size_t mesh_of(const DrawItem& item) {
    const auto [found, is_new] = numbers_.try_emplace({item.mesh, item.material}, meshes_.size());
    if (!is_new) return found->second;
    const Mesh& mesh = *list_.meshes[item.mesh];
    const Material& material = *list_.materials[item.material];
    const auto [number, new_material] = material_numbers_.try_emplace(item.material, 0);
    if (new_material) number->second = materials_.add(material, item.material);
    const MeshAccessors& accessors = accessors_of(item.mesh);
    Json attributes = {{"POSITION", accessors.position}, {"NORMAL", accessors.normal}};
    constexpr const char* kUvNames[] = {"TEXCOORD_0", "TEXCOORD_1"};
    for (int set = 0; set < 2; ++set) {
      if (accessors.uv[set]) attributes[kUvNames[set]] = *accessors.uv[set];
    }
    if (accessors.color) attributes["COLOR_0"] = *accessors.color;
    constexpr int kModes[] = {4, 1, 0};  // in the order of Topology
    meshes_.push_back({{"name", mesh.name},
                       {"primitives",
                        {{{"attributes", std::move(attributes)},
                          {"indices", accessors.indices},
                          {"material", number->second},
                          {"mode", kModes[static_cast<std::size_t>(mesh.topology)]}}}}});
    return found->second;
  }

  const MeshAccessors& accessors_of(std::uint32_t index) {
    const auto [found, is_new] = mesh_accessors_.try_emplace(index);
    if (!is_new) return found->second;
    const Mesh& mesh = *list_.meshes[index];
    MeshAccessors& accessors = found->second;
    accessors.position = add_positions(mesh);
    accessors.normal = add_attribute<glm::vec3>(mesh, "VEC3", glb_normal);
    for (int set = 0; set < 2; ++set) {
      const auto uv = [&](const VertexAttributes& vertex) { return vertex.uv[set]; };
      const bool reads = (uv_sets_[index] & (1u << set)) != 0;
      if (!reads && std::ranges::all_of(
                        mesh.attributes, [](const glm::vec2& v) { return v == glm::vec2(0); }, uv))
        continue;
      accessors.uv[set] = add_attribute<glm::vec2>(mesh, "VEC2", uv);
    }
    if (std::ranges::any_of(mesh.attributes, [](const VertexAttributes& v) { return v.color != glm::vec4(1); })) {
      accessors.color = add_attribute<glm::vec4>(
          mesh, "VEC4", [](const VertexAttributes& vertex) { return glm::clamp(vertex.color, 0.0f, 1.0f); });
    }
    accessors.indices = buffer_.add<std::uint32_t>(mesh.indices, Use::indices, kUint32, "SCALAR");
    return accessors;
  }

  std::size_t add_positions(const Mesh& mesh) {
    const std::size_t number = buffer_.add<glm::vec3>(mesh.positions, Use::vertices, kFloat32, "VEC3");
    glm::vec3 low = mesh.positions[0], high = low;
    for (const glm::vec3& position : mesh.positions) {
      low = glm::min(low, position);
      high = glm::max(high, position);
    }
    buffer_.accessor(number)["min"] = {low.x, low.y, low.z};
    buffer_.accessor(number)["max"] = {high.x, high.y, high.z};
    return number;
  }

  template <typename T, typename Read>
  std::size_t add_attribute(const Mesh& mesh, const char* type, const Read& read) {
    std::vector<T> values;
    values.reserve(mesh.attributes.size());
    for (const VertexAttributes& vertex : mesh.attributes) values.push_back(read(vertex));
    return buffer_.add<T>(values, Use::vertices, kFloat32, type);
  }

  void add_light(std::size_t index) {
    const Light& light = list_.lights[index].light;
    constexpr const char* kKinds[] = {"directional", "point", "spot"};
    const float largest = std::max({light.color.r, light.color.g, light.color.b, 1.0f});
    Json json = {{"type", kKinds[static_cast<std::size_t>(light.kind)]},
                 {"color", {light.color.r / largest, light.color.g / largest, light.color.b / largest}},
                 {"intensity", light.intensity * largest}};
    if (light.range_m > 0 && light.kind != LightKind::directional) json["range"] = light.range_m;
    if (light.kind == LightKind::spot) {
      json["spot"] = {{"innerConeAngle", light.inner_cone_rad},
                      {"outerConeAngle", std::min(light.outer_cone_rad, kWidestCone_rad)}};
    }
    glm::dmat4 world_from_light = list_.world_from_node[list_.lights[index].transform];
    for (int column = 0; column < 3; ++column) {
      const double length = glm::length(world_from_light[column]);
      if (length > 0) world_from_light[column] /= length;
    }
    if (light.kind != LightKind::point) world_from_light = world_from_light * turn_of_light(light.direction);
    const std::vector<glm::dmat4> matrices = gltf_nodes_of(world_from_light);
    if (matrices.empty()) return;
    Json node = {{"name", std::string("light ") + std::to_string(index)}};
    node["extensions"]["KHR_lights_punctual"]["light"] = lights_.size();
    node["extras"] = {{"light", index}, {"transform", list_.lights[index].transform}};
    lights_.push_back(std::move(json));
    add_node(std::move(node), matrices);
  }

  static std::string join(std::string json, const std::string& bytes) {
    constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
    constexpr std::size_t kHeader = 12, kChunk = 8;
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::size_t all = kHeader + kChunk + json.size() + (bytes.empty() ? 0 : kChunk + bytes.size());
    if (all > std::numeric_limits<std::uint32_t>::max()) {
      throw MachineError("the scene needs " + std::to_string(all) + " bytes as a GLB, expected less than 4 GiB");
    }
    std::string file;
    file.reserve(all);
    for (const std::size_t word : {std::size_t{kMagic}, std::size_t{kVersion}, all, json.size(), std::size_t{kJson}}) {
      append_binary(file, static_cast<std::uint32_t>(word));
    }
    file += json;
    if (bytes.empty()) return file;
    append_binary(file, static_cast<std::uint32_t>(bytes.size()));
    append_binary(file, kBinary);
    file += bytes;
    return file;
  }

  const DrawList& list_;
  std::span<const SceneItem> items_;
  GlbBuffer buffer_;
  GlbMaterials materials_;
  Json nodes_ = Json::array(), top_ = Json::array(), meshes_ = Json::array(), lights_ = Json::array();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> numbers_;  // of glTF meshes, by mesh and material
  std::map<std::uint32_t, std::size_t> material_numbers_;
  std::map<std::uint32_t, MeshAccessors> mesh_accessors_;
  std::vector<unsigned> uv_sets_;  // by mesh: bit k, a texture reads set k
  std::set<std::string> extensions_;
};

}  // namespace

glm::vec3 glb_normal(const VertexAttributes& vertex) {
  const glm::dvec3 normal(vertex.normal);
  const double length = glm::length(normal);
  return length > 0 ? glm::vec3(normal / length) : glm::vec3(0, 0, 1);
}

std::string glb_bytes(const DrawList& list, std::span<const SceneItem> items) {
  SIMVIS_ASSERT(items.empty() || items.size() == list.items.size());
  return GlbWriter(list, items).take();
}

}  // namespace simvis::live
