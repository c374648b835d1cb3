#include "engine/render/pipelines.h"

#include <bit>
#include <cstddef>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/render/geometry_pool.h"
#include "engine/vulkan/pipeline_parts.h"
#include "shaders/interop.h"
#include "shaders/mesh_color.frag.h"
#include "shaders/mesh_color.vert.h"
#include "shaders/mesh_color_mapped.frag.h"
#include "shaders/mesh_color_mapped.vert.h"
#include "shaders/mesh_color_mapped_shadowed.frag.h"
#include "shaders/mesh_color_shadowed.frag.h"
#include "shaders/mesh_color_textured.frag.h"
#include "shaders/mesh_color_textured_shadowed.frag.h"
#include "shaders/mesh_depth.vert.h"
#include "shaders/mesh_item.frag.h"
#include "shaders/mesh_item.vert.h"
#include "shaders/mesh_item_mask.frag.h"
#include "shaders/mesh_item_mask.vert.h"
#include "shaders/mesh_item_mask_textured.frag.h"
#include "shaders/mesh_layer.frag.h"
#include "shaders/mesh_layer_mapped.frag.h"
#include "shaders/mesh_layer_mapped_shadowed.frag.h"
#include "shaders/mesh_layer_shadowed.frag.h"
#include "shaders/mesh_layer_textured.frag.h"
#include "shaders/mesh_layer_textured_shadowed.frag.h"
#include "shaders/mesh_mask.frag.h"
#include "shaders/mesh_mask.vert.h"
#include "shaders/mesh_mask_instance.frag.h"
#include "shaders/mesh_mask_instance.vert.h"
#include "shaders/mesh_mask_instance_textured.frag.h"
#include "shaders/mesh_mask_textured.frag.h"
#include "shaders/mesh_shadow.frag.h"
#include "shaders/mesh_shadow_mask.frag.h"
#include "shaders/mesh_shadow_mask_textured.frag.h"

