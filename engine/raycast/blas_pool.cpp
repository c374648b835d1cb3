#include "engine/raycast/blas_pool.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "shaders/interop.h"

namespace simvis {

namespace {

static_assert(sizeof(BvhNode) == sizeof(shader::TreeNode) && Bvh::kMaxDepth == SIMVIS_TREE_DEPTH);

constexpr std::uint64_t kFirst = 1024;

glm::uvec3 bits_of(const glm::vec3& v) {
  return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y), std::bit_cast<std::uint32_t>(v.z)};
}

Buffer make_buffer(DeviceImpl& device, const char* name, VkDeviceSize size) {
  return Buffer(device, {.name = name,
                         .size = size,
                         .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                  VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                         .memory = MemoryKind::device});
}

}  // namespace

bool BlasPool::update(const RayInstances& items, Uploads& uploads) {
  for (auto& [mesh, entry] : entries_) entry.wanted = false;
  std::vector<std::pair<const Blas*, Bvh>> fresh;
  std::uint64_t nodes = 0, triangles = 0;
  for (const RayInstance& item : items.items()) {
    const Blas& mesh = *item.mesh;
    const auto [found, added] = entries_.try_emplace(mesh.mesh().get());
    Entry& entry = found->second;
    entry.wanted = true;
    if (!added) continue;
    entry.mesh = mesh.mesh();
    const bool by_host = mesh.by_host();  // see block_of()
    fresh.emplace_back(&mesh, by_host ? Bvh{} : mesh.make_device_tree());
    entry.nodes = fresh.back().second.nodes.size();
    entry.triangles = by_host ? 0 : mesh.triangles();
    nodes += entry.nodes;
    triangles += entry.triangles;
  }
  std::erase_if(entries_, [](const auto& entry) { return !entry.second.wanted; });
  const bool moved = make_room(nodes, triangles, uploads);
  for (const auto& [mesh, tree] : fresh) upload(*mesh, tree, entries_.at(mesh->mesh().get()), uploads);
  return moved;
}

BlasPool::Place BlasPool::place(const Blas& mesh) const {
  const auto found = entries_.find(mesh.mesh().get());
  SIMVIS_ASSERT(found != entries_.end() && found->second.resident);
  return {static_cast<std::uint32_t>(found->second.first_node),
          static_cast<std::uint32_t>(found->second.first_triangle)};
}

// Adds half of the needed size, so that a scene that grows part by part is not copied each time.
std::uint64_t BlasPool::capacity(std::uint64_t needed, std::uint64_t stride) const {
  const std::uint64_t most = device_.limits().maxStorageBufferRange / stride;
  if (needed > most) {
    throw MachineError("rays cannot be cast: the scene's meshes need a buffer of " + std::to_string(needed * stride) +
                       " bytes, and " + device_.physical.info.name + " addresses " + std::to_string(most * stride));
  }
  return std::min(most, std::max(kFirst, needed + needed / 2));
}

bool BlasPool::make_room(std::uint64_t nodes, std::uint64_t triangles, Uploads& uploads) {
  // The shader's bindings need buffers even if all meshes are exact shapes, which have no nodes.
  const bool is_bound = nodes_ || entries_.empty();
  if (is_bound && nodes_used_ + nodes <= node_capacity_ && triangles_used_ + triangles <= triangle_capacity_) {
    return false;
  }
  std::vector<Entry*> living;
  std::uint64_t living_nodes = 0, living_triangles = 0;
  for (auto& [mesh, entry] : entries_) {
    if (!entry.resident) continue;
    living.push_back(&entry);
    living_nodes += entry.nodes;
    living_triangles += entry.triangles;
  }
  const std::uint64_t node_capacity = capacity(living_nodes + nodes, sizeof(shader::TreeNode));
  const std::uint64_t triangle_capacity = capacity(living_triangles + triangles, sizeof(shader::RayTriangle));
  Buffer new_nodes = make_buffer(device_, "ray mesh nodes", node_capacity * sizeof(shader::TreeNode));
  Buffer new_triangles = make_buffer(device_, "ray triangles", triangle_capacity * sizeof(shader::RayTriangle));
  // The meshes keep their order, so that the same history gives the same layout.
  std::ranges::sort(living, {}, &Entry::first_node);
  nodes_used_ = triangles_used_ = 0;
  for (Entry* entry : living) {
    uploads.copy(nodes_, new_nodes, entry->first_node * sizeof(shader::TreeNode),
                 nodes_used_ * sizeof(shader::TreeNode), entry->nodes * sizeof(shader::TreeNode));
    uploads.copy(triangles_, new_triangles, entry->first_triangle * sizeof(shader::RayTriangle),
                 triangles_used_ * sizeof(shader::RayTriangle), entry->triangles * sizeof(shader::RayTriangle));
    entry->first_node = nodes_used_;
    entry->first_triangle = triangles_used_;
    nodes_used_ += entry->nodes;
    triangles_used_ += entry->triangles;
  }
  nodes_ = std::move(new_nodes);
  triangles_ = std::move(new_triangles);
  node_capacity_ = node_capacity;
  triangle_capacity_ = triangle_capacity;
  return true;
}

void BlasPool::upload(const Blas& mesh, const Bvh& tree, Entry& entry, Uploads& uploads) {
  entry.first_node = nodes_used_;
  entry.first_triangle = triangles_used_;
  entry.resident = true;
  nodes_used_ += entry.nodes;
  triangles_used_ += entry.triangles;
  uploads.write(nodes_, entry.first_node * sizeof(shader::TreeNode), std::as_bytes(std::span(tree.nodes)));
  std::vector<shader::RayTriangle> triangles;
  triangles.reserve(entry.triangles);
  for (const std::uint32_t primitive : tree.order) {
    const auto [a, b, c] = mesh.unit_corners(primitive);
    triangles.push_back({glm::uvec4(bits_of(a), primitive), glm::vec4(b, 0), glm::vec4(c, 0)});
  }
  uploads.write(triangles_, entry.first_triangle * sizeof(shader::RayTriangle), std::as_bytes(std::span(triangles)));
}

void BlasPool::clear() {
  entries_.clear();
  nodes_used_ = triangles_used_ = node_capacity_ = triangle_capacity_ = 0;
  nodes_ = {};
  triangles_ = {};
}

}  // namespace simvis
