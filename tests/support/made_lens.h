// Lenses of tests: the word of a model with its coefficients, and the published formula of each model in long double.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/frame_plan.h>
#include "effects/camera/lens.h"

namespace simvis::test {

struct MadeLens {
  std::string_view model;            ///< the word of the attribute `distortion`
  Pinhole pinhole;                   ///< pixels start at the corner of the first pixel
  std::vector<double> coefficients;  ///< in the order of calibrations
};

const LensType& lens_type(const MadeLens& lens);

Lens made(const MadeLens& lens);

/// The attributes of the lens, without those of the pinhole.
std::string lens_attributes(const MadeLens& lens);

/// The pixel of a point of the view frame, by the formula of the publication, term by term in long double.
glm::dvec2 formula_pixel(const MadeLens& lens, const glm::dvec3& point);

}  // namespace simvis::test
