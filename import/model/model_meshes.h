// The mesh files of a model, for what is seen and for what collides.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/mesh/mesh_file.h"

namespace simvis {

/// The endings of files that read() takes, for messages.
inline constexpr const char* kModelMeshEndings = ".dae, .zae, .obj, .ply, .stl, .gltf or .glb";

/// Reads each file once, however many visuals and collisions name it. Graphs are shared: nobody changes them.
class ModelMeshes {
 public:
  static bool is_known(const std::filesystem::path& file);

  /// The meshes of a file; their shapes without a material have `fallback`, but those of glTF, which has a material of
  /// its own for them. glTF as written is not turned, although its text says that y is up: neither Gazebo (gz-common
  /// f4a6dbd1, UpdatedRootNodeTransform() in AssimpLoader.cc) nor RViz (ros2/rviz f7112b1a,
  /// computeTransformOverSceneGraph() in assimp_loader.cpp) turns it. Throws InputError naming the file, as often as it
  /// is asked for, if it is broken, and OutsideFolders (engine/base/read_fence.h).
  GroupPtr read(const std::filesystem::path& file, MeshFileAxes axes, const std::shared_ptr<const Material>& fallback,
                ContentPool& pool);
  /// The meshes as they collide: with the axes of the file, whatever their materials.
  GroupPtr surface(const std::filesystem::path& file, ContentPool& pool);

  /// What the files that have been read gave rise to, each once.
  std::vector<std::string> release_warnings() { return std::move(warnings_); }

 private:
  using Key = std::tuple<std::filesystem::path, MeshFileAxes, std::shared_ptr<const Material>>;
  struct MeshContent {
    GroupPtr root;  // null: it cannot be read
    std::string error;
  };
  std::map<Key, MeshContent> read_;
  std::vector<std::string> warnings_;
};

}  // namespace simvis
