#include "engine/render/oit_buffer.h"

#include <algorithm>
#include <string>

#include <simvis/error.h>
#include "engine/vulkan/pipeline_parts.h"
#include "shaders/interop.h"
#include "shaders/layers_resolve.frag.h"
#include "shaders/layers_resolve.vert.h"

namespace simvis {
namespace {

constexpr std::uint64_t kFirstNodes = 1u << 16;
constexpr std::uint64_t kLayersFramesKept = 256;  // as in RenderTargets

std::uint32_t rows_of(const Pass& pass) { return pass.supersampling * pass.height_px; }
std::uint32_t columns_of(const Pass& pass) { return pass.supersampling * pass.width_px; }
VkDeviceSize list_bytes(const Pass& pass, std::uint32_t rows) {
  return sizeof(shader::LayerBand) + sizeof(std::uint32_t) * VkDeviceSize{columns_of(pass)} * pass.msaa * rows;
}

void layers_barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags written, VkPipelineStageFlags to,
                    VkAccessFlags used) {
  const VkMemoryBarrier memory{
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .pNext = nullptr, .srcAccessMask = written, .dstAccessMask = used};
  vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

constexpr VkPipelineStageFlags kTargets = VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                          VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT |
                                          VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
constexpr VkAccessFlags kTargetsWritten =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kTargetsUsed =
    kTargetsWritten | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_READ_BIT;

}  // namespace

std::uint64_t OitBuffer::max_nodes() const {
  return device_.limits().maxStorageBufferRange / sizeof(shader::LayerNode);
}

void OitBuffer::reserve_nodes(std::uint64_t nodes) {
  nodes_ = Buffer(device_, {.name = "transparent layers",
                            .size = nodes * sizeof(shader::LayerNode),
                            .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                            .memory = MemoryKind::device});
}

void OitBuffer::describe() {
  const DescriptorLayout& layout = pipelines_.layers_set_layout();
  if (!set_) set_ = DescriptorSets(device_, layout, 1, "layers set");
  write_descriptor(device_, layout, set_.get(), SIMVIS_LAYER_LISTS, {lists_.get(), 0, VK_WHOLE_SIZE});
  write_descriptor(device_, layout, set_.get(), SIMVIS_LAYER_NODES, {nodes_.get(), 0, VK_WHOLE_SIZE});
}

void OitBuffer::begin_frame(std::span<const Pass* const> passes) {
  bands_drawn_ = 0;
  if (passes.empty()) {
    if (++frames_idle_ <= kLayersFramesKept) return;
    for (Buffer* buffer : {&lists_, &nodes_, &counts_}) *buffer = Buffer();
    cuts_ = 1;
    return;
  }
  frames_idle_ = 0;
  VkDeviceSize lists = 0, bands_in_all = 0;
  for (const Pass* pass : passes) {
    const std::vector<LayerRows> cut = bands(*pass);
    lists = std::max(lists, list_bytes(*pass, cut.front().count));
    bands_in_all += cut.size();
  }
  if (!nodes_) reserve_nodes(std::min(kFirstNodes, max_nodes()));
  if (!lists_ || lists_.size() < lists) {
    lists_ = Buffer(device_, {.name = "lists of transparent layers",
                              .size = lists,
                              .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                              .memory = MemoryKind::device});
  }
  const VkDeviceSize counts = bands_in_all * sizeof(std::uint32_t);
  if (!counts_ || counts_.size() < counts) {
    counts_ = Buffer(device_, {.name = "numbers of transparent layers",
                               .size = counts,
                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                               .memory = MemoryKind::readback});
  }
  describe();
}

std::vector<LayerRows> OitBuffer::bands(const Pass& pass) const {
  const VkDeviceSize limit = device_.limits().maxStorageBufferRange - sizeof(shader::LayerBand);
  const std::uint32_t rows = rows_of(pass);
  const auto addressed = static_cast<std::uint32_t>(
      std::clamp<VkDeviceSize>(limit / (list_bytes(pass, 1) - sizeof(shader::LayerBand)), 1, rows));
  const std::uint32_t height = std::clamp((rows + cuts_ - 1) / cuts_, 1u, addressed);
  std::vector<LayerRows> bands;
  for (std::uint32_t first = 0; first < rows; first += height) {
    bands.push_back({first, std::min(height, rows - first)});
  }
  return bands;
}

void OitBuffer::record_begin(VkCommandBuffer commands, const Pass& pass, const LayerRows& rows) {
  // Waits until the previous band is resolved and counted and its colour is drawn.
  layers_barrier(commands, kTargets | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                 kTargetsWritten, kTargets | VK_PIPELINE_STAGE_TRANSFER_BIT,
                 kTargetsUsed | VK_ACCESS_TRANSFER_WRITE_BIT);
  const shader::LayerBand band{.rows = {0, columns_of(pass), rows.first, pass.msaa}};
  vkCmdUpdateBuffer(commands, lists_.get(), 0, sizeof band, &band);
  vkCmdFillBuffer(commands, lists_.get(), sizeof band, list_bytes(pass, rows.count) - sizeof band, 0);
  layers_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                 VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  const VkDescriptorSet set = set_.get();
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout(), SIMVIS_LAYERS_SET, 1, &set, 0,
                          nullptr);
}

