#include "engine/cluster_facing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {
namespace {

// Of a float32 that was rounded once, and of sums in double: far more than either.
constexpr double kRoom = 1e-6;

// Its normal has the length of twice its area.
struct Triangle {
  glm::dvec3 a, normal;
  double longest = 0;  // side
};

Triangle triangle_at(const Mesh& mesh, std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> corners) {
  const glm::dvec3 a(mesh.positions[vertices[corners[0]]]), b(mesh.positions[vertices[corners[1]]]),
      c(mesh.positions[vertices[corners[2]]]);
  return {a, glm::cross(b - a, c - a), std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)})};
}

// What has two corners in one place has none of its own to show, however it is rounded.
bool is_line(const Mesh& mesh, std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> corners) {
  const glm::vec3 &a = mesh.positions[vertices[corners[0]]], &b = mesh.positions[vertices[corners[1]]],
                  &c = mesh.positions[vertices[corners[2]]];
  return a == b || b == c || c == a;
}

ClusterFacing facing_of(const Mesh& mesh, const Clustering& clustering, const Cluster& cluster) {
  const std::span<const std::uint32_t> vertices = clustering.vertices_of(cluster);
  const std::span<const std::uint8_t> corners = clustering.corners_of(cluster);
  const auto each = [&](const auto& look) {
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const std::span<const std::uint8_t> three = corners.subspan(i, 3);
      if (!is_line(mesh, vertices, three)) look(triangle_at(mesh, vertices, three));
    }
  };
  glm::dvec3 sum(0);
  each([&](const Triangle& t) {
    if (const double length = glm::length(t.normal); length > 0) sum += t.normal / length;
  });
  ClusterFacing facing;
  if (!(glm::length(sum) > 0)) return facing;
  facing.axis = glm::vec3(glm::normalize(sum));
  const glm::dvec3 axis(facing.axis), center(cluster.center);
  double cosine = 1, bulge = -std::numeric_limits<double>::infinity(), height = std::numeric_limits<double>::infinity();
  each([&](const Triangle& t) {
    const double length = glm::length(t.normal);
    height = std::min(height, length / t.longest);
    if (!(length > 0)) return;
    cosine = std::min(cosine, glm::dot(t.normal, axis) / length);
    bulge = std::max(bulge, glm::dot(t.normal, center - t.a) / length);
  });
  const double size = glm::length(glm::dvec3(cluster.half_size));
  facing.least_cosine = static_cast<float>(cosine - kRoom);
  facing.bulge = static_cast<float>(bulge + kRoom * (size + std::abs(bulge)));
  facing.least_height = static_cast<float>(height * (1 - kRoom));
  return facing;
}

}  // namespace

std::vector<ClusterFacing> facing_of(const Mesh& mesh, const Clustering& clustering) {
  std::vector<ClusterFacing> facing;
  facing.reserve(clustering.clusters.size());
  for (const Cluster& cluster : clustering.clusters) facing.push_back(facing_of(mesh, clustering, cluster));
  return facing;
}

// How thin is too thin. Rounding moves a corner by up to s pixels along each axis. A triangle with the sides p and q
// has the area 2 A = p x q in the picture; moved, it differs by at most 2 s (|p|1 + |q|1) + 8 s^2 <= 4 s E + 8 s^2,
// where E is no less than any side's |.|1. As 2 A <= E^2, nothing turns over where 2 A > 6 s E.
//
// In space, with fx and fy the focal lengths and z the depths: 2 A >= fx fy (2 A0) D / zmax^3, where A0 is the area and
// D how far the eye lies behind the plane; and max(fx, fy) L W / zmin will do as E, where L is the longest side and
// W^2 = 2 + (tx + ty)^2, tx and ty the tangents of the view's widest angles. 2 A0 / L is the triangle's height h, so
//   min(fx, fy) h D zmin / (zmax^3 W) > 6 s
// is enough. In whatever unit of length: here the mesh's.
//
// s is the grid's, and what float32 moves a vertex by in space, seen from zmin: at most max(fx, fy) W / zmin times
// that. The grid moves by half a step; the other half is for the rounding of the viewport, some 2^-23 of its width.
MeshEye::MeshEye(const View& view, const MeshPlanes& planes, const glm::dmat4& view_from_mesh, double snap_px)
    : planes_(planes) {
  const Pinhole& k = view.pinhole;
  const glm::dmat3 axes(view_from_mesh);
  const double square = glm::dot(axes[0], axes[0]);
  if (view.parallel || !(k.fx_px > 0 && k.fy_px > 0 && square > 0)) return;
  const glm::dmat3 squares = glm::transpose(axes) * axes;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      if (!(std::abs(squares[c][r] - (c == r ? square : 0)) <= kRoom * square)) return;
    }
  }
  eye_ = glm::transpose(axes) * -glm::dvec3(view_from_mesh[3]) / square;
  const glm::dmat4 rows = glm::transpose(view_from_mesh);
  unit_m_ = std::sqrt(square);
  depth_ = rows[2] / unit_m_;
  const double tangents =
      std::max(k.cx_px, view.width_px - k.cx_px) / k.fx_px + std::max(k.cy_px, view.height_px - k.cy_px) / k.fy_px;
  const double skew = std::sqrt(2 + tangents * tangents), least = std::min(k.fx_px, k.fy_px);
  snapped_ = 6 * snap_px * skew / least;
  rounded_ = 6 * std::max(k.fx_px, k.fy_px) * skew * skew / least * planes.slack / unit_m_;
}

bool MeshEye::sees_only_backs(const Cluster& cluster, const ClusterFacing& facing) const {
  const double cosine = facing.least_cosine;
  if (cosine <= 0 || facing.least_height <= 0) return false;
  const glm::dvec3 center(cluster.center), half(cluster.half_size), way = center - eye_, axis(facing.axis);
  const double along = glm::dot(way, axis);
  if (along <= 0) return false;
  const double across = std::sqrt(std::max(0.0, glm::dot(way, way) - along * along));
  const double behind = along * cosine - across * std::sqrt(1 - cosine * cosine) - facing.bulge;
  const double depth = glm::dot(glm::dvec3(depth_), center) + depth_.w,
               extent = glm::dot(glm::abs(glm::dvec3(depth_)), half);
  const double nearest = depth - extent, farthest = depth + extent;
  if (!(behind > 0 && nearest > 0)) return false;
  const double seen = facing.least_height * behind * nearest / (farthest * farthest * farthest);
  return seen > snapped_ + rounded_ / nearest && inside(planes_, center, half);
}

}  // namespace simvis
