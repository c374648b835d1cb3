// What is seen of the shapes of robots and worlds.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <tuple>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/model/model_description.h"

namespace simvis {

/// The meshes of boxes, round shapes and surfaces, each computed once.
class ShapeMeshes {
 public:
  explicit ShapeMeshes(ContentPool& pool) : pool_(pool) {}

  std::shared_ptr<const Mesh> mesh(const ModelShape& shape);

  std::size_t computed() const { return computed_; }  ///< meshes

 private:
  using Key = std::tuple<ModelShape::Kind, double, double, double>;

  ContentPool& pool_;
  std::map<Key, std::shared_ptr<const Mesh>> known_;
  std::size_t computed_ = 0;
};

/// Adds the node of a box, a sphere, a cylinder, a capsule, an ellipsoid, which is a stretched sphere, or a surface, in
/// the frame of the shape. Rays meet the round ones as such.
void add_shape_nodes(const ModelShape& shape, ShapeMeshes& meshes, Group& group);

}  // namespace simvis
