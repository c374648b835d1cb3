#include "effects/camera/lens.h"

#include <algorithm>
#include <utility>

namespace simvis {

Lens::Lens(const Pinhole& pinhole, std::shared_ptr<const LensModel> model)
    : pinhole_(pinhole), model_(std::move(model)) {}

glm::dvec2 Lens::pixel(const glm::dvec3& direction) const {
  const glm::dvec2 d = model_->place(direction);
  return {pinhole_.cx_px + pinhole_.fx_px * d.x, pinhole_.cy_px + pinhole_.fy_px * d.y};
}

std::optional<glm::dvec3> Lens::direction(const glm::dvec2& pixel) const {
  return model_->direction({(pixel.x - pinhole_.cx_px) / pinhole_.fx_px, (pixel.y - pinhole_.cy_px) / pinhole_.fy_px});
}

const LensType* lens_type_of(const AttributeValues& attributes) {
  const auto type = std::ranges::find(lens_types(), attributes.choice("distortion"), &LensType::name);
  return type == lens_types().end() ? nullptr : *type;
}

std::vector<double> numbers_of(AttributeTable coefficients, const AttributeValues& attributes) {
  std::vector<double> numbers;
  for (const AttributeSpec& spec : coefficients) {
    numbers.push_back(attributes.is_set(spec.name) ? attributes.number(spec.name) : 0);
  }
  return numbers;
}

std::optional<Lens> lens_of(const Pinhole& pinhole, std::string_view distortion_model,
                            std::span<const double> coefficients) {
  for (const LensType* const type : lens_types()) {
    if (type->ros_name != distortion_model) continue;
    if (std::shared_ptr<const LensModel> model = type->create(coefficients)) return Lens(pinhole, std::move(model));
  }
  return std::nullopt;
}

}  // namespace simvis
