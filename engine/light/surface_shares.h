// How a surface divides the light that meets it between a mirror, a pane of glass, and what is matte.
//
// Shares   A surface reflects the share `mirror` of the light; of the rest, the share `transmission` meets a pane (see
//          Material); what remains is matte.
// Pane     A pane is a thin sheet of glass: light passes in the same direction, without an offset. One face reflects
//          the share R of the light by Fresnel's equations. Both faces together, including all multiple reflections
//          between them without interference, reflect 2 R / (1 + R) for each polarisation; the incident light is
//          unpolarised. The rest passes, coloured by the base colour. A pane is one sheet of triangles: a ray through a
//          box meets two panes.
#pragma once

#include <simvis/mesh.h>

namespace simvis {

/// The one-way shares of light at a surface. They sum to at most 1; a black or coloured pane absorbs the rest.
struct SurfaceShares {
  double matte = 1, reflected = 0, passed = 0;
};

/// `reflectance` is that of the base colour, `cosine` that of the angle of incidence, in (0, 1].
SurfaceShares surface_shares(const Material& material, double reflectance, double cosine);

/// The share of unpolarised light that a thin pane in air reflects.
double pane_reflectance(double refractive_index, double cosine);

}  // namespace simvis
