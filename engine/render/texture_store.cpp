#include "engine/render/texture_store.h"

#include <algorithm>
#include <bit>
#include <set>
#include <string>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/vulkan/formats.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

constexpr std::uint32_t kSetsPerPool = 64;

VkSamplerAddressMode address_mode(Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case Wrap::mirrored_repeat:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case Wrap::clamp_to_edge:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

VkFilter filter(Filter filter) { return filter == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST; }

TexelKind kind_of(std::uint32_t binding, bool alpha_covers) {
  if (binding == SIMVIS_BASE_COLOR_TEXTURE) return alpha_covers ? TexelKind::covering_color : TexelKind::color;
  return binding == SIMVIS_EMISSIVE_MAP ? TexelKind::color : TexelKind::data;
}

GpuImage make_image(DeviceImpl& device, const Texture& texture, TexelKind kind) {
  SIMVIS_ASSERT(texture.width > 0 && texture.height > 0);
  SIMVIS_ASSERT(texture.rgba.size() == std::size_t{4} * texture.width * texture.height);
  const std::uint32_t limit = device.limits().maxImageDimension2D, side = std::max(texture.width, texture.height);
  if (side > limit) {
    throw InputError("texture \"" + texture.name + "\" has " + std::to_string(texture.width) + " x " +
                     std::to_string(texture.height) + " pixels, expected at most " + std::to_string(limit) +
                     " on a side on this device");
  }
  const auto levels = static_cast<std::uint32_t>(std::bit_width(side));
  return GpuImage(device, {.name = "texture " + texture.name,
                           .width = texture.width,
                           .height = texture.height,
                           .mip_levels = texture.sampler.mipmapped ? levels : 1,
                           .format = kind == TexelKind::data ? kMapFormat : kTextureFormat,
                           .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
}

}  // namespace

VkDescriptorSet TextureStore::require(const TextureSet& wanted, Uploads& uploads) {
  const auto& textures = wanted.textures;
  SetKey key{.alpha_covers = wanted.alpha_covers};
  std::ranges::transform(textures, key.textures.begin(), [](const auto& texture) { return texture.get(); });
  if (const auto found = sets_.find(key); found != sets_.end()) return found->second;
  // The shader does not read hidden textures, so any image of the set can fill their bindings.
  const auto shown = std::ranges::find_if(textures, [](const auto& texture) { return texture != nullptr; });
  SIMVIS_ASSERT(shown != textures.end());
  const auto filler = static_cast<std::uint32_t>(shown - textures.begin());
  VkDescriptorImageInfo images[SIMVIS_TEXTURES];
  for (std::uint32_t binding = 0; binding < SIMVIS_TEXTURES; ++binding) {
    const std::uint32_t source = textures[binding] ? binding : filler;
    const Entry& entry = resident(textures[source], kind_of(source, wanted.alpha_covers), uploads);
    images[binding] = {.sampler = sampler(textures[source]->sampler),
                       .imageView = entry.image.view(),
                       .imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  }
  const VkDescriptorSet set = free_set();
  for (std::uint32_t binding = 0; binding < SIMVIS_TEXTURES; ++binding) {
    write_descriptor(device_, set_layout_, set, binding, images[binding]);
  }
  return sets_.emplace(key, set).first->second;
}

const TextureStore::Entry& TextureStore::resident(const std::shared_ptr<const Texture>& texture, TexelKind kind,
                                                  Uploads& uploads) {
  const std::pair key(texture.get(), kind);
  if (const auto found = entries_.find(key); found != entries_.end()) return found->second;
  Entry entry{.texture = texture, .image = make_image(device_, *texture, kind)};
  const std::vector<MipLevel> smaller = smaller_levels(*texture, kind, *device_.threads);
  std::vector<std::span<const std::byte>> levels{std::as_bytes(std::span(texture->rgba))};
  for (const MipLevel& level : smaller) levels.push_back(std::as_bytes(std::span(level.rgba)));
  uploads.write(entry.image, levels);
  return entries_.emplace(key, std::move(entry)).first->second;
}

void TextureStore::keep_only(const std::vector<std::shared_ptr<const Material>>& materials) {
  std::set<const Texture*> wanted{nullptr};
  for (const auto& material : materials) {
    wanted.insert(material->base_color_texture.get());
    for (const SurfaceMap& map : material->maps) wanted.insert(map.texture.get());
  }
  std::erase_if(sets_, [&](const auto& set) {
    if (std::ranges::all_of(set.first.textures, [&](const Texture* texture) { return wanted.contains(texture); })) {
      return false;
    }
    free_sets_.push_back(set.second);
    return true;
  });
  std::erase_if(entries_, [&](const auto& entry) { return !wanted.contains(entry.first.first); });
}

void TextureStore::count(std::uint64_t& textures, std::uint64_t& bytes) const {
  textures = entries_.size();
  bytes = 0;
  for (const auto& [key, entry] : entries_) {
    const Texture& texture = *entry.texture;
    std::uint64_t width = texture.width, height = texture.height;
    bytes += 4 * width * height;
    while (texture.sampler.mipmapped && (width > 1 || height > 1)) {
      width = std::max<std::uint64_t>(width / 2, 1);
      height = std::max<std::uint64_t>(height / 2, 1);
      bytes += 4 * width * height;
    }
  }
}

void TextureStore::name_memory(const Uploads& uploads, const std::function<std::uint64_t(VkDescriptorSet)>& sampled,
                               std::vector<PlannedMemory>& memory) const {
  const std::size_t first = memory.size();
  for (const auto& [key, entry] : entries_) {
    std::uint64_t draws = 0;
    for (const auto& [set_key, set] : sets_) {
      if (std::ranges::find(set_key.textures, key.first) != set_key.textures.end()) draws += sampled(set);
    }
    memory.push_back(
        {entry.image.desc().name,
         draws > 0 ? "sampled in " + std::to_string(draws) + " draws" : "a material shows it, in no view of this frame",
         entry.image.memory_bytes(), uploads.bytes_to(entry.image)});
  }
  std::sort(memory.begin() + static_cast<std::ptrdiff_t>(first), memory.end(),
            [](const PlannedMemory& a, const PlannedMemory& b) { return a.name < b.name; });
}

void TextureStore::clear() { keep_only({}); }

VkSampler TextureStore::sampler(const Sampler& wanted) {
  for (const auto& [known, handle] : samplers_) {
    if (known == wanted) return handle.get();
  }
  VkSamplerCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  info.magFilter = filter(wanted.magnify);
  info.minFilter = filter(wanted.minify);
  info.mipmapMode =
      wanted.between_mips == Filter::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = address_mode(wanted.wrap_u);
  info.addressModeV = address_mode(wanted.wrap_v);
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  info.maxLod = VK_LOD_CLAMP_NONE;
  if (!wanted.mipmapped) {
    // The Vulkan specification gives these values for samplers without mips: with nearest mips and a maximum level of a
    // quarter, minification and magnification can still be distinguished.
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
    info.maxLod = 0.25f;
  }
  VkSampler sampler = VK_NULL_HANDLE;
  vk_check(vkCreateSampler(device_.device, &info, nullptr, &sampler), "vkCreateSampler");
  samplers_.emplace_back(wanted, Handle<VkSampler>(device_, sampler, "texture sampler"));
  return sampler;
}

VkDescriptorSet TextureStore::free_set() {
  if (free_sets_.empty()) {
    const std::span<const VkDescriptorSet> sets =
        made_sets_.emplace_back(device_, set_layout_, kSetsPerPool, "texture sets").all();
    free_sets_.assign(sets.begin(), sets.end());
  }
  const VkDescriptorSet set = free_sets_.back();
  free_sets_.pop_back();
  return set;
}

}  // namespace simvis
