#include "effects/camera/vignetting.h"

#include <algorithm>
#include <cmath>

namespace simvis {

namespace {

constexpr AttributeSpec kVignettingAttributes[] = {
    {.name = "vignetting",
     .kind = AttributeKind::choice,
     .default_value = "none",
     .text = "none, cos^4 of the angle, or a polynomial",
     .choices = "none natural polynomial"},
    {.name = "v1", .default_value = "0", .text = "coefficient of r^2"},
    {.name = "v2", .default_value = "0", .text = "coefficient of r^4"},
    {.name = "v3", .default_value = "0", .text = "coefficient of r^6"},
};

std::unique_ptr<CameraEffect> create_vignetting(const CameraEffectContext& context) {
  const AttributeValues& a = context.attributes;
  if (a.choice("vignetting") == "none") return nullptr;
  const VignettingLaw law = a.choice("vignetting") == "natural" ? VignettingLaw::natural : VignettingLaw::polynomial;
  return std::make_unique<Vignetting>(law, std::array{a.number("v1"), a.number("v2"), a.number("v3")},
                                      a.where("vignetting"));
}

const CameraEffectRegistration kVignettingRegistration(
    {.type = {.name = "vignetting",
              .summary = "An image that grows darker towards its corners.",
              .notes = "natural is cos^4 of the angle to the optical axis; polynomial is 1 + v1 r^2 + v2 r^4 + v3 r^6 "
                       "with r = 1 at half the diagonal.",
              .source = "attribute vignetting other than none",
              .outputs = kShownInColor,
              .reference = "cos^4: Kang and Weiss, ECCV 2000; polynomial: Goldman, PAMI 32, 2010",
              .needs = kHasImageSensor,
              .attributes = kVignettingAttributes},
     .order = CameraOrder::aperture,
     .create = create_vignetting});

}  // namespace

double Vignetting::factor(const CameraLayout& layout, std::uint32_t x, std::uint32_t y) const {
  if (law_ == VignettingLaw::natural) {
    const double cosine = std::max(layout.axis_cosine(x, y), 0.0);
    return cosine * cosine * cosine * cosine;
  }
  const double dx = x + 0.5 - layout.pinhole.cx_px, dy = y + 0.5 - layout.pinhole.cy_px;
  const double width = layout.width_px, height = layout.height_px;
  const double r2 = 4 * (dx * dx + dy * dy) / (width * width + height * height);
  return 1 + r2 * (v_[0] + r2 * (v_[1] + r2 * v_[2]));
}

void Vignetting::configure_rays(CameraLayout& layout) const {
  if (law_ == VignettingLaw::natural) return;
  for (std::uint32_t y = 0; y < layout.height_px; ++y) {
    for (std::uint32_t x = 0; x < layout.width_px; ++x) {
      const double factor = this->factor(layout, x, y);
      if (factor >= 0) continue;
      fail_at(where_, "attribute \"vignetting\": the polynomial of v1, v2, v3 is " + format_number(factor) +
                          " at column " + std::to_string(x) + " of row " + std::to_string(y) +
                          ", expected at least 0 all over the image");
    }
  }
}

void Vignetting::post_process(const FrameTime&, const CameraLayout& layout, Image& color) const {
  std::vector<float>& pixels = color.pixels.edit();
  for (std::uint32_t y = 0; y < color.height; ++y) {
    for (std::uint32_t x = 0; x < color.width; ++x) {
      const double factor = this->factor(layout, x, y);
      float* const pixel = pixels.data() + (std::size_t{y} * color.width + x) * color.channels;
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(factor * static_cast<double>(pixel[c]));
    }
  }
}

}  // namespace simvis
