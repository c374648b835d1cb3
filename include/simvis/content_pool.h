// A pool that holds identical content once: equal meshes, textures or materials become one shared object.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

#include <simvis/export.h>
#include <simvis/mesh.h>

namespace simvis {

/// Finds equal content by hash and then by value. Names are not compared.
///
/// Lifetime  the pool holds weak references: content that has no other owner is released.
/// Threads   one thread at a time.
class SIMVIS_API ContentPool {
 public:
  std::shared_ptr<const Mesh> intern(Mesh&& mesh);           ///< the pooled mesh that equals `mesh`; never null
  std::shared_ptr<const Texture> intern(Texture&& texture);  ///< the pooled texture that equals `texture`; never null
  /// The pooled material that equals `material`; never null. Its textures should come from this pool, because textures
  /// of materials are compared by identity.
  std::shared_ptr<const Material> intern(Material&& material);

 private:
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Mesh>> meshes_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Texture>> textures_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Material>> materials_;
};

}  // namespace simvis
