// A mesh with a tree over its triangles, for casting rays on the host and on the device.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/wide_bvh.h"

namespace simvis {

/// A mesh of triangles and its unit frame, in which it lies in the unit ball: (p - centre) / radius.
class Blas {
 public:
  /// `cache`: a folder where the tree of a large mesh is kept; empty: nowhere.
  Blas(std::shared_ptr<const Mesh> mesh, std::filesystem::path cache);

  const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
  std::uint32_t triangles() const { return static_cast<std::uint32_t>(mesh_->indices.size() / 3); }
  const glm::dvec3& centre() const { return centre_; }        ///< of the mesh's box
  double radius() const { return radius_; }                   ///< half the box's diagonal; 0: no ray can meet it
  const glm::dvec3& half_size() const { return half_size_; }  ///< of the box, in radii

  /// Over the triangles in the unit frame, rounded to float32, leaf by leaf those of leaves(). Empty if the radius is
  /// 0. Made when first asked for, by whichever thread.
  const WideBvh& tree() const {
    if (!made_.load(std::memory_order_acquire)) make_tree();
    return tree_;
  }

  /// Primitives; after tree().
  const std::vector<WideBvh::Leaf>& leaves() const { return leaves_; }

  /// The same for a device, with up to four triangles in a leaf.
  Bvh make_device_tree() const;

  /// A triangle's corners in the unit frame, rounded: off by up to 2^-25 per axis.
  std::array<glm::vec3, 3> unit_corners(std::uint32_t primitive) const;

 private:
  std::vector<Box> boxes() const;
  void make_tree() const;

  std::shared_ptr<const Mesh> mesh_;
  std::filesystem::path cache_;
  glm::dvec3 centre_, half_size_;
  double radius_;
  mutable std::mutex making_;
  mutable std::atomic<bool> made_ = false;
  mutable WideBvh tree_;
  mutable std::vector<WideBvh::Leaf> leaves_;
};

}  // namespace simvis
