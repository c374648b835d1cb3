#include "engine/base/temporary_name.h"

#include <unistd.h>

#include <atomic>
#include <climits>
#include <cstdint>

namespace simvis {

std::string temporary_name() {
  static std::atomic<std::uint64_t> calls = 0;
  char machine[HOST_NAME_MAX + 1] = "";
  ::gethostname(machine, sizeof machine - 1);
  return std::string(machine) + "." + std::to_string(::getpid()) + "." + std::to_string(++calls);
}

}  // namespace simvis
