// Collision shapes and masses from the shapes of a model's links.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include <simvis/content_pool.h>
#include "elements/dynamics/world/part_shapes.h"
#include "elements/dynamics/world/world.h"
#include "import/model/model_description.h"
#include "import/model/model_meshes.h"

namespace simvis {

/// The triangles of collision meshes. Each file is made triangles once.
class CollisionMeshes {
 public:
  /// `files` are those of the description whose shapes are asked for.
  CollisionMeshes(std::shared_ptr<ModelMeshes> files, ContentPool& pool) : files_(std::move(files)), pool_(pool) {}
  /// Throws InputError for a file that is broken.
  const Triangles& read(const std::filesystem::path& file);

 private:
  std::shared_ptr<ModelMeshes> files_;
  ContentPool& pool_;
  std::map<std::filesystem::path, Triangles> read_;
};

/// How meshes collide: as their convex hulls, or as they are, which nothing that moves may do.
enum class MeshCollision { hull, triangles };

/// The shape without its place in the link. Throws InputError at the collision for a mesh that is broken or flat.
CollisionShape collision_shape_of(const ModelCollision& collision, MeshCollision as, CollisionMeshes& meshes);

/// The mass of a solid in the frame of its shape. A mesh that is open, or turned inside out, is the solid of its convex
/// hull; a plane has no mass. Throws InputError at the solid for a mesh that is broken, or flat.
MassProperties mass_of_solid(const ModelSolid& solid, CollisionMeshes& meshes);

}  // namespace simvis
