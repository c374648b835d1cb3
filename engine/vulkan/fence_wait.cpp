#include "engine/vulkan/fence_wait.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

constexpr const char* kMaxWaitVariable = "SIMVIS_MAX_WAIT_S";

// The limit is the sum of waits of at most this length. A process that stands still in one of them loses only that one.
constexpr std::chrono::nanoseconds kWaitPart = std::chrono::seconds(1);

}  // namespace

std::chrono::nanoseconds max_wait() {
  const char* const text = std::getenv(kMaxWaitVariable);
  if (text == nullptr) return kMaxWait;
  const double seconds = as_number<double>(text).value_or(0);
  if (!(seconds >= kMinMaxWait_s && seconds <= kMaxMaxWait_s)) {
    throw InputError(std::string("the environment variable ") + kMaxWaitVariable + " is \"" + text +
                     "\", expected seconds from 0.001 to 1000000");
  }
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

VkResult wait_for_fence(VkDevice device, VkFence fence, std::chrono::nanoseconds limit) {
  using Clock = std::chrono::steady_clock;
  for (std::chrono::nanoseconds left = limit;;) {
    const std::chrono::nanoseconds part = std::min(left, kWaitPart);
    const Clock::time_point begin = Clock::now();
    const VkResult result = vkWaitForFences(device, 1, &fence, VK_TRUE, static_cast<std::uint64_t>(part.count()));
    if (result != VK_TIMEOUT) return result;
    left -= std::min<std::chrono::nanoseconds>(Clock::now() - begin, part);
    if (left.count() <= 0) return VK_TIMEOUT;
  }
}

}  // namespace simvis
