// How far the depths of a rendered image may be off.
//
// What it speaks of. The depth Z of a pixel is that of the surface met at the pixel's centre. The bound holds for all
// pixels with a finite depth whose surface is flat over three pixels in a row and three in a column with it. On what is
// narrower the slant cannot be told: where the surface bends smoothly from pixel to pixel the steeper slope is taken,
// elsewhere none. Which of two surfaces a pixel on an edge shows is for the rasteriser to decide, whose corners lie on
// a grid of 1/256 pixel: either of those met within that distance of the centre may be the one shown.
//
// Rounding, as an absolute error of w = 1 / Z, which is affine in pixel coordinates on a plane (u = 2^-24, half an ulp
// of 1; gx, gy the gradient of w per pixel):
//   vertices   A vertex reaches the rasteriser displaced by at most e metres (see VertexRounding), and so is each point
//              of a triangle. With m the gradient of w in the tangents of the view (the plane is m . (x, y, z) = 1),
//              dw = w e |m|.
//   set-up     See plane_rounding.h: evaluation, slope and snapping. Needles are left out here, too.
//   gradient   gx and gy are differences of neighbouring w, off by 2 dw each.
// Then |dZ| <= Z^2 dw / (1 - Z dw), and Z is rounded to float32.
#pragma once

#include <string_view>

#include <simvis/frame_plan.h>
#include <simvis/image.h>
#include "engine/geometry/plane_rounding.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

/// How an image of depth came about, as far as rounding is concerned.
struct DepthView {
  Pinhole pinhole;
  VertexRounding rounding;
  RasterReach reach;
};

/// The name among a sensor's values of what depth_error_bound() says of its last measurement.
inline constexpr std::string_view kDepthErrorBound = "depth_error_bound_m";

/// `list` is what the view is drawn from.
DepthView depth_view(const View& view, const DrawList& list);

/// At least |Z - true Z| of every pixel with a finite depth, in metres; 0 where there is none. +infinity if a surface
/// is so slanted and far away that its depth is anybody's guess.
double depth_error_bound(const Image& depth, const DepthView& view);

}  // namespace simvis