namespace simvis {
namespace {

using Surface = PipelineKey::Surface;

// Vertex buffers: positions, instances, and other attributes for the pipelines that read them.
constexpr VkVertexInputBindingDescription kBindings[] = {{0, sizeof(glm::vec3), VK_VERTEX_INPUT_RATE_VERTEX},
                                                         {1, sizeof(shader::Instance), VK_VERTEX_INPUT_RATE_INSTANCE},
                                                         {2, sizeof(PackedAttributes), VK_VERTEX_INPUT_RATE_VERTEX}};
constexpr VkVertexInputBindingDescription kItemBindings[] = {
    kBindings[0], kBindings[1], {kItemBinding, sizeof(std::uint32_t), VK_VERTEX_INPUT_RATE_INSTANCE}, kBindings[2]};

// Exactly the inputs that each vertex shader reads.
constexpr VkVertexInputAttributeDescription kPosition{SIMVIS_POSITION, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
constexpr VkVertexInputAttributeDescription kNormal{SIMVIS_NORMAL, 2, VK_FORMAT_R16G16B16A16_SNORM,
                                                    offsetof(PackedAttributes, normal)};
constexpr VkVertexInputAttributeDescription kUv0{SIMVIS_UV_0, 2, VK_FORMAT_R32G32_SFLOAT,
                                                 offsetof(PackedAttributes, uv)};
constexpr VkVertexInputAttributeDescription kUv1{SIMVIS_UV_1, 2, VK_FORMAT_R32G32_SFLOAT,
                                                 offsetof(PackedAttributes, uv) + 2 * sizeof(float)};
constexpr VkVertexInputAttributeDescription kColor{SIMVIS_COLOR, 2, VK_FORMAT_R16G16B16A16_UNORM,
                                                   offsetof(PackedAttributes, color)};
constexpr VkVertexInputAttributeDescription kClipX{SIMVIS_INSTANCE_CLIP_X, 1, VK_FORMAT_R32G32B32A32_SFLOAT,
                                                   offsetof(shader::Instance, clip_x)};
constexpr VkVertexInputAttributeDescription kClipY{SIMVIS_INSTANCE_CLIP_Y, 1, VK_FORMAT_R32G32B32A32_SFLOAT,
                                                   offsetof(shader::Instance, clip_y)};
constexpr VkVertexInputAttributeDescription kClipW{SIMVIS_INSTANCE_CLIP_W, 1, VK_FORMAT_R32G32B32A32_SFLOAT,
                                                   offsetof(shader::Instance, clip_w)};
constexpr VkVertexInputAttributeDescription kMaterial{SIMVIS_INSTANCE_MATERIAL, 1, VK_FORMAT_R32_UINT,
                                                      offsetof(shader::Instance, material)};
constexpr VkVertexInputAttributeDescription kError{SIMVIS_INSTANCE_ERROR, 1, VK_FORMAT_R32_SFLOAT,
                                                   offsetof(shader::Instance, error_m)};
constexpr VkVertexInputAttributeDescription kItem{SIMVIS_INSTANCE_ITEM, kItemBinding, VK_FORMAT_R32_UINT, 0};
constexpr VkVertexInputAttributeDescription kDepthInputs[] = {kPosition, kClipX, kClipY, kClipW};
constexpr VkVertexInputAttributeDescription kMaskInputs[] = {kPosition, kClipX, kClipY, kClipW,
                                                             kMaterial, kUv0,   kUv1,   kColor};
constexpr VkVertexInputAttributeDescription kItemInputs[] = {kPosition, kClipX, kClipY, kClipW, kItem};
constexpr VkVertexInputAttributeDescription kMaskedItemInputs[] = {kPosition, kClipX, kClipY, kClipW, kItem,
                                                                   kMaterial, kUv0,   kUv1,   kColor};
constexpr VkVertexInputAttributeDescription kColorInputs[] = {kPosition, kClipX,  kClipY, kClipW, kMaterial,
                                                              kError,    kNormal, kUv0,   kUv1,   kColor};

// Inputs of a CPU-selected vertex, which contains the rows of its instance.
constexpr VkVertexInputBindingDescription kCpuSelectedBinding{0, sizeof(shader::CpuSelectedVertex),
                                                              VK_VERTEX_INPUT_RATE_VERTEX};
constexpr std::uint32_t kRows = offsetof(shader::CpuSelectedVertex, clip_x);
constexpr VkVertexInputAttributeDescription kCpuSelectedInputs[] = {
    kPosition,
    {SIMVIS_INSTANCE_CLIP_X, 0, kClipX.format, kRows + kClipX.offset},
    {SIMVIS_INSTANCE_CLIP_Y, 0, kClipY.format, kRows + kClipY.offset},
    {SIMVIS_INSTANCE_CLIP_W, 0, kClipW.format, kRows + kClipW.offset}};

VkPipelineVertexInputStateCreateInfo cpu_selected_input() {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
          .pNext = nullptr,
          .flags = 0,
          .vertexBindingDescriptionCount = 1,
          .pVertexBindingDescriptions = &kCpuSelectedBinding,
          .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(std::size(kCpuSelectedInputs)),
          .pVertexAttributeDescriptions = kCpuSelectedInputs};
}

VkPipelineVertexInputStateCreateInfo vertex_input(std::span<const VkVertexInputAttributeDescription> inputs) {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
          .pNext = nullptr,
          .flags = 0,
          .vertexBindingDescriptionCount = inputs.size() > std::size(kDepthInputs) ? 3u : 2u,
          .pVertexBindingDescriptions = kBindings,
          .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(inputs.size()),
          .pVertexAttributeDescriptions = inputs.data()};
}

// As vertex_input(), for inputs with kItem.
VkPipelineVertexInputStateCreateInfo item_input(std::span<const VkVertexInputAttributeDescription> inputs) {
  VkPipelineVertexInputStateCreateInfo input = vertex_input(inputs);
  input.vertexBindingDescriptionCount = inputs.size() > std::size(kItemInputs) ? 4u : 3u;
  input.pVertexBindingDescriptions = kItemBindings;
  return input;
}

VkPrimitiveTopology primitive(Topology topology) {
  switch (topology) {
    case Topology::triangles:
      return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    case Topology::lines:
      return VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
    case Topology::points:
      return VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
  }
  return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
}

VkPipelineRasterizationStateCreateInfo rasterization(const PipelineKey& key) {
  VkPipelineRasterizationStateCreateInfo info{};
  info.polygonMode = VK_POLYGON_MODE_FILL;
  info.cullMode = key.cull_back ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
  info.frontFace = key.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE;
  return info;
}

VkPipelineDepthStencilStateCreateInfo depth_stencil(const PipelineKey& key) {
  VkPipelineDepthStencilStateCreateInfo info{};
  info.depthTestEnable = VK_TRUE;
  info.depthWriteEnable = !key.blends();
  info.depthCompareOp = VK_COMPARE_OP_GREATER;
  return info;
}

// Alpha keeps the clear value, or holds the instance. Transparent surfaces are stored as OIT layers instead.
VkPipelineColorBlendAttachmentState color_blend(const PipelineKey& key) {
  VkPipelineColorBlendAttachmentState state{};
  if (key.items) state.colorWriteMask = key.color ? VK_COLOR_COMPONENT_A_BIT : VK_COLOR_COMPONENT_R_BIT;
  if (!key.depth_only && !key.blends()) {
    state.colorWriteMask |= VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
  }
  return state;
}

// The specialization constants of a shader, 4 bytes each, in the order of their numbers.
struct Constants {
  static constexpr std::uint32_t kCount = 17;
  std::uint32_t values[kCount];
  VkSpecializationMapEntry entries[kCount];
  VkSpecializationInfo info{kCount, entries, sizeof values, values};

