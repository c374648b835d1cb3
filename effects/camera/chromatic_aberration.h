// The effect `chromatic_aberration`: a lens that magnifies red, green and blue unequally, so that edges away from the
// middle of the image have coloured fringes.
//
//   <sensor type="camera" ... color_magnification="1.001 1 0.9985"/>
//
// Model    Lateral chromatic aberration, linear in the distance from the optical axis, as in the model `linear` of the
//          database Lensfun. A point that the camera without the effect shows at the distance r from the principal
//          point is at r times its magnification in each colour. Each magnification is a picture of its own, so that
//          what only one colour sees at the edge of the image is there. Depth and truth are those of the
//          magnification 1.
// Error    None for light of three wavelengths.
// Limits   Colours are equally sharp: no axial aberration. With a lens, colours are magnified before its distortion. A
//          camera refuses it with a fisheye that takes several views (see sensors/camera/camera_views.h).
#pragma once

#include <glm/glm.hpp>

#include <simvis/camera_effect.h>

namespace simvis {

class ChromaticAberration : public CameraEffect {
 public:
  /// Magnifications of red, green and blue, each above 0. `at` is where they were written, for messages.
  ChromaticAberration(const glm::dvec3& magnification, const Location& at) : magnification_(magnification), at_(at) {}

  void configure_rays(CameraLayout& layout) const override;

 private:
  glm::dvec3 magnification_;
  Location at_;
};

}  // namespace simvis
