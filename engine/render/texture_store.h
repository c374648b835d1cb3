// The device images of the textures that a draw list shows.
#pragma once

#include <array>
#include <compare>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/mesh.h>
#include "engine/draw/mip_levels.h"
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/gpu_image.h"
#include "engine/vulkan/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// The visible textures of a material.
struct TextureSet {
  /// By binding; null if the material has no such texture or does not show it.
  std::array<std::shared_ptr<const Texture>, SIMVIS_TEXTURES> textures;
  bool alpha_covers = false;  ///< whether alpha of the base colour is a covered share: it is not ignored

  bool operator==(const TextureSet&) const = default;
};

/// Textures are identified by address, uploaded when first needed, and released when the list no longer contains them.
class TextureStore {
 public:
  TextureStore(DeviceImpl& device, const DescriptorLayout& set_layout) : device_(device), set_layout_(set_layout) {}

  /// Returns the descriptor set of at least one texture, and uploads the textures that are not resident.
  /// Throws InputError if a texture is larger than the device allows.
  VkDescriptorSet require(const TextureSet& wanted, Uploads& uploads);

  /// Appends the images of this object to `memory`. `sampled` returns the number of draws of this frame that read a
  /// set.
  void name_memory(const Uploads& uploads, const std::function<std::uint64_t(VkDescriptorSet)>& sampled,
                   std::vector<PlannedMemory>& memory) const;

  /// Releases the textures that no material in `materials` uses.
  void keep_only(const std::vector<std::shared_ptr<const Material>>& materials);

  /// Returns the number of textures and the size of their texels in bytes, all mip levels included.
  void count(std::uint64_t& textures, std::uint64_t& bytes) const;

  void clear();

 private:
  struct Entry {
    std::shared_ptr<const Texture> texture;  // ownership prevents reuse of the address by another texture
    GpuImage image;
  };
  struct SetKey {
    std::array<const Texture*, SIMVIS_TEXTURES> textures{};
    bool alpha_covers = false;
    auto operator<=>(const SetKey&) const = default;
  };
  const Entry& resident(const std::shared_ptr<const Texture>& texture, TexelKind kind, Uploads& uploads);
  VkSampler sampler(const Sampler& sampler);
  VkDescriptorSet free_set();

  DeviceImpl& device_;
  const DescriptorLayout& set_layout_;
  std::map<std::pair<const Texture*, TexelKind>, Entry> entries_;
  std::map<SetKey, VkDescriptorSet> sets_;
  std::vector<std::pair<Sampler, Handle<VkSampler>>> samplers_;
  std::vector<DescriptorSets> made_sets_;
  std::vector<VkDescriptorSet> free_sets_;
};

}  // namespace simvis
