#include "scenegraph/assimp_meshes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>
#include <unordered_map>

#include "scenegraph/srgb.h"

namespace simvis {
namespace {

struct Vertex {
  glm::vec3 position{0};
  VertexAttributes attributes;
};

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::vec3 vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

// Unit length, or zero where there is none.
glm::vec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0);
}

glm::vec4 read_color(const AssimpFile& file, const aiColor4D& color) {
  glm::vec4 linear{1};
  for (unsigned i = 0; i < 4; ++i) {
    const float value = color[i];
    if (!std::isfinite(value) || value < 0) file.fail("a vertex colour is negative or not finite");
    linear[static_cast<int>(i)] = i < 3 ? linear_from_srgb(value) : value;
  }
  return linear;
}

// A normal of zero stands for one that is missing.
Vertex read_vertex(const AssimpFile& file, const aiMesh& source, unsigned index) {
  Vertex vertex;
  vertex.position = vec3(source.mVertices[index]);
  if (!is_finite(vertex.position)) file.fail("vertex " + std::to_string(index) + " is not finite");
  vertex.attributes.normal =
      source.HasNormals() ? unit_or_zero(glm::dvec3(vec3(source.mNormals[index]))) : glm::vec3(0);
  for (unsigned set = 0; set < 2; ++set) {
    if (!source.HasTextureCoords(set)) continue;
    const glm::vec3 uv = vec3(source.mTextureCoords[set][index]);
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) file.fail("a texture coordinate is not finite");
    vertex.attributes.uv[set] = {uv.x, 1 - uv.y};
  }
  if (source.HasVertexColors(0)) vertex.attributes.color = read_color(file, source.mColors[0][index]);
  return vertex;
}

glm::vec3 face_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return unit_or_zero(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
}

// Collects corners; those of equal bits become one vertex.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::size_t corners) { mesh_.indices.reserve(corners); }

  void add(const Vertex& vertex) {
    const std::string key = bits_of(vertex);
    const auto [entry, is_new] = known_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      mesh_.positions.push_back(vertex.position);
      mesh_.attributes.push_back(vertex.attributes);
    }
    mesh_.indices.push_back(entry->second);
  }

  Mesh take() { return std::move(mesh_); }

 private:
  static std::string bits_of(const Vertex& vertex) {
    static_assert(sizeof(Vertex) == 14 * sizeof(float), "no padding, so that equal vertices have equal bytes");
    return {reinterpret_cast<const char*>(&vertex), sizeof vertex};
  }

  Mesh mesh_;
  std::unordered_map<std::string, std::uint32_t> known_;
};

void add_face(AssimpFile& file, const aiMesh& source, const aiFace& face, MeshBuilder& builder) {
  std::array<Vertex, 3> corners;
  bool is_bare = false;
  for (unsigned i = 0; i < face.mNumIndices; ++i) {
    corners[i] = read_vertex(file, source, face.mIndices[i]);
    is_bare = is_bare || corners[i].attributes.normal == glm::vec3(0);
  }
  if (is_bare && source.HasNormals()) file.warn("normals that are zero or not finite are replaced by their face's");
  glm::vec3 normal{0};
  if (is_bare && face.mNumIndices == 3) {
    normal = face_normal(corners[0].position, corners[1].position, corners[2].position);
  }
  if (normal == glm::vec3(0)) normal = VertexAttributes{}.normal;
  for (unsigned i = 0; i < face.mNumIndices; ++i) {
    if (corners[i].attributes.normal == glm::vec3(0)) corners[i].attributes.normal = normal;
    builder.add(corners[i]);
  }
}

}  // namespace

Mesh convert_mesh(AssimpFile& file, const aiMesh& source) {
  const unsigned primitive = source.mPrimitiveTypes & (aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const unsigned corners = primitive == aiPrimitiveType_POINT ? 1 : primitive == aiPrimitiveType_LINE ? 2 : 3;
  const std::uint64_t total = std::uint64_t{source.mNumFaces} * corners;
  if (total > std::numeric_limits<std::uint32_t>::max()) file.fail("a mesh has more than 2^32 - 1 corners");
  if (source.HasBones()) file.warn("skins are not animated; skinned meshes are imported in their rest pose");
  MeshBuilder builder(total);
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices == corners) add_face(file, source, face, builder);
  }
  Mesh mesh = builder.take();
  mesh.name = source.mName.C_Str();
  mesh.topology = corners == 1 ? Topology::points : corners == 2 ? Topology::lines : Topology::triangles;
  compute_bounds(mesh);
  return mesh;
}

}  // namespace simvis
