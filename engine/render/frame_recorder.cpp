#include "engine/render/frame_recorder.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "engine/geometry/view_projection.h"
#include "engine/vulkan/formats.h"

namespace simvis {
namespace {

VkPipelineLayout layout(const FrameContext& frame) { return frame.pipelines.layout(); }

void bind_shadow_set(const FrameContext& frame) {
  const VkDescriptorSet set = frame.shadows->set();
  vkCmdBindDescriptorSets(frame.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, frame.pipelines.shadows().layout.get(),
                          SIMVIS_SHADOW_SET, 1, &set, 0, nullptr);
}

// The buffer from which a run takes its vertices.
enum class VertexSource : std::uint8_t { meshes, cpu_selected, copies };

VertexSource source_of(const DrawRun& run) {
  if (run.key.cpu_selected) return VertexSource::cpu_selected;
  return run.copied ? VertexSource::copies : VertexSource::meshes;
}

// The state that a run may change.
struct Bound {
  VkPipeline pipeline = VK_NULL_HANDLE;
  VkDescriptorSet texture = VK_NULL_HANDLE;
  VkBuffer indices = VK_NULL_HANDLE;
  std::optional<VertexSource> vertices;
  std::vector<VkMultiDrawIndexedInfoEXT> parts{};  // scratch memory for one multi-draw
};

std::span<const DrawRun> share_of(const FrameContext& frame, const ViewDraws& draws, DrawPhase share) {
  const std::size_t ends[] = {draws.first_run, draws.first_layer, draws.first_depth_visible, draws.end_run};
  const auto i = static_cast<std::size_t>(share);
  return frame.draws.runs().subspan(ends[i], ends[i + 1] - ends[i]);
}

void bind_vertices(const FrameContext& frame, VertexSource source, bool items) {
  const VkDeviceSize offsets[] = {0, 0, 0};
  if (source == VertexSource::cpu_selected) {
    vkCmdBindVertexBuffers(frame.commands, 0, 1, &frame.cpu_selected, offsets);
    return;
  }
  const bool copies = source == VertexSource::copies;
  const VkBuffer buffers[] = {copies ? frame.copied_positions : frame.geometry.positions(), frame.instances,
                              copies ? frame.copied_attributes : frame.geometry.attributes()};
  vkCmdBindVertexBuffers(frame.commands, 0, buffers[2] == VK_NULL_HANDLE ? 2 : 3, buffers, offsets);
  if (items) vkCmdBindVertexBuffers(frame.commands, kItemBinding, 1, &frame.items, offsets);
}

void bind_run(const FrameContext& frame, const Pass& pass, const DrawRun& run, Bound& bound) {
  PipelineKey key = run.key;
  key.samples = static_cast<std::uint8_t>(pass.msaa);
  VkPipeline& pipeline = frame.known_pipelines[key.bits()];
  if (pipeline == VK_NULL_HANDLE) {
    pipeline = frame.pipelines.get(key);
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
  if (const VertexSource source = source_of(run); source != bound.vertices) {
    bind_vertices(frame, source, key.items && !key.color);
    bound.vertices = source;
  }
  if (!run.is_indexed()) return;
  const VkBuffer indices = run.own_indices ? frame.frame_indices : frame.geometry.indices();
  if (indices != bound.indices) {
    vkCmdBindIndexBuffer(frame.commands, indices, 0, VK_INDEX_TYPE_UINT32);
    bound.indices = indices;
  }
}

// The number of runs, starting with the first, that are parts of the same instance of a mesh and differ only in the
// part.
std::size_t parts_together(std::span<const DrawRun> runs) {
  const DrawRun& first = runs.front();
  const auto other = [&first](const DrawRun& run) {
    return run.first_instance != first.first_instance || run.key.cpu_selected || run.copied ||
           run.key.bits() != first.key.bits();
  };
  return static_cast<std::size_t>(std::find_if(runs.begin() + 1, runs.end(), other) - runs.begin());
}

// Draws runs that share the state bound by bind_run().
void draw_together(const FrameContext& frame, std::span<const DrawRun> runs, Bound& bound) {
  const DrawRun& first = runs.front();
  if (first.key.cpu_selected) {
    vkCmdDraw(frame.commands, first.range.index_count, 1, first.range.first_index, 0);
  } else if (!first.is_indexed()) {
    vkCmdDraw(frame.commands, first.range.index_count, 1, first.range.first_index, first.first_instance);
  } else {
    bound.parts.clear();
    for (const DrawRun& run : runs) {
      bound.parts.push_back({run.range.first_index, run.range.index_count, run.range.vertex_offset});
    }
    frame.device.draw_indexed(frame.commands, bound.parts, first.instance_count, first.first_instance);
  }
  frame.counters.draws += runs.size();
  if (first.key.topology != Topology::triangles) return;
  for (const DrawRun& run : runs) {
    frame.counters.triangles += std::uint64_t{run.range.index_count / 3} * run.instance_count;
  }
}

// Sets the size of the points of a run: see ViewBlock.
void push_point_size(const FrameContext& frame, const DrawRun& run, float half_width_px) {
  const float size = frame.device.physical.has_large_points ? run.point_m * half_width_px : 0;
  vkCmdPushConstants(frame.commands, layout(frame), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                     offsetof(shader::ViewBlock, lights) + 2 * sizeof(std::uint32_t), sizeof size, &size);
}

VkViewport viewport_of(const Pass& pass, const View& view) {
  const auto supersampling = static_cast<float>(pass.supersampling),
             guard = supersampling * static_cast<float>(guard_rows(view));
  return {.x = supersampling * static_cast<float>(view.x_px),
          .y = supersampling * static_cast<float>(view.y_px) - guard,
          .width = supersampling * static_cast<float>(view.width_px),
          .height = supersampling * static_cast<float>(view.height_px) + 2 * guard,
          .minDepth = 0,
          .maxDepth = 1};
}

// Records draws of a view, as far as they lie within the scissor.
void record_runs(const FrameContext& frame, const Pass& pass, const View& view, const ViewDraws& draws, DrawPhase share,
                 std::span<const DrawRun> runs, const VkRect2D& scissor, Bound& bound) {
  const VkViewport viewport = viewport_of(pass, view);
  frame.device.begin_label(frame.commands, view.name);
  vkCmdSetViewport(frame.commands, 0, 1, &viewport);
  vkCmdSetScissor(frame.commands, 0, 1, &scissor);
  shader::ViewBlock block = draws.block;
  if (!view.shadows.empty()) block.lights.y = frame.shadows->first_texel(draws.shadowed);
  vkCmdPushConstants(frame.commands, layout(frame), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                     sizeof block, &block);
  if (!view.shadows.empty()) bind_shadow_set(frame);
  const auto number = static_cast<std::size_t>(&draws - frame.draws.views().data());
  for (std::size_t first = 0, count = 0; first < runs.size(); first += count) {
    count = parts_together(runs.subspan(first));
    bind_run(frame, pass, runs[first], bound);
    if (runs[first].key.topology == Topology::points) push_point_size(frame, runs[first], viewport.width / 2);
    if (frame.queries && first == 0) frame.queries->begin_draws(frame.commands, number, share);
    draw_together(frame, runs.subspan(first, count), bound);
  }
  if (frame.queries) frame.queries->end_draws(frame.commands);
  frame.device.end_label(frame.commands);
}

// Records the part of the view that lies in these rows of the targets.
void record_view(const FrameContext& frame, const Pass& pass, const View& view, const ViewDraws& draws, DrawPhase share,
                 const LayerRows& rows, Bound& bound) {
  const std::span<const DrawRun> runs = share_of(frame, draws, share);
  const std::uint32_t top = std::max(pass.supersampling * view.y_px, rows.first);
  const std::uint32_t bottom = std::min(pass.supersampling * (view.y_px + view.height_px), rows.first + rows.count);
  if (runs.empty() || top >= bottom) return;
  const VkRect2D scissor{{static_cast<std::int32_t>(pass.supersampling * view.x_px), static_cast<std::int32_t>(top)},
                         {pass.supersampling * view.width_px, bottom - top}};
  record_runs(frame, pass, view, draws, share, runs, scissor, bound);
}

// Draws the sky where the view has hit nothing.
void record_sky(const FrameContext& frame, const Pass& pass, const View& view, Bound& bound) {
  const VkViewport viewport = viewport_of(pass, view);
  const VkRect2D scissor{{static_cast<std::int32_t>(pass.supersampling * view.x_px),
                          static_cast<std::int32_t>(pass.supersampling * view.y_px)},
                         {pass.supersampling * view.width_px, pass.supersampling * view.height_px}};
  vkCmdSetViewport(frame.commands, 0, 1, &viewport);
  vkCmdSetScissor(frame.commands, 0, 1, &scissor);
  frame.counters.pipelines_made += frame.sky->record(frame.commands, frame.list, pass, view) ? 1 : 0;
  ++frame.counters.pipelines_bound;
  ++frame.counters.draws;
  bound = {};
}

VkRect2D in_target(const View& view, const PixelRect& pixels) {
  const glm::uvec2 size = pixels.last - pixels.first;
  return {
      {static_cast<std::int32_t>(view.x_px + pixels.first.x), static_cast<std::int32_t>(view.y_px + pixels.first.y)},
      {size.x, size.y}};
}

// One of the Vulkan render passes that make up a pass.
class RenderPassScope {
 public:
  RenderPassScope(const FrameContext& frame, const Pass& pass, const RenderTarget& target, bool resumed, bool continued)
      : frame_(frame), pass_(pass) {
    const Medium& medium = frame.list.medium;
    // In fog, only the air is visible at infinite distance.
    const glm::vec3& background = medium.extinction_per_m > 0 ? medium.airlight : frame.list.environment.background;
    VkClearValue clear[2]{};
    clear[0].depthStencil = {0, 0};
    clear[1].color = {{background.r, background.g, background.b, 1}};
    if (pass.items) clear[1].color.float32[3] = -1;
    if (pass.has_item_target()) clear[1].color.uint32[0] = kNoItem;
    const VkRenderPassBeginInfo info{
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
        .pNext = nullptr,
        .renderPass = frame.pipelines.render_pass({.color = pass.color,
                                                   .items = pass.has_item_target(),
                                                   .keep_depth = pass.depth,
                                                   .sampled = pass.shadow_maps,
                                                   .averaged = pass.samples() > 1,
                                                   .resumed = resumed,
                                                   .continued = continued,
                                                   .samples = pass.msaa}),
        .framebuffer = target.framebuffer.get(),
        .renderArea = {{0, 0}, {pass.supersampling * pass.width_px, pass.supersampling * pass.height_px}},
        .clearValueCount = pass.color || pass.has_item_target() ? 2u : 1u,
        .pClearValues = clear};
    vkCmdBeginRenderPass(frame.commands, &info, VK_SUBPASS_CONTENTS_INLINE);
    ++frame.counters.passes;
  }
  ~RenderPassScope() { vkCmdEndRenderPass(frame_.commands); }
  RenderPassScope(const RenderPassScope&) = delete;
  RenderPassScope& operator=(const RenderPassScope&) = delete;

  /// Draws what is due of the views of a shadow atlas, and records a timestamp at the end of each view.
  void record_due(std::span<const ViewDraws> views, const ShadowMapCache& cache) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      const View& view = pass_.views[i];
      if (!cache.due(i).empty()) {
        const VkRect2D place = in_target(view, cache.due(i));
        if (!cache.is_new()) clear(place);
        const std::span<const DrawRun> runs = cache.due_runs(i);
        if (!runs.empty()) record_runs(frame_, pass_, view, views[i], DrawPhase::solid, runs, place, bound_);
        ++frame_.counters.views;
        ++frame_.counters.shadow_maps;
      }
      if (frame_.queries) frame_.queries->stamp(frame_.commands);
    }
  }

