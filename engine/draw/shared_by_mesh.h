// A table of data that is computed from meshes. All simulations of the process share its entries.
#pragma once

#include <memory>
#include <mutex>
#include <unordered_map>

#include <simvis/mesh.h>

namespace simvis {

/// Holds weak references: what has no other owner is released. A T owns its mesh, so that no other mesh can have the
/// address while the T is there.
///
/// Threads   any.
template <typename T>
class SharedByMesh {
 public:
  /// Returns the T of this mesh, made by make() if there is none. make() is called under a lock: it should leave long
  /// work to the T's first use.
  template <typename Make>
  std::shared_ptr<const T> find_or_make(const Mesh& mesh, const Make& make) {
    const std::lock_guard lock(mutex_);
    std::weak_ptr<const T>& known = known_[&mesh];
    std::shared_ptr<const T> found = known.lock();
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
  std::unordered_map<const Mesh*, std::weak_ptr<const T>> known_;
  std::size_t kept_ = 16;
};

}  // namespace simvis
