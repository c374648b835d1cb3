#include "engine/culling/occluders.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace simvis {
namespace {

// Largest distance of the fourth corner from the plane of the other three, relative to the longest side.
constexpr double kOccluderFlatness = 1e-4;

struct Face {
  glm::vec3 corners[3];
  double area = 0;
  bool joined = false;
};

glm::dvec3 normal_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) { return glm::cross(b - a, c - a); }

std::vector<Face> largest_faces(const Mesh& mesh, const Clustering& clustering) {
  const glm::dvec3 diagonal(mesh.bounds_max - mesh.bounds_min);
  const double least = kMinOccluderShare * glm::dot(diagonal, diagonal);
  std::vector<Face> faces;
  if (!(least > 0)) return faces;
  for (const Cluster& cluster : clustering.clusters) {
    // No triangle has more area than half the squared diagonal of its box.
    if (2 * glm::dot(glm::dvec3(cluster.half_size), glm::dvec3(cluster.half_size)) < least) continue;
    const auto vertices = clustering.vertices_of(cluster);
    const auto corners = clustering.corners_of(cluster);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      Face face;
      for (std::size_t k = 0; k < 3; ++k) face.corners[k] = mesh.positions[vertices[corners[i + k]]];
      face.area = glm::length(normal_of(face.corners[0], face.corners[1], face.corners[2])) / 2;
      if (face.area >= least) faces.push_back(face);
    }
  }
  std::ranges::stable_sort(faces, std::ranges::greater(), &Face::area);
  if (faces.size() > kMaxOccluders) faces.resize(kMaxOccluders);
  return faces;
}

// Joins b to a at a common side. Empty unless the result is a flat convex quadrangle.
std::optional<Occluder> joined(const Face& a, const Face& b) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 &p = a.corners[i], &q = a.corners[(i + 1) % 3];
      if (b.corners[k] != q || b.corners[(k + 1) % 3] != p) continue;
      const Occluder occluder{{p, b.corners[(k + 2) % 3], q, a.corners[(i + 2) % 3]}, 4};
      const auto corner = [&](int n) { return glm::dvec3(occluder.corners[static_cast<std::size_t>(n % 4)]); };
      const glm::dvec3 normal = glm::normalize(normal_of(a.corners[0], a.corners[1], a.corners[2]));
      double longest = 0;
      for (int n = 0; n < 4; ++n) longest = std::max(longest, glm::distance(corner(n), corner(n + 1)));
      if (std::abs(glm::dot(normal, corner(1) - corner(0))) > kOccluderFlatness * longest) return {};
      for (int n = 0; n < 4; ++n) {
        if (!(glm::dot(normal_of(corner(n), corner(n + 1), corner(n + 2)), normal) > 0)) return {};
      }
      return occluder;
    }
  }
  return {};
}

}  // namespace

std::vector<Occluder> extract_occluders(const Mesh& mesh, const Clustering& clustering) {
  std::vector<Occluder> occluders;
  std::vector<Face> faces = largest_faces(mesh, clustering);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].joined) continue;
    Occluder occluder{{faces[i].corners[0], faces[i].corners[1], faces[i].corners[2]}, 3};
    for (std::size_t k = i + 1; k < faces.size(); ++k) {
      if (faces[k].joined) continue;
      if (const auto both = joined(faces[i], faces[k])) {
        occluder = *both;
        faces[k].joined = true;
        break;
      }
    }
    occluders.push_back(occluder);
  }
  return occluders;
}

}  // namespace simvis
