// Records the draws and copies of a frame into a command buffer.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "engine/render/frame_draw_lists.h"
#include "engine/render/geometry_pool.h"
#include "engine/render/gpu_queries.h"
#include "engine/render/oit_buffer.h"
#include "engine/render/pipelines.h"
#include "engine/render/render_targets.h"
#include "engine/render/shadow_map_cache.h"
#include "engine/render/shadow_maps.h"
#include "engine/render/sky_backdrop.h"

namespace simvis {

/// The pipelines that are created during a frame.
struct MadePipelines {
  std::vector<std::uint64_t> meshes;  ///< PipelineKey::bits()
  std::vector<std::uint32_t> means;   ///< ResolvePass::pipeline_key()
};

struct FrameContext {
  DeviceImpl& device;
  VkCommandBuffer commands;
  Pipelines& pipelines;
  std::unordered_map<std::uint64_t, VkPipeline>&
      known_pipelines;  ///< that this renderer has used, by bits of their keys
  ResolvePass& average;
  OitBuffer& layers;
  const GeometryPool& geometry;
  VkDescriptorSet frame_set;
  const ShadowMaps* shadows;  ///< null if no view has shadows
  SkyBackdrop* sky;           ///< null if no view shows a picture of the sky
  VkBuffer instances;
  VkBuffer items;              ///< of the instances; null if no pass has items
  VkBuffer frame_indices;      ///< null if no run has its own indices
  VkBuffer cpu_selected;       ///< null if no run has CPU-selected vertices
  VkBuffer copied_positions;   ///< null if no run is copied
  VkBuffer copied_attributes;  ///< the same, or if no such run has colour
  const FrameDrawLists& draws;
  const DrawList& list;
  FrameCounters& counters;
  MadePipelines& made;
  GpuQueries* queries = nullptr;  ///< null unless the device is instrumented
};

/// Whether any of the views shows a transparent surface.
bool shows_layers(std::span<const ViewDraws> views);

/// Binds the state that all passes of the frame share.
void record_bindings(const FrameContext& frame);

/// Records one render pass, or several if a view shows transparent surfaces. `views` are the draws of pass.views.
void record_pass(const FrameContext& frame, const Pass& pass, const RenderTarget& target,
                 std::span<const ViewDraws> views);

/// As record_pass(), for the views of a shadow atlas that are due.
void record_shadow_maps(const FrameContext& frame, const Pass& maps, const RenderTarget& target,
                        std::span<const ViewDraws> views, const ShadowMapCache& cache);

/// Copies the results of the pass to its readback buffers. Several colour samples per pixel are averaged first.
void record_readback(const FrameContext& frame, const Pass& pass, const RenderTarget& target);

/// Records the barrier that makes all readback buffers visible to the host after the submission has finished.
void record_end(const FrameContext& frame);

}  // namespace simvis
