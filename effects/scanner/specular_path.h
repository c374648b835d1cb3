// The effect `specular_path`: beams go on from mirrors and through glass, as often as the attribute `path_depth` says.
//
// Shares   Of a surface's light a share `mirror` is reflected, and of the rest a share `transmission` meets a pane (see
//          Material); what is left is matte as ever. Light comes back the way it went, so an onward ray's share of the
//          beam is the square of what goes one way.
// Mirror   the angle of reflection is that of incidence. The range is the length of the whole path, unfolded.
// Pane     a thin sheet of glass: rays go on as they came, from the same origin, without an offset. Of unpolarised
//          light one face reflects R by Fresnel's equations, and the two, with all that goes to and fro between them
//          and does not interfere, 2 R / (1 + R), for each polarisation; the rest passes, coloured by the base colour.
//          A pane is one sheet of triangles: a box is met at both sides.
// Depth    after so many mirrors and panes a beam goes no farther: what these send on is lost.
//
// Not seen: the glint of a mirror that the beam meets square on, which comes back to the receiver itself.
//
// Where a reflected ray begins. The place P that was hit is off the triangle by rounding: by the bound b of the range;
// by 8 u |P| for P's own coordinates and its way into the world (u = 2^-53); and the triangle is placed anew as seen
// from P, where its corners are off by less than 3 b. (A bound is at least the corners' error, 28 u of the mesh's reach
// and distance and 21 u of the offsets from the world's origin, see ray_caster.h; from P the distance is within the
// reach, so that 56 u reach and 21 u (2 |mesh| + reach) take its place, and |mesh| <= |sensor| + distance.) Over the
// cosine of incidence that is how far along the ray the triangle can be met again; the ray begins beyond twice that.
// What stands nearer than that behind a mirror, 1e-13 m in a room, is not met from there.
#pragma once

#include <simvis/surface_point.h>

namespace simvis {

/// Where light goes that meets a surface, one way; with what a black or coloured pane keeps at most 1 together.
struct SurfaceShares {
  double matte = 1, reflected = 0, passed = 0;
};

/// `cosine` of incidence in (0, 1].
SurfaceShares surface_shares(const Material& material, double reflectance, double cosine);

/// Of a thin pane in air: what it reflects of unpolarised light.
double pane_reflectance(double refractive_index, double cosine);

}  // namespace simvis
