// What the renderer hands back: the pixels of each pass, and what drawing them cost.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace simvis {

/// What a frame cost, counted and not timed.
struct FrameCounters {
  std::uint64_t passes = 0, views = 0, draws = 0, triangles = 0, pipelines_bound = 0, dispatches = 0;
  std::uint64_t pipelines_made = 0;  ///< compiled, or taken from the cache of earlier runs
  std::uint64_t bytes_uploaded = 0, bytes_read_back = 0;
  std::uint64_t items_culled = 0;
  std::uint64_t meshes_held = 0, textures_held = 0;  ///< on the device, after the frame
  std::uint64_t mesh_bytes = 0, texture_bytes = 0;   ///< that they take there
  std::uint64_t layers = 0;                          ///< of transparent surfaces, over all samples: see OitBuffer
  std::uint64_t layer_bytes = 0;                     ///< of memory for them, on the device after the frame

  bool operator==(const FrameCounters&) const = default;
};

/// What one view cost, counted and not timed.
struct ViewCounts {
  std::uint64_t draws = 0, triangles = 0;
  std::uint64_t masked_triangles = 0;                        ///< of them: each of their pixels asks for alpha
  std::uint64_t boxes_examined = 0, triangles_examined = 0;  ///< held against the view by the host: see Cluster

  bool operator==(const ViewCounts&) const = default;
};

/// Where a pass's pixels lie. Valid until the next submit() or the renderer's end.
struct PassResult {
  std::span<const float> depth;       ///< width * height, rows from the top, d = near / z; empty if not asked for
  std::span<const glm::vec4> color;   ///< width * height, rows from the top, linear RGBA; empty if not asked for
  std::span<const ViewCounts> views;  ///< views[i] belongs to the pass's views[i]
  /// Vertices are moved to a grid, by up to so many pixels along each axis, before pixels are found that a triangle
  /// covers. Vulkan leaves open whether depth is then taken from where they were, or from where they are now.
  double snap_px = 0;
  double depth_snap_px = 0;  ///< snap_px, or 0 on a device of which it is known that depth is not moved
};

}  // namespace simvis
