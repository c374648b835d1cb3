// Identical content is held once: two meshes, textures or materials that are equal become one object.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

#include <simvis/mesh.h>

namespace simvis {

/// Finds what is equal by hash and then by value, names aside. What nobody holds any more is forgotten.
class ContentPool {
 public:
  std::shared_ptr<const Mesh> intern(Mesh&& mesh);
  std::shared_ptr<const Texture> intern(Texture&& texture);
  /// The material's texture should come from this pool: textures are compared by identity.
  std::shared_ptr<const Material> intern(Material&& material);

 private:
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Mesh>> meshes_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Texture>> textures_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Material>> materials_;
};

}  // namespace simvis
