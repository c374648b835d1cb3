#include "engine/render/geometry_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/geometry/cluster_cache.h"

namespace simvis {
namespace {

constexpr std::uint64_t kFirstVertices = 4096, kFirstIndices = 16384;
constexpr VkBufferUsageFlags kCopied = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
constexpr VkBufferUsageFlags kVertexUsage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | kCopied;
constexpr VkBufferUsageFlags kIndexUsage = VK_BUFFER_USAGE_INDEX_BUFFER_BIT | kCopied;

// The first load allocates exactly what it needs. Later growth adds half of what there is, so that a scene that grows
// part by part is not moved each time.
std::uint64_t capacity_for(std::uint64_t living, std::uint64_t added, std::uint64_t least) {
  const std::uint64_t needed = living + added;
  if (needed > std::numeric_limits<std::int32_t>::max()) {
    throw MachineError("the scene's meshes hold more than 2^31 vertices or indices, which Vulkan cannot address");
  }
  return std::max(least, needed + living / 2);
}

// As std::lround() of values of at most 16 bits, in a fraction of its time: the sum is exact in double.
std::int32_t rounded(float value) {
  return static_cast<std::int32_t>(double{value} + std::copysign(0.5, double{value}));
}

std::int16_t snorm16(float value) {
  return static_cast<std::int16_t>(rounded(std::clamp(value, -1.0f, 1.0f) * 32767.0f));
}

std::uint16_t unorm16(float value) {
  return static_cast<std::uint16_t>(rounded(std::clamp(value, 0.0f, 1.0f) * 65535.0f));
}

PackedAttributes pack(const VertexAttributes& a) {
  return {.normal = {snorm16(a.normal.x), snorm16(a.normal.y), snorm16(a.normal.z), 0},
          .uv = {{a.uv[0].x, a.uv[0].y}, {a.uv[1].x, a.uv[1].y}},
          .color = {unorm16(a.color.r), unorm16(a.color.g), unorm16(a.color.b), unorm16(a.color.a)}};
}

void check(const Mesh& mesh) {
  SIMVIS_ASSERT(mesh.attributes.size() == mesh.positions.size());
  const auto largest = std::max_element(mesh.indices.begin(), mesh.indices.end());
  SIMVIS_ASSERT(*largest < mesh.positions.size());
}

}  // namespace

void append_packed(std::span<const VertexAttributes> attributes, std::span<const std::uint32_t> vertices,
                   std::vector<PackedAttributes>& packed) {
  const VertexAttributes* last = nullptr;
  for (const std::uint32_t vertex : vertices) {
    // Points of a cloud mostly have the attributes of the point before.
    const VertexAttributes& a = attributes[vertex];
    packed.push_back(last != nullptr && a == *last ? packed.back() : pack(a));
    last = &a;
  }
}

std::span<const MeshRange> GeometryPool::update(std::span<const std::shared_ptr<const Mesh>> meshes,
                                                std::span<const MeshUse> uses, Uploads& uploads) {
  // Only the first load uses the disk cache: later meshes may be new in each frame, as deforming meshes are.
  const std::filesystem::path cache = entries_.empty() ? device_.cache_folder : "";
  for (auto& [mesh, entry] : entries_) entry.use = MeshUse::none;
  std::vector<Entry*> fresh;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (uses[i] == MeshUse::none || meshes[i]->indices.empty()) continue;
    const auto [found, added] = entries_.try_emplace(meshes[i].get());
    found->second.use = std::max(found->second.use, uses[i]);
    if (!added) continue;
    check(*meshes[i]);
    found->second.mesh = meshes[i];
    fresh.push_back(&found->second);
  }
  std::erase_if(entries_, [](const auto& entry) { return entry.second.use == MeshUse::none; });
  cut_into_clusters(fresh, cache);
  place_new(meshes, uploads);
  ranges_.assign(meshes.size(), MeshRange{});
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto found = entries_.find(meshes[i].get());
    if (found == entries_.end()) continue;
    Entry& entry = found->second;
    if (uses[i] == MeshUse::attributes && !entry.has_attributes) upload_attributes(entry, uploads);
    const bool shaded = uses[i] == MeshUse::attributes || uses[i] == MeshUse::shaded_clusters;
    if (shaded && entry.facing.empty() && entry.mesh->topology == Topology::triangles) {
      entry.facing = normal_cones_of(*entry.mesh, entry.clustering, device_.threads.get());
    }
    ranges_[i] = {.first_index = static_cast<std::uint32_t>(entry.first_index),
                  .index_count = static_cast<std::uint32_t>(entry.mesh->indices.size()),
                  .vertex_offset = static_cast<std::int32_t>(entry.first_vertex),
                  .clusters = entry.clustering.clusters,
                  .clustering = &entry.clustering,
                  .resident = entry.use >= MeshUse::positions,
                  .facing = entry.facing,
                  .positions = entry.mesh->positions,
                  .occluders = entry.occluders,
                  .flat = &entry.flat,
                  .bounds_min = entry.mesh->bounds_min,
                  .bounds_max = entry.mesh->bounds_max};
  }
  return ranges_;
}

