// Waits for submissions, but never without end.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>

namespace simvis {

/// How long the device may take for one submission if SIMVIS_MAX_WAIT_S does not say otherwise. A frame on the cores of
/// the host takes minutes where it is large and many processes share these cores. Drivers of GPUs end a submission that
/// hangs by themselves, after about ten seconds.
inline constexpr std::chrono::seconds kMaxWait{600};

/// The limits of SIMVIS_MAX_WAIT_S.
inline constexpr double kMinMaxWait_s = 0.001, kMaxMaxWait_s = 1e6;

/// kMaxWait, or the seconds of the environment variable SIMVIS_MAX_WAIT_S. Throws InputError if these are no number
/// within the limits.
std::chrono::nanoseconds max_wait();

/// vkWaitForFences for one fence. VK_TIMEOUT: it was not signalled within `limit`; 0 asks without waiting. Time in
/// which the process is stopped or the machine sleeps does not count.
VkResult wait_for_fence(VkDevice device, VkFence fence, std::chrono::nanoseconds limit);

}  // namespace simvis
