#include "engine/render/frame_buffers.h"

#include <algorithm>
#include <cstring>
#include <string>

#include <simvis/error.h>
#include "engine/vulkan/texel_buffer.h"

namespace simvis {
namespace {

constexpr VkDeviceSize kFirstSize = 16384;
static_assert(sizeof(shader::LightBlock) == SIMVIS_LIGHT_ROWS * kTexelBytes);

// The smallest alpha that is kept. An opaque surface is kept for any alpha of its texture.
float cutoff_of(const Material& m) {
  switch (m.alpha_mode) {
    case AlphaMode::opaque:
      return 0;
    case AlphaMode::mask:
      return m.alpha_cutoff;
    case AlphaMode::blend:
      return kMinDepthVisibleAlpha;
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
          .uv_row_v = {t[0][1], t[1][1], t[2][1], m.occlusion_strength},
          .finish = {std::max(m.roughness, kMinRoughness), m.opacity, m.metallic, m.normal_scale}};
}
static_assert(kMinRoughness == static_cast<float>(SIMVIS_MIN_ROUGHNESS));

shader::MapPlacesBlock map_places_of(const Material& m) {
  shader::MapPlacesBlock block{};
  for (std::size_t i = 0; i < kMapKinds; ++i) {
    const auto& t = m.maps[i].uv_transform;
    block.row_u[i] = {t[0][0], t[1][0], t[2][0], m.maps[i].uv_set};
    block.row_v[i] = {t[0][1], t[1][1], t[2][1], 0};
  }
  return block;
}

}  // namespace

bool FrameBuffers::reserve(Buffer& buffer, const char* name, VkBufferUsageFlags usage, VkDeviceSize size) {
  if (buffer && size <= buffer.size()) return false;
  buffer = Buffer(device_, {.name = name,
                            .size = std::max({kFirstSize, size, buffer ? 2 * buffer.size() : 0}),
                            .usage = usage,
                            .memory = MemoryKind::dynamic});
  return true;
}

void FrameBuffers::describe(std::uint32_t binding, const Buffer& buffer, VkDeviceSize range) {
  write_descriptor(device_, set_layout_, set_.get(), binding, {.buffer = buffer.get(), .offset = 0, .range = range});
}

bool FrameBuffers::reserve_table(Table& table, const char* name, std::uint32_t binding, VkDeviceSize size) {
  const VkDeviceSize limit = device_.limits().maxStorageBufferRange;
  if (size > limit) {
    throw MachineError("a frame needs " + std::to_string(size) + " bytes of " + name + "; " +
                       device_.physical.info.name + " allows " + std::to_string(limit));
  }
  if (!reserve(table.buffer, name, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, size)) return false;
  describe(binding, table.buffer, std::min(limit, table.buffer.size()));
  return true;
}

void FrameBuffers::reserve_lights(VkDeviceSize size) {
  if (!reserve(lights_, "lights", VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, size)) return;
  light_texels_ = make_texel_view(device_, lights_);
  write_descriptor(device_, set_layout_, set_.get(), SIMVIS_LIGHTS, light_texels_.get());
}

void FrameBuffers::write_instances(std::span<const shader::Instance> instances, Uploads& uploads) {
  if (instances.empty()) return;
  reserve(instances_, "instances", VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, instances.size_bytes());
  uploads.write(instances_, 0, std::as_bytes(instances));
}

void FrameBuffers::write_items(std::span<const std::uint32_t> items, Uploads& uploads) {
  if (items.empty()) return;
  reserve(items_, "items of instances", VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, items.size_bytes());
  uploads.write(items_, 0, std::as_bytes(items));
}

void FrameBuffers::write_indices(std::span<const std::uint32_t> indices, Uploads& uploads) {
  if (indices.empty()) return;
  reserve(indices_, "indices of the frame", VK_BUFFER_USAGE_INDEX_BUFFER_BIT, indices.size_bytes());
  uploads.write(indices_, 0, std::as_bytes(indices));
}

void FrameBuffers::write_cpu_selected(std::span<const std::span<const shader::CpuSelectedVertex>> vertices,
                                      Uploads& uploads) {
  VkDeviceSize size = 0, written = 0;
  for (const std::span<const shader::CpuSelectedVertex> each : vertices) size += each.size_bytes();
  if (size == 0) return;
  reserve(cpu_selected_, "vertices selected on the CPU", VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, size);
  for (const std::span<const shader::CpuSelectedVertex> each : vertices) {
    uploads.write(cpu_selected_, written, std::as_bytes(each));
    written += each.size_bytes();
  }
}

void FrameBuffers::write_copies(std::span<const VertexCopies> copies, Uploads& uploads) {
  std::size_t count = 0;
  for (const VertexCopies& each : copies) count += each.vertices.size();
  if (count == 0) return;
  reserve(copied_positions_, "copied positions", VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, count * sizeof(glm::vec3));
  if (std::ranges::any_of(copies, &VertexCopies::with_attributes)) {
    reserve(copied_attributes_, "copied attributes", VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
            count * sizeof(PackedAttributes));
  }
  std::size_t place = 0;
  for (const VertexCopies& each : copies) {
    for (std::size_t first = 0; first < each.vertices.size(); first += kUploadBlock) {
      const auto block = each.vertices.subspan(first, std::min(kUploadBlock, each.vertices.size() - first));
      positions_.clear();
      for (const std::uint32_t vertex : block) positions_.push_back(each.mesh->positions[vertex]);
      uploads.write(copied_positions_, place * sizeof(glm::vec3), std::as_bytes(std::span(positions_)));
      if (each.with_attributes) {
        packed_.clear();
        append_packed(each.mesh->attributes, block, packed_);
        uploads.write(copied_attributes_, place * sizeof(PackedAttributes), std::as_bytes(std::span(packed_)));
      }
      place += block.size();
    }
  }
}

void FrameBuffers::release_copies() {
  copied_positions_ = Buffer();
  copied_attributes_ = Buffer();
}

void FrameBuffers::write_lights(std::span<const shader::LightBlock> lights, Uploads& uploads) {
  reserve_lights(lights.size_bytes());
  if (!lights.empty()) uploads.write(lights_, 0, std::as_bytes(lights));
}

template <typename Wanted, typename BlockOf>
void FrameBuffers::write_table(Table& table, const DrawList& list, const Wanted& wanted, const BlockOf& block_of,
                               Uploads& uploads) {
  table.slots.resize(list.materials.size());
  for (std::size_t m = 0; m < table.slots.size(); ++m) {
    Slot& slot = table.slots[m];
    if (!wanted(m) || (slot.material == list.materials[m] && slot.revision == list.material_revision[m])) continue;
    const auto block = block_of(*list.materials[m]);
    uploads.write(table.buffer, m * sizeof block, std::as_bytes(std::span(&block, 1)));
    slot = {list.materials[m], list.material_revision[m]};
  }
}

void FrameBuffers::write_materials(const DrawList& list, std::span<const std::uint8_t> wanted, Uploads& uploads) {
  if (std::ranges::find_if(wanted, [](std::uint8_t read) { return read != 0; }) == wanted.end()) return;
  const VkDeviceSize size = list.materials.size() * sizeof(shader::MaterialBlock);
  if (reserve_table(materials_, "materials", SIMVIS_MATERIALS, size)) materials_.slots.clear();
  write_table(
      materials_, list, [&](std::size_t m) { return wanted[m] != 0; }, block_of, uploads);
}

void FrameBuffers::write_map_places(const DrawList& list, std::span<const std::uint8_t> shown, Uploads& uploads) {
  const auto has_maps = [&](std::size_t m) { return shown[m] >> SIMVIS_FIRST_MAP != 0; };
  std::size_t end = list.materials.size();
  while (end > 0 && !has_maps(end - 1)) --end;
  if (end == 0) return;
  const VkDeviceSize size = end * sizeof(shader::MapPlacesBlock);
  if (reserve_table(map_places_, "places of maps", SIMVIS_MAP_PLACES, size)) map_places_.slots.clear();
  write_table(map_places_, list, has_maps, map_places_of, uploads);
}

void FrameBuffers::name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const {
  const auto add = [&](const Buffer& buffer, const char* reason) {
    if (!buffer) return;
    memory.push_back({buffer.desc().name, reason, buffer.memory_bytes(), uploads.bytes_to(buffer)});
  };
  add(instances_, "instance transforms of each view");
  add(items_, "items of the instances of views whose items are read");
  add(indices_, "triangles that views see, selected on the CPU one by one");
  add(cpu_selected_, "triangles without holes that strips see, selected on the CPU one by one");
  add(copied_positions_, "points of large clouds and corners of triangles of large meshes that views see");
  add(copied_attributes_, "normals, colours and texture coordinates of these vertices");
  add(materials_.buffer, "materials that shaders read");
  add(map_places_.buffer, "texture transforms of maps");
  add(lights_, "lights of each colour view");
}

}  // namespace simvis
