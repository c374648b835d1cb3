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
// Where a reflected ray begins: see effects/scanner/onward_ray.h.
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
