// The graphics pipelines of meshes: layouts, shaders and one pipeline per kind of surface, created on first use.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>

#include <simvis/mesh.h>
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/handle.h"
#include "engine/vulkan/render_pass.h"

namespace simvis {

/// The lights of a view, by kind.
struct LightCounts {
  std::uint16_t directional = 0, point = 0, spot = 0;  ///< together at most SIMVIS_MAX_LIGHTS
  bool ranged = false;                                 ///< a light has a range
  /// The lights of the kind, two or more, have the same direction, cone and intensity: their shaders read these once.
  bool alike_point = false, alike_spot = false;

  std::uint32_t all() const { return std::uint32_t{directional} + point + spot; }
  bool any() const { return all() > 0; }
  bool operator==(const LightCounts&) const = default;
};

/// Selects the pipeline of a run of meshes. Fields that have no effect in a pass keep their defaults, so that equal
/// pipelines have equal keys.
struct PipelineKey {
  /// `faded`: fragments that pass the alpha cutoff are blended with one opacity for the whole surface.
  enum class Surface : std::uint8_t { opaque, masked, blended, faded };

  bool color = false;      ///< the pass has a colour target
  bool depth_only = true;  ///< no colour is written: a depth pass, or the second draw of blended surfaces for depth
  Topology topology = Topology::triangles;
  Surface surface = Surface::opaque;
  bool textured = false;
  bool unlit = false;
  bool glossy = false;    ///< lights produce specular highlights
  bool metallic = false;  ///< highlights have the colour of the surface
  std::uint8_t maps = 0;  ///< bit mask of the maps that are shown, bit number = binding, from SIMVIS_FIRST_MAP on
  LightCounts lights{};   ///< none for unlit surfaces
  bool cull_back = false;
  bool fog = false;           ///< the medium has an extinction above 0
  bool mirrored = false;      ///< the transform reverses the winding of triangles
  bool shadow_map = false;    ///< depth for a shadow map
  bool orthographic = false;  ///< orthographic view, as for the shadow map of a directional light
  bool shadowed = false;      ///< the surface reads shadow maps
  bool items = false;         ///< the pass has a target of items or, with colour, alpha holds the instance
  bool cpu_selected = false;  ///< vertices are shader::CpuSelectedVertex
  std::uint8_t samples = 1;   ///< per pixel of the targets of the pass: 1, 2, 4 or 8

  bool shades() const {
    return !depth_only || surface == Surface::masked || shadow_map || items;
  }  ///< has a fragment shader
  bool blends() const { return surface == Surface::blended || surface == Surface::faded; }
  std::uint64_t bits() const;
};

/// Additional layouts and shaders for pipelines of scenes with shadows, made when the first such pipeline is needed.
struct ShadowPipelines {
  /// `mesh_sets`: the set layouts of all mesh pipelines, see Pipelines.
  ShadowPipelines(DeviceImpl& device, std::span<const VkDescriptorSetLayout> mesh_sets);

  DescriptorLayout set_layout;              ///< SIMVIS_SHADOW_SET
  Handle<VkPipelineLayout> layout;          ///< the layout of all meshes, followed by this set
  Handle<VkShaderModule> map_frag;          ///< depth of opaque surfaces in a shadow map
  Handle<VkShaderModule> map_mask_frag[2];  ///< depth of masked surfaces, without and with a texture
  Handle<VkShaderModule> color_frag[3];     ///< colour with shadows, without a texture, with a texture, with maps
  Handle<VkShaderModule> layer_frag[3];     ///< as color_frag, for transparent surfaces
};

/// The vertex buffer binding of the instances' items; the other bindings are as in passes without items.
inline constexpr std::uint32_t kItemBinding = 3;

/// The shaders of passes that read back items. Made when a plan first has items.
struct ItemShaders {
  explicit ItemShaders(DeviceImpl& device);

  Handle<VkShaderModule> vert, frag;    ///< of opaque surfaces
  Handle<VkShaderModule> mask_vert;     ///< of masked surfaces
  Handle<VkShaderModule> mask_frag[2];  ///< without and with a texture
  /// Draw masked surfaces in a colour pass, whose alpha holds the instance. [0]: without a texture, [1]: with one.
  Handle<VkShaderModule> instance_vert, instance_frag[2];
};

/// The renderers of a device share them, whatever their simulation.
///
/// Lifetime  pipelines and layouts live as long as this object. The owner of a submission that uses them keeps it until
///           the submission has finished.
/// Threads   any. A thread that needs a pipeline that another one is making waits for it.
class Pipelines {
 public:
  explicit Pipelines(std::shared_ptr<SharedDevice> device);

  /// Creates the pipeline on first use.
  VkPipeline get(const PipelineKey& key);

  std::size_t made();  ///< number of pipelines so far

  VkPipelineLayout layout() const { return layout_.get(); }
  const DescriptorLayout& frame_set_layout() const { return frame_set_layout_; }
  const DescriptorLayout& texture_set_layout() const { return texture_set_layout_; }
  const DescriptorLayout& layers_set_layout() const { return layers_set_layout_; }

  /// Creates the objects on first use.
  const ShadowPipelines& shadows();

  /// Creates the render pass on first use.
  VkRenderPass render_pass(const RenderPassKind& kind);

 private:
  // The shaders of a pipeline and its vertex input.
  struct Program {
    VkPipelineShaderStageCreateInfo stages[2];
    std::uint32_t stage_count;
    VkPipelineVertexInputStateCreateInfo input;
  };
  // These expect that the caller holds the lock.
  const ShadowPipelines& locked_shadows();
  VkRenderPass locked_render_pass(const RenderPassKind& kind);
  Program program(const PipelineKey& key, const VkSpecializationInfo& constants);
  Program item_program(const PipelineKey& key, const VkSpecializationInfo* of_points);
  Program shadow_map_program(const PipelineKey& key, const VkSpecializationInfo& constants);
  Handle<VkPipeline> make(const PipelineKey& key);

  std::mutex making_;
  DeviceImpl device_;  // owns what renderers share, so that none of them needs to outlive the others
  DescriptorLayout frame_set_layout_, texture_set_layout_, layers_set_layout_;
  Handle<VkPipelineLayout> layout_;
  std::unordered_map<std::uint32_t, Handle<VkRenderPass>> render_passes_;
  Handle<VkShaderModule> depth_vert_, mask_vert_, color_vert_;
  Handle<VkShaderModule> mask_frag_[2];   // without and with a texture
  Handle<VkShaderModule> color_frag_[3];  // without a texture, with a texture, with maps
  Handle<VkShaderModule> mapped_vert_;
  Handle<VkShaderModule> layer_frag_[3];  // as color_frag_, for transparent surfaces
  std::optional<ShadowPipelines> shadows_;
  std::optional<ItemShaders> items_;
  std::unordered_map<std::uint64_t, Handle<VkPipeline>> pipelines_;
};

/// The pipelines of the renderers of this device.
std::shared_ptr<Pipelines> shared_pipelines(const DeviceImpl& device);

}  // namespace simvis