  /// `stamped`: records a timestamp at the end of each view.
  void record(std::span<const ViewDraws> views, DrawPhase share, const LayerRows& rows, bool stamped = false) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      record_view(frame_, pass_, pass_.views[i], views[i], share, rows, bound_);
      if (frame_.sky && pass_.color && share == DrawPhase::solid) record_sky(frame_, pass_, pass_.views[i], bound_);
      if (stamped && frame_.queries) frame_.queries->stamp(frame_.commands);
    }
  }

 private:
  void clear(const VkRect2D& place) const {
    VkClearAttachment nothing{};
    nothing.aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT;
    const VkClearRect rect{.rect = place, .baseArrayLayer = 0, .layerCount = 1};
    vkCmdClearAttachments(frame_.commands, 1, &nothing, 1, &rect);
  }

  const FrameContext& frame_;
  const Pass& pass_;
  Bound bound_;
};

// The parts of these rows of the targets that show transparent surfaces, one for each view that has any.
std::vector<VkRect2D> layered_parts(const Pass& pass, std::span<const ViewDraws> views, const LayerRows& rows) {
  std::vector<VkRect2D> parts;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PixelRect& layered = views[i].layered;
    if (layered.empty()) continue;
    const glm::uvec2 corner(pass.views[i].x_px, pass.views[i].y_px);
    const glm::uvec2 first = pass.supersampling * (corner + layered.first),
                     last = pass.supersampling * (corner + layered.last);
    const std::uint32_t top = std::max(first.y, rows.first), bottom = std::min(last.y, rows.first + rows.count);
    if (top >= bottom) continue;
    parts.push_back(
        {{static_cast<std::int32_t>(first.x), static_cast<std::int32_t>(top)}, {last.x - first.x, bottom - top}});
  }
  return parts;
}

