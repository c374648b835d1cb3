// The models of lenses. Each is defined in a file of its own.
#include "effects/camera/lens.h"

namespace simvis {

extern const LensType kBrownConrady, kKannalaBrandt, kRationalPolynomial, kDoubleSphere, kFTheta, kFThetaBackward;

namespace {

constexpr const LensType* kLensTypes[] = {&kBrownConrady, &kKannalaBrandt, &kRationalPolynomial,
                                          &kDoubleSphere, &kFTheta,        &kFThetaBackward};

}  // namespace

std::span<const LensType* const> lens_types() { return kLensTypes; }

}  // namespace simvis