  explicit Constants(const PipelineKey& key) {
    values[SIMVIS_MASKED] = key.surface == Surface::masked || key.surface == Surface::faded;
    values[SIMVIS_UNLIT] = key.unlit;
    values[SIMVIS_DIRECTIONAL_LIGHTS] = key.lights.directional;
    values[SIMVIS_POINT_LIGHTS] = key.lights.point;
    values[SIMVIS_SPOT_LIGHTS] = key.lights.spot;
    values[SIMVIS_RANGED] = key.lights.ranged;
    values[SIMVIS_ALIKE_POINT_LIGHTS] = key.lights.alike_point;
    values[SIMVIS_ALIKE_SPOT_LIGHTS] = key.lights.alike_spot;
    values[SIMVIS_FADED] = key.surface == Surface::faded;
    values[SIMVIS_GLOSSY] = key.glossy;
    values[SIMVIS_SHADOWED] = key.shadowed;
    values[SIMVIS_ORTHOGRAPHIC] = key.orthographic;
    values[SIMVIS_METALLIC] = key.metallic;
    values[SIMVIS_MAPS] = key.maps == 0 ? 0u : key.maps | (key.textured ? 1u << SIMVIS_BASE_COLOR_TEXTURE : 0u);
    values[SIMVIS_FOG] = key.fog;
    values[SIMVIS_ITEMS] = key.items;
    values[SIMVIS_POINTS] = key.topology == Topology::points;
    constexpr std::uint32_t kSize = sizeof values[0];
    for (std::uint32_t i = 0; i < kCount; ++i) entries[i] = {i, i * kSize, kSize};
  }
  Constants(const Constants&) = delete;
};

}  // namespace

