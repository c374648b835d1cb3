// From reversed-Z depth around a beam to its range, and how far that range may be off.
//
// On a plane, w = 1 / z = d / near is affine in pixel coordinates. So every surface that is flat over a few pixels
// gives its exact w anywhere between their centres, up to rounding; z and range do not have that property.
//
// What is taken from the pixels. Along a line of pixels, three that lie on one surface have a second difference of w of
// at most 4 n, where n bounds the error of each. Those differences say which surfaces there may be at the beam: ones
// that begin or end at its left, at its right, or go on past it. If pixels beside the beam pass for one surface, and no
// other that they allow for departs from it, w is interpolated between them. Where flat surfaces meet so that their
// extensions cross between the pixels (a crease), their envelope is taken. Elsewhere (a step, or surfaces finer than
// three pixels) the pixels do not say which surface the beam meets: the range is that of the surface on the beam's
// side, the bound is infinite.
//
// What the bound speaks of. Assumed of what a beam meets, a gap that lets it pass included, is:
//   width    It is flat over three by three pixels around or beside the beam; where the layout has one ring, over three
//            along it and one down. What is smaller may have left no trace in the pixels.
//   needles  No triangle that the pixels around show is a needle in the picture: one of L pixels fills at least the
//            L / V-th part of the box around it, V the size of the view. What float32 makes of the slope of others
//            (below) is not bounded by anything that pixels show. This binds what crosses much of the view only.
// Edges need no assumption: vertices are snapped to a grid before pixels are found that a triangle covers, and may be
// displaced (below), so that an edge may seem to lie beyond a pixel's centre. Beams as near to a centre as that are
// taken to be on either side of it. (In two directions, the next column there is taken to be as straight as the cell's
// own; and of one ring no edge runs along the ring within that distance.)
// With that no pixels of other surfaces can mislead, in line by chance or not. The beam's own surface has at least one
// of the two pixels beside it, and two more beyond. What the other pixel is off from its plane is a second difference,
// which is in the bound; and where that is too large, three pixels that may be such a surface are not believed to be
// none, unless their second difference is above what errors can make.
//
// How far the w of a beam is off, with n the error of a pixel: where the surface covers both pixels beside it, n. Where
// it ends between them, at a distance f of the beam from its last pixel, (1 + 2 f) n for its plane extended from its
// last two, and f times the second difference that was found. The larger of all that the pixels allow for is taken; in
// two directions the pixels' shares multiply.
//
// The error n of a pixel's w on a plane m . (x, y, z) = 1, whose gradient per pixel is g = m / focal (u = 2^-24):
//   vertices   A vertex reaches the rasteriser displaced by at most e in each clip coordinate (see VertexRounding), so
//              at each point of a triangle its plane is displaced by as much. Rows of clip x and y hold a share h of z,
//              the tangent of the view's middle: dw = w e (|mx| sqrt(1 + hx^2) + |my| sqrt(1 + hy^2) + w'), w' the w of
//              the plane in the view's middle.
//   evaluation The rasteriser evaluates w = a + gx x + gy y in float32 with x, y counted from the target's corner; with
//              X, Y the farthest that a vertex lies from there: u (10 (|gx| X + |gy| Y) + 4 w). Of the 10, two are
//              roundings of the vertex's pixel coordinates, one of its depth, seven of a and of the sum.
//   slope      gx and gy are quotients: differences of products of vertex differences, over the triangle's area, which
//              is one itself. Rounding each term and the area costs 25 u k D, with D the difference of w between the
//              triangle's corners and k the area of the box around it over twice its own. Assumed is k D <= |gx| V +
//              |gy| H, V and H the size of the view: that is what the needles above are about.
//   snapping   Vulkan does not say whether depth is interpolated between vertices as they came or as they were snapped
//              to 2^-subPixelPrecisionBits pixels, by rounding or cutting off. In the second case each lies that far
//              beside the place whose depth it has: s (|gx| + |gy|), s = 2^-subPixelPrecisionBits. lavapipe does the
//              first (Mesa, lp_state_setup.c): there s = 0. See PassResult::depth_snap_px.
// This is arithmetic as lavapipe does it. Vulkan demands nothing of the arithmetic of rasterisers; on other devices the
// bound holds if theirs is no worse than float32, and their shaders round to nearest. Gradients are themselves taken
// from pixels, so that they are off by 2 n per pixel: what that adds to n is in it.
#pragma once

#include <cstdint>

#include "engine/renderer.h"
#include "sensors/scan_layout.h"
#include "sensors/vertex_rounding.h"

namespace simvis {

/// The pixels of one face, as the renderer left them.
struct FacePixels {
  const float* depth = nullptr;  ///< first pixel of the face; d = near_m / z, 0 = nothing
  std::uint32_t stride_px = 0;   ///< from one row to the next
  double near_m = 0;
  double focal_px = 0;
  double reach_x_px = 0, reach_y_px = 0;              ///< the farthest that a vertex lies from the target's corner
  double width_px = 0, height_px = 0;                 ///< of the viewport
  double middle_tangent_x = 0, middle_tangent_y = 0;  ///< where the viewport's middle lies in the face
  double snap_px = 0, depth_snap_px = 0;              ///< see PassResult
};

/// Of a view of a pass.
FacePixels face_pixels(const PassResult& result, const Pass& pass, const View& view);

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
