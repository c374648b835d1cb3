#include "engine/raycast/blas.h"

#include <utility>

#include "engine/geometry/tree_cache.h"

namespace simvis {

Blas::Blas(std::shared_ptr<const Mesh> mesh, std::filesystem::path cache)
    : mesh_(std::move(mesh)), cache_(std::move(cache)) {
  const glm::dvec3 low(mesh_->bounds_min), high(mesh_->bounds_max);
  centre_ = 0.5 * (low + high);
  radius_ = 0.5 * glm::length(high - low);
  half_size_ = radius_ > 0 ? 0.5 * (high - low) / radius_ : glm::dvec3(0);
}

void Blas::make_tree() const {
  const std::lock_guard lock(making_);
  if (made_.load(std::memory_order_relaxed)) return;
  tree_ = make_tree_cached(*mesh_, boxes(), leaves_, cache_);
  made_.store(true, std::memory_order_release);
}

Bvh Blas::make_device_tree() const {
  constexpr std::uint32_t kMaxLeafSize = 4;
  return build_bvh(boxes(), kMaxLeafSize);
}

std::vector<Box> Blas::boxes() const {
  std::vector<Box> boxes;
  if (radius_ == 0) return boxes;
  boxes.reserve(triangles());
  for (std::uint32_t t = 0; t < triangles(); ++t) {
    const auto [a, b, c] = unit_corners(t);
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  return boxes;
}

std::array<glm::vec3, 3> Blas::unit_corners(std::uint32_t primitive) const {
  std::array<glm::vec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 p(mesh_->positions[mesh_->indices[std::size_t{3} * primitive + k]]);
    corners[k] = (p - centre_) / radius_;
  }
  return corners;
}

}  // namespace simvis