void GeometryPool::cut_into_clusters(std::span<Entry* const> fresh, const std::filesystem::path& cache) {
  std::uint64_t indices = 0, done = 0;
  for (const Entry* entry : fresh) indices += entry->mesh->indices.size();
  for (Entry* entry : fresh) {
    device_.report({"preparing meshes", done, indices});
    entry->clustering = make_clusters_cached(*entry->mesh, cache, device_.threads.get());
    if (entry->mesh->topology == Topology::triangles) {
      entry->occluders = extract_occluders(*entry->mesh, entry->clustering);
      entry->flat = face_planes_of(*entry->mesh, entry->clustering);
    }
    done += entry->mesh->indices.size();
  }
}

// Places new meshes in the order of the list, so that the same list gives the same layout.
void GeometryPool::place_new(std::span<const std::shared_ptr<const Mesh>> meshes, Uploads& uploads) {
  std::uint64_t vertices = 0, indices = 0;
  for (const auto& [mesh, entry] : entries_) {
    if (!entry.lacks_place()) continue;
    vertices += mesh->positions.size();
    indices += mesh->indices.size();
  }
  if (indices == 0) return;
  // make_room() may move only meshes that are uploaded, so new meshes get their places after this call.
  make_room(vertices, indices, uploads);
  for (const std::shared_ptr<const Mesh>& mesh : meshes) {
    const auto found = entries_.find(mesh.get());
    if (found != entries_.end() && found->second.lacks_place()) place(found->second, uploads);
  }
}

void GeometryPool::make_room(std::uint64_t vertices, std::uint64_t indices, Uploads& uploads) {
  if (vertices_used_ + vertices <= vertex_capacity_ && indices_used_ + indices <= index_capacity_) return;
  std::vector<Entry*> living;
  std::uint64_t living_vertices = 0, living_indices = 0;
  for (auto& [mesh, entry] : entries_) {
    if (!entry.resident) continue;
    living.push_back(&entry);
    living_vertices += mesh->positions.size();
    living_indices += mesh->indices.size();
  }
  const std::uint64_t vertex_capacity = capacity_for(living_vertices, vertices, kFirstVertices);
  const std::uint64_t index_capacity = capacity_for(living_indices, indices, kFirstIndices);
  Buffer positions = make_buffer("mesh positions", vertex_capacity * sizeof(glm::vec3), kVertexUsage);
  Buffer index_buffer = make_buffer("mesh indices", index_capacity * sizeof(std::uint32_t), kIndexUsage);
  Buffer attributes;
  if (attributes_) {
    attributes = make_buffer("mesh attributes", vertex_capacity * sizeof(PackedAttributes), kVertexUsage);
  }
  // Meshes keep their order, so that the same history gives the same layout.
  std::sort(living.begin(), living.end(),
            [](const Entry* a, const Entry* b) { return a->first_vertex < b->first_vertex; });
  vertices_used_ = indices_used_ = 0;
  const auto move = [&](const Buffer& from, const Buffer& to, std::uint64_t old_first, std::uint64_t new_first,
                        std::uint64_t count, std::uint64_t stride) {
    uploads.copy(from, to, old_first * stride, new_first * stride, count * stride);
  };
  for (Entry* entry : living) {
    const std::uint64_t vertex_count = entry->mesh->positions.size(), index_count = entry->mesh->indices.size();
    move(positions_, positions, entry->first_vertex, vertices_used_, vertex_count, sizeof(glm::vec3));
    move(indices_, index_buffer, entry->first_index, indices_used_, index_count, sizeof(std::uint32_t));
    if (entry->has_attributes) {
      move(attributes_, attributes, entry->first_vertex, vertices_used_, vertex_count, sizeof(PackedAttributes));
    }
    entry->first_vertex = vertices_used_;
    entry->first_index = indices_used_;
    vertices_used_ += vertex_count;
    indices_used_ += index_count;
  }
  positions_ = std::move(positions);
  indices_ = std::move(index_buffer);
  attributes_ = std::move(attributes);
  vertex_capacity_ = vertex_capacity;
  index_capacity_ = index_capacity;
}

