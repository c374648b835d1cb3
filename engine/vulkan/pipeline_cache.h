// The pipeline cache, kept on disk between runs.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace simvis {

/// Loads the file of this device and driver. A file that is missing, corrupt or of another device or driver counts as
/// empty. save() writes the file again if the driver's data has changed, first under a temporary name. A folder that
/// cannot be written is no error.
class PipelineCache {
 public:
  PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties, const std::filesystem::path& folder);
  ~PipelineCache();
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;

  VkPipelineCache get() const { return cache_; }
  void save() const;

 private:
  VkDevice device_;
  VkPhysicalDeviceProperties properties_;
  std::filesystem::path file_;  // empty: nothing is kept on disk
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  std::vector<char> loaded_;
};

}  // namespace simvis
