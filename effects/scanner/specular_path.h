// The effect `specular_path`: mirrors reflect beams and glass transmits them, up to `path_depth` times per beam.
//
// Shares   A surface reflects the share `mirror` of the light; of the rest, the share `transmission` meets a pane (see
//          Material); what remains is matte. Light returns along the same path, so the share of the beam that a
//          continued ray carries is the square of the one-way share.
// Mirror   The angle of reflection equals the angle of incidence. The range is the length of the whole unfolded path.
// Pane     A pane is a thin sheet of glass: rays continue in the same direction, from the same origin, without an
//          offset. One face reflects the share R of the light by Fresnel's equations. Both faces together, including
//          all multiple reflections between them without interference, reflect 2 R / (1 + R) for each polarisation; the
//          incident light is unpolarised. The rest passes, coloured by the base colour. A pane is one sheet of
//          triangles: a beam through a box meets two panes.
// Depth    A beam ends after `path_depth` mirrors and panes; what the last of them sends on is lost.
//
// Not modelled: the glint of a mirror that the beam hits at a right angle, which returns directly to the receiver.
//
// Origin of a reflected ray. The hit point P is off the triangle by rounding: by the bound b of the range, and by 8 u
// |P| for P's own coordinates and their transform to the world (u = 2^-53). The triangle is also transformed again
// relative to P, where its corners are off by less than 3 b. (A bound is at least the error of the corners, 28 u of the
// mesh's reach and distance and 21 u of the offsets from the world's origin, see ray_caster.h. From P the distance is
// within the reach, so 56 u reach and 21 u (2 |mesh| + reach) take their place, and |mesh| <= |sensor| + distance.) The
// sum of these errors divided by the cosine of incidence is the distance along the ray within which the ray can hit the
// same triangle again. The reflected ray begins beyond twice that distance. A surface nearer than that to the mirror,
// 1e-13 m in a room, is not hit from there.
#pragma once

#include <simvis/surface_point.h>

namespace simvis {

/// The one-way shares of light at a surface. They sum to at most 1; a black or coloured pane absorbs the rest.
struct SurfaceShares {
  double matte = 1, reflected = 0, passed = 0;
};

/// `cosine` is that of the angle of incidence, in (0, 1].
SurfaceShares surface_shares(const Material& material, double reflectance, double cosine);

/// The share of unpolarised light that a thin pane in air reflects.
double pane_reflectance(double refractive_index, double cosine);

}  // namespace simvis