void OitBuffer::record_end(VkCommandBuffer commands) {
  layers_barrier(commands, kTargets | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                 kTargetsWritten | VK_ACCESS_SHADER_WRITE_BIT,
                 kTargets | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                 kTargetsUsed | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
  const VkBufferCopy count{
      .srcOffset = 0, .dstOffset = bands_drawn_++ * sizeof(std::uint32_t), .size = sizeof(std::uint32_t)};
  vkCmdCopyBuffer(commands, lists_.get(), counts_.get(), 1, &count);
}

void OitBuffer::record_resolve(VkCommandBuffer commands, const Pass& pass, std::span<const VkRect2D> parts) {
  const VkViewport viewport{.x = 0,
                            .y = 0,
                            .width = static_cast<float>(columns_of(pass)),
                            .height = static_cast<float>(rows_of(pass)),
                            .minDepth = 0,
                            .maxDepth = 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, resolve_pipeline(pass.msaa));
  for (const VkRect2D& part : parts) {
    vkCmdSetScissor(commands, 0, 1, &part);
    vkCmdDraw(commands, 3, 1, 0, 0);
  }
}

std::uint64_t OitBuffer::found() const {
  std::uint64_t sum = 0;
  const auto* counts = reinterpret_cast<const std::uint32_t*>(counts_.mapped());
  for (std::uint32_t i = 0; i < bands_drawn_; ++i) sum += counts[i];
  return sum;
}

std::uint64_t OitBuffer::bytes() const { return (lists_ ? lists_.size() : 0) + (nodes_ ? nodes_.size() : 0); }

bool OitBuffer::grow() {
  const auto* counts = reinterpret_cast<const std::uint32_t*>(counts_.mapped());
  const std::uint64_t most = bands_drawn_ > 0 ? *std::max_element(counts, counts + bands_drawn_) : 0;
  if (most == 0 || most * sizeof(shader::LayerNode) <= nodes_.size()) return false;
  const std::uint64_t limit = max_nodes();
  if (most > limit) {
    if (cuts_ >= device_.physical.targets.height_px) {
      throw MachineError("one row of a picture shows " + std::to_string(most) + " layers of transparent surfaces; " +
                         device_.physical.info.name + " can keep " + std::to_string(limit) + " apart");
    }
    cuts_ *= static_cast<std::uint32_t>((most + limit - 1) / limit);
  }
  nodes_ = Buffer();                                // frees the memory before the new allocation
  reserve_nodes(std::min(limit, most + most / 4));  // motion may add some layers in the next frame
  return true;
}

VkPipeline OitBuffer::resolve_pipeline(std::uint32_t samples) {
  Handle<VkPipeline>& known = resolve_[samples];
  if (known) return known.get();
  if (!resolve_vert_) {
    resolve_vert_ = make_module(device_, layers_resolve_vert, "layers_resolve.vert");
    resolve_frag_ = make_module(device_, layers_resolve_frag, "layers_resolve.frag");
  }
  const VkPipelineShaderStageCreateInfo stages[] = {shader_stage(VK_SHADER_STAGE_VERTEX_BIT, resolve_vert_.get()),
                                                    shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, resolve_frag_.get())};
  // layers + transmittance * background; alpha stays 1
  VkPipelineColorBlendAttachmentState color{};
  color.blendEnable = VK_TRUE;
  color.srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
  color.dstColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  color.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
  known = make_pipeline(device_,
                        {.stages = stages,
                         .samples = samples,
                         .colors = {&color, 1},
                         .layout = pipelines_.layout(),
                         .render_pass = pipelines_.render_pass({.color = true, .samples = samples})},
                        "resolve of transparent layers");
  return known.get();
}

void OitBuffer::name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const {
  const auto add = [&](const Buffer& buffer, const char* reason) {
    if (!buffer) return;
    memory.push_back({buffer.desc().name, reason, buffer.memory_bytes(), uploads.bytes_to(buffer)});
  };
  add(lists_, "first layer of each sample");
  add(nodes_, "layers of transparent surfaces");
  add(counts_, "number of layers of each band");
}

}  // namespace simvis
