// The textures that a draw list shows, on the device.
#pragma once

#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "engine/frame_plan.h"
#include "engine/gpu_image.h"
#include "engine/mesh.h"
#include "engine/uploads.h"

namespace simvis {

/// Textures are told apart by identity, uploaded on first need, and forgotten once a list no longer holds them.
class TextureStore {
 public:
  TextureStore(Device::Impl& device, VkDescriptorSetLayout set_layout) : device_(device), set_layout_(set_layout) {}

  /// The descriptor set of a texture; uploads it if it is not resident.
  /// Throws InputError when it is larger than the device allows.
  VkDescriptorSet require(const std::shared_ptr<const Texture>& texture, Uploads& uploads);

  /// Adds its images; `sampled` says how many draws of this frame read from a set.
  void name_memory(const Uploads& uploads, const std::function<std::uint64_t(VkDescriptorSet)>& sampled,
                   std::vector<PlannedMemory>& memory) const;

  /// Forgets all that is not among `materials`.
  void keep_only(const std::vector<std::shared_ptr<const Material>>& materials);

  /// How many textures it holds, and how many bytes of texels, those of smaller levels included.
  void count(std::uint64_t& textures, std::uint64_t& bytes) const;

  void clear();

 private:
  struct Entry {
    std::shared_ptr<const Texture> texture;  // keeps the address from being given to another texture
    GpuImage image;
    VkDescriptorSet set = VK_NULL_HANDLE;
    bool wanted = true;
  };
  VkSampler sampler(const Sampler& sampler);
  VkDescriptorSet free_set();

  Device::Impl& device_;
  VkDescriptorSetLayout set_layout_;
  std::unordered_map<const Texture*, Entry> entries_;
  std::vector<std::pair<Sampler, Handle<VkSampler>>> samplers_;
  std::vector<Handle<VkDescriptorPool>> pools_;
  std::vector<VkDescriptorSet> free_sets_;
};

}  // namespace simvis
