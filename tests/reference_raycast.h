// The truth that scans are held against: a ray cast in double precision over the triangles of a DrawList.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <numeric>
#include <vector>

#include "engine/draw_list.h"

namespace simvis::reference {

struct Hit {
  double range_m = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;
};

/// Opaque triangles of a list in the frame of a sensor, with a bounding volume hierarchy over them.
/// What lets a laser pass (blended below one half) is left out; masked textures are not handled and must not occur.
class RayCaster {
 public:
  RayCaster(const DrawList& list, const glm::dmat4& sensor_from_world) {
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

  std::size_t triangle_count() const { return triangles_.size(); }

  /// Nearest hit along a unit direction from the sensor's origin, either side of a triangle.
  Hit cast(const glm::dvec3& direction) const {
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

  /// Where the plane of a triangle is met in this direction; not finite or negative where it is not.
  double range_of_plane(std::uint32_t triangle, const glm::dvec3& direction) const {
    const auto& [a, b, c] = triangles_[triangle];
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    return glm::dot(normal, a) / glm::dot(normal, direction);
  }

  /// What cast() finds, found without the hierarchy: the test of the test.
  Hit cast_all(const glm::dvec3& direction) const {
    Hit hit;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) intersect(t, direction, hit);
    return refined(hit, direction);
  }

 private:
  struct Box {
    glm::dvec3 low, high;
    std::uint32_t first, second, count;  // count 0: first and second are the children
  };

  // The range of the triangle found, again and in long double: on slivers double leaves some hundred roundings.
  Hit refined(Hit hit, const glm::dvec3& direction) const {
    if (!std::isfinite(hit.range_m)) return hit;
    using Vector = glm::vec<3, long double>;
    const auto& [a, b, c] = triangles_[hit.triangle];
    const Vector corner(a), normal = glm::cross(Vector(b) - corner, Vector(c) - corner);
    hit.range_m = static_cast<double>(glm::dot(normal, corner) / glm::dot(normal, Vector(direction)));
    return hit;
  }

  // Slabs, widened by what the divisions may round away.
  static bool crosses(const Box& box, const glm::dvec3& direction, double limit) {
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

  // Moeller and Trumbore 1997, from the origin. Edges belong to both neighbours within 1e-12 of the barycentrics.
  void intersect(std::uint32_t index, const glm::dvec3& direction, Hit& hit) const {
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

  std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
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

  double centre(std::uint32_t t, int axis) const {
    return triangles_[t][0][axis] + triangles_[t][1][axis] + triangles_[t][2][axis];
  }

  std::vector<std::array<glm::dvec3, 3>> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> nodes_;
};

}  // namespace simvis::reference
