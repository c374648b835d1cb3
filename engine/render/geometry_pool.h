// All meshes of a draw list in three device buffers: positions, other attributes, indices.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/mesh.h>
#include "engine/culling/face_planes.h"
#include "engine/culling/normal_cone.h"
#include "engine/culling/occluders.h"
#include "engine/geometry/clusters.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// Where a mesh lies, in the terms of vkCmdDrawIndexed, if it is on the device; and its clusters.
struct MeshRange {
  std::uint32_t first_index = 0, index_count = 0;
  std::int32_t vertex_offset = 0;
  std::span<const Cluster> clusters{};  ///< their index numbers count from the mesh's first
  const Clustering* clustering = nullptr;
  std::span<const NormalCone> facing{};    ///< of each cluster, of triangles that are shaded; else empty
  std::span<const glm::vec3> positions{};  ///< in host memory
  std::span<const Occluder> occluders{};   ///< of triangles
  const FacePlanes* flat = nullptr;
};

/// What a vertex carries besides its position, as the GPU reads it. Colours beyond 1 are clamped.
struct PackedAttributes {
  std::int16_t normal[4];
  float uv[2][2];
  std::uint16_t color[4];
};
static_assert(sizeof(PackedAttributes) == 32);

/// What a draw list needs of a mesh, each with all before it: its clusters, from which strips pick triangles on the
/// host; positions and indices on the device; attributes there.
enum class MeshUse : std::uint8_t { none, clusters, positions, attributes };

/// Meshes are told apart by identity, cut into clusters and uploaded once, and forgotten once a list no longer holds
/// them. The buffers are filled from the front; when the end is reached, what still lives moves to the front of larger
/// ones, within the device. Indices are uploaded in the order of the mesh's clusters. Attributes lie at the same vertex
/// numbers as positions. What no list has needed on the device is not there.
class GeometryPool {
 public:
  explicit GeometryPool(Device::Impl& device) : device_(device) {}

  /// Makes the meshes of a list ready; `uses[i]` and the result's entry i belong to meshes[i]. Valid until the next
  /// call. Throws MachineError when they do not fit.
  std::span<const MeshRange> update(std::span<const std::shared_ptr<const Mesh>> meshes, std::span<const MeshUse> uses,
                                    Uploads& uploads);

  /// How many meshes it holds on the device, and how many bytes of them.
  void count(std::uint64_t& meshes, std::uint64_t& bytes) const;

  /// Adds its buffers.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  /// Null handles where nothing has needed them.
  VkBuffer positions() const { return positions_.get(); }
  VkBuffer attributes() const { return attributes_.get(); }
  VkBuffer indices() const { return indices_.get(); }

  /// Forgets everything.
  void clear();

 private:
  struct Entry {
    std::shared_ptr<const Mesh> mesh;  // keeps the address from being given to another mesh
    Clustering clustering;
    std::vector<Occluder> occluders;
    FacePlanes flat;
    std::vector<NormalCone> facing;
    std::uint64_t first_vertex = 0, first_index = 0;
    bool resident = false, has_attributes = false;  // on the device
    MeshUse use = MeshUse::none;                    // by this list

    bool lacks_place() const { return use >= MeshUse::positions && !resident; }
  };
  void cut_into_clusters(std::span<Entry* const> fresh, const std::filesystem::path& cache);
  void place_new(std::span<const std::shared_ptr<const Mesh>> meshes, Uploads& uploads);
  void make_room(std::uint64_t vertices, std::uint64_t indices, Uploads& uploads);
  void place(Entry& entry, Uploads& uploads);
  void upload_indices(const Entry& entry, Uploads& uploads);
  void upload_attributes(Entry& entry, Uploads& uploads);

  Buffer make_buffer(const char* name, VkDeviceSize size, VkBufferUsageFlags usage);

  Device::Impl& device_;
  Buffer positions_, attributes_, indices_;
  std::uint64_t vertex_capacity_ = 0, index_capacity_ = 0;
  std::uint64_t vertices_used_ = 0, indices_used_ = 0;
  std::unordered_map<const Mesh*, Entry> entries_;
  std::vector<MeshRange> ranges_;
  std::vector<std::uint32_t> unpacked_;   // a block of what is being uploaded
  std::vector<PackedAttributes> packed_;  // likewise
};

}  // namespace simvis
