// What the shaders read through descriptor set 0: instances, materials, lights.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/buffer.h"
#include "engine/draw_list.h"
#include "engine/uploads.h"
#include "shaders/interop.h"

namespace simvis {

/// Buffers that the host writes while nothing is in flight. Instances and lights are written anew in each frame; a
/// material's slot only when the material has changed.
class FrameBuffers {
 public:
  FrameBuffers(Device::Impl& device, VkDescriptorSetLayout set_layout);

  /// Brings slot m up to date with list.materials[m], for each m with wanted[m] != 0.
  void write_materials(const DrawList& list, std::span<const std::uint8_t> wanted, Uploads& uploads);
  void write_instances(std::span<const shader::Instance> instances, Uploads& uploads);
  void write_lights(std::span<const shader::LightBlock> lights, Uploads& uploads);

  VkDescriptorSet set() const { return set_; }

  /// Forgets which materials are up to date.
  void clear() { slots_.clear(); }

 private:
  struct Slot {
    std::shared_ptr<const Material> material;  // null: nothing written yet
    std::uint64_t revision = 0;
  };
  // Makes the buffer of a binding hold `size` bytes; true if it is a new one, whose content is undefined.
  bool reserve(std::uint32_t binding, VkDeviceSize size);
  void write(std::uint32_t binding, std::span<const std::byte> data, Uploads& uploads);

  Device::Impl& device_;
  Handle<VkDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;  // freed with its pool
  Buffer buffers_[3];                     // by binding
  std::vector<Slot> slots_;
};

}  // namespace simvis
