#include "engine/vulkan/handle.h"

namespace simvis {
namespace {

template <typename T>
struct Traits;

#define SIMVIS_VULKAN_OBJECT(Type, OBJECT_TYPE, destroy_function)                                        \
  template <>                                                                                            \
  struct Traits<Vk##Type> {                                                                              \
    static constexpr VkObjectType kType = VK_OBJECT_TYPE_##OBJECT_TYPE;                                  \
    static void destroy(VkDevice device, Vk##Type handle) { destroy_function(device, handle, nullptr); } \
  };
SIMVIS_VULKAN_OBJECT(Buffer, BUFFER, vkDestroyBuffer)
SIMVIS_VULKAN_OBJECT(BufferView, BUFFER_VIEW, vkDestroyBufferView)
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
SIMVIS_VULKAN_OBJECT(QueryPool, QUERY_POOL, vkDestroyQueryPool)
#undef SIMVIS_VULKAN_OBJECT

}  // namespace

template <typename T>
Handle<T>::Handle(DeviceImpl& device, T handle, std::string_view name) : device_(&device), handle_(handle) {
  try {
    device.adopt(Traits<T>::kType, reinterpret_cast<std::uint64_t>(handle), name);
  } catch (...) {
    Traits<T>::destroy(device.device, handle);
    throw;
  }
}

template <typename T>
void Handle<T>::retire() {
  if (handle_ == VK_NULL_HANDLE) return;
  device_->retire([device = device_->device, handle = handle_] { Traits<T>::destroy(device, handle); });
  handle_ = VK_NULL_HANDLE;
}

template class Handle<VkBuffer>;
template class Handle<VkBufferView>;
template class Handle<VkImage>;
template class Handle<VkImageView>;
template class Handle<VkSampler>;
template class Handle<VkFramebuffer>;
template class Handle<VkRenderPass>;
template class Handle<VkShaderModule>;
template class Handle<VkPipeline>;
template class Handle<VkPipelineLayout>;
template class Handle<VkDescriptorSetLayout>;
template class Handle<VkDescriptorPool>;
template class Handle<VkCommandPool>;
template class Handle<VkFence>;
template class Handle<VkQueryPool>;

}  // namespace simvis
