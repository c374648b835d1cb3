#include "elements/dynamics/bullet/convex_pieces.h"

#include <HACD/hacdHACD.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "elements/dynamics/bullet/bullet_shape.h"

namespace simvis {
namespace {

// The time that HACD takes grows with the cube of this number: 0.4 s for a torus of 500 triangles, 10 s for one of
// 2,304. With 300, the pieces of a torus already fill hollows up to four times as deep as they should.
constexpr std::size_t kMaxHacdTriangles = 500;
// HACD scales meshes so that the diagonal of their box is twice its scale factor.
constexpr double kHacdScale = 1000;
// A flat piece becomes a plate behind its surface. Its thickness is this share of the concavity.
constexpr double kPlateShare = 0.5;

struct IndexedMesh {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> triangles;  // three corners each
};

// Points at the same place become one, and triangles that lose a corner by it are left out.
IndexedMesh welded(std::span<const glm::dvec3> points, std::span<const std::uint32_t> triangles) {
  IndexedMesh mesh;
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  const auto number_of = [&](const glm::dvec3& p) {
    const auto [found, is_new] = numbers.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.points.size()));
    if (is_new) mesh.points.push_back(p);
    return found->second;
  };
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const std::uint32_t a = number_of(points[triangles[i]]), b = number_of(points[triangles[i + 1]]),
                        c = number_of(points[triangles[i + 2]]);
    if (a != b && b != c && c != a) mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
  }
  return mesh;
}

// At most about kMaxHacdTriangles triangles, whose corners are corners of the mesh.
IndexedMesh simplified(const IndexedMesh& mesh) {
  if (mesh.triangles.size() <= 3 * kMaxHacdTriangles) return mesh;
  std::vector<glm::vec3> points;  // relative to the first, as float32
  for (const glm::dvec3& p : mesh.points) points.emplace_back(p - mesh.points.front());
  std::vector<std::uint32_t> kept(mesh.triangles.size());
  constexpr float kAnyError = 1;  // of the mesh's size
  kept.resize(meshopt_simplify(kept.data(), mesh.triangles.data(), mesh.triangles.size(), &points.front().x,
                               points.size(), sizeof(glm::vec3), 3 * kMaxHacdTriangles, kAnyError, 0, nullptr));
  // Holes and seams hold many triangles in place.
  if (kept.size() > 2 * 3 * kMaxHacdTriangles) {
    kept.resize(mesh.triangles.size());
    kept.resize(meshopt_simplifySloppy(kept.data(), mesh.triangles.data(), mesh.triangles.size(), &points.front().x,
                                       points.size(), sizeof(glm::vec3), 3 * kMaxHacdTriangles, kAnyError, nullptr));
  }
  return welded(mesh.points, kept);
}

double diagonal_of(std::span<const glm::dvec3> points) {
  glm::dvec3 low = points.front(), high = low;
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return glm::distance(low, high);
}

// The number of the cluster of each triangle.
std::vector<std::size_t> clusters_of(const IndexedMesh& mesh, double concavity_m) {
  std::vector<HACD::Vec3<HACD::Real>> points;
  for (const glm::dvec3& p : mesh.points) points.emplace_back(p.x, p.y, p.z);
  std::vector<HACD::Vec3<long>> triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    triangles.emplace_back(mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]);
  }
  HACD::HACD hacd;
  hacd.SetPoints(points.data());
  hacd.SetNPoints(points.size());
  hacd.SetTriangles(triangles.data());
  hacd.SetNTriangles(triangles.size());
  hacd.SetNClusters(1);
  hacd.SetScaleFactor(kHacdScale);
  hacd.SetConcavity(concavity_m * 2 * kHacdScale / diagonal_of(mesh.points));
  // HACD then measures concavity against the opposite surface and within faces too, not at corners only.
  hacd.SetAddExtraDistPoints(true);
  hacd.SetAddFacesPoints(true);
  hacd.Compute();
  return {hacd.GetPartition(), hacd.GetPartition() + triangles.size()};
}

// The points and the same points moved behind the surface that they lie on.
std::vector<glm::dvec3> plate_of(const std::vector<glm::dvec3>& points, const glm::dvec3& outward, double thickness_m) {
  std::vector<glm::dvec3> plate = points;
  const double length = glm::length(outward);
  if (!(length > 0)) return plate;
  for (const glm::dvec3& p : points) plate.push_back(p - thickness_m / length * outward);
  return plate;
}

}  // namespace

std::vector<CollisionShape> bullet_convex_pieces(std::span<const glm::dvec3> points,
                                                 std::span<const std::uint32_t> triangles, double concavity_m) {
  const IndexedMesh mesh = simplified(welded(points, triangles));
  if (mesh.triangles.empty()) return {};
  struct Cluster {
    std::vector<glm::dvec3> points;
    glm::dvec3 outward{0};  // sum of the triangles' areas times their normals, doubled
  };
  const std::vector<std::size_t> cluster_of = clusters_of(mesh, concavity_m);
  std::vector<Cluster> clusters(1 + std::ranges::max(cluster_of));
  for (std::size_t t = 0; t < cluster_of.size(); ++t) {
    Cluster& cluster = clusters[cluster_of[t]];
    std::array<glm::dvec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.points[mesh.triangles[3 * t + i]];
    cluster.points.insert(cluster.points.end(), corners.begin(), corners.end());
    cluster.outward += glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  }
  std::vector<CollisionShape> pieces;
  for (const Cluster& cluster : clusters) {
    std::optional<CollisionShape> hull = bullet_convex_hull(cluster.points);
    if (!hull) hull = bullet_convex_hull(plate_of(cluster.points, cluster.outward, kPlateShare * concavity_m));
    if (hull) pieces.push_back(*std::move(hull));
  }
  return pieces;
}

}  // namespace simvis
