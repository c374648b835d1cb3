#include "effects/camera/chromatic_aberration.h"

namespace simvis {

namespace {

constexpr AttributeSpec kChromaticAberrationAttributes[] = {
    {.name = "color_magnification",
     .kind = AttributeKind::vector,
     .default_value = "1 1 1",
     .text = "sizes of the red, green and blue picture about the optical axis, relative to a lens without aberration",
     .min = 0.9,
     .max = 1.1},
};

std::unique_ptr<CameraEffect> create_chromatic_aberration(const CameraEffectContext& context) {
  const double(&sizes)[3] = context.attributes.vector("color_magnification");
  const glm::dvec3 magnification(sizes[0], sizes[1], sizes[2]);
  if (magnification == glm::dvec3(1)) return nullptr;
  return std::make_unique<ChromaticAberration>(magnification, context.attributes.where("color_magnification"));
}

const CameraEffectRegistration kChromaticAberrationRegistration(
    {.type = {.name = "chromatic_aberration",
              .summary = "A lens that magnifies red, green and blue unequally.",
              .notes =
                  "Lateral aberration that is linear in the distance from the optical axis. Each magnification is a "
                  "picture of its own. Depth and truth are those of the magnification 1. A fisheye that takes "
                  "several views cannot have it.",
              .source = "attribute color_magnification other than 1 1 1",
              .outputs = kShownInColor,
              .reference = "edges at their distance from the middle times the magnification of each colour; the model "
                           "`linear` of lateral chromatic aberration in the manual of Lensfun",
              .needs = kHasPixelRays,
              .attributes = kChromaticAberrationAttributes},
     .order = CameraOrder::lens,
     .create = create_chromatic_aberration});

}  // namespace

void ChromaticAberration::configure_rays(CameraLayout& layout) const {
  layout.exposure.magnification = magnification_;
  layout.exposure.magnification_at = at_;
}

}  // namespace simvis
