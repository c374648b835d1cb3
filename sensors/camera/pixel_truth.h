// What a camera says of the surface at the centre of each pixel besides its depth: the outputs of
// sensors/surface_output.h, and what the table of objects needs.
//
// Pixels   The surface is that which the ray through the pixel's centre meets, whatever samples colour takes; nothing
//          is averaged. It is depth-visible (see Material).
// Drawn    Views of pixels that are those of the image are drawn: depth and items come from one pass. What is drawn
//          differs from the ray at pixels whose centre lies within the rasteriser's snapping of an edge (1/256 of a
//          pixel along each axis). The pixels around the outlines of round shapes are cast, and where an output needs
//          exact points, all pixels of round shapes (see open_pixels.h).
// Cast     Everything comes from one ray for each pixel (see pixel_rays.h) with outputs that need it, such as `normal`,
//          which needs the triangle; with what pixel_flow.h casts; with layers; for another layer than `visible`; and
//          for images that are interpolated from several views, whose pixels are no pixels of a view.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/image.h>
#include <simvis/measurement.h>
#include <simvis/sensor_needs.h>
#include "sensors/camera/depth_error_bound.h"
#include "sensors/camera/pixel_flow.h"
#include "sensors/camera/pixel_layers.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/surface_layer.h"
#include "sensors/surface_output.h"

namespace simvis {

/// What is asked for: words of the attribute `outputs`.
struct TruthDesc {
  std::vector<const SurfaceOutputType*> surfaces{};  ///< in the order of surface_outputs()
  bool boxes = false,                                ///< a table of objects, see object_table.h
      silhouettes = false;                           ///< of these objects; only with boxes

  FlowDesc flow{};
  std::uint32_t layers = 0;                    ///< see pixel_layers.h; 0: not asked for
  SurfaceLayer layer = SurfaceLayer::visible;  ///< of everything here but `layers`, and of depth

  bool of_surfaces() const { return !surfaces.empty() || boxes; }
  bool any() const { return of_surfaces() || flow.any() || layers > 0; }
  bool needs_ids() const { return needs(kSurfaceIds) || boxes || layers > 0; }
  bool needs_items() const { return needs(kSurfaceItems) || boxes || flow.any(); }
  bool needs_bounds() const { return needs(kSurfaceDepthBound); }
  /// Whether the point of a round shape itself must be known, and not that of the mesh that is drawn for it.
  bool needs_exact_points() const { return needs(kSurfaceMesh) || flow.any(); }
  /// Whether pixels of a view that are those of the image must be cast all the
  /// same.
  bool casts() const { return needs(kSurfaceCast) || flow.casts() || layers > 0 || layer != SurfaceLayer::visible; }
  /// Whether a surface output needs it.
  bool needs(SurfaceNeed need) const {
    return std::ranges::any_of(surfaces, [&](const SurfaceOutputType* each) { return (each->needs & need) != 0; });
  }
};

/// Words of the attribute `outputs` besides those of surface_outputs().
inline constexpr std::string_view kTruthWords =
    "flow_backward flow_forward scene_flow occlusion layers boxes silhouettes";

/// Reads the attributes `outputs`, `layer` and `max_layers`. Throws InputError if bounds are asked for without a depth,
/// silhouettes without boxes, or as flow_desc() and surface_layer(). `measures_depth`: depth is measured, or what
/// follows from it.
TruthDesc truth_desc(const AttributeValues& attributes, bool measures_depth);

/// The outputs of one view, without those of flow and layers; `prefix` stands
/// in front of their names.
std::vector<OutputSpec> truth_outputs(const std::string& prefix, const AttributeValues& attributes);

/// A draw list with the ids of its items and its objects; these are empty if they
/// are not asked for.
struct IdentifiedList {
  const DrawList& list;
  ItemIds ids;
  std::span<const SceneObject> objects{};
};

/// What pixels see, [y * width + x].
struct PixelItems {
  std::uint32_t width_px = 0;
  std::vector<std::uint32_t> item{};  ///< in DrawList::items, or kNoItem
  std::vector<float> range_m{};       ///< along the ray
};

/// The images of one view.
class PixelTruth {
 public:
  PixelTruth(const TruthDesc& desc, std::uint32_t width_px, std::uint32_t height_px);

  /// Starts new images; every pixel sees nothing.
  void begin();
  /// Reads the pixels of a drawn view, which are those of the image from
  /// `first_row` on. The pass has items if needs_items(). `depth_bounds_m` are
  /// those of these pixels if needs_bounds().
  void read(const Pass& pass, const View& view, const PassResult& result, const IdentifiedList& world,
            std::uint32_t first_row, std::span<const double> depth_bounds_m);
  /// Reads rows that were cast. `directions` and `seen` as those of PixelRays,
  /// by pixel of the image.
  void read(const PixelRows& rows, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
            const IdentifiedList& world);
  /// The same for pixels of an image that was drawn: `pixels` of these rows.
  void read(const PixelRows& rows, std::span<const std::uint32_t> pixels, std::span<const glm::dvec3> directions,
            std::span<const SeenSurface> seen, const IdentifiedList& world);
  /// Makes a pixel one of an item without a surface, in front of what it has
  /// been read to see.
  void cover(std::uint32_t pixel, std::uint32_t item, double range_m, const glm::dvec3& direction,
             const IdentifiedList& world);

  /// What the pixels see, with `boxes` only.
  const PixelItems& items() const { return items_; }
  /// The images, in the order of truth_outputs(), without numbers before the
  /// first begin().
  void add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const;

 private:
  /// The numbers of one output, [(y * width + x) * channels + channel].
  struct Output {
    const SurfaceOutputType* type;
    MeasuredNumbers numbers;
  };
  void set(std::size_t pixel, const PixelSurface& surface);
  void forget(std::size_t pixel);

  TruthDesc desc_;
  std::uint32_t width_px_, height_px_;
  std::vector<Output> outputs_;
  PixelItems items_;
};

/// A bound on the error of the depth along Z that is stored for a surface that a ray has met.
double cast_depth_bound(const SeenSurface& surface, const glm::dvec3& direction);

/// Depth along Z, in metres, of rows that were cast, as a camera gives it.
/// Returns the largest bound of their errors.
double cast_depth(const PixelRows& rows, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
                  std::uint32_t width_px, std::vector<float>& depth);

}  // namespace simvis
