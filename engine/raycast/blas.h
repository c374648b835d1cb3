// A mesh with a tree over its triangles, for ray casting on the host and on the device.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <simvis/mesh.h>
#include "engine/draw/solid_cloud.h"
#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/height_grid.h"

namespace simvis {

/// A triangle mesh and its unit frame. Several threads may use one at the same time. A point p of the mesh is (p -
/// centre) / radius in the unit frame, so that the mesh lies in the unit ball.
class Blas {
 public:
  /// `cache`: folder that keeps the trees of large meshes; empty for none. `pool`: threads that build trees.
  Blas(std::shared_ptr<const Mesh> mesh, std::filesystem::path cache, std::shared_ptr<ThreadPool> pool);

  const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
  std::uint32_t triangles() const { return static_cast<std::uint32_t>(mesh_->indices.size() / 3); }
  /// Whether the primitives are the points of a solid cloud.
  bool is_cloud() const { return is_solid_cloud(*mesh_); }
  const glm::dvec3& centre() const { return centre_; }        ///< centre of the mesh's box
  double radius() const { return radius_; }                   ///< half the diagonal of the box; 0: no ray can hit it
  const glm::dvec3& half_size() const { return half_size_; }  ///< half the size of the box, in radii

  /// Tree over the triangles, or over the spheres or discs of a cloud, in the unit frame, rounded to float32. Leaf i
  /// holds the primitives leaves()[i]. The tree is empty if the radius is 0. The first call builds it, on any thread;
  /// threads that call meanwhile help with the work of the pool.
  const WideBvh& tree() const {
    if (state_.load(std::memory_order_acquire) != State::made) make_tree();
    return tree_;
  }

  /// Primitives of each leaf; valid after tree().
  const std::vector<WideBvh::Leaf>& leaves() const { return leaves_; }

  /// The mean size of a leaf's box, in radii, weighted by the area of the boxes; valid after tree().
  double leaf_size() const { return leaf_size_; }

  bool is_grid() const { return grid_.has_value(); }  ///< whether the mesh is a regular grid of heights

  /// The blocks of a mesh that is a regular grid of heights; null for other meshes. The first call makes them, on any
  /// thread. A ray goes through them in place of the tree, unless the transform of the item flattens it.
  const HeightPyramid* pyramid() const;

  /// Whether a device leaves the mesh to the host: it is an exact shape or a grid, whose triangles may be more than a
  /// device addresses.
  bool by_host() const { return mesh_->surface || is_grid(); }

  /// Builds the tree for a device, with up to four triangles in a leaf.
  Bvh make_device_tree() const;

  /// Corners of a triangle in the unit frame. Rounding moves each by up to 2^-25 per axis.
  std::array<glm::vec3, 3> unit_corners(std::uint32_t primitive) const;

 private:
  enum class State : std::uint32_t { none, making, made };
  std::vector<Box> boxes() const;
  void make_tree() const;
  void end_making(State state) const;

  std::shared_ptr<const Mesh> mesh_;
  std::filesystem::path cache_;
  glm::dvec3 centre_, half_size_;
  double radius_;
  std::shared_ptr<ThreadPool> pool_;
  std::optional<GridSize> grid_;
  mutable std::once_flag pyramid_made_;
  mutable std::optional<HeightPyramid> pyramid_;
  mutable std::atomic<State> state_ = State::none;  // state of the members below
  mutable WideBvh tree_;
  mutable std::vector<WideBvh::Leaf> leaves_;
  mutable double leaf_size_ = 0;
};

/// The Blas of a mesh, which all ray casters of the process share while one of them holds it. If there is none yet, it
/// gets the other arguments. Any thread may call.
std::shared_ptr<const Blas> shared_blas(const std::shared_ptr<const Mesh>& mesh, const std::filesystem::path& cache,
                                        const std::shared_ptr<ThreadPool>& pool);

}  // namespace simvis
