#include "engine/culling/normal_cone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/thread_pool.h"

namespace simvis {
namespace {

// Relative margin for one rounding to float32 and for sums in double. It is much larger than both errors.
constexpr double kRoom = 1e-6;

struct Triangle {
  glm::dvec3 a, normal;
  double length = 0;   // of `normal`: twice the triangle's area
  double longest = 0;  // the longest side
};

Triangle triangle_at(const Mesh& mesh, const ClusterVertices& vertices, std::span<const std::uint8_t> corners) {
  const glm::dvec3 a(mesh.positions[vertices[corners[0]]]), b(mesh.positions[vertices[corners[1]]]),
      c(mesh.positions[vertices[corners[2]]]);
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  return {a, normal, glm::length(normal), std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)})};
}

// A triangle with two corners at one position is never drawn, however it is rounded.
bool is_line(const Mesh& mesh, const ClusterVertices& vertices, std::span<const std::uint8_t> corners) {
  const glm::vec3 &a = mesh.positions[vertices[corners[0]]], &b = mesh.positions[vertices[corners[1]]],
                  &c = mesh.positions[vertices[corners[2]]];
  return a == b || b == c || c == a;
}

NormalCone normal_cones_of(const Mesh& mesh, const Clustering& clustering, const Cluster& cluster) {
  const ClusterVertices vertices = clustering.vertices_of(cluster);
  const std::span<const std::uint8_t> corners = clustering.corners_of(cluster);
  std::array<Triangle, kClusterTriangles> triangles;
  std::size_t count = 0;
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const std::span<const std::uint8_t> three = corners.subspan(i, 3);
    if (is_line(mesh, vertices, three)) continue;
    const Triangle& t = triangles[count++] = triangle_at(mesh, vertices, three);
    if (t.length > 0) sum += t.normal / t.length;
  }
  NormalCone facing;
  if (!(glm::length(sum) > 0)) return facing;
  facing.axis = glm::vec3(glm::normalize(sum));
  const glm::dvec3 axis(facing.axis), center(cluster.center);
  double cosine = 1, apex_offset = -std::numeric_limits<double>::infinity(),
         height = std::numeric_limits<double>::infinity();
  for (const Triangle& t : std::span(triangles).first(count)) {
    height = std::min(height, t.length / t.longest);
    if (!(t.length > 0)) continue;
    cosine = std::min(cosine, glm::dot(t.normal, axis) / t.length);
    apex_offset = std::max(apex_offset, glm::dot(t.normal, center - t.a) / t.length);
  }
  const double size = glm::length(glm::dvec3(cluster.half_size));
  facing.cutoff = static_cast<float>(cosine - kRoom);
  facing.apex_offset = static_cast<float>(apex_offset + kRoom * (size + std::abs(apex_offset)));
  facing.min_height = static_cast<float>(height * (1 - kRoom));
  return facing;
}

}  // namespace

std::vector<NormalCone> normal_cones_of(const Mesh& mesh, const Clustering& clustering, ThreadPool* pool) {
  std::vector<NormalCone> facing(clustering.clusters.size());
  const auto make = [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      facing[i] = normal_cones_of(mesh, clustering, clustering.clusters[i]);
    }
  };
  constexpr std::size_t kWorthAThread = 1u << 10;
  if (pool == nullptr) {
    make(0, 0, facing.size());
  } else {
    pool->parallel_for(facing.size(), kWorthAThread, make);
  }
  return facing;
}

NormalConeCuller::NormalConeCuller(const FacingTolerance& limit, const MeshPlanes& planes,
                                   const glm::dmat4& view_from_mesh)
    : limit_(limit), planes_(planes), eye_(eye_in(view_from_mesh)), depth_(glm::transpose(view_from_mesh)[2]) {}

bool NormalConeCuller::is_backfacing(const Cluster& cluster, const NormalCone& facing) const {
  const double cosine = facing.cutoff;
  if (cosine <= 0 || facing.min_height <= 0) return false;
  const glm::dvec3 center(cluster.center), half(cluster.half_size), way = center - eye_->place, axis(facing.axis);
  const double along = glm::dot(way, axis);
  if (along <= 0) return false;
  const double across = std::sqrt(std::max(0.0, glm::dot(way, way) - along * along));
  const double behind = along * cosine - across * std::sqrt(1 - cosine * cosine) - facing.apex_offset;
  const double depth = glm::dot(glm::dvec3(depth_), center) + depth_.w,
               extent = glm::dot(glm::abs(glm::dvec3(depth_)), half);
  const double nearest = depth - extent, farthest = depth + extent;
  if (!(behind > 0 && nearest > 0)) return false;
  const double seen_m2 = facing.min_height * behind * eye_->unit_m * eye_->unit_m;
  return seen_m2 > limit_.min_m2(nearest, farthest, planes_.slack) && inside(planes_, center, half);
}

}  // namespace simvis
