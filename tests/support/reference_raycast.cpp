#include "tests/support/reference_raycast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace simvis::reference {

RayCaster::RayCaster(const DrawList& list, const glm::dmat4& sensor_from_world) {
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const Material& material = *list.materials[item.material];
    if (mesh.topology != Topology::triangles) continue;
    if (material.alpha_mode == AlphaMode::blend && material.base_color.a < 0.5f) continue;
    const glm::dmat4 sensor_from_mesh = sensor_from_world * list.world_from_node[item.transform];
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::array<glm::dvec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = glm::dvec3(sensor_from_mesh * glm::dvec4(mesh.positions[mesh.indices[i + k]], 1.0));
      }
      triangles_.push_back(corners);
    }
  }
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()));
}

Hit RayCaster::cast(const glm::dvec3& direction) const {
  Hit hit;
  if (nodes_.empty()) return hit;
  std::array<std::uint32_t, 128> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Box& box = nodes_[stack[--top]];
    if (!crosses(box, direction, hit.range_m)) continue;
    if (box.count > 0) {
      for (std::uint32_t i = box.first; i < box.first + box.count; ++i) intersect(order_[i], direction, hit);
    } else {
      stack[top++] = box.first;
      stack[top++] = box.second;
    }
  }
  return refined(hit, direction);
}

double RayCaster::range_of_plane(std::uint32_t triangle, const glm::dvec3& direction) const {
  const auto& [a, b, c] = triangles_[triangle];
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  return glm::dot(normal, a) / glm::dot(normal, direction);
}

Hit RayCaster::cast_all(const glm::dvec3& direction) const {
  Hit hit;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) intersect(t, direction, hit);
  return refined(hit, direction);
}

Hit RayCaster::refined(Hit hit, const glm::dvec3& direction) const {
  if (!std::isfinite(hit.range_m)) return hit;
  using Vector = glm::vec<3, long double>;
  const auto& [a, b, c] = triangles_[hit.triangle];
  const Vector corner(a), normal = glm::cross(Vector(b) - corner, Vector(c) - corner);
  hit.range_m = static_cast<double>(glm::dot(normal, corner) / glm::dot(normal, Vector(direction)));
  return hit;
}

bool RayCaster::crosses(const Box& box, const glm::dvec3& direction, double limit) {
  double near = 0, far = limit;
  for (int a = 0; a < 3; ++a) {
    if (direction[a] == 0) {
      if (box.low[a] > 0 || box.high[a] < 0) return false;
      continue;
    }
    const double s = box.low[a] / direction[a], t = box.high[a] / direction[a];
    near = std::max(near, std::min(s, t) * (1 - 1e-12) - 1e-12);
    far = std::min(far, std::max(s, t) * (1 + 1e-12) + 1e-12);
  }
  return near <= far;
}

void RayCaster::intersect(std::uint32_t index, const glm::dvec3& direction, Hit& hit) const {
  constexpr double kEdge = 1e-12;
  const auto& [a, b, c] = triangles_[index];
  const glm::dvec3 ab = b - a, ac = c - a;
  const glm::dvec3 p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0) return;
  const double u = glm::dot(-a, p) / determinant;
  if (!(u >= -kEdge && u <= 1 + kEdge)) return;
  const glm::dvec3 q = glm::cross(-a, ab);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= -kEdge && u + v <= 1 + kEdge)) return;
  const double t = glm::dot(ac, q) / determinant;
  if (t > 0 && t < hit.range_m) hit = {t, index};
}

std::uint32_t RayCaster::build(std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t kLeaf = 4;
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Box box{glm::dvec3(std::numeric_limits<double>::infinity()), glm::dvec3(-std::numeric_limits<double>::infinity()),
          begin, 0, end - begin};
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const glm::dvec3& corner : triangles_[order_[i]]) {
      box.low = glm::min(box.low, corner);
      box.high = glm::max(box.high, corner);
    }
  }
  nodes_.push_back(box);
  if (end - begin <= kLeaf) return index;
  const glm::dvec3 size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t s, std::uint32_t t) { return centre(s, axis) < centre(t, axis); });
  const std::uint32_t first = build(begin, middle);
  const std::uint32_t second = build(middle, end);
  nodes_[index].first = first;
  nodes_[index].second = second;
  nodes_[index].count = 0;
  return index;
}

double RayCaster::centre(std::uint32_t t, int axis) const {
  return triangles_[t][0][axis] + triangles_[t][1][axis] + triangles_[t][2][axis];
}

}  // namespace simvis::reference
