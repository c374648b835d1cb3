// What the queue of a device may still use after a wait for it has failed.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/vulkan/device_memory.h"

namespace simvis {

/// An object without an owner, to be destroyed later.
struct Retired {
  std::function<void()> destroy;
  std::uint64_t serial = 0;  ///< the last submission that may use it
};

/// Objects whose owner has ended before the submissions that use them.
///
/// Threads  all functions from any thread.
class UnfinishedWork {
 public:
  explicit UnfinishedWork(VkDevice device) : device_(device) {}

  /// The fence of a submission that no caller waits for any more.
  void add(VkFence fence);
  /// Keeps the objects, and the memory that they are bound to.
  void keep(std::vector<Retired> objects, std::unique_ptr<DeviceMemory> memory);

  /// Whether a submission may still be under way. The submissions of a lost device are not.
  bool any();
  /// Destroys what is kept. No submission may be under way.
  void destroy();

 private:
  struct Kept {
    std::unique_ptr<DeviceMemory> memory;  // outlives the objects
    std::vector<Retired> objects;
  };

  VkDevice device_;
  std::mutex mutex_;  // protects all members below
  std::vector<VkFence> fences_;
  std::vector<Kept> kept_;
};

}  // namespace simvis
