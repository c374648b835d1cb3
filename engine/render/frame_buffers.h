// Per-frame buffers that shaders read: instances as vertex inputs, materials and lights through descriptor set 0.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "engine/render/geometry_pool.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/descriptor_sets.h"
#include "engine/vulkan/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// The host writes these buffers while no submission is in flight. Each buffer is created when it is first needed.
/// Instances and lights are rewritten in each frame; the slot of a material is rewritten only when the material has
/// changed.
class FrameBuffers {
 public:
  FrameBuffers(DeviceImpl& device, const DescriptorLayout& set_layout)
      : device_(device), set_layout_(set_layout), set_(device, set_layout, 1, "frame set") {}

  /// Updates slot m from list.materials[m], for each m with wanted[m] != 0.
  void write_materials(const DrawList& list, std::span<const std::uint8_t> wanted, Uploads& uploads);
  /// Updates the texture transforms of the maps of material m that shown[m] selects (see DrawCache::textures_shown()).
  void write_map_places(const DrawList& list, std::span<const std::uint8_t> shown, Uploads& uploads);
  void write_instances(std::span<const shader::Instance> instances, Uploads& uploads);
  /// The item of each instance, for passes with items.
  void write_items(std::span<const std::uint32_t> items, Uploads& uploads);
  void write_indices(std::span<const std::uint32_t> indices, Uploads& uploads);
  /// Writes the spans one after the other, without gaps.
  void write_cpu_selected(std::span<const std::span<const shader::CpuSelectedVertex>> vertices, Uploads& uploads);
  /// Writes the vertices one copy after the other; attributes only of copies with attributes.
  void write_copies(std::span<const VertexCopies> copies, Uploads& uploads);
  /// Releases the buffers of copies. No frame that uses them is under way.
  void release_copies();
  /// Required for each frame that shows colour, even without lights, because its shaders refer to the buffer.
  void write_lights(std::span<const shader::LightBlock> lights, Uploads& uploads);

  /// Appends the buffers of this object to `memory`.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  VkBuffer instances() const { return instances_.get(); }
  VkBuffer items() const { return items_.get(); }
  VkBuffer indices() const { return indices_.get(); }
  VkBuffer cpu_selected() const { return cpu_selected_.get(); }
  VkBuffer copied_positions() const { return copied_positions_.get(); }
  VkBuffer copied_attributes() const { return copied_attributes_.get(); }
  VkDescriptorSet set() const { return set_.get(); }

  /// Marks the slots of all materials as not written.
  void clear() {
    materials_.slots.clear();
    map_places_.slots.clear();
  }

 private:
  struct Slot {
    std::shared_ptr<const Material> material;  // null if the slot has not been written
    std::uint64_t revision = 0;
  };
  // A buffer with one block for each material.
  struct Table {
    Buffer buffer;
    std::vector<Slot> slots;
  };
  // Ensures that a buffer holds `size` bytes. Returns true if the buffer is new; its content is then undefined.
  bool reserve(Buffer& buffer, const char* name, VkBufferUsageFlags usage, VkDeviceSize size);
  bool reserve_table(Table& table, const char* name, std::uint32_t binding, VkDeviceSize size);
  template <typename Wanted, typename BlockOf>
  void write_table(Table& table, const DrawList& list, const Wanted& wanted, const BlockOf& block_of, Uploads& uploads);
  void reserve_lights(VkDeviceSize size);
  void describe(std::uint32_t binding, const Buffer& buffer, VkDeviceSize range);

  DeviceImpl& device_;
  const DescriptorLayout& set_layout_;
  DescriptorSets set_;
  Buffer instances_, items_, indices_, cpu_selected_, copied_positions_, copied_attributes_, lights_;
  Handle<VkBufferView> light_texels_;  // of lights_
  Table materials_, map_places_;
  std::vector<glm::vec3> positions_;      // a block of copies
  std::vector<PackedAttributes> packed_;  // the same
};

}  // namespace simvis
