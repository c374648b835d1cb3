#include "engine/render/shadow_maps.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/vulkan/texel_buffer.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

static_assert(sizeof(shader::ShadowBlock) == SIMVIS_SHADOW_ROWS * kTexelBytes);

glm::dmat4 inverse_of_rigid(const glm::dmat4& m) {
  const glm::dmat3 back = glm::transpose(glm::dmat3(m));
  glm::dmat4 inverse(back);
  inverse[3] = glm::dvec4(-(back * glm::dvec3(m[3])), 1);
  return inverse;
}

shader::ShadowBlock shadow_block_of(const ShadowUse& use, const Pass& maps, const glm::dmat4& world_from_view) {
  const View& map = maps.views[use.first_view];
  const glm::dmat4 map_from_view = map.view_from_world * world_from_view;
  const glm::dmat4 rows = glm::transpose(map_from_view);
  const Pinhole& k = map.pinhole;
  const double inverse_depth = map.orthographic ? 1 / (map.far_m - map.near_m) : 0;
  const double first = map.orthographic ? map.far_m : map.near_m, apart = glm::length(glm::dvec3(map_from_view[3]));
  return {.row_x = glm::vec4(rows[0]),
          .row_y = glm::vec4(rows[1]),
          .row_z = glm::vec4(rows[2]),
          .projection = glm::vec4(glm::dvec4(k.fx_px, k.fy_px, k.cx_px, k.cy_px)),
          .depth = glm::vec4(glm::dvec4(first, inverse_depth, apart, use.views > 1 ? 1 : 0)),
          .place = glm::vec4(map.x_px, map.y_px, map.width_px, map.height_px)};
}

}  // namespace

glm::vec4 pixel_row(const View& view, std::uint32_t supersampling) {
  const Pinhole& k = view.pinhole;
  const double samples = supersampling;
  return {glm::dvec4(samples * (view.x_px + k.cx_px), samples * (view.y_px + k.cy_px), 1 / (samples * k.fx_px),
                     1 / (samples * k.fy_px))};
}

std::vector<shader::ShadowBlock> shadow_blocks(const View& view, const Pass& maps) {
  SIMVIS_ASSERT(view.shadows.size() <= SIMVIS_MAX_SHADOWS);
  const glm::dmat4 world_from_view = inverse_of_rigid(view.view_from_world);
  std::vector<shader::ShadowBlock> blocks;
  for (const ShadowUse& use : view.shadows) {
    SIMVIS_ASSERT(use.first_view + use.views <= maps.views.size());
    blocks.push_back(shadow_block_of(use, maps, world_from_view));
  }
  return blocks;
}

ShadowMaps::ShadowMaps(DeviceImpl& device, const DescriptorLayout& set_layout)
    : device_(device), set_layout_(set_layout), set_(device, set_layout, 1, "shadow set") {
  // Shaders fetch texels by index, so the sampler does not filter.
  VkSamplerCreateInfo sampler_info{};
  sampler_info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  VkSampler sampler = VK_NULL_HANDLE;
  vk_check(vkCreateSampler(device.device, &sampler_info, nullptr, &sampler), "vkCreateSampler");
  sampler_ = Handle<VkSampler>(device, sampler, "shadow sampler");
}

void ShadowMaps::write(const FramePlan& plan, const Pass& maps, Uploads& uploads) {
  static_assert(sizeof(glm::vec4) == kTexelBytes);
  std::vector<glm::vec4> texels;
  first_texels_.clear();
  for (const Pass& pass : plan.passes) {
    for (const View& view : pass.views) {
      if (view.shadows.empty()) continue;
      texels.push_back(pixel_row(view, pass.supersampling));
      first_texels_.push_back(static_cast<std::uint32_t>(texels.size()));
      for (const shader::ShadowBlock& block : shadow_blocks(view, maps)) {
        texels.insert(texels.end(),
                      {block.row_x, block.row_y, block.row_z, block.projection, block.depth, block.place});
      }
    }
  }
  const std::span<const std::byte> bytes = std::as_bytes(std::span(texels));
  if (!blocks_ || blocks_.size() < bytes.size()) {
    blocks_ = Buffer(device_, {.name = "shadows",
                               .size = std::max<VkDeviceSize>(bytes.size(), blocks_ ? 2 * blocks_.size() : 0),
                               .usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                               .memory = MemoryKind::dynamic});
    texels_ = make_texel_view(device_, blocks_);
    write_descriptor(device_, set_layout_, set(), SIMVIS_SHADOWS, texels_.get());
  }
  uploads.write(blocks_, 0, bytes);
}

void ShadowMaps::show(const GpuImage& atlas) {
  write_descriptor(device_, set_layout_, set(), SIMVIS_SHADOW_ATLAS,
                   {.sampler = sampler_.get(),
                    .imageView = atlas.view(),
                    .imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL});
}

void ShadowMaps::name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const {
  if (!blocks_) return;
  memory.push_back({blocks_.desc().name, "shadow maps of the lights of each colour view", blocks_.memory_bytes(),
                    uploads.bytes_to(blocks_)});
}

}  // namespace simvis
