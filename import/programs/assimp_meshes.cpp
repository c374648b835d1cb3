#include "import/programs/assimp_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "engine/base/srgb.h"
#include "import/programs/polygon.h"
#include "import/programs/vertex_numbers.h"

namespace simvis {
namespace {

struct Vertex {
  glm::vec3 position{0};
  VertexAttributes attributes;
};

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::vec3 vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

// Returns v scaled to unit length, or zero if that is not possible.
glm::vec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0);
}

glm::vec4 read_color(AssimpFile& file, const aiColor4D& color) {
  glm::vec4 linear{1};
  for (unsigned i = 0; i < 4; ++i) {
    const float value = color[i];
    if (!std::isfinite(value) || value < 0) {
      file.warn("vertex colours that are negative or not finite are read as white");
      return glm::vec4(1);
    }
    linear[static_cast<int>(i)] = i < 3 ? linear_from_srgb(value) : value;
  }
  return linear;
}

// A zero normal means that the normal is missing.
Vertex read_vertex(AssimpFile& file, const aiMesh& source, unsigned index) {
  Vertex vertex;
  vertex.position = vec3(source.mVertices[index]);
  if (!is_finite(vertex.position)) file.fail("vertex " + std::to_string(index) + " is not finite");
  vertex.attributes.normal =
      source.HasNormals() ? unit_or_zero(glm::dvec3(vec3(source.mNormals[index]))) : glm::vec3(0);
  for (unsigned set = 0; set < 2; ++set) {
    if (!source.HasTextureCoords(set)) continue;
    const glm::vec3 uv = vec3(source.mTextureCoords[set][index]);
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) {
      vertex.attributes.uv[set] = {uv.x, 1 - uv.y};
    } else {
      file.warn("texture coordinates that are not finite are read as 0 0");
    }
  }
  if (file.has_colors && source.HasVertexColors(0))
    vertex.attributes.color = read_color(file, source.mColors[0][index]);
  return vertex;
}

glm::vec3 face_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return unit_or_zero(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
}

// Collects corners. Corners with equal bits become one vertex.
class MeshBuilder {
 public:
  MeshBuilder() = default;
  MeshBuilder(std::string name, Topology topology) {
    mesh_.name = std::move(name);
    mesh_.topology = topology;
  }

  void add(Vertex vertex) {
    // Minus zero becomes zero, so that equal vertices have equal bits.
    vertex.position += 0.0f;
    vertex.attributes.normal += 0.0f;
    mesh_.indices.push_back(numbers_.add(mesh_, vertex.position, vertex.attributes));
  }

  Mesh take() {
    numbers_ = {};
    mesh_.positions.shrink_to_fit();
    mesh_.attributes.shrink_to_fit();
    mesh_.indices.shrink_to_fit();
    return std::move(mesh_);
  }

 private:
  Mesh mesh_;
  VertexNumbers numbers_;
};

using Corners = std::vector<Vertex>;

void read_corners(AssimpFile& file, const aiMesh& source, const aiFace& face, Corners& corners) {
  if (face.mNumIndices > kMaxPolygonCorners) {
    file.fail("a polygon has " + std::to_string(face.mNumIndices) + " corners, expected at most " +
              std::to_string(kMaxPolygonCorners));
  }
  corners.clear();
  for (unsigned i = 0; i < face.mNumIndices; ++i) corners.push_back(read_vertex(file, source, face.mIndices[i]));
}

// A corner without a normal gets the normal of its triangle.
void add_triangle(const std::array<Vertex, 3>& corners, MeshBuilder& builder) {
  const glm::vec3 flat = face_normal(corners[0].position, corners[1].position, corners[2].position);
  for (Vertex corner : corners) {
    glm::vec3& normal = corner.attributes.normal;
    if (normal == glm::vec3(0)) normal = flat == glm::vec3(0) ? VertexAttributes{}.normal : flat;
    builder.add(corner);
  }
}

void add_polygon(const Corners& corners, MeshBuilder& builder) {
  if (corners.size() == 3) return add_triangle({corners[0], corners[1], corners[2]}, builder);
  std::vector<glm::vec3> positions;
  for (const Vertex& corner : corners) positions.push_back(corner.position);
  for (const auto& [a, b, c] : triangles_of_polygon(positions)) {
    add_triangle({corners[a], corners[b], corners[c]}, builder);
  }
}

// Corners without a normal are shown unlit, so they may have any normal.
void add_line(const Corners& corners, MeshBuilder& builder) {
  for (Vertex corner : corners) {
    if (corner.attributes.normal == glm::vec3(0)) corner.attributes.normal = VertexAttributes{}.normal;
    builder.add(corner);
  }
}

bool has_normal(const Vertex& corner) { return corner.attributes.normal != glm::vec3(0); }

// True if the polygon has an area but a corner lacks a normal.
bool lacks_needed_normals(const Corners& corners) {
  bool has_size = false;
  for (std::size_t i = 2; i < corners.size() && !has_size; ++i) {
    has_size = face_normal(corners[0].position, corners[i - 1].position, corners[i].position) != glm::vec3(0);
  }
  return has_size && !std::ranges::all_of(corners, has_normal);
}

}  // namespace

std::vector<Mesh> convert_mesh(AssimpFile& file, const aiMesh& source, const std::vector<bool>* faces) {
  std::array<MeshBuilder, 3> builders;
  for (const Topology topology : {Topology::triangles, Topology::lines, Topology::points}) {
    builders[static_cast<std::size_t>(topology)] = MeshBuilder(source.mName.C_Str(), topology);
  }
  MeshBuilder &triangles = builders[0], &lines = builders[1], &points = builders[2];
  bool is_bare = false, has_any_normal = false;
  const auto add_face = [&](const Corners& corners) {
    is_bare = is_bare || lacks_needed_normals(corners);
    has_any_normal = has_any_normal || std::ranges::any_of(corners, has_normal);
    if (corners.size() >= 3) return add_polygon(corners, triangles);
    if (corners.size() == 2) return add_line(corners, lines);
    for (const Vertex& corner : corners) points.add(corner);
  };
  Corners corners;
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    if (faces != nullptr && !(*faces)[f]) continue;
    read_corners(file, source, source.mFaces[f], corners);
    add_face(corners);
  }
  // For a file with points only, Assimp returns vertices without faces.
  for (unsigned i = 0; source.mNumFaces == 0 && i < source.mNumVertices; ++i) {
    add_face({read_vertex(file, source, i)});
  }
  // Zero normals throughout mean that the file has none: STL must write something.
  if (is_bare && has_any_normal) file.warn("normals that are zero or not finite are replaced by their face's");
  std::vector<Mesh> meshes;
  for (MeshBuilder& builder : builders) {
    Mesh mesh = builder.take();
    if (mesh.indices.size() > std::numeric_limits<std::uint32_t>::max()) file.fail("a mesh has over 2^32 - 1 corners");
    if (!mesh.indices.empty()) meshes.push_back(std::move(mesh));
  }
  return meshes;
}

}  // namespace simvis
