#include "engine/render/sky_backdrop.h"

#include <algorithm>
#include <span>
#include <string>

#include <simvis/error.h>
#include "engine/geometry/view_projection.h"
#include "engine/vulkan/formats.h"
#include "engine/vulkan/pipeline_parts.h"
#include "engine/vulkan/vulkan_check.h"
#include "shaders/interop.h"
#include "shaders/sky.frag.h"
#include "shaders/sky.vert.h"

namespace simvis {
namespace {

constexpr const char* kSkyImage = "picture of the sky";

Handle<VkSampler> make_sky_sampler(DeviceImpl& device) {
  VkSamplerCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  VkSampler sampler = VK_NULL_HANDLE;
  vk_check(vkCreateSampler(device.device, &info, nullptr, &sampler), "vkCreateSampler");
  return Handle<VkSampler>(device, sampler, "sky sampler");
}

shader::SkyBlock sky_block(const DrawList& list, const Pass& pass, const View& view) {
  const glm::dmat3 world_from_sky(list.world_from_node[list.sky.transform]), view_from_world(view.view_from_world);
  const glm::dmat3 sky_from_view = glm::inverse(view_from_world * world_from_sky);
  const ViewProjection projection = make_projection(view);
  // A point of the picture plane from its clip coordinates, see ViewBlock::projection.
  const glm::dmat3 view_from_clip(1 / projection.scale_x, 0, 0, 0, 1 / projection.scale_y, 0,
                                  -projection.shift_x / projection.scale_x, -projection.shift_y / projection.scale_y,
                                  1);
  const glm::dmat3 rows = glm::transpose(sky_from_view * view_from_clip);
  return {.row_x = glm::vec4(glm::dvec4(rows[0], 0)),
          .row_y = glm::vec4(glm::dvec4(rows[1], 0)),
          .row_z = glm::vec4(glm::dvec4(rows[2], 0)),
          .brightness = glm::vec4(list.sky.factor, pass.items ? -1 : 1, 0, 0)};
}

}  // namespace

SkyBackdrop::SkyBackdrop(DeviceImpl& device, Pipelines& pipelines)
    : device_(device),
      pipelines_(pipelines),
      vert_(make_module(device, sky_vert, "sky.vert")),
      frag_(make_module(device, sky_frag, "sky.frag")),
      sampler_(make_sky_sampler(device)),
      set_(device, pipelines.texture_set_layout(), 1, "sky set") {}

void SkyBackdrop::show(const std::shared_ptr<const SkyPicture>& picture, Uploads& uploads) {
  if (picture == picture_) return;
  const std::uint32_t limit = device_.limits().maxImageDimension2D;
  if (std::max(picture->width, picture->height) > limit) {
    throw InputError("the picture of the sky has " + std::to_string(picture->width) + " x " +
                     std::to_string(picture->height) + " pixels, expected at most " + std::to_string(limit) +
                     " on a side on this device");
  }
  picture_ = nullptr;
  image_ = GpuImage(device_, {.name = kSkyImage,
                              .width = picture->width,
                              .height = picture->height,
                              .format = kColorFormat,
                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  std::vector<glm::vec4> texels(picture->radiance.size());
  std::ranges::transform(picture->radiance, texels.begin(), [](const glm::vec3& each) { return glm::vec4(each, 1); });
  const std::span<const std::byte> level = std::as_bytes(std::span(texels));
  uploads.write(image_, {&level, 1});
  const VkDescriptorImageInfo info{
      .sampler = sampler_.get(), .imageView = image_.view(), .imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  // The shader reads the first texture only; the set has the layout of those of materials.
  for (std::uint32_t binding = 0; binding < SIMVIS_TEXTURES; ++binding) {
    write_descriptor(device_, pipelines_.texture_set_layout(), set_.get(), binding, info);
  }
  picture_ = picture;
}

bool SkyBackdrop::record(VkCommandBuffer commands, const DrawList& list, const Pass& pass, const View& view) {
  const std::size_t known = made_.size();
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline(pass.msaa));
  const VkDescriptorSet set = set_.get();
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout(), SIMVIS_TEXTURE_SET, 1, &set,
                          0, nullptr);
  const shader::SkyBlock block = sky_block(list, pass, view);
  static_assert(sizeof block <= sizeof(shader::ViewBlock));
  vkCmdPushConstants(commands, pipelines_.layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                     sizeof block, &block);
  vkCmdDraw(commands, 3, 1, 0, 0);
  return made_.size() > known;
}

VkPipeline SkyBackdrop::pipeline(std::uint32_t samples) {
  Handle<VkPipeline>& known = made_[samples];
  if (known) return known.get();
  const VkPipelineShaderStageCreateInfo stages[] = {shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vert_.get()),
                                                    shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, frag_.get())};
  VkPipelineColorBlendAttachmentState color{};
  color.colorWriteMask =
      VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{};
  depth.depthTestEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER_OR_EQUAL;  // its depth 0 is that of what nothing has been drawn over
  known = make_pipeline(device_,
                        {.stages = stages,
                         .samples = samples,
                         .depth = depth,
                         .colors = {&color, 1},
                         .layout = pipelines_.layout(),
                         .render_pass = pipelines_.render_pass({.color = true, .samples = samples})},
                        "sky");
  return known.get();
}

void SkyBackdrop::name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const {
  if (!image_) return;
  memory.push_back({kSkyImage, "seen where nothing is hit", image_.memory_bytes(), uploads.bytes_to(image_)});
}

}  // namespace simvis