std::uint64_t PipelineKey::bits() const {
  constexpr int kLightBits = 9;  // of each count
  std::uint64_t bits = static_cast<std::uint64_t>(topology) | static_cast<std::uint64_t>(surface) << 2;
  for (const bool flag :
       {color, depth_only, textured, unlit, glossy, metallic, cull_back, mirrored, shadow_map, orthographic, shadowed,
        fog, items, cpu_selected, lights.ranged, lights.alike_point, lights.alike_spot}) {
    bits = bits << 1 | (flag ? 1u : 0u);
  }
  bits = bits << SIMVIS_TEXTURES | maps;
  static_assert(SIMVIS_MAX_LIGHTS < 1 << kLightBits);
  for (const std::uint16_t count : {lights.directional, lights.point, lights.spot}) bits = bits << kLightBits | count;
  return bits << 3 | static_cast<std::uint64_t>(std::countr_zero(samples));
}

ShadowPipelines::ShadowPipelines(DeviceImpl& device, std::span<const VkDescriptorSetLayout> mesh_sets)
    : map_frag(make_module(device, mesh_shadow_frag, "mesh_shadow.frag")),
      map_mask_frag{make_module(device, mesh_shadow_mask_frag, "mesh_shadow_mask.frag"),
                    make_module(device, mesh_shadow_mask_textured_frag, "mesh_shadow_mask_textured.frag")},
      color_frag{make_module(device, mesh_color_shadowed_frag, "mesh_color_shadowed.frag"),
                 make_module(device, mesh_color_textured_shadowed_frag, "mesh_color_textured_shadowed.frag"),
                 make_module(device, mesh_color_mapped_shadowed_frag, "mesh_color_mapped_shadowed.frag")},
      layer_frag{make_module(device, mesh_layer_shadowed_frag, "mesh_layer_shadowed.frag"),
                 make_module(device, mesh_layer_textured_shadowed_frag, "mesh_layer_textured_shadowed.frag"),
                 make_module(device, mesh_layer_mapped_shadowed_frag, "mesh_layer_mapped_shadowed.frag")} {
  const VkDescriptorSetLayoutBinding bindings[] = {
      descriptor_binding(SIMVIS_SHADOWS, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT),
      descriptor_binding(SIMVIS_SHADOW_ATLAS, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_SHADER_STAGE_FRAGMENT_BIT)};
  set_layout = DescriptorLayout(device, bindings, "shadow set layout");
  std::vector<VkDescriptorSetLayout> sets(mesh_sets.begin(), mesh_sets.end());
  sets.push_back(set_layout.get());
  layout = make_mesh_layout(device, sets, "mesh pipeline layout with shadows");
}

ItemShaders::ItemShaders(DeviceImpl& device)
    : vert(make_module(device, mesh_item_vert, "mesh_item.vert")),
      frag(make_module(device, mesh_item_frag, "mesh_item.frag")),
      mask_vert(make_module(device, mesh_item_mask_vert, "mesh_item_mask.vert")),
      mask_frag{make_module(device, mesh_item_mask_frag, "mesh_item_mask.frag"),
                make_module(device, mesh_item_mask_textured_frag, "mesh_item_mask_textured.frag")},
      instance_vert(make_module(device, mesh_mask_instance_vert, "mesh_mask_instance.vert")),
      instance_frag{make_module(device, mesh_mask_instance_frag, "mesh_mask_instance.frag"),
                    make_module(device, mesh_mask_instance_textured_frag, "mesh_mask_instance_textured.frag")} {}