void GeometryPool::place(Entry& entry, Uploads& uploads) {
  const Mesh& mesh = *entry.mesh;
  entry.first_vertex = vertices_used_;
  entry.first_index = indices_used_;
  entry.resident = true;
  vertices_used_ += mesh.positions.size();
  indices_used_ += mesh.indices.size();
  uploads.write(positions_, entry.first_vertex * sizeof(glm::vec3), std::as_bytes(std::span(mesh.positions)));
  upload_indices(entry, uploads);
}

void GeometryPool::upload_indices(const Entry& entry, Uploads& uploads) {
  std::uint64_t place = entry.first_index;
  const auto write = [&](std::span<const std::uint32_t> indices) {
    uploads.write(indices_, place * sizeof(std::uint32_t), std::as_bytes(indices));
    place += indices.size();
  };
  if (entry.mesh->topology != Topology::triangles) return write(entry.mesh->indices);
  unpacked_.clear();
  for (const Cluster& cluster : entry.clustering.clusters) {
    const ClusterVertices vertices = entry.clustering.vertices_of(cluster);
    for (const std::uint8_t corner : entry.clustering.corners_of(cluster)) unpacked_.push_back(vertices[corner]);
    if (unpacked_.size() < kUploadBlock && &cluster != &entry.clustering.clusters.back()) continue;
    write(unpacked_);
    unpacked_.clear();
  }
}

void GeometryPool::upload_attributes(Entry& entry, Uploads& uploads) {
  if (!attributes_) {
    attributes_ = make_buffer("mesh attributes", vertex_capacity_ * sizeof(PackedAttributes), kVertexUsage);
  }
  const std::span<const VertexAttributes> attributes = entry.mesh->attributes;
  for (std::size_t first = 0; first < attributes.size(); first += kUploadBlock) {
    packed_.clear();
    for (const VertexAttributes& a : attributes.subspan(first, std::min(kUploadBlock, attributes.size() - first))) {
      // Points of a cloud mostly have the attributes of the point before.
      packed_.push_back(!packed_.empty() && a == *(&a - 1) ? packed_.back() : pack(a));
    }
    uploads.write(attributes_, (entry.first_vertex + first) * sizeof(PackedAttributes),
                  std::as_bytes(std::span(packed_)));
  }
  entry.has_attributes = true;
}

Buffer GeometryPool::make_buffer(const char* name, VkDeviceSize size, VkBufferUsageFlags usage) {
  return Buffer(device_, {.name = name, .size = size, .usage = usage, .memory = MemoryKind::device});
}

void GeometryPool::count(std::uint64_t& meshes, std::uint64_t& bytes) const {
  meshes = bytes = 0;
  for (const auto& [mesh, entry] : entries_) {
    if (!entry.resident) continue;
    ++meshes;
    const std::size_t vertex = sizeof(glm::vec3) + (entry.has_attributes ? sizeof(PackedAttributes) : 0);
    bytes += mesh->positions.size() * vertex + mesh->indices.size() * sizeof(std::uint32_t);
  }
}

void GeometryPool::name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const {
  const auto placed = std::ranges::count_if(entries_, [](const auto& entry) { return entry.second.resident; });
  const std::string meshes = std::to_string(placed) + " meshes";
  const auto add = [&](const Buffer& buffer, const std::string& reason) {
    if (!buffer) return;
    memory.push_back({buffer.desc().name, reason, buffer.memory_bytes(), uploads.bytes_to(buffer)});
  };
  add(positions_, meshes);
  add(indices_, meshes);
  const auto shown = std::ranges::count_if(entries_, [](const auto& entry) { return entry.second.has_attributes; });
  add(attributes_,
      "normals, colours and texture coordinates of the " + std::to_string(shown) + " meshes that colour or masks show");
}

void GeometryPool::clear() {
  entries_.clear();
  vertices_used_ = indices_used_ = vertex_capacity_ = index_capacity_ = 0;
  positions_ = {};
  attributes_ = {};
  indices_ = {};
}

}  // namespace simvis
