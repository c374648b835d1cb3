// The effect `gaussian_splats`: captured surroundings in the images of cameras. sensors/camera/camera_splats.h has it.
#include <simvis/effect.h>

namespace simvis {
namespace {

const EffectRegistration kGaussianSplatsRegistration({
    .name = "gaussian_splats",
    .summary = "Cameras and range sensors see Gaussian splats, in front of and between surfaces.",
    .notes =
        "Each splat is evaluated on the ray of the pixel or beam, so that every lens sees the same splats. Depth, "
        "range and ids are those of the splat behind which less than half of the light is left. The host computes "
        "them: images of hundreds of thousands of splats take seconds a frame on two cores. A warning names sensors "
        "that do not see splats. See docs/gaussian-splats.md.",
    .source = "a visible part with Gaussian splats",
    .outputs = kShownInColor | kShownInDepth | kShownInRanges,
    .reference = "Kerbl et al. 2023, with the Gaussian along the ray as Moenne-Loccoz et al. 2024 have it",
});

}  // namespace
}  // namespace simvis
