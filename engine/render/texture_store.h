// The textures that a draw list shows, on the device.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/mesh.h>
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/gpu_image.h"
#include "engine/vulkan/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// What is shown of a material's textures, by binding; null where there is none, or none is shown.
using TextureSet = std::array<std::shared_ptr<const Texture>, SIMVIS_TEXTURES>;

/// Textures are told apart by identity, uploaded on first need, and forgotten once a list no longer holds them.
class TextureStore {
 public:
  TextureStore(Device::Impl& device, const DescriptorLayout& set_layout) : device_(device), set_layout_(set_layout) {}

  /// The descriptor set of some textures, at least one; uploads those that are not resident.
  /// Throws InputError when one is larger than the device allows.
  VkDescriptorSet require(const TextureSet& textures, Uploads& uploads);

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
  };
  const Entry& resident(const std::shared_ptr<const Texture>& texture, VkFormat format, Uploads& uploads);
  VkSampler sampler(const Sampler& sampler);
  VkDescriptorSet free_set();

  Device::Impl& device_;
  const DescriptorLayout& set_layout_;
  std::map<std::pair<const Texture*, VkFormat>, Entry> entries_;
  std::map<std::array<const Texture*, SIMVIS_TEXTURES>, VkDescriptorSet> sets_;
  std::vector<std::pair<Sampler, Handle<VkSampler>>> samplers_;
  std::vector<DescriptorSets> made_sets_;
  std::vector<VkDescriptorSet> free_sets_;
};

}  // namespace simvis
