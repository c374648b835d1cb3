#include "engine/splats/splat_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/splats/seen_splats.h"

namespace simvis {
namespace {

constexpr std::uint32_t kLeafSize = 4;

// The box around the ellipsoid outside of which a splat stops no light, with room for the rounding to float32 and that
// of the traversal.
Box box_of(const Splat& splat) {
  const glm::dmat3 axes = splat_rotation(splat);
  const glm::dvec3 sigma = splat_sigma(splat);
  const double reach = std::sqrt(splat_square_reach(splat));
  constexpr double kPadding = 1e-6;
  Box box;
  for (int row = 0; row < 3; ++row) {
    const double center = splat.center[row];
    const double half = reach * glm::length(glm::dvec3(axes[0][row], axes[1][row], axes[2][row]) * sigma),
                 padded = (1 + kPadding) * half + kPadding * std::abs(center);
    box.low[row] = static_cast<float>(center - padded);
    box.high[row] = static_cast<float>(center + padded);
  }
  return box;
}

// Whether the ray is in the box somewhere between its origin and its end.
bool meets(const BvhNode& node, const MeshRay& ray, const glm::dvec3& inverse) {
  double first = 0, last = ray.end_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = node.low[axis], high = node.high[axis];
    if (ray.direction[axis] == 0) {
      if (ray.origin[axis] < low || ray.origin[axis] > high) return false;
      continue;
    }
    const double a = (low - ray.origin[axis]) * inverse[axis], b = (high - ray.origin[axis]) * inverse[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

}  // namespace

SplatTree::SplatTree(std::shared_ptr<const SplatCloud> cloud) : cloud_(std::move(cloud)) {
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < cloud_->splats.size(); ++i) {
    const Splat& splat = cloud_->splats[i];
    if (static_cast<double>(splat.opacity) < kMinSplatAlpha) continue;
    visible_.push_back(i);
    boxes.push_back(box_of(splat));
  }
  tree_ = build_bvh(boxes, kLeafSize);
}

void SplatTree::find(const MeshRay& ray, std::vector<SplatOnRay>& found) const {
  if (tree_.nodes.empty()) return;
  const glm::dvec3 inverse = 1.0 / ray.direction;
  std::array<std::uint32_t, Bvh::kMaxDepth + 2> open;
  std::size_t count = 0;
  open[count++] = 0;
  while (count > 0) {
    const BvhNode& node = tree_.nodes[open[--count]];
    if (!meets(node, ray, inverse)) continue;
    if (node.count == 0) {
      open[count++] = node.first;
      open[count++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) test(ray, visible_[tree_.order[node.first + i]], found);
  }
}

// Rounding: of the difference of origin and centre, its turn and its division by the standard deviations s, some 32 u
// of its length, u = 2^-53; of the direction the same. Let c be that difference and d the direction, both in standard
// deviations. An error e of the origin moves the peak -c.d / d.d by at most e / (min(s) |d|). An error f of the
// direction moves it by at most f |c| / (min(s) |d|^2): the derivative of the peak is -(f.(c + 2 t d)) / d.d at the
// peak t, and c + 2 t d is c mirrored about the plane across d.
void SplatTree::test(const MeshRay& ray, std::uint32_t number, std::vector<SplatOnRay>& found) const {
  const Splat& splat = cloud_->splats[number];
  const glm::dvec3 sigma = splat_sigma(splat), from_center = ray.origin - glm::dvec3(splat.center);
  const glm::dmat3 splat_from_mesh = glm::transpose(splat_rotation(splat));
  const glm::dvec3 c = splat_from_mesh * from_center / sigma, d = splat_from_mesh * ray.direction / sigma;
  const double square = glm::dot(d, d), range_m = -glm::dot(c, d) / square;
  if (!(range_m > 0 && range_m < ray.end_m)) return;
  const glm::dvec3 across = glm::cross(c, d);
  const double square_distance = glm::dot(across, across) / square;
  if (!(square_distance <= splat_square_reach(splat))) return;
  const double alpha = splat_alpha(splat.opacity, square_distance);
  if (alpha == 0) return;
  constexpr double kRounding = 32 * 0x1p-53;
  const double of_origin = ray.origin_error + kRounding * glm::length(from_center),
               of_direction = ray.direction_error + kRounding * glm::length(ray.direction),
               error = of_origin + of_direction * glm::length(c) / std::sqrt(square),
               thinnest = std::min({sigma.x, sigma.y, sigma.z});
  found.push_back({range_m, alpha, error / (thinnest * std::sqrt(square)) + kRounding * range_m, number});
}

}  // namespace simvis
