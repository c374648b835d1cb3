// The registry of the outputs of cameras that describe the surface at the centre of each pixel.
//
// To add an output, add a pair of files with a function that fills its numbers and one static
// SurfaceOutputRegistration; no other file changes. The attribute `outputs` of camera and stereo camera, --describe,
// checks, measurements and all their consumers then have it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/draw_list.h>
#include <simvis/export.h>
#include <simvis/output_spec.h>
#include <simvis/sensor_needs.h>

namespace simvis {

/// The surface at the centre of a pixel.
///
/// Frames   V = view frame of the camera at the time of the pixel's row: x right, y down, z forward.
struct PixelSurface {
  const DrawList& list;      ///< as the pixel sees it
  ItemIds ids;               ///< with kSurfaceIds
  std::uint32_t item = 0;    ///< in DrawList::items; with kSurfaceItems
  double range_m = 0;        ///< along the ray through the centre
  glm::dvec3 point_m{0};     ///< V
  glm::dvec3 normal{0};      ///< V, unit length, towards the camera; NaN unless the ray is cast
  double depth_bound_m = 0;  ///< of the error of its depth; +infinity: none; with kSurfaceDepthBound
  /// From V to metres along the axes of the item's mesh, from its origin; with kSurfaceMesh. Null for Gaussian splats.
  const glm::dmat4* mesh_from_view = nullptr;
};

/// What an output needs of a surface. The values are summed.
enum SurfaceNeed : std::uint8_t {
  kSurfaceItems = 1,       ///< the item that is seen
  kSurfaceIds = 2,         ///< ids of items; with kSurfaceItems
  kSurfaceCast = 4,        ///< a ray for each pixel, as normals do
  kSurfaceDepthBound = 8,  ///< depth among outputs, and the bound of its error
  kSurfaceMesh = 16        ///< the frame of the item's mesh; with kSurfaceItems
};

inline constexpr std::uint32_t kMaxSurfaceChannels = 4;

/// The description of an output for the registry.
struct SurfaceOutputType {
  std::string_view name;                        ///< of the output, and its word in the attribute `outputs`
  std::uint32_t order = 1000;                   ///< among these outputs: ascending, then by name
  ValueType value_type = ValueType::f32;        ///< f32, f64, u8, u32 or i32
  std::uint32_t channels = 1;                   ///< at most kMaxSurfaceChannels
  std::string_view unit{}, frame{}, meaning{};  ///< as OutputSpec
  double nothing = 0;                           ///< the number where nothing is seen
  std::uint8_t needs = 0;                       ///< sum of SurfaceNeed
  void (*fill)(const PixelSurface& surface, std::span<double> numbers) = nullptr;  ///< sets all channels
};

/// A static object of this type adds an output. Strings must live as long as the program.
struct SurfaceOutputRegistration {
  explicit SurfaceOutputRegistration(const SurfaceOutputType& type);
};

/// All of them in their order. The pointers stay valid.
std::vector<const SurfaceOutputType*> surface_outputs();

/// The choices of an attribute `outputs`: those of the type's own, then the names of all surface outputs.
std::string_view with_surface_outputs(std::string_view own_choices);

}  // namespace simvis
