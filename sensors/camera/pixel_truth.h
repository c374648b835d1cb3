// What a camera says of the surface at the centre of each pixel besides its depth: ids, range, normal, coordinates on
// the thing itself, and the bound of the depth's error.
//
// Pixels   The surface is that which the ray through the pixel's centre meets, whatever samples colour takes; nothing
//          is averaged. It is depth-visible (see Material).
// Drawn    Views of pixels that are those of the image are drawn: depth and items come from one pass, and what is
//          drawn differs from the ray at pixels whose centre lies within the rasteriser's snapping of an edge (1/256 of
//          a pixel along each axis). At the outlines of round shapes, which lie outside of what is drawn of them, the
//          pixels are cast (see round_edges.h).
// Cast     With `normal`, which needs the triangle, with what pixel_flow.h casts, with layers, for another layer than
//          `visible`, and for images that are interpolated from several views, because their pixels are no pixels of a
//          view, everything comes from one ray for each pixel (see pixel_rays.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
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

namespace simvis {

/// What is asked for: words of the attribute `outputs`.
struct TruthDesc {
  bool instance = false, semantic = false;  ///< ids, see ItemIds; 0: nothing
  bool range = false;                       ///< along the ray, in metres; +infinity: nothing
  bool normal = false;       ///< of the triangle: view frame at the time of the row, unit length, towards the camera
  bool coordinates = false;  ///< in metres, in the frame of the item's mesh
  bool bound = false;        ///< of the error of the depth, in metres; +infinity: no depth, or no bound
  bool boxes = false,        ///< a table of things, see object_table.h
      silhouettes = false;   ///< of these things; only with boxes

  FlowDesc flow{};
  std::uint32_t layers = 0;                    ///< see pixel_layers.h; 0: not asked for
  SurfaceLayer layer = SurfaceLayer::visible;  ///< of everything here but `layers`, and of depth

  bool of_surfaces() const { return instance || semantic || range || normal || coordinates || bound || boxes; }
  bool any() const { return of_surfaces() || flow.any() || layers > 0; }
  bool needs_ids() const { return instance || semantic || boxes || layers > 0; }
  bool needs_items() const { return instance || semantic || coordinates || boxes || flow.any(); }
  /// Whether pixels of a view that are those of the image must be cast all the same.
  bool casts() const { return normal || flow.casts() || layers > 0 || layer != SurfaceLayer::visible; }
};

/// Reads the attributes `outputs`, `layer` and `max_layers`. Throws InputError if a bound is asked for without a depth,
/// silhouettes without boxes, or as flow_desc() and surface_layer(). `measures_depth`: depth is measured, or what
/// follows from it.
TruthDesc truth_desc(const AttributeValues& attributes, bool measures_depth);

/// The outputs of one view, without those of flow and layers; `prefix` stands in front of their names.
std::vector<OutputSpec> truth_outputs(const std::string& prefix, const AttributeValues& attributes);

/// A draw list with the ids of its items; these are empty if no ids are asked for.
struct IdentifiedList {
  const DrawList& list;
  ItemIds ids;
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
  /// Reads the pixels of a drawn view, which are those of the image from `first_row` on. The pass has items if
  /// needs_items().
  void read(const Pass& pass, const View& view, const PassResult& result, const IdentifiedList& world,
            std::uint32_t first_row);
  /// Reads rows that were cast. `directions` and `seen` as those of PixelRays, by pixel of the image.
  void read(const PixelRows& rows, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
            const IdentifiedList& world);
  /// The same for pixels of an image that was drawn: `pixels` of these rows.
  void read(const PixelRows& rows, std::span<const std::uint32_t> pixels, std::span<const glm::dvec3> directions,
            std::span<const SeenSurface> seen, const IdentifiedList& world);
  /// Makes a pixel one of an item without a surface, in front of what it has been read to see.
  void cover(std::uint32_t pixel, std::uint32_t item, double range_m, const IdentifiedList& world);
  /// Sets the bounds of rows from their depths, which were drawn.
  void read_bounds(const Image& depth, const DepthView& view, std::uint32_t first_row, std::uint32_t rows);

  /// What the pixels see, with `boxes` only.
  const PixelItems& items() const { return items_; }
  /// The images, in the order of truth_outputs(), without numbers before the first begin().
  void add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const;

 private:
  void forget(std::size_t pixel);

  TruthDesc desc_;
  std::uint32_t width_px_, height_px_;
  SharedArray<std::uint32_t> instance_, semantic_;
  SharedArray<float> range_, normal_, coordinates_, bound_;
  PixelItems items_;
};

/// Depth along Z, in metres, of rows that were cast, as a camera gives it. Returns the largest bound of their errors.
double cast_depth(const PixelRows& rows, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
                  std::uint32_t width_px, std::vector<float>& depth);

}  // namespace simvis
