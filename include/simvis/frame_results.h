// The results of the renderer: the pixels of each pass, and counters of the work that drawing took.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace simvis {

/// The work of one frame in counts, without times.
struct FrameCounters {
  std::uint64_t passes = 0,          ///< render passes
      views = 0,                     ///< views of all passes, less the shadow maps that are kept
      shadow_maps = 0,               ///< shadow maps drawn: one for a view of the light, six for a cube. Those whose
                                     ///< casters and light stand still are kept from frame to frame; of the others
                                     ///< only the part that moving casters cover is drawn
      draws = 0,                     ///< draw calls
      triangles = 0,                 ///< triangles of these draw calls
      pipelines_bound = 0,           ///< pipeline bindings
      dispatches = 0;                ///< compute dispatches
  std::uint64_t pipelines_made = 0;  ///< compiled, or taken from the cache of earlier runs or from other simulations
  std::uint64_t bytes_uploaded = 0,  ///< host to device
      bytes_read_back = 0;           ///< device to host
  std::uint64_t items_culled = 0;    ///< items that a view did not draw because it cannot see them, summed over views
  std::uint64_t meshes_held = 0,     ///< meshes on the device after the frame
      textures_held = 0;             ///< textures on the device after the frame
  std::uint64_t levels_held = 0;     ///< coarser levels among these meshes
  std::uint64_t mesh_bytes = 0,      ///< device memory of meshes
      texture_bytes = 0;             ///< device memory of textures
  std::uint64_t layers = 0;          ///< OIT layers over all samples: see engine/render/oit_buffer.h
  std::uint64_t layer_bytes = 0;     ///< device memory of OIT layers after the frame

  bool operator==(const FrameCounters&) const = default;  ///< member by member
};

/// The work of one view in counts, without times.
struct ViewCounts {
  std::uint64_t draws = 0,             ///< draw calls
      triangles = 0;                   ///< triangles of these draw calls
  std::uint64_t masked_triangles = 0;  ///< triangles among them whose pixels all evaluate alpha
  std::uint64_t boxes_examined = 0,    ///< boxes that the host tested against the view: see engine/geometry/clusters.h
      triangles_examined = 0;          ///< triangles that the host tested against the view

  bool operator==(const ViewCounts&) const = default;  ///< member by member
};

/// The item of a pixel that shows none.
inline constexpr std::uint32_t kNoItem = ~std::uint32_t{0};

/// The bits of the alpha that stands for instance 0; see SIMVIS_INSTANCE_0 in shaders/interop.h.
inline constexpr std::uint32_t kInstance0 = 0x00800000;

/// The pixels of a pass in host memory.
///
/// Lifetime  valid until the renderer's next submit() or its destruction.
struct PassResult {
  std::span<const float> depth;      ///< width * height, rows from the top, d = near / z; empty if not requested
  std::span<const glm::vec4> color;  ///< width * height, rows from the top, linear RGBA; empty if not requested; alpha
                                     ///< is 1, or with items as `instance_items` says
  /// width * height, rows from the top: the item in DrawList::items whose depth the pixel has, or kNoItem. Empty if not
  /// requested, or requested with colour: see item_of().
  std::span<const std::uint32_t> items;
  /// With colour and items: the item of each instance. The alpha of colour then stands for an instance, and is below 0
  /// where there is none.
  std::span<const std::uint32_t> instance_items;
  std::span<const ViewCounts> views;  ///< views[i] belongs to the pass's views[i]
  /// Rasterisation snaps vertices to a grid before it determines the covered pixels; this is the largest displacement
  /// along each axis, in pixels. Vulkan does not specify whether depth is then interpolated from the original or from
  /// the snapped positions.
  double snap_px = 0;
  /// The item of a pixel, or kNoItem, of a pass with items.
  std::uint32_t item_of(std::size_t pixel) const {
    if (!items.empty()) return items[pixel];
    const float alpha = color[pixel].a;
    return alpha < 0 ? kNoItem : instance_items[std::bit_cast<std::uint32_t>(alpha) - kInstance0];
  }
  double depth_snap_px = 0;  ///< snap_px, or 0 on a device that is known to interpolate depth from original positions
};

}  // namespace simvis
