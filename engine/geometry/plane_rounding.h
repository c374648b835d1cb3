// Bounds of the error that float32 and snapping cause in the w = 1 / z of a plane that a rasteriser draws.
//
// For a plane whose w has the gradient (gx, gy) per pixel, the absolute errors of w are as follows, with u = 2^-24,
// half an ulp of 1:
//   evaluation The rasteriser evaluates w = a + gx x + gy y in float32, with x and y counted from the target's corner.
//              X and Y are the largest distances of a vertex from there. The error is u (10 (|gx| X + |gy| Y) + 4 w).
//              Of the 10, two are roundings of the vertex's pixel coordinates, one is that of its depth, and seven are
//              roundings of a and of the sum.
//   slope      gx and gy are quotients: differences of products of vertex differences, over the triangle's area, which
//              is such a difference itself. Rounding each term and the area costs 25 u k D, where D is the difference
//              of w between the triangle's corners and k is the area of the box around the triangle over twice its own
//              area. The bound assumes k D <= |gx| V + |gy| H, where V and H are the size of the view. This excludes
//              needles: a triangle L pixels long in the image must fill at least the L / V-th part of the box around
//              it.
//   snapping   Vulkan does not specify whether depth is interpolated between the original vertices or between vertices
//              snapped to 2^-subPixelPrecisionBits pixels, by rounding or truncation. In the second case each vertex
//              lies that far from the place whose depth it has: s (|gx| + |gy|), s = 2^-subPixelPrecisionBits. lavapipe
//              does the first (Mesa, lp_state_setup.c), so s = 0 there. See PassResult::depth_snap_px.
// This is the arithmetic of lavapipe. Vulkan demands nothing of the arithmetic of rasterisers. On other devices the
// bound holds if their arithmetic is no worse than float32 and their shaders round to nearest.
#pragma once

#include <simvis/frame_plan.h>

namespace simvis {

/// The location of a view in its target, as far as it matters for rounding.
struct RasterReach {
  double x_px = 0, y_px = 0;           ///< largest distance of a vertex from the target's corner
  double width_px = 0, height_px = 0;  ///< size of the viewport
  double depth_snap_px = 0;            ///< see PassResult
};

RasterReach raster_reach(const View& view, double depth_snap_px);

/// The error of w is at most per_gx |gx| + per_gy |gy| + per_w w.
struct PlaneRounding {
  double per_gx = 0, per_gy = 0, per_w = 0;

  explicit PlaneRounding(const RasterReach& reach)
      : per_gx(kUnit * (kEvaluation * reach.x_px + kSlope * reach.width_px) + reach.depth_snap_px),
        per_gy(kUnit * (kEvaluation * reach.y_px + kSlope * reach.height_px) + reach.depth_snap_px),
        per_w(kUnit * kValue) {}

  static constexpr double kUnit = 0x1p-24, kEvaluation = 10, kSlope = 25, kValue = 4;
};

}  // namespace simvis
