// Order-independent transparency with per-sample linked lists: all transparent fragments of a sample are stored and
// then composited by depth. The image is exact and does not depend on the order in which parts and faces are drawn.
//
// Each fragment of a transparent surface that no solid surface hides becomes a node in the linked list of its sample:
// Yang, Hensley, Gruen, Thibieroz, "Real-Time Concurrent Linked List Construction on the GPU", EGSR 2010. A full-screen
// triangle then resolves the layers of each list from the nearest to the farthest.
//
// No layer is lost. The number of nodes is known after the frame is drawn. If the memory was too small, it grows and
// the frame is drawn again. If a device cannot address enough memory, the pass is drawn in bands of rows.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/pipelines.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// A range of rows of the targets of a pass.
struct LayerRows {
  std::uint32_t first = 0, count = 0;
};

/// Memory is allocated for the first pass that shows a transparent surface, and is freed after many frames without
/// one.
class OitBuffer {
 public:
  OitBuffer(DeviceImpl& device, Pipelines& pipelines) : device_(device), pipelines_(pipelines) {}

  /// `passes` are the passes of the frame that show a transparent surface.
  void begin_frame(std::span<const Pass* const> passes);

  /// The bands of rows in which a pass with transparent surfaces is drawn.
  std::vector<LayerRows> bands(const Pass& pass) const;

  /// Clears the lists for a band and binds them for the render passes that follow. Call it outside a render pass.
  void record_begin(VkCommandBuffer commands, const Pass& pass, const LayerRows& rows);
  /// Call it after the render pass that drew the layers of a band.
  void record_end(VkCommandBuffer commands);
  /// Composites the layers over the colour of the pass in these parts of its targets, which do not overlap and hold all
  /// layers. Call it inside a render pass. It changes viewport and scissor.
  void record_resolve(VkCommandBuffer commands, const Pass& pass, std::span<const VkRect2D> parts);

  /// Call it after the frame is drawn. Returns true if the memory was too small: it has been enlarged, and the frame
  /// must be drawn again. Throws MachineError if the device has no more memory.
  bool grow();

  /// Appends the buffers of this object to `memory`.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  std::uint64_t found() const;  ///< number of layers in the frame
  std::uint64_t bytes() const;  ///< size on the device in bytes

 private:
  void describe();
  void reserve_nodes(std::uint64_t nodes);
  std::uint64_t max_nodes() const;
  VkPipeline resolve_pipeline(std::uint32_t samples);

  DeviceImpl& device_;
  Pipelines& pipelines_;
  DescriptorSets set_;
  Handle<VkShaderModule> resolve_vert_, resolve_frag_;
  std::unordered_map<std::uint32_t, Handle<VkPipeline>> resolve_;
  Buffer lists_, nodes_, counts_;
  std::uint32_t bands_drawn_ = 0;  // in the current frame
  std::uint32_t cuts_ = 1;         // minimum number of bands per pass
  std::uint64_t frames_idle_ = 0;
};

}  // namespace simvis
