#include "import/programs/meshes/polygon_meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "engine/base/srgb.h"
#include "import/programs/polygon.h"

namespace simvis {
namespace {

// Returns v scaled to unit length, or zero if that is not possible.
glm::vec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0);
}

glm::vec3 face_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return unit_or_zero(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
}

bool has_normal(const PolygonCorner& corner) { return corner.attributes.normal != glm::vec3(0); }

// True if the polygon has an area but a corner lacks a normal.
bool lacks_needed_normals(std::span<const PolygonCorner> corners) {
  bool has_size = false;
  for (std::size_t i = 2; i < corners.size() && !has_size; ++i) {
    has_size = face_normal(corners[0].position, corners[i - 1].position, corners[i].position) != glm::vec3(0);
  }
  return has_size && !std::ranges::all_of(corners, has_normal);
}

}  // namespace

glm::vec3 corner_position(const PartSource& source, std::size_t vertex, const glm::vec3& position) {
  if (std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z)) return position;
  source.fail("vertex " + std::to_string(vertex) + " is not finite");
}

glm::vec3 corner_normal(const glm::vec3& normal) { return unit_or_zero(glm::dvec3(normal)); }

glm::vec2 corner_uv(PartSource& source, const glm::vec2& uv) {
  if (std::isfinite(uv.x) && std::isfinite(uv.y)) return {uv.x, 1 - uv.y};
  source.warn("texture coordinates that are not finite are read as 0 0");
  return glm::vec2(0);
}

glm::vec4 corner_color(PartSource& source, const glm::vec4& srgb) {
  glm::vec4 linear{1};
  for (int i = 0; i < 4; ++i) {
    if (!std::isfinite(srgb[i]) || srgb[i] < 0) {
      source.warn("vertex colours that are negative or not finite are read as white");
      return glm::vec4(1);
    }
    linear[i] = i < 3 ? linear_from_srgb(srgb[i]) : srgb[i];
  }
  return linear;
}

void PolygonMeshes::Builder::add(PolygonCorner corner) {
  // Minus zero becomes zero, so that equal vertices have equal bits.
  corner.position += 0.0f;
  corner.attributes.normal += 0.0f;
  mesh.indices.push_back(numbers.add(mesh, corner.position, corner.attributes));
}

PolygonMeshes::PolygonMeshes(PartSource& source, const std::string& name) : source_(source) {
  for (const Topology topology : {Topology::triangles, Topology::lines, Topology::points}) {
    Mesh& mesh = builders_[static_cast<std::size_t>(topology)].mesh;
    mesh.name = name;
    mesh.topology = topology;
  }
}

void PolygonMeshes::add(std::span<const PolygonCorner> corners) {
  if (corners.size() > kMaxPolygonCorners) {
    source_.fail("a polygon has " + std::to_string(corners.size()) + " corners, expected at most " +
                 std::to_string(kMaxPolygonCorners));
  }
  lacks_normals_ = lacks_normals_ || lacks_needed_normals(corners);
  has_normals_ = has_normals_ || std::ranges::any_of(corners, has_normal);
  if (corners.size() >= 3) return add_polygon(corners);
  for (PolygonCorner corner : corners) {
    // Lines without normals are shown unlit, so they may have any normal.
    if (corners.size() == 2 && !has_normal(corner)) corner.attributes.normal = VertexAttributes{}.normal;
    builders_[static_cast<std::size_t>(corners.size() == 2 ? Topology::lines : Topology::points)].add(corner);
  }
}

void PolygonMeshes::add_polygon(std::span<const PolygonCorner> corners) {
  Builder& triangles = builders_[static_cast<std::size_t>(Topology::triangles)];
  if (corners.size() == 3) return add_triangle({corners[0], corners[1], corners[2]}, triangles);
  std::vector<glm::vec3> positions;
  for (const PolygonCorner& corner : corners) positions.push_back(corner.position);
  for (const auto& [a, b, c] : triangles_of_polygon(positions)) {
    add_triangle({corners[a], corners[b], corners[c]}, triangles);
  }
}

// A corner without a normal gets the normal of its triangle.
void PolygonMeshes::add_triangle(const std::array<PolygonCorner, 3>& corners, Builder& builder) {
  const glm::vec3 flat = face_normal(corners[0].position, corners[1].position, corners[2].position);
  for (PolygonCorner corner : corners) {
    if (!has_normal(corner)) corner.attributes.normal = flat == glm::vec3(0) ? VertexAttributes{}.normal : flat;
    builder.add(corner);
  }
}

std::vector<Mesh> PolygonMeshes::take() {
  // Zero normals throughout mean that the file has none: STL must write something.
  if (lacks_normals_ && has_normals_) {
    source_.warn("normals that are zero or not finite are replaced by their face's");
  }
  std::vector<Mesh> meshes;
  for (Builder& builder : builders_) {
    Mesh mesh = std::move(builder.mesh);
    builder.numbers = {};
    if (mesh.indices.size() > std::numeric_limits<std::uint32_t>::max())
      source_.fail("a mesh has over 2^32 - 1 corners");
    mesh.positions.shrink_to_fit();
    mesh.attributes.shrink_to_fit();
    mesh.indices.shrink_to_fit();
    if (!mesh.indices.empty()) meshes.push_back(std::move(mesh));
  }
  return meshes;
}

}  // namespace simvis
