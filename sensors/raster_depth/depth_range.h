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
//   width    It is flat over three by three pixels around or beside the beam. What is smaller may have left no trace in
//            the pixels.
//   needles  No triangle that the pixels around show is a needle in the picture: see plane_rounding.h. What float32
//            makes of the slope of one is not bounded by anything that pixels show.
// Edges need no assumption: vertices are snapped to a grid before pixels are found that a triangle covers, and may be
// displaced (below), so that an edge may seem to lie beyond a pixel's centre. Beams as near to a centre as that are
// taken to be on either side of it. (In two directions, the next column there is taken to be as straight as the cell's
// own.)
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
//   set-up     See plane_rounding.h: evaluation, slope and snapping.
// Gradients are themselves taken from pixels, so that they are off by 2 n per pixel: what that adds to n is in it.
#pragma once

#include <cstdint>

#include <simvis/renderer.h>
#include "sensors/laser_scanner/scan_layout.h"
#include "sensors/raster_depth/plane_rounding.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

/// The pixels of one face, as the renderer left them.
struct FacePixels {
  const float* depth = nullptr;  ///< first pixel of the face; d = near_m / z, 0 = nothing
  std::uint32_t stride_px = 0;   ///< from one row to the next
  double near_m = 0;
  double focal_x_px = 0, focal_y_px = 0;
  RasterReach reach;
  double middle_tangent_x = 0, middle_tangent_y = 0;  ///< where the viewport's middle lies in the face
  double snap_px = 0;                                 ///< see PassResult
};

/// Of a view of a pass.
FacePixels face_pixels(const PassResult& result, const Pass& pass, const View& view);

/// A range along the ray with its bound, in metres; +infinity for a range that does not exist.
struct RangeEstimate {
  double range_m = 0;
  double error_bound_m = 0;
};

/// Linear in w on one surface; the envelope at a crease; the surface on the beam's side at a step.
RangeEstimate planar_range(const FacePixels& pixels, const BeamTap& tap, const VertexRounding& rounding);

/// No bound that planar_range() gives a finite range is below this share of it.
double min_planar_bound();

/// The range of the pixel that the beam falls in, along that pixel's own ray: what other simulators report.
/// `planar` is what planar_range() found: the bound is their difference and its bound.
RangeEstimate nearest_range(const FacePixels& pixels, const BeamTap& tap, const ScanFace& face,
                            const RangeEstimate& planar);

}  // namespace simvis
