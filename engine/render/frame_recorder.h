// Writes a frame's draws and copies into a command buffer.
#pragma once

#include <span>
#include <vector>

#include "engine/render/frame_draw_lists.h"
#include "engine/render/geometry_pool.h"
#include "engine/render/gpu_queries.h"
#include "engine/render/oit_buffer.h"
#include "engine/render/pipelines.h"
#include "engine/render/render_targets.h"
#include "engine/render/shadow_maps.h"

namespace simvis {

/// The pipelines that a frame is the first to use.
struct MadePipelines {
  std::vector<std::uint64_t> meshes;  ///< PipelineKey::bits()
  std::vector<std::uint32_t> means;   ///< ResolvePass::pipeline_key()
};

struct FrameContext {
  Device::Impl& device;
  VkCommandBuffer commands;
  Pipelines& pipelines;
  ResolvePass& average;
  OitBuffer& layers;
  const GeometryPool& geometry;
  VkDescriptorSet frame_set;
  const ShadowMaps* shadows;  ///< null where no view has any
  VkBuffer instances;
  VkBuffer frame_indices;  ///< null where no run has indices of its own
  VkBuffer cpu_selected;   ///< null where no run has picked vertices
  const FrameDrawLists& draws;
  const DrawList& list;
  FrameCounters& counters;
  MadePipelines& made;
  GpuQueries* queries = nullptr;  ///< null unless the device is instrumented
};

/// Whether a view of the pass shows something transparent.
bool shows_layers(std::span<const ViewDraws> views);

/// Binds what all passes of the frame share.
void record_bindings(const FrameContext& frame);

/// One render pass, and more where something transparent is seen; `views` are the draws of pass.views.
void record_pass(const FrameContext& frame, const Pass& pass, const RenderTarget& target,
                 std::span<const ViewDraws> views);

/// Copies the pass's results to its readback buffers; of several samples of colour their mean.
void record_readback(const FrameContext& frame, const Pass& pass, const RenderTarget& target);

/// Makes all readback visible to the host, once the submission has finished.
void record_end(const FrameContext& frame);

}  // namespace simvis
