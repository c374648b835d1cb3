// The effect `gaussian_splats`: captured surroundings in the images of cameras. sensors/camera/camera_splats.h has it.
#include <simvis/effect.h>

namespace simvis {
namespace {

const EffectRegistration kGaussianSplatsRegistration({
    .name = "gaussian_splats",
    .summary = "Cameras see Gaussian splats, in front of and between what is drawn.",
    .notes =
        "Each splat is evaluated on the ray of the pixel, so that every lens sees the same splats. Depth, range and "
        "ids are those of the splat behind which less than half of the light is left. The host computes them: "
        "hundreds of thousands of splats take seconds a frame on two cores. Other sensors do not see splats, and a "
        "warning says so. See docs/gaussian-splats.md.",
    .source = "a visible part with Gaussian splats",
    .outputs = kShownInColor | kShownInDepth,
    .reference = "Kerbl et al. 2023, with the Gaussian along the ray as Moenne-Loccoz et al. 2024 have it",
});

}  // namespace
}  // namespace simvis
