#include "engine/vulkan/uploads.h"

#include <algorithm>
#include <cstring>

#include "engine/base/assert.h"
#include "engine/vulkan/formats.h"

namespace simvis {
namespace {

constexpr VkDeviceSize kStagingSize = 4u << 20;
constexpr VkDeviceSize kStagingAlignment = 16;  // copies to images start at a multiple of a texel, up to 16 bytes

void record(VkCommandBuffer commands, const GpuImage& image, VkPipelineStageFlags from, VkPipelineStageFlags to,
            VkImageLayout old_layout, VkImageLayout new_layout, VkAccessFlags written, VkAccessFlags read) {
  const VkImageMemoryBarrier barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                     .pNext = nullptr,
                                     .srcAccessMask = written,
                                     .dstAccessMask = read,
                                     .oldLayout = old_layout,
                                     .newLayout = new_layout,
                                     .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                     .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                     .image = image.get(),
                                     .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, image.desc().mip_levels, 0, 1}};
  vkCmdPipelineBarrier(commands, from, to, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace

void Uploads::begin(VkCommandBuffer commands) {
  commands_ = commands;
  bytes_ = 0;
  written_.clear();
  copies_ = false;
  copied_to_.clear();
}

void Uploads::count(std::uint64_t target, std::uint64_t bytes) {
  bytes_ += bytes;
  // The target is usually the same as before, or one of a few.
  for (auto written = written_.rbegin(); written != written_.rend(); ++written) {
    if (written->target != target) continue;
    written->bytes += bytes;
    return;
  }
  written_.push_back({target, bytes});
}

std::uint64_t Uploads::bytes_to(std::uint64_t target) const {
  for (const Written& written : written_) {
    if (written.target == target) return written.bytes;
  }
  return 0;
}

Uploads::Staged Uploads::stage(std::span<const std::byte> data) {
  VkDeviceSize offset = (used_ + kStagingAlignment - 1) / kStagingAlignment * kStagingAlignment;
  if (staging_.empty() || offset + data.size() > staging_.back().size()) {
    staging_.emplace_back(device_, BufferDesc{.name = "staging",
                                              .size = std::max<VkDeviceSize>(kStagingSize, data.size()),
                                              .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                              .memory = MemoryKind::staging});
    offset = 0;
  }
  std::memcpy(staging_.back().mapped() + offset, data.data(), data.size());
  used_ = offset + data.size();
  return {staging_.back().get(), offset};
}

void Uploads::write(const Buffer& target, VkDeviceSize offset, std::span<const std::byte> data) {
  if (data.empty()) return;
  count(reinterpret_cast<std::uint64_t>(target.get()), data.size());
  if (target.mapped()) {
    std::memcpy(target.mapped() + offset, data.data(), data.size());
    return;
  }
  const Staged staged = stage(data);
  const VkBufferCopy region{.srcOffset = staged.offset, .dstOffset = offset, .size = data.size()};
  vkCmdCopyBuffer(commands_, staged.buffer, target.get(), 1, &region);
  note_copy_to(target);
}

void Uploads::write(const GpuImage& target, std::span<const std::span<const std::byte>> levels) {
  const GpuImageDesc& desc = target.desc();
  SIMVIS_ASSERT(levels.size() == desc.mip_levels);
  record(commands_, target, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
         VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0, VK_ACCESS_TRANSFER_WRITE_BIT);
  for (std::uint32_t level = 0; level < desc.mip_levels; ++level) {
    const VkExtent3D extent{std::max(1u, desc.width >> level), std::max(1u, desc.height >> level), 1};
    SIMVIS_ASSERT(levels[level].size() == texel_bytes(desc.format) * extent.width * extent.height);
    count(reinterpret_cast<std::uint64_t>(target.get()), levels[level].size());
    const Staged staged = stage(levels[level]);
    const VkBufferImageCopy region{.bufferOffset = staged.offset,
                                   .bufferRowLength = 0,
                                   .bufferImageHeight = 0,
                                   .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
                                   .imageOffset = {0, 0, 0},
                                   .imageExtent = extent};
    vkCmdCopyBufferToImage(commands_, staged.buffer, target.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  }
  record(commands_, target, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_ACCESS_TRANSFER_WRITE_BIT,
         VK_ACCESS_SHADER_READ_BIT);
}

void Uploads::note_copy_to(const Buffer& target) {
  copies_ = true;
  if (copied_to_.empty() || copied_to_.back() != target.get()) copied_to_.push_back(target.get());
}

void Uploads::copy(const Buffer& from, const Buffer& to, VkDeviceSize from_offset, VkDeviceSize to_offset,
                   VkDeviceSize size) {
  if (size == 0) return;
  if (std::ranges::find(copied_to_, from.get()) != copied_to_.end()) {
    const VkMemoryBarrier written{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .pNext = nullptr,
                                  .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT};
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &written, 0,
                         nullptr, 0, nullptr);
    copied_to_.clear();
  }
  const VkBufferCopy region{.srcOffset = from_offset, .dstOffset = to_offset, .size = size};
  vkCmdCopyBuffer(commands_, from.get(), to.get(), 1, &region);
  note_copy_to(to);
}

void Uploads::finish() {
  if (!copies_) return;
  const VkMemoryBarrier copied{
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
      .pNext = nullptr,
      .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
      .dstAccessMask = VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_SHADER_READ_BIT};
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                       VK_PIPELINE_STAGE_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &copied, 0,
                       nullptr, 0, nullptr);
}

}  // namespace simvis
