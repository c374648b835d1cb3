// Computes the range of a beam and its error bound from the reversed-Z depth pixels around the beam.
//
// On a plane, w = 1 / z = d / near is affine in pixel coordinates. Every surface that is flat over a few pixels
// therefore gives its exact w anywhere between their centres, up to rounding; z and range do not have that property.
//
// Use of the pixels. Three pixels in a line that lie on one surface have a second difference of w of at most 4 n, where
// n bounds the error of each. The second differences show which surfaces can exist at the beam: surfaces that begin or
// end to its left, to its right, or continue past it. If the pixels beside the beam agree with one surface, and no
// other surface that the pixels allow deviates from it, w is interpolated between them. Where flat surfaces meet so
// that their extensions cross between the pixels (a crease), their envelope is used. Elsewhere (a step, or surfaces
// narrower than three pixels) the pixels do not determine which surface the beam hits: the range is that of the surface
// on the beam's side, and the bound is infinite.
//
// Assumptions of the bound. The surface that a beam hits, or a gap that lets it pass, satisfies:
//   width    It is flat over three by three pixels around or beside the beam. A smaller surface may leave no trace in
//            the pixels.
//   needles  No triangle that the pixels around show is a needle in the image: see plane_rounding.h. The pixels give no
//            bound on the float32 slope of a needle.
// Edges need no assumption. Vertices are snapped to a grid before the rasteriser finds the pixels that a triangle
// covers, and they may be displaced (below), so an edge may appear on the wrong side of a pixel's centre. A beam within
// that distance of a centre is treated as lying on either side of it. (In two directions, the next column there is
// assumed to be as straight as the cell's own column.)
// Under these assumptions pixels of other surfaces cannot cause a wrong result, even if they lie in line by chance. The
// beam's own surface has at least one of the two pixels beside the beam, and two more beyond. The deviation of the
// other pixel from its plane is a second difference, which is in the bound. If that difference is too large, three
// pixels that may be such a surface are rejected only if their second difference is larger than errors can make it.
//
// Error of a beam's w, with n the error of a pixel: if the surface covers both pixels beside the beam, the error is n.
// If it ends between them, with f the distance of the beam from its last pixel, the error is (1 + 2 f) n for the plane
// extended from its last two pixels, plus f times the second difference that was found. The bound is the largest error
// over all surfaces that the pixels allow; in two directions the shares of the pixels multiply.
//
// Error n of a pixel's w on a plane m . (x, y, z) = 1, whose gradient per pixel is g = m / focal (u = 2^-24):
//   vertices   A vertex reaches the rasteriser displaced by at most e in each clip coordinate (see VertexRounding), so
//              each point of a triangle displaces its plane by as much. The rows of clip x and y contain a share h of
//              z, the tangent of the view's middle: dw = w e (|mx| sqrt(1 + hx^2) + |my| sqrt(1 + hy^2) + w'), with w'
//              the w of the plane in the view's middle.
//   set-up     See plane_rounding.h: evaluation, slope and snapping.
// The gradients are taken from pixels, so they are off by 2 n per pixel; n includes the effect of that.
#pragma once

#include <cstdint>

#include <simvis/frame_results.h>
#include "engine/base/program_api.h"
#include "engine/geometry/plane_rounding.h"
#include "sensors/raster_depth/beam_tap.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

/// The pixels of one face, as rendered.
struct FacePixels {
  const float* depth = nullptr;  ///< first pixel of the face; d = near_m / z, 0 where nothing is hit
  std::uint32_t stride_px = 0;   ///< from one row to the next
  double near_m = 0;
  double focal_x_px = 0, focal_y_px = 0;
  RasterReach reach;
  double middle_tangent_x = 0, middle_tangent_y = 0;  ///< position of the viewport's middle in the face
  double snap_px = 0;                                 ///< see PassResult
};

/// The pixels of one view of a pass.
FacePixels face_pixels(const PassResult& result, const Pass& pass, const View& view);

/// A range along the ray with its bound, in metres; the range is +infinity where nothing is hit.
struct RangeEstimate {
  double range_m = 0;
  double error_bound_m = 0;
};

/// Interpolates linearly in w on one surface; takes the envelope at a crease, and the surface on the beam's side at a
/// step.
RangeEstimate planar_range(const FacePixels& pixels, const BeamTap& tap, const VertexRounding& rounding);

/// The smallest bound of planar_range(), as a share of a finite range.
SIMVIS_PROGRAM_API double min_planar_bound();

/// An upper bound of |m| of the plane m . (x, y, z) = 1 that the pixels around a beam show, from the steepest slopes
/// between them; +infinity if one of them shows nothing.
double steepness_at(const FacePixels& pixels, const BeamTap& tap);

/// The range of the pixel that contains the beam, along that pixel's own ray, as other simulators report it. `planar`
/// is the result of planar_range(): the bound is the difference to it plus its bound.
RangeEstimate nearest_range(const FacePixels& pixels, const BeamTap& tap, const ScanFace& face,
                            const RangeEstimate& planar);

}  // namespace simvis
