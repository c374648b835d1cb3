#include "engine/vulkan/loader_lock.h"

namespace simvis {

std::shared_mutex& loader_lists() {
  static std::shared_mutex mutex;
  return mutex;
}

}  // namespace simvis
