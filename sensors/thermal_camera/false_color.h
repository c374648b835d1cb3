// False colours for pictures of one quantity.
//
// Palette  the "cubehelix" of D. A. Green, "A colour scheme for the display of astronomical intensity images", Bulletin
//          of the Astronomical Society of India 39, 2011: a helix around the diagonal of the colour cube whose
//          perceived brightness rises evenly from black to white, so that it prints in grey too. Start 0.5, 1.5 turns
//          backwards, hue 1, gamma 1.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// Codes of sRGB in [0, 1] for a share in [0, 1], from black to white.
glm::dvec3 false_color(double share);

}  // namespace simvis
