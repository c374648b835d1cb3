#include "simvis/inside_solid.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace simvis {
namespace {

// A point within a closed surface has the winding number 1, and one at a side of an open surface at most a half.
constexpr double kInside = 0.75;

// The share of all directions from `eye` that meets the triangle, above 0 if its back is seen.
double solid_angle(const glm::dvec3& eye, const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
  const glm::dvec3 a = p - eye, b = q - eye, c = r - eye;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = glm::dot(a, glm::cross(b, c));
  const double rest = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return 2 * std::atan2(volume, rest) / (4 * std::numbers::pi);
}

}  // namespace

bool is_inside_solid(const Mesh& mesh, const glm::dmat4& world_from_mesh, const glm::dvec3& world_m, double near_m) {
  if (mesh.topology != Topology::triangles || mesh.indices.size() < 3) return false;
  const glm::dvec3 own(glm::inverse(world_from_mesh) * glm::dvec4(world_m, 1));
  const bool is_in_box = glm::all(glm::greaterThanEqual(own, glm::dvec3(mesh.bounds_min))) &&
                         glm::all(glm::lessThanEqual(own, glm::dvec3(mesh.bounds_max)));
  if (!is_in_box) return false;
  std::vector<glm::dvec3> corners;
  corners.reserve(mesh.positions.size());
  for (const glm::vec3& position : mesh.positions) {
    corners.emplace_back(world_from_mesh * glm::dvec4(glm::dvec3(position), 1));
  }
  glm::dvec3 low = corners[mesh.indices[0]], high = low;
  for (const std::uint32_t index : mesh.indices) {
    low = glm::min(low, corners[index]);
    high = glm::max(high, corners[index]);
  }
  if (glm::length(glm::max(high - world_m, world_m - low)) < near_m) return false;
  double winding = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    winding +=
        solid_angle(world_m, corners[mesh.indices[i]], corners[mesh.indices[i + 1]], corners[mesh.indices[i + 2]]);
  }
  const double mirrored = glm::determinant(glm::dmat3(world_from_mesh)) < 0 ? -1 : 1;
  return mirrored * winding > kInside;
}

bool is_depth_visible(const Material* material) {
  if (material == nullptr) return true;
  const float alpha = material->alpha_mode == AlphaMode::blend ? material->base_color.a : 1;
  return alpha * material->opacity >= kMinDepthVisibleAlpha;
}

}  // namespace simvis
