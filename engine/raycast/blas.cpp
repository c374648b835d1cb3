#include "engine/raycast/blas.h"

#include <cmath>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "engine/base/thread_pool.h"
#include "engine/geometry/tree_cache.h"

namespace simvis {

namespace {

// How far the shape of a point of a cloud reaches along each axis. A disc with the unit normal n reaches by
// r sqrt(1 - n_i^2) along axis i.
glm::dvec3 reach_of(const Mesh& cloud, std::uint32_t vertex) {
  const double radius_m = cloud.surface->radius_m;
  if (!is_cloud_of_discs(cloud)) return glm::dvec3(radius_m);
  const glm::dvec3 n(cloud.attributes[vertex].normal), squares = n * n;
  const double square = squares.x + squares.y + squares.z;
  glm::dvec3 reach;
  for (int i = 0; i < 3; ++i) reach[i] = radius_m * std::sqrt((squares[(i + 1) % 3] + squares[(i + 2) % 3]) / square);
  return reach;
}

double mean_leaf_size(const WideBvh& tree) {
  double areas = 0, sizes = 0;
  for (const WideNode& node : tree.nodes()) {
    for (std::uint32_t lane = 0; lane < node.children; ++lane) {
      if (node.primitives[lane] == 0) continue;
      const Box box = node.box(lane);
      const glm::dvec3 size = glm::dvec3(box.high) - glm::dvec3(box.low);
      const double area = size.x * size.y + size.y * size.z + size.z * size.x;
      areas += area;
      sizes += area * glm::length(size);
    }
  }
  return areas > 0 ? sizes / areas : 0;
}

// The trees of all simulations of the process, for any thread. Weak references: a tree without another owner is
// released. A tree owns its mesh, so that no other mesh can have the address while the tree is there.
class KnownBlases {
 public:
  // make() is called under a lock: it should leave long work to the first use of the tree.
  template <typename Make>
  std::shared_ptr<const Blas> find_or_make(const Mesh& mesh, const Make& make) {
    const std::lock_guard lock(mutex_);
    std::weak_ptr<const Blas>& known = known_[&mesh];
    std::shared_ptr<const Blas> found = known.lock();
    if (found) return found;
    found = make();
    known = found;
    forget_expired();
    return found;
  }

 private:
  // Each time that the number of entries has doubled, so that each is looked at a bounded number of times.
  void forget_expired() {
    if (known_.size() < kept_) return;
    std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
    kept_ = 2 * known_.size() + 1;
  }

  std::mutex mutex_;
  std::unordered_map<const Mesh*, std::weak_ptr<const Blas>> known_;
  std::size_t kept_ = 16;
};

}  // namespace

Blas::Blas(std::shared_ptr<const Mesh> mesh, std::filesystem::path cache, std::shared_ptr<ThreadPool> pool)
    : mesh_(std::move(mesh)), cache_(std::move(cache)), pool_(std::move(pool)) {
  const glm::dvec3 low(mesh_->bounds_min), high(mesh_->bounds_max);
  centre_ = 0.5 * (low + high);
  radius_ = 0.5 * glm::length(high - low);
  half_size_ = radius_ > 0 ? 0.5 * (high - low) / radius_ : glm::dvec3(0);
  grid_ = find_grid(*mesh_);
}

const HeightPyramid* Blas::pyramid() const {
  if (!grid_) return nullptr;
  std::call_once(pyramid_made_, [this] { pyramid_.emplace(*mesh_, *grid_); });
  return &*pyramid_;
}

void Blas::make_tree() const {
  State state = State::none;
  while (!state_.compare_exchange_strong(state, State::making, std::memory_order_acquire)) {
    if (state == State::made) return;
    // This thread helps the pool. Waiting for a lock instead would take helpers away from the thread that builds.
    pool_->help_while([this] { return state_.load(std::memory_order_acquire) == State::making; });
    state = State::none;
  }
  try {
    // The cache knows trees by their triangles.
    tree_ = make_tree_cached(*mesh_, boxes(), leaves_, is_cloud() ? "" : cache_, pool_.get());
    leaf_size_ = mean_leaf_size(tree_);
  } catch (...) {
    end_making(State::none);
    throw;
  }
  end_making(State::made);
}

void Blas::end_making(State state) const {
  state_.store(state, std::memory_order_release);
  pool_->notify();
}

Bvh Blas::make_device_tree() const {
  constexpr std::uint32_t kMaxLeafSize = 4;
  return build_bvh(boxes(), kMaxLeafSize, 1, pool_.get());
}

std::vector<Box> Blas::boxes() const {
  std::vector<Box> boxes;
  if (radius_ == 0) return boxes;
  if (is_cloud()) {
    boxes.reserve(mesh_->indices.size());
    for (const std::uint32_t index : mesh_->indices) {
      const glm::vec3 reach(reach_of(*mesh_, index) / radius_);
      const glm::vec3 middle((glm::dvec3(mesh_->positions[index]) - centre_) / radius_);
      boxes.push_back({middle - reach, middle + reach});
    }
    return boxes;
  }
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

std::shared_ptr<const Blas> shared_blas(const std::shared_ptr<const Mesh>& mesh, const std::filesystem::path& cache,
                                        const std::shared_ptr<ThreadPool>& pool) {
  static KnownBlases known;
  return known.find_or_make(*mesh, [&] { return std::make_shared<const Blas>(mesh, cache, pool); });
}

}  // namespace simvis
