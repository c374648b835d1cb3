// From reversed-Z depth around a beam to its range, and how far that range may be off.
//
// On a plane, w = 1 / z = d / near is affine in pixel coordinates. So every surface that is flat over a few pixels
// gives its exact w anywhere between their centres, up to rounding; z and range do not have that property.
//
// What is taken from the pixels and what is assumed. Pixels of a line lie on one surface if the second differences of
// w vanish within rounding; both neighbours of the beam must do so with pixels on either side, or with two on one side
// while the other side is another surface. Between them w is interpolated. Where two or more flat surfaces meet so that
// their extensions cross between the pixels (a crease), their envelope is taken; since a bevel or a small step may hide
// there, the bound is then the relief of all pixels around. Elsewhere (a step, or surfaces finer than three pixels) the
// pixels do not say which surface the beam meets: the range is that of the surface on the beam's side, the bound is
// infinite. Assumed is that the surface that the beam meets is at least three pixels wide: what is narrower may have
// left no trace in the pixels.
//
// Rounding, per pixel, as an absolute error of w (u = 2^-24, half an ulp of 1):
//   vertices   A vertex reaches the rasteriser displaced by at most e metres (see VertexRounding), so at each point
//              of a triangle its plane is displaced by at most e. With m the gradient of w in the tangents of the face
//              (the plane is m . (x, y, z) = 1 and |m| = 1 / its distance from the sensor), dw = w e |m|.
//   plane set-up  The rasteriser evaluates w = a + gx x + gy y in float32 with x, y counted from the target's corner:
//              kSetup roundings of terms no larger than |gx| X + |gy| Y + w, X and Y the farthest that a vertex lies
//              from there: the target's size, and for a strip, whose viewport is as high as wide, its width.
#pragma once

#include <cstdint>

#include "sensors/scan_layout.h"
#include "sensors/vertex_rounding.h"

namespace simvis {

/// The pixels of one face, as the renderer left them.
struct FacePixels {
  const float* depth = nullptr;  ///< first pixel of the face; d = near_m / z, 0 = nothing
  std::uint32_t stride_px = 0;   ///< from one row to the next
  double near_m = 0;
  double focal_px = 0;
  double reach_x_px = 0, reach_y_px = 0;  ///< the farthest that a vertex lies from the target's corner
};

/// A range along the ray with its bound, in metres; +infinity for a range that does not exist.
struct RangeEstimate {
  double range_m = 0;
  double error_bound_m = 0;
};

/// Linear in w on one surface; the envelope at a crease; the surface on the beam's side at a step.
RangeEstimate planar_range(const FacePixels& pixels, const BeamTap& tap, bool planar_layout,
                           const VertexRounding& rounding);

/// No bound that planar_range() gives a finite range is below this share of it.
double least_planar_bound();

/// The range of the pixel that the beam falls in, along that pixel's own ray: what other simulators report.
/// `planar` is what planar_range() found: the bound is their difference and its bound.
RangeEstimate nearest_range(const FacePixels& pixels, const BeamTap& tap, const ScanFace& face,
                            const RangeEstimate& planar);

}  // namespace simvis
