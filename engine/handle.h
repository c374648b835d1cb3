// A move-only owner of one Vulkan object. When it goes, the object is put on the device's retire list, and destroyed
// once the submission that may still use it has finished.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string_view>
#include <utility>

#include "engine/device_impl.h"

namespace simvis {

#define SIMVIS_VULKAN_OBJECT(Type, OBJECT_TYPE, destroy_function)                              \
  inline constexpr VkObjectType object_type(Vk##Type) { return VK_OBJECT_TYPE_##OBJECT_TYPE; } \
  inline void destroy_object(VkDevice device, Vk##Type handle) { destroy_function(device, handle, nullptr); }

SIMVIS_VULKAN_OBJECT(Buffer, BUFFER, vkDestroyBuffer)
SIMVIS_VULKAN_OBJECT(DeviceMemory, DEVICE_MEMORY, vkFreeMemory)
SIMVIS_VULKAN_OBJECT(Image, IMAGE, vkDestroyImage)
SIMVIS_VULKAN_OBJECT(ImageView, IMAGE_VIEW, vkDestroyImageView)
SIMVIS_VULKAN_OBJECT(Sampler, SAMPLER, vkDestroySampler)
SIMVIS_VULKAN_OBJECT(Framebuffer, FRAMEBUFFER, vkDestroyFramebuffer)
SIMVIS_VULKAN_OBJECT(RenderPass, RENDER_PASS, vkDestroyRenderPass)
SIMVIS_VULKAN_OBJECT(ShaderModule, SHADER_MODULE, vkDestroyShaderModule)
SIMVIS_VULKAN_OBJECT(Pipeline, PIPELINE, vkDestroyPipeline)
SIMVIS_VULKAN_OBJECT(PipelineLayout, PIPELINE_LAYOUT, vkDestroyPipelineLayout)
SIMVIS_VULKAN_OBJECT(DescriptorSetLayout, DESCRIPTOR_SET_LAYOUT, vkDestroyDescriptorSetLayout)
SIMVIS_VULKAN_OBJECT(DescriptorPool, DESCRIPTOR_POOL, vkDestroyDescriptorPool)
SIMVIS_VULKAN_OBJECT(CommandPool, COMMAND_POOL, vkDestroyCommandPool)
SIMVIS_VULKAN_OBJECT(Fence, FENCE, vkDestroyFence)
#undef SIMVIS_VULKAN_OBJECT

template <typename T>
class Handle {
 public:
  Handle() = default;
  /// Takes over `handle`. The name shows in messages of the validation layer and in debuggers.
  Handle(Device::Impl& device, T handle, std::string_view name) : device_(&device), handle_(handle) {
    device.adopt(object_type(handle), reinterpret_cast<std::uint64_t>(handle), name);
  }
  ~Handle() { retire(); }
  Handle(Handle&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, VK_NULL_HANDLE)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      retire();
      device_ = other.device_;
      handle_ = std::exchange(other.handle_, VK_NULL_HANDLE);
    }
    return *this;
  }

  T get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
  void retire() {
    if (handle_ == VK_NULL_HANDLE) return;
    device_->retire(
        {.handle = reinterpret_cast<std::uint64_t>(handle_),
         .destroy = [](VkDevice device, std::uint64_t h) { destroy_object(device, reinterpret_cast<T>(h)); }});
    handle_ = VK_NULL_HANDLE;
  }

  Device::Impl* device_ = nullptr;
  T handle_ = VK_NULL_HANDLE;
};

}  // namespace simvis
