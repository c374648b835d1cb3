#include "engine/frame_recorder.h"

#include "engine/view_projection.h"

namespace simvis {
namespace {

VkPipelineLayout layout(const FrameContext& frame) { return frame.pipelines.layout(); }

void bind_frame_set(const FrameContext& frame, std::uint32_t lights_offset) {
  vkCmdBindDescriptorSets(frame.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout(frame), SIMVIS_FRAME_SET, 1,
                          &frame.frame_set, 1, &lights_offset);
}

// The state that a run may change.
struct Bound {
  VkPipeline pipeline = VK_NULL_HANDLE;
  VkDescriptorSet texture = VK_NULL_HANDLE;
  VkBuffer indices = VK_NULL_HANDLE;
};

void bind_run(const FrameContext& frame, const Pass& pass, const DrawRun& run, Bound& bound) {
  PipelineKey key = run.key;
  key.samples = static_cast<std::uint8_t>(pass.msaa);
  const std::size_t known = frame.pipelines.made();
  const VkPipeline pipeline = frame.pipelines.get(key);
  if (frame.pipelines.made() > known) {
    ++frame.counters.pipelines_made;
    frame.made.meshes.push_back(key.bits());
  }
  if (pipeline != bound.pipeline) {
    vkCmdBindPipeline(frame.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    bound.pipeline = pipeline;
    ++frame.counters.pipelines_bound;
  }
  if (run.texture != VK_NULL_HANDLE && run.texture != bound.texture) {
    vkCmdBindDescriptorSets(frame.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout(frame), SIMVIS_TEXTURE_SET, 1,
                            &run.texture, 0, nullptr);
    bound.texture = run.texture;
  }
  const VkBuffer indices = run.own_indices ? frame.frame_indices : frame.geometry.indices();
  if (indices != bound.indices) {
    vkCmdBindIndexBuffer(frame.commands, indices, 0, VK_INDEX_TYPE_UINT32);
    bound.indices = indices;
  }
}

void draw_run(const FrameContext& frame, const DrawRun& run) {
  vkCmdDrawIndexed(frame.commands, run.range.index_count, run.instance_count, run.range.first_index,
                   run.range.vertex_offset, run.first_instance);
  ++frame.counters.draws;
  if (run.key.topology == Topology::triangles) {
    frame.counters.triangles += std::uint64_t{run.range.index_count / 3} * run.instance_count;
  }
}

void record_view(const FrameContext& frame, const Pass& pass, const View& view, const ViewDraws& draws, Bound& bound) {
  if (draws.first_run == draws.end_run) return;
  const auto grid = static_cast<float>(pass.grid), guard = grid * static_cast<float>(guard_rows(view));
  const VkViewport viewport{.x = grid * static_cast<float>(view.x_px),
                            .y = grid * static_cast<float>(view.y_px) - guard,
                            .width = grid * static_cast<float>(view.width_px),
                            .height = grid * static_cast<float>(view.height_px) + 2 * guard,
                            .minDepth = 0,
                            .maxDepth = 1};
  const VkRect2D scissor{
      {static_cast<std::int32_t>(pass.grid * view.x_px), static_cast<std::int32_t>(pass.grid * view.y_px)},
      {pass.grid * view.width_px, pass.grid * view.height_px}};
  frame.device.begin_label(frame.commands, view.name);
  vkCmdSetViewport(frame.commands, 0, 1, &viewport);
  vkCmdSetScissor(frame.commands, 0, 1, &scissor);
  vkCmdPushConstants(frame.commands, layout(frame), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                     sizeof draws.block, &draws.block);
  if (draws.lights_offset != 0) bind_frame_set(frame, draws.lights_offset);
  const auto number = static_cast<std::size_t>(&draws - frame.draws.views().data());
  for (std::size_t i = draws.first_run; i < draws.end_run; ++i) {
    const DrawRun& run = frame.draws.runs()[i];
    bind_run(frame, pass, run, bound);
    if (frame.queries && i == draws.first_run) frame.queries->begin_draws(frame.commands, number);
    draw_run(frame, run);
  }
  if (frame.queries) frame.queries->end_draws(frame.commands, number);
  frame.device.end_label(frame.commands);
}

void copy_image(const FrameContext& frame, const GpuImage& image, const Buffer& buffer) {
  const VkBufferImageCopy region{.bufferOffset = 0,
                                 .bufferRowLength = 0,
                                 .bufferImageHeight = 0,
                                 .imageSubresource = {image.desc().aspect, 0, 0, 1},
                                 .imageOffset = {0, 0, 0},
                                 .imageExtent = {image.desc().width, image.desc().height, 1}};
  vkCmdCopyImageToBuffer(frame.commands, image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.get(), 1, &region);
  frame.counters.bytes_read_back += buffer.size();
}

}  // namespace

void record_bindings(const FrameContext& frame) {
  bind_frame_set(frame, 0);
  // Without instances there are no draws: every view looks past the meshes.
  if (frame.geometry.positions() == VK_NULL_HANDLE || frame.instances == VK_NULL_HANDLE) return;
  const VkBuffer buffers[] = {frame.geometry.positions(), frame.instances, frame.geometry.attributes()};
  const VkDeviceSize offsets[] = {0, 0, 0};
  vkCmdBindVertexBuffers(frame.commands, 0, buffers[2] == VK_NULL_HANDLE ? 2 : 3, buffers, offsets);
}

void record_pass(const FrameContext& frame, const Pass& pass, const RenderTarget& target,
                 std::span<const ViewDraws> views) {
  const glm::vec3& background = frame.list.environment.background;
  VkClearValue clear[2]{};
  clear[0].depthStencil = {0, 0};
  clear[1].color = {{background.r, background.g, background.b, 1}};
  const VkRenderPassBeginInfo info{
      .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
      .pNext = nullptr,
      .renderPass = frame.pipelines.render_pass(
          {.color = pass.color, .keep_depth = pass.depth, .averaged = pass.samples() > 1, .samples = pass.msaa}),
      .framebuffer = target.framebuffer.get(),
      .renderArea = {{0, 0}, {pass.grid * pass.width_px, pass.grid * pass.height_px}},
      .clearValueCount = pass.color ? 2u : 1u,
      .pClearValues = clear};
  if (frame.queries) frame.queries->stamp(frame.commands);
  frame.device.begin_label(frame.commands, pass.name);
  vkCmdBeginRenderPass(frame.commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  Bound bound;
  for (std::size_t i = 0; i < views.size(); ++i) {
    record_view(frame, pass, pass.views[i], views[i], bound);
    if (frame.queries) frame.queries->stamp(frame.commands);
  }
  vkCmdEndRenderPass(frame.commands);
  if (frame.queries) frame.queries->stamp(frame.commands);
  frame.device.end_label(frame.commands);
  ++frame.counters.passes;
  frame.counters.views += views.size();
}

void record_readback(const FrameContext& frame, const Pass& pass, const RenderTarget& target) {
  if (pass.depth) copy_image(frame, target.depth, target.depth_readback);
  if (pass.samples() > 1) {
    const std::size_t known = frame.average.made();
    frame.average.record(frame.commands, pass, target.average, target.color);
    if (frame.average.made() > known) {
      ++frame.counters.pipelines_made;
      frame.made.means.push_back(SampleAverage::pipeline_key(pass));
    }
    ++frame.counters.dispatches;
  }
  if (pass.color) copy_image(frame, target.color, target.color_readback);
  if (frame.queries) frame.queries->stamp(frame.commands);
}

void record_end(const FrameContext& frame) {
  const VkMemoryBarrier read_back{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .pNext = nullptr,
                                  .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
  vkCmdPipelineBarrier(frame.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &read_back, 0,
                       nullptr, 0, nullptr);
}

}  // namespace simvis
