// All meshes of a draw list in three device buffers: positions, other vertex attributes and indices.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/mesh.h>
#include "engine/culling/mesh_range.h"
#include "engine/geometry/clusters.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// The vertex attributes other than the position, as the GPU reads them. Colours are clamped to [0, 1].
struct PackedAttributes {
  std::int16_t normal[4];
  float uv[2][2];
  std::uint16_t color[4];
};
static_assert(sizeof(PackedAttributes) == 32);

/// Appends the attributes of some vertices.
void append_packed(std::span<const VertexAttributes> attributes, std::span<const std::uint32_t> vertices,
                   std::vector<PackedAttributes>& packed);

/// Vertices of a mesh that a frame copies to the device.
struct VertexCopies {
  const Mesh* mesh = nullptr;
  std::span<const std::uint32_t> vertices{};
  bool with_attributes = false;
};

/// Data that is converted for the upload is converted in blocks of about this size, so that no full second copy exists.
inline constexpr std::size_t kUploadBlock = 1u << 16;

/// The data of a mesh that a draw list needs: `clusters` on the host, from which views select triangles and points;
/// with normal cones of these, if it is `shaded`; clusters, with `positions` and indices on the device; all of these
/// with `attributes` on the device. A list is shaded as a whole or not at all, so that the larger of two uses of a mesh
/// includes the other.
enum class MeshUse : std::uint8_t { none, clusters, shaded_clusters, positions, attributes };

/// Meshes are identified by address. Each mesh is split into clusters and uploaded once, and is released when the list
/// no longer contains it. The buffers are filled from the front. When a buffer is full, the device copies the meshes
/// still in use to the front of larger buffers. Indices are uploaded in the order of the clusters of the mesh.
/// Attributes have the same vertex numbers as positions. Data that no list has needed on the device is not uploaded.
class GeometryPool {
 public:
  explicit GeometryPool(DeviceImpl& device) : device_(device) {}

  /// Prepares the meshes of a list. `uses[i]` and entry i of the result belong to meshes[i]. The result is valid until
  /// the next call. Throws MachineError if the meshes do not fit.
  std::span<const MeshRange> update(std::span<const std::shared_ptr<const Mesh>> meshes, std::span<const MeshUse> uses,
                                    Uploads& uploads);

  /// Returns the number of meshes on the device and their size in bytes.
  void count(std::uint64_t& meshes, std::uint64_t& bytes) const;

  /// Appends the buffers of this object to `memory`.
  void name_memory(const Uploads& uploads, std::vector<PlannedMemory>& memory) const;

  /// Null handles if no mesh has needed the buffer.
  VkBuffer positions() const { return positions_.get(); }
  VkBuffer attributes() const { return attributes_.get(); }
  VkBuffer indices() const { return indices_.get(); }

  /// Releases all meshes and buffers.
  void clear();

 private:
  struct Entry {
    std::shared_ptr<const Mesh> mesh;  // ownership prevents reuse of the address by another mesh
    Clustering clustering;
    std::vector<Occluder> occluders;
    FacePlanes flat;
    std::vector<NormalCone> facing;
    std::uint64_t first_vertex = 0, first_index = 0;
    bool resident = false, has_attributes = false;  // on the device
    MeshUse use = MeshUse::none;                    // in the current list

    bool lacks_place() const { return use >= MeshUse::positions && !resident; }
  };
  void cut_into_clusters(std::span<Entry* const> fresh, const std::filesystem::path& cache);
  void place_new(std::span<const std::shared_ptr<const Mesh>> meshes, Uploads& uploads);
  void make_room(std::uint64_t vertices, std::uint64_t indices, Uploads& uploads);
  void place(Entry& entry, Uploads& uploads);
  void upload_indices(const Entry& entry, Uploads& uploads);
  void upload_attributes(Entry& entry, Uploads& uploads);

  Buffer make_buffer(const char* name, VkDeviceSize size, VkBufferUsageFlags usage);

  DeviceImpl& device_;
  Buffer positions_, attributes_, indices_;
  std::uint64_t vertex_capacity_ = 0, index_capacity_ = 0;
  std::uint64_t vertices_used_ = 0, indices_used_ = 0;
  std::unordered_map<const Mesh*, Entry> entries_;
  std::vector<MeshRange> ranges_;
  std::vector<std::uint32_t> unpacked_;   // staging block during an upload
  std::vector<PackedAttributes> packed_;  // staging block during an upload
};

}  // namespace simvis