// For each band: draws the layers of all views, then composites them over the solid surfaces. After the bands: draws
// the depth-visible transparent surfaces for depth.
void record_layers(const FrameContext& frame, const Pass& pass, const RenderTarget& target,
                   std::span<const ViewDraws> views, const LayerRows& all) {
  const std::vector<LayerRows> bands = frame.layers.bands(pass);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const bool last = i + 1 == bands.size();
    frame.layers.record_begin(frame.commands, pass, bands[i]);
    {
      RenderPassScope drawn(frame, pass, target, i > 0, true);
      if (i == 0) drawn.record(views, DrawPhase::solid, all);
      drawn.record(views, DrawPhase::layers, bands[i]);
    }
    frame.layers.record_end(frame.commands);
    RenderPassScope resolved(frame, pass, target, true, !last);
    const std::vector<VkRect2D> parts = layered_parts(pass, views, bands[i]);
    frame.layers.record_resolve(frame.commands, pass, parts);
    frame.counters.draws += parts.size();
    ++frame.counters.pipelines_bound;
    if (last) resolved.record(views, DrawPhase::depth_visible, all, true);
  }
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

// Lets the host read a mapped image, whose writes already are visible to transfers.
void show_to_host(const FrameContext& frame, const GpuImage& image) {
  const VkImageMemoryBarrier readable{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                      .pNext = nullptr,
                                      .srcAccessMask = 0,
                                      .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
                                      .oldLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                      .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                                      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                      .image = image.get(),
                                      .subresourceRange = {image.desc().aspect, 0, 1, 0, 1}};
  vkCmdPipelineBarrier(frame.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 0, nullptr, 0,
                       nullptr, 1, &readable);
  frame.counters.bytes_read_back +=
      std::uint64_t{image.desc().width} * image.desc().height * texel_bytes(image.desc().format);
}

