// The outputs of cameras that come with SimVis and need only the surface at a
// pixel's centre.
#include <cmath>
#include <limits>

#include "sensors/surface_output.h"

namespace simvis {
namespace {

constexpr double kNoSurfaceNumber = std::numeric_limits<double>::quiet_NaN(),
                 kNoSurfaceRange = std::numeric_limits<double>::infinity();

void set_vector(const glm::dvec3& value, std::span<double> numbers) {
  for (int c = 0; c < 3; ++c) numbers[static_cast<std::size_t>(c)] = value[c];
}

// A bound stays one when it is stored.
double rounded_up_to_float(double bound) {
  const auto rounded = static_cast<float>(bound);
  const bool is_less = static_cast<double>(rounded) < bound;
  return static_cast<double>(is_less ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded);
}

const SurfaceOutputRegistration kInstanceOutput({.name = "instance",
                                                 .order = 1,
                                                 .value_type = ValueType::u32,
                                                 .meaning = "id of the object at the pixel's centre, as in objects.csv",
                                                 .needs = kSurfaceItems | kSurfaceIds,
                                                 .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                   numbers[0] = surface.ids.instance[surface.item];
                                                 }});

const SurfaceOutputRegistration kSemanticOutput({.name = "semantic",
                                                 .order = 2,
                                                 .value_type = ValueType::u32,
                                                 .meaning = "id of its class, as elements of type label say; 0: none",
                                                 .needs = kSurfaceItems | kSurfaceIds,
                                                 .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                   numbers[0] = surface.ids.semantic[surface.item];
                                                 }});

const SurfaceOutputRegistration kShapeOutput({.name = "shape",
                                              .order = 7,
                                              .value_type = ValueType::u32,
                                              .meaning = "id of the shape at the pixel's centre, as in shapes.csv",
                                              .needs = kSurfaceItems | kSurfaceIds,
                                              .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                numbers[0] = surface.ids.shape[surface.item];
                                              }});

const SurfaceOutputRegistration kRangeOutput({.name = "range",
                                              .order = 3,
                                              .unit = "m",
                                              .meaning = "range along the ray through the pixel's centre",
                                              .nothing = kNoSurfaceRange,
                                              .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                numbers[0] = surface.range_m;
                                              }});

const SurfaceOutputRegistration kNormalOutput({.name = "normal",
                                               .order = 4,
                                               .channels = 3,
                                               .frame = "optical",
                                               .meaning = "normal of the triangle, unit length, towards the camera",
                                               .nothing = kNoSurfaceNumber,
                                               .needs = kSurfaceCast,
                                               .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                 set_vector(surface.normal, numbers);
                                               }});

const SurfaceOutputRegistration kObjectCoordinatesOutput(
    {.name = "object_coordinates",
     .order = 5,
     .channels = 3,
     .unit = "m",
     .frame = "mesh",
     .meaning = "the point along the axes of the item's mesh, from its origin",
     .nothing = kNoSurfaceNumber,
     .needs = kSurfaceItems | kSurfaceMesh,
     .fill = [](const PixelSurface& surface, std::span<double> numbers) {
       const bool known = surface.mesh_from_view != nullptr;
       set_vector(
           known ? glm::dvec3(*surface.mesh_from_view * glm::dvec4(surface.point_m, 1)) : glm::dvec3(kNoSurfaceNumber),
           numbers);
     }});

const SurfaceOutputRegistration kDepthErrorBoundOutput(
    {.name = "depth_error_bound",
     .order = 6,
     .unit = "m",
     .meaning = "largest error of the pixel's depth; inf: it has no bound",
     .nothing = kNoSurfaceRange,
     .needs = kSurfaceDepthBound,
     .fill = [](const PixelSurface& surface, std::span<double> numbers) {
       numbers[0] = rounded_up_to_float(surface.depth_bound_m);
     }});

}  // namespace
}  // namespace simvis
