#include "engine/frame_buffers.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "engine/error.h"
#include "engine/vulkan_check.h"

namespace simvis {
namespace {

constexpr VkDeviceSize kFirstSize = 16384;
// What a view may read from its offset on.
constexpr VkDeviceSize kLightsRange = SIMVIS_MAX_LIGHTS * sizeof(shader::LightBlock);

// The least alpha that is there: an opaque surface is, whatever its texture says.
float cutoff_of(const Material& m) {
  switch (m.alpha_mode) {
    case AlphaMode::opaque:
      return 0;
    case AlphaMode::mask:
      return m.alpha_cutoff;
    case AlphaMode::blend:
      return kLeastMetAlpha;
  }
  return 0;
}

shader::MaterialBlock block_of(const Material& m) {
  const auto& t = m.uv_transform;
  glm::vec4 base = m.base_color;
  if (m.alpha_mode == AlphaMode::blend) base.a *= m.opacity;
  return {.base_color = base,
          .emissive_cutoff = glm::vec4(m.emissive, cutoff_of(m)),
          .uv_row_u = {t[0][0], t[1][0], t[2][0], m.uv_set},
          .uv_row_v = {t[0][1], t[1][1], t[2][1], 0},
          .finish = {std::max(m.roughness, kLeastRoughness), m.opacity, 0, 0}};
}

}  // namespace

FrameBuffers::FrameBuffers(Device::Impl& device, VkDescriptorSetLayout set_layout) : device_(device) {
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1}};
  const VkDescriptorPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .pNext = nullptr,
                                             .flags = 0,
                                             .maxSets = 1,
                                             .poolSizeCount = 2,
                                             .pPoolSizes = sizes};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  vk_check(vkCreateDescriptorPool(device.device, &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = Handle<VkDescriptorPool>(device, pool, "frame set");
  const VkDescriptorSetAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .pNext = nullptr,
                                               .descriptorPool = pool,
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &set_layout};
  vk_check(vkAllocateDescriptorSets(device.device, &allocation, &set_), "vkAllocateDescriptorSets");
}

bool FrameBuffers::reserve(Buffer& buffer, const char* name, VkBufferUsageFlags usage, VkDeviceSize size) {
  if (buffer && size <= buffer.size()) return false;
  buffer = Buffer(device_, {.name = name,
                            .size = std::max({kFirstSize, size, buffer ? 2 * buffer.size() : 0}),
                            .usage = usage,
                            .memory = MemoryKind::dynamic});
  return true;
}

void FrameBuffers::describe(std::uint32_t binding, VkDescriptorType type, const Buffer& buffer, VkDeviceSize range) {
  const VkDescriptorBufferInfo info{.buffer = buffer.get(), .offset = 0, .range = range};
  VkWriteDescriptorSet write{};
  write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
  write.dstSet = set_;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = type;
  write.pBufferInfo = &info;
  vkUpdateDescriptorSets(device_.device, 1, &write, 0, nullptr);
}

bool FrameBuffers::reserve_materials(VkDeviceSize size) {
  const VkDeviceSize limit = device_.limits().maxStorageBufferRange;
  if (size > limit) {
    throw MachineError("a frame needs " + std::to_string(size) + " bytes of materials; " + device_.physical.info.name +
                       " allows " + std::to_string(limit));
  }
  if (!reserve(materials_, "materials", VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, size)) return false;
  describe(SIMVIS_MATERIALS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, materials_, std::min(limit, materials_.size()));
  return true;
}

void FrameBuffers::reserve_lights(VkDeviceSize size) {
  if (!reserve(lights_, "lights", VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, size)) return;
  describe(SIMVIS_LIGHTS, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, lights_, kLightsRange);
}

void FrameBuffers::write_instances(std::span<const shader::Instance> instances, Uploads& uploads) {
  if (instances.empty()) return;
  reserve(instances_, "instances", VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, instances.size_bytes());
  uploads.write(instances_, 0, std::as_bytes(instances));
}

void FrameBuffers::write_indices(std::span<const std::uint32_t> indices, Uploads& uploads) {
  if (indices.empty()) return;
  reserve(indices_, "indices of the frame", VK_BUFFER_USAGE_INDEX_BUFFER_BIT, indices.size_bytes());
  uploads.write(indices_, 0, std::as_bytes(indices));
}

void FrameBuffers::write_lights(std::span<const shader::LightBlock> lights, Uploads& uploads) {
  reserve_lights(lights.size_bytes() + kLightsRange);  // the last view's range ends within the buffer
  uploads.write(lights_, 0, std::as_bytes(lights));
}

void FrameBuffers::write_materials(const DrawList& list, std::span<const std::uint8_t> wanted, Uploads& uploads) {
  if (std::ranges::find_if(wanted, [](std::uint8_t read) { return read != 0; }) == wanted.end()) return;
  if (reserve_materials(list.materials.size() * sizeof(shader::MaterialBlock))) slots_.clear();
  slots_.resize(list.materials.size());
  for (std::size_t m = 0; m < slots_.size(); ++m) {
    Slot& slot = slots_[m];
    if (!wanted[m] || (slot.material == list.materials[m] && slot.revision == list.material_revision[m])) continue;
    const shader::MaterialBlock block = block_of(*list.materials[m]);
    uploads.write(materials_, m * sizeof block, std::as_bytes(std::span(&block, 1)));
    slot = {list.materials[m], list.material_revision[m]};
  }
}

void FrameBuffers::name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const {
  const auto add = [&](const Buffer& buffer, const char* reason) {
    if (!buffer) return;
    memory.push_back({buffer.desc().name, reason, buffer.memory_bytes(), uploads.bytes_to(buffer)});
  };
  add(instances_, "where each view sees what it draws");
  add(indices_, "triangles that views one pixel high see, picked one by one");
  add(materials_, "what shaders read of surfaces: colour, and where alpha decides");
  add(lights_, "lights as each view of colour has them");
}

}  // namespace simvis
