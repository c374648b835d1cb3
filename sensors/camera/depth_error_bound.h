// An upper bound on the error of the depths of a rendered image.
//
// Assumptions. The depth Z of a pixel is that of the surface at the pixel's centre. The bound holds for all pixels with
// a finite depth whose surface is flat over three pixels in a row and three in a column that include the pixel. The
// slope of a narrower surface cannot be found from the pixels: where a surface bends smoothly from pixel to pixel the
// steeper slope is used, elsewhere the slope is taken as zero; round shapes see below. The rasteriser decides which of
// two surfaces a pixel on an edge shows. It places vertices on a grid of 1/256 pixel, so the pixel may show either of
// the surfaces within that distance of its centre.
//
// Rounding, as an absolute error of w = 1 / Z, which is affine in pixel coordinates on a plane (u = 2^-24, half an ulp
// of 1; gx, gy the gradient of w per pixel):
//   vertices   A vertex reaches the rasteriser displaced by at most e metres (see VertexRounding), and so does each
//              point of a triangle. With m the gradient of w in the tangents of the view (the plane is m . (x, y, z) =
//              1), dw = w e |m|.
//   set-up     See plane_rounding.h: evaluation, slope and snapping. Needle triangles are excluded here, too.
//   gradient   gx and gy are differences of neighbouring w, so each of them is off by 2 dw.
//   shapes     What is drawn of a round shape lies inside of it by up to d metres (see shape_deviation.h): dw =
//              w d |m|. The drawn mesh is convex, so that w is concave in its image, and |gx| and |gy| are at most the
//              steps to the neighbours on either side. These steps are used where no line of pixels is straight and
//              all four neighbours may show the same shape; pixels beside an outline before a near surface count, too.
//              The bound does not cover pixels one of whose four neighbours shows something else than their shape:
//              their slope is not known, and within the distance d of an outline a pixel may show what is behind it.
//              A camera casts these pixels, see open_pixels.h.
// Then |dZ| <= Z^2 dw / (1 - Z dw), and Z is rounded to float32.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/image.h>
#include "engine/geometry/plane_rounding.h"
#include "sensors/raster_depth/shape_deviation.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

/// The parameters of a depth image that determine its rounding.
struct DepthView {
  Pinhole pinhole;
  VertexRounding rounding;
  RasterReach reach;
  ShapeDeviation deviation;
};

/// The name of the sensor value that holds depth_error_bound() of the last measurement.
inline constexpr std::string_view kDepthErrorBound = "depth_error_bound_m";

/// `list` is the draw list from which the view is drawn.
DepthView depth_view(const View& view, const DrawList& list);

/// Upper bound on |Z - true Z| of each pixel, in metres; +infinity where nothing is hit, or as below.
std::vector<double> depth_error_bounds(const Image& depth, const DepthView& view);

/// Upper bound on |Z - true Z| over all pixels with a finite depth but `others`, in metres; 0 if there is none.
/// +infinity if a surface is so slanted and so far away that its depth has no bound. `others` are ascending.
double depth_error_bound(const Image& depth, const DepthView& view, std::span<const std::uint32_t> others = {});

}  // namespace simvis
