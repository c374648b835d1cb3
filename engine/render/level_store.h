// The coarser levels of the meshes of a draw list.
#pragma once

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/geometry/mesh_tiles.h"
#include "engine/vulkan/device_impl.h"

namespace simvis {

/// Meshes are identified by address. The levels of a mesh are made once, and released with it. Nothing is made until
/// update() is called.
class LevelStore {
 public:
  explicit LevelStore(DeviceImpl& device) : device_(device) {}

  /// Makes the levels of `meshes` that are new, and releases those of meshes that are not among them. Null pointers are
  /// passed over.
  void update(std::span<const std::shared_ptr<const Mesh>> meshes);

  /// The tiles of a mesh of the last update(); empty for any other mesh, and if none has levels. Valid until the next
  /// update().
  std::span<const LevelledTile> tiles_of(const Mesh* mesh) const;

 private:
  struct Entry {
    std::shared_ptr<const Mesh> mesh;  // ownership prevents reuse of the address by another mesh
    std::vector<LevelledTile> tiles;
    bool used = false;  // in the current list
  };

  DeviceImpl& device_;
  std::unordered_map<const Mesh*, Entry> entries_;
};

}  // namespace simvis