// Gives the host an image of colour or of items: where it is, or copied.
void read_back(const FrameContext& frame, const GpuImage& image, const Buffer& buffer) {
  if (image.pixels()) {
    show_to_host(frame, image);
  } else {
    copy_image(frame, image, buffer);
  }
}

}  // namespace

bool shows_layers(std::span<const ViewDraws> views) {
  return std::ranges::any_of(views,
                             [](const ViewDraws& draws) { return draws.first_depth_visible > draws.first_layer; });
}

void record_bindings(const FrameContext& frame) {
  vkCmdBindDescriptorSets(frame.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout(frame), SIMVIS_FRAME_SET, 1,
                          &frame.frame_set, 0, nullptr);
}

void record_pass(const FrameContext& frame, const Pass& pass, const RenderTarget& target,
                 std::span<const ViewDraws> views) {
  const LayerRows all{0, pass.supersampling * pass.height_px};
  if (frame.queries) frame.queries->stamp(frame.commands);
  frame.device.begin_label(frame.commands, pass.name);
  if (shows_layers(views)) {
    record_layers(frame, pass, target, views, all);
  } else {
    RenderPassScope(frame, pass, target, false, false).record(views, DrawPhase::solid, all, true);
  }
  if (frame.queries) frame.queries->stamp(frame.commands);
  frame.device.end_label(frame.commands);
  frame.counters.views += views.size();
}

void record_shadow_maps(const FrameContext& frame, const Pass& maps, const RenderTarget& target,
                        std::span<const ViewDraws> views, const ShadowMapCache& cache) {
  if (frame.queries) frame.queries->stamp(frame.commands);
  frame.device.begin_label(frame.commands, maps.name);
  if (cache.any_due()) {
    RenderPassScope(frame, maps, target, !cache.is_new(), false).record_due(views, cache);
  } else if (frame.queries) {
    for (std::size_t i = 0; i < views.size(); ++i) frame.queries->stamp(frame.commands);
  }
  if (frame.queries) frame.queries->stamp(frame.commands);
  frame.device.end_label(frame.commands);
}

void record_readback(const FrameContext& frame, const Pass& pass, const RenderTarget& target) {
  if (pass.depth) copy_image(frame, target.depth, target.depth_readback);
  if (pass.samples() > 1) {
    const std::size_t known = frame.average.made();
    frame.average.record(frame.commands, pass, target.average, target.color);
    if (frame.average.made() > known) {
      ++frame.counters.pipelines_made;
      frame.made.means.push_back(ResolvePass::pipeline_key(pass));
    }
    ++frame.counters.dispatches;
  }
  if (pass.color) read_back(frame, target.color, target.color_readback);
  if (pass.has_item_target()) read_back(frame, target.items, target.items_readback);
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
