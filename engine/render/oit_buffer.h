// Transparent surfaces, kept apart for each sample of a pass until all are there, then laid over each other by depth:
// so their picture is exact, and the same in whatever order parts and faces are drawn.
//
// Each fragment of a transparent surface that no solid one hides becomes a node in its sample's linked list: Yang,
// Hensley, Gruen, Thibieroz, "Real-Time Concurrent Linked List Construction on the GPU", EGSR 2010. A full-screen
// triangle then finds each list's layers from the nearest on.
//
// No layer is lost. How many nodes there are is known when the frame is drawn; were there too many for the memory, the
// frame is drawn again with more of it. Where a device cannot address as much, a pass is drawn in bands of rows.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/pipelines.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// Rows of a pass's targets.
struct LayerRows {
  std::uint32_t first = 0, count = 0;
};

/// Makes nothing before the first pass that shows something transparent, and gives its memory back when no frame has
/// shown such a thing for long.
class OitBuffer {
 public:
  OitBuffer(Device::Impl& device, Pipelines& pipelines) : device_(device), pipelines_(pipelines) {}

  /// `passes` are those of the frame that show something transparent.
  void begin_frame(std::span<const Pass* const> passes);

  /// The bands in which such a pass is drawn.
  std::vector<LayerRows> bands(const Pass& pass) const;

  /// Empties the lists, for a band. Outside render passes; binds them for the next ones.
  void record_begin(VkCommandBuffer commands, const Pass& pass, const LayerRows& rows);
  /// After the render pass in which a band's layers were drawn.
  void record_end(VkCommandBuffer commands);
  /// Draws what the layers show over the pass's colour. Within a render pass; changes viewport and scissor.
  void record_resolve(VkCommandBuffer commands, const Pass& pass, const LayerRows& rows);

  /// Once the frame is drawn: whether there was too little memory. There is more now, for another try.
  /// Throws MachineError where the device has no more.
  bool grow();

  /// Adds its buffers.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  std::uint64_t found() const;  ///< layers of the frame
  std::uint64_t bytes() const;  ///< on the device

 private:
  void make_set();
  void describe();
  void reserve_nodes(std::uint64_t nodes);
  std::uint64_t max_nodes() const;
  VkPipeline resolve_pipeline(std::uint32_t samples);

  Device::Impl& device_;
  Pipelines& pipelines_;
  Handle<VkDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;  // freed with its pool
  Handle<VkShaderModule> resolve_vert_, resolve_frag_;
  std::unordered_map<std::uint32_t, Handle<VkPipeline>> resolve_;
  Buffer lists_, nodes_, counts_;
  std::uint32_t bands_drawn_ = 0;  // of the frame
  std::uint32_t cuts_ = 1;         // into at least how many bands a pass is cut
  std::uint64_t frames_idle_ = 0;
};

}  // namespace simvis