Pipelines::Pipelines(std::shared_ptr<SharedDevice> device)
    : device_(std::move(device)),
      depth_vert_(make_module(device_, mesh_depth_vert, "mesh_depth.vert")),
      mask_vert_(make_module(device_, mesh_mask_vert, "mesh_mask.vert")),
      color_vert_(make_module(device_, mesh_color_vert, "mesh_color.vert")),
      mask_frag_{make_module(device_, mesh_mask_frag, "mesh_mask.frag"),
                 make_module(device_, mesh_mask_textured_frag, "mesh_mask_textured.frag")},
      color_frag_{make_module(device_, mesh_color_frag, "mesh_color.frag"),
                  make_module(device_, mesh_color_textured_frag, "mesh_color_textured.frag"),
                  make_module(device_, mesh_color_mapped_frag, "mesh_color_mapped.frag")},
      mapped_vert_(make_module(device_, mesh_color_mapped_vert, "mesh_color_mapped.vert")),
      layer_frag_{make_module(device_, mesh_layer_frag, "mesh_layer.frag"),
                  make_module(device_, mesh_layer_textured_frag, "mesh_layer_textured.frag"),
                  make_module(device_, mesh_layer_mapped_frag, "mesh_layer_mapped.frag")} {
  const VkDescriptorSetLayoutBinding frame_bindings[] = {
      descriptor_binding(SIMVIS_MATERIALS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_VERTEX_BIT),
      descriptor_binding(SIMVIS_LIGHTS, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT),
      descriptor_binding(SIMVIS_MAP_PLACES, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_VERTEX_BIT)};
  frame_set_layout_ = DescriptorLayout(device_, frame_bindings, "frame set layout");
  VkDescriptorSetLayoutBinding texture_bindings[SIMVIS_TEXTURES];
  for (std::uint32_t binding = 0; binding < SIMVIS_TEXTURES; ++binding) {
    texture_bindings[binding] =
        descriptor_binding(binding, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_SHADER_STAGE_FRAGMENT_BIT);
  }
  texture_set_layout_ = DescriptorLayout(device_, texture_bindings, "texture set layout");

  const VkDescriptorSetLayoutBinding layer_bindings[] = {
      descriptor_binding(SIMVIS_LAYER_LISTS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT),
      descriptor_binding(SIMVIS_LAYER_NODES, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT)};
  layers_set_layout_ = DescriptorLayout(device_, layer_bindings, "layers set layout");

  const VkDescriptorSetLayout sets[] = {frame_set_layout_.get(), texture_set_layout_.get(), layers_set_layout_.get()};
  layout_ = make_mesh_layout(device_, sets, "mesh pipeline layout");
}

VkRenderPass Pipelines::render_pass(const RenderPassKind& kind) {
  const std::lock_guard lock(making_);
  return locked_render_pass(kind);
}

VkRenderPass Pipelines::locked_render_pass(const RenderPassKind& kind) {
  const auto [place, added] = render_passes_.try_emplace(kind.bits());
  if (!place->second) place->second = make_render_pass(device_, kind);
  return place->second.get();
}

const ShadowPipelines& Pipelines::shadows() {
  const std::lock_guard lock(making_);
  return locked_shadows();
}

const ShadowPipelines& Pipelines::locked_shadows() {
  if (!shadows_) {
    const VkDescriptorSetLayout sets[] = {frame_set_layout_.get(), texture_set_layout_.get(), layers_set_layout_.get()};
    shadows_.emplace(device_, sets);
  }
  return *shadows_;
}

VkPipeline Pipelines::get(const PipelineKey& key) {
  const std::lock_guard lock(making_);
  const auto [place, added] = pipelines_.try_emplace(key.bits());
  if (!place->second) place->second = make(key);
  return place->second.get();
}

std::size_t Pipelines::made() {
  const std::lock_guard lock(making_);
  return pipelines_.size();
}

