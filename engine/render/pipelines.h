// The graphics pipelines of meshes: layouts, shaders, and one pipeline per kind of surface, made when first drawn.
#pragma once

#include <optional>
#include <unordered_map>

#include <simvis/mesh.h>
#include "engine/render/shadow_pipelines.h"
#include "engine/vulkan/handle.h"
#include "engine/vulkan/render_pass.h"

namespace simvis {

/// How a run of meshes is drawn. What a pass does not show stays at its default, so that equal pipelines have equal
/// keys.
struct PipelineKey {
  /// `faded`: what a cutoff keeps is blended, all of it alike.
  enum class Surface : std::uint8_t { opaque, masked, blended, faded };

  bool color = false;      ///< the pass has a colour target
  bool depth_only = true;  ///< no colour is written: a depth pass, or blended surfaces once more for depth
  Topology topology = Topology::triangles;
  Surface surface = Surface::opaque;
  bool textured = false;
  bool unlit = false;
  bool glossy = false;       ///< lights have highlights on it
  bool metallic = false;     ///< in its own colour
  std::uint8_t maps = 0;     ///< a sum of 1 << binding of the maps that are shown, from SIMVIS_FIRST_MAP on
  std::uint16_t lights = 0;  ///< how many light it, up to SIMVIS_MAX_LIGHTS
  bool cull_back = false;
  bool fog = false;           ///< seen through air that is not clear
  bool mirrored = false;      ///< the transform turns the winding of triangles
  bool shadow_map = false;    ///< depth for a shadow map
  bool orthographic = false;  ///< in light from afar
  bool shadowed = false;      ///< something may stand in the way of its lights
  bool cpu_selected = false;  ///< vertices are shader::CpuSelectedVertex
  std::uint8_t samples = 1;   ///< of each pixel of the pass's targets: 1, 2, 4 or 8

  bool shades() const { return !depth_only || surface == Surface::masked || shadow_map; }  ///< has a fragment shader
  bool blends() const { return surface == Surface::blended || surface == Surface::faded; }
  std::uint64_t bits() const;
};

class Pipelines {
 public:
  explicit Pipelines(Device::Impl& device);

  /// Made on first use.
  VkPipeline get(const PipelineKey& key);

  std::size_t made() const { return pipelines_.size(); }  ///< so far

  VkPipelineLayout layout() const { return layout_.get(); }
  VkDescriptorSetLayout frame_set_layout() const { return frame_set_layout_.get(); }
  VkDescriptorSetLayout texture_set_layout() const { return texture_set_layout_.get(); }
  VkDescriptorSetLayout layers_set_layout() const { return layers_set_layout_.get(); }

  /// Made on first use.
  const ShadowPipelines& shadows();

  /// Made on first use.
  VkRenderPass render_pass(const RenderPassKind& kind);

 private:
  // The shaders of a pipeline and what its vertices carry.
  struct Program {
    VkPipelineShaderStageCreateInfo stages[2];
    std::uint32_t stage_count;
    VkPipelineVertexInputStateCreateInfo input;
  };
  Program program(const PipelineKey& key, const VkSpecializationInfo& constants);
  Program shadow_map_program(const PipelineKey& key, const VkSpecializationInfo& constants);
  Handle<VkPipeline> make(const PipelineKey& key);

  Device::Impl& device_;
  Handle<VkDescriptorSetLayout> frame_set_layout_, texture_set_layout_, layers_set_layout_;
  Handle<VkPipelineLayout> layout_;
  std::unordered_map<std::uint32_t, Handle<VkRenderPass>> render_passes_;
  Handle<VkShaderModule> depth_vert_, mask_vert_, color_vert_;
  Handle<VkShaderModule> mask_frag_[2];   // without and with a texture
  Handle<VkShaderModule> color_frag_[3];  // likewise, and with maps
  Handle<VkShaderModule> mapped_vert_;
  Handle<VkShaderModule> layer_frag_[3];  // as color_frag_, of transparent surfaces
  std::optional<ShadowPipelines> shadows_;
  std::unordered_map<std::uint64_t, Handle<VkPipeline>> pipelines_;
};

}  // namespace simvis
