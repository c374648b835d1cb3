// The node of a mesh that a file names.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/node.h>

namespace simvis {

/// A shape with the mesh, through the pool, and with the mesh's name. The pooled mesh may have another name, because
/// meshes with the same content are one.
inline std::shared_ptr<Shape> shape_node(Mesh&& mesh, ContentPool& pool) {
  std::string name = mesh.name;
  auto node = std::make_shared<Shape>(pool.intern(std::move(mesh)));
  node->name = std::move(name);
  return node;
}

}  // namespace simvis