Pipelines::Program Pipelines::program(const PipelineKey& key, const VkSpecializationInfo& constants) {
  if (key.shadow_map) return shadow_map_program(key, constants);
  // Without colour, vertex shaders have constants for points alone.
  const VkSpecializationInfo* const of_points = key.topology == Topology::points ? &constants : nullptr;
  if (key.items && key.depth_only) return item_program(key, of_points);
  if (!key.depth_only) {
    const std::size_t look = key.maps != 0 ? 2 : key.textured ? 1 : 0;
    const Handle<VkShaderModule>& fragments = key.blends()
                                                  ? (key.shadowed ? locked_shadows().layer_frag : layer_frag_)[look]
                                                  : (key.shadowed ? locked_shadows().color_frag : color_frag_)[look];
    return {
        {shader_stage(VK_SHADER_STAGE_VERTEX_BIT, key.maps != 0 ? mapped_vert_.get() : color_vert_.get(), &constants),
         shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragments.get(), &constants)},
        2,
        vertex_input(kColorInputs)};
  }
  if (key.surface == Surface::masked) {
    return {{shader_stage(VK_SHADER_STAGE_VERTEX_BIT, mask_vert_.get(), of_points),
             shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, mask_frag_[key.textured].get())},
            2,
            vertex_input(kMaskInputs)};
  }
  return {{shader_stage(VK_SHADER_STAGE_VERTEX_BIT, depth_vert_.get(), of_points)},
          1,
          key.cpu_selected ? cpu_selected_input() : vertex_input(kDepthInputs)};
}

Pipelines::Program Pipelines::item_program(const PipelineKey& key, const VkSpecializationInfo* of_points) {
  if (!items_) items_.emplace(device_);
  const bool masked = key.surface == Surface::masked;
  if (key.color) {
    SIMVIS_ASSERT(masked);
    return {{shader_stage(VK_SHADER_STAGE_VERTEX_BIT, items_->instance_vert.get(), of_points),
             shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, items_->instance_frag[key.textured].get())},
            2,
            vertex_input(kMaskInputs)};
  }
  const VkShaderModule vertices = masked ? items_->mask_vert.get() : items_->vert.get();
  const VkShaderModule fragments = masked ? items_->mask_frag[key.textured].get() : items_->frag.get();
  return {{shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertices, of_points),
           shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragments)},
          2,
          masked ? item_input(kMaskedItemInputs) : item_input(kItemInputs)};
}

Pipelines::Program Pipelines::shadow_map_program(const PipelineKey& key, const VkSpecializationInfo& constants) {
  const bool masked = key.surface == Surface::masked;
  const VkShaderModule vertices = masked ? mask_vert_.get() : depth_vert_.get();
  const VkShaderModule fragments =
      masked ? locked_shadows().map_mask_frag[key.textured].get() : locked_shadows().map_frag.get();
  return {{shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertices, &constants),
           shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragments)},
          2,
          masked ? vertex_input(kMaskInputs) : vertex_input(kDepthInputs)};
}

Handle<VkPipeline> Pipelines::make(const PipelineKey& key) {
  const Constants constants(key);
  const Program shaders = program(key, constants.info);
  SIMVIS_ASSERT((shaders.stage_count == 2) == key.shades());
  const VkPipelineColorBlendAttachmentState color = color_blend(key);
  const GraphicsPipelineDesc desc{
      .stages = {shaders.stages, shaders.stage_count},
      .input = shaders.input,
      .topology = primitive(key.topology),
      .raster = rasterization(key),
      .samples = key.samples,
      .depth = depth_stencil(key),
      .colors = {&color, key.color || key.items ? 1u : 0u},
      .layout = key.shadowed ? locked_shadows().layout.get() : layout_.get(),
      .render_pass = locked_render_pass(
          {.color = key.color, .items = key.items && !key.color, .sampled = key.shadow_map, .samples = key.samples})};
  return make_pipeline(device_, desc, "mesh pipeline " + std::to_string(key.bits()));
}

std::shared_ptr<Pipelines> shared_pipelines(const DeviceImpl& device) {
  static std::mutex mutex;
  static std::map<const SharedDevice*, std::weak_ptr<Pipelines>> known;
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  std::shared_ptr<Pipelines> pipelines = known[device.shared.get()].lock();
  if (pipelines == nullptr) {
    pipelines = std::make_shared<Pipelines>(device.shared);
    known[device.shared.get()] = pipelines;
  }
  return pipelines;
}

}  // namespace simvis
