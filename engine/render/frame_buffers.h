// What the shaders read of a frame: instances as vertex inputs; materials and lights through descriptor set 0.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// Buffers that the host writes while nothing is in flight, each made when it is first needed. Instances and lights are
/// written anew in each frame; a material's slot only when the material has changed.
class FrameBuffers {
 public:
  FrameBuffers(Device::Impl& device, VkDescriptorSetLayout set_layout);

  /// Brings slot m up to date with list.materials[m], for each m with wanted[m] != 0.
  void write_materials(const DrawList& list, std::span<const std::uint8_t> wanted, Uploads& uploads);
  /// Likewise the places of its maps, where shown[m] names some (see DrawCache::textures_shown()).
  void write_map_places(const DrawList& list, std::span<const std::uint8_t> shown, Uploads& uploads);
  void write_instances(std::span<const shader::Instance> instances, Uploads& uploads);
  void write_indices(std::span<const std::uint32_t> indices, Uploads& uploads);
  /// Those of each span behind those of the one before.
  void write_cpu_selected(std::span<const std::span<const shader::CpuSelectedVertex>> vertices, Uploads& uploads);
  /// For frames that show colour, also without lights: their shaders name the buffer.
  void write_lights(std::span<const shader::LightBlock> lights, Uploads& uploads);

  /// Adds its buffers.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  VkBuffer instances() const { return instances_.get(); }
  VkBuffer indices() const { return indices_.get(); }
  VkBuffer cpu_selected() const { return cpu_selected_.get(); }
  VkDescriptorSet set() const { return set_; }

  /// Forgets which materials are up to date.
  void clear() {
    materials_.slots.clear();
    map_places_.slots.clear();
  }

 private:
  struct Slot {
    std::shared_ptr<const Material> material;  // null: nothing written yet
    std::uint64_t revision = 0;
  };
  // Something of each material.
  struct Table {
    Buffer buffer;
    std::vector<Slot> slots;
  };
  // Makes a buffer hold `size` bytes; true if it is a new one, whose content is undefined.
  bool reserve(Buffer& buffer, const char* name, VkBufferUsageFlags usage, VkDeviceSize size);
  bool reserve_table(Table& table, const char* name, std::uint32_t binding, VkDeviceSize size);
  template <typename Wanted, typename BlockOf>
  void write_table(Table& table, const DrawList& list, const Wanted& wanted, const BlockOf& block_of, Uploads& uploads);
  void reserve_lights(VkDeviceSize size);
  void describe(std::uint32_t binding, VkDescriptorType type, const Buffer& buffer, VkDeviceSize range);

  Device::Impl& device_;
  Handle<VkDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;  // freed with its pool
  Buffer instances_, indices_, cpu_selected_, lights_;
  Table materials_, map_places_;
};

}  // namespace simvis
