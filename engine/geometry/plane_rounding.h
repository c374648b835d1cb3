// How far float32 and snapping put the w = 1 / z of a plane off that a rasteriser draws.
//
// Of a plane whose w has the gradient (gx, gy) per pixel, as an absolute error of w (u = 2^-24, half an ulp of 1):
//   evaluation The rasteriser evaluates w = a + gx x + gy y in float32 with x, y counted from the target's corner; with
//              X, Y the farthest that a vertex lies from there: u (10 (|gx| X + |gy| Y) + 4 w). Of the 10, two are
//              roundings of the vertex's pixel coordinates, one of its depth, seven of a and of the sum.
//   slope      gx and gy are quotients: differences of products of vertex differences, over the triangle's area, which
//              is one itself. Rounding each term and the area costs 25 u k D, with D the difference of w between the
//              triangle's corners and k the area of the box around it over twice its own. Assumed is k D <= |gx| V +
//              |gy| H, V and H the size of the view. That leaves out needles: a triangle L pixels long in the picture
//              has to fill at least the L / V-th part of the box around it.
//   snapping   Vulkan does not say whether depth is interpolated between vertices as they came or as they were snapped
//              to 2^-subPixelPrecisionBits pixels, by rounding or cutting off. In the second case each lies that far
//              beside the place whose depth it has: s (|gx| + |gy|), s = 2^-subPixelPrecisionBits. lavapipe does the
//              first (Mesa, lp_state_setup.c): there s = 0. See PassResult::depth_snap_px.
// This is arithmetic as lavapipe does it. Vulkan demands nothing of the arithmetic of rasterisers; on other devices the
// bound holds if theirs is no worse than float32, and their shaders round to nearest.
#pragma once

#include <simvis/frame_plan.h>

namespace simvis {

/// Where a view lies in its target, as far as rounding is concerned.
struct RasterReach {
  double x_px = 0, y_px = 0;           ///< the farthest that a vertex lies from the target's corner
  double width_px = 0, height_px = 0;  ///< of the viewport
  double depth_snap_px = 0;            ///< see PassResult
};

RasterReach raster_reach(const View& view, double depth_snap_px);

/// w is off by at most per_gx |gx| + per_gy |gy| + per_w w.
struct PlaneRounding {
  double per_gx = 0, per_gy = 0, per_w = 0;

  explicit PlaneRounding(const RasterReach& reach)
      : per_gx(kUnit * (kEvaluation * reach.x_px + kSlope * reach.width_px) + reach.depth_snap_px),
        per_gy(kUnit * (kEvaluation * reach.y_px + kSlope * reach.height_px) + reach.depth_snap_px),
        per_w(kUnit * kValue) {}

  static constexpr double kUnit = 0x1p-24, kEvaluation = 10, kSlope = 25, kValue = 4;
};

}  // namespace simvis
