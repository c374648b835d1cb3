// A logical Vulkan device that is open in this process. All simulations with the same choice of a device share it.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <simvis/device_info.h>
#include "engine/vulkan/found_device.h"
#include "engine/vulkan/pipeline_cache.h"
#include "engine/vulkan/sharing/unfinished_work.h"

namespace simvis {

/// Simulations share a device if these settings are equal.
struct DeviceChoice {
  bool validation = false, instrumented = false;
  std::string select;                  ///< as DeviceDesc::select
  std::filesystem::path cache_folder;  ///< empty: nothing is kept on disk

  auto operator<=>(const DeviceChoice&) const = default;
};

/// Vulkan lets threads call functions of one device at the same time, as long as each uses objects of its own. So what
/// one simulation makes belongs to its DeviceImpl, and only the queue needs a lock.
///
/// A device that is lost, or whose queue does not end its work, is given up: shared_device() opens another one from
/// then on, and users of this one get errors. It is closed when its last user ends and its queue has ended all work.
///
/// Threads  any.
class SharedDevice {
 public:
  SharedDevice(FoundDevice found, const DeviceChoice& choice);
  /// Saves the pipeline cache. All users have waited for their submissions.
  ~SharedDevice();
  SharedDevice(const SharedDevice&) = delete;
  SharedDevice& operator=(const SharedDevice&) = delete;

  const Instance& instance() const { return *instance_; }
  const PhysicalDevice& physical() const { return physical_; }
  const DeviceChoice& choice() const { return choice_; }
  VkDevice get() const { return device_; }
  VkPipelineCache pipeline_cache() const { return pipeline_cache_->get(); }

  /// vkQueueSubmit. Submissions of all threads run in the order of these calls.
  VkResult submit(const VkSubmitInfo& info, VkFence fence);

  /// Gives the device up because `call` has returned `result`. `purpose` as in vk_check().
  void give_up(VkResult result, const char* call, std::string_view purpose);
  bool given_up() const { return given_up_; }
  /// Throws MachineError with the reason if the device was given up.
  void require_usable() const;
  /// As vk_check(). If the device is lost, it is given up.
  void check(VkResult result, const char* call, std::string_view purpose = {});

  /// What the queue may still use although its owner has ended.
  UnfinishedWork& unfinished() { return *unfinished_; }
  /// Whether the queue may still use objects whose owners no longer wait for it.
  bool has_unfinished() { return given_up_ && unfinished_->any(); }

  /// Names and labels for debuggers and messages; they cost nothing without validation.
  void name(VkObjectType type, std::uint64_t handle, std::string_view name) const;
  void begin_label(VkCommandBuffer commands, std::string_view name) const;
  void end_label(VkCommandBuffer commands) const;

  /// vkCmdDrawMultiIndexedEXT; null if the device draws one at a time.
  PFN_vkCmdDrawMultiIndexedEXT draw_many() const { return draw_many_; }

 private:
  void create();
  template <typename Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device_, name));
  }

  std::shared_ptr<Instance> instance_;
  PhysicalDevice physical_;
  DeviceChoice choice_;
  VkDevice device_ = VK_NULL_HANDLE;
  std::mutex submitting_;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::unique_ptr<PipelineCache> pipeline_cache_;
  std::optional<UnfinishedWork> unfinished_;
  std::atomic<bool> given_up_ = false;
  mutable std::mutex reason_mutex_;
  std::string reason_;  // why it was given up
  PFN_vkCmdDrawMultiIndexedEXT draw_many_ = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label_ = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label_ = nullptr;
};

}  // namespace simvis
