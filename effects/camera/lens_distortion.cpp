#include "effects/camera/lens_distortion.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/decimal.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

namespace {

constexpr std::string_view kNone = "none";

bool has_coefficient(const LensType& type, std::string_view name) {
  return std::ranges::any_of(type.coefficients, [&](const AttributeSpec& spec) { return spec.name == name; });
}

// The rows of all models. One that several models have says what it is in each.
std::vector<AttributeSpec> coefficient_rows() {
  struct Meaning {
    std::string text, models;
  };
  std::vector<std::pair<AttributeSpec, std::vector<Meaning>>> rows;
  for (const LensType* const type : lens_types()) {
    for (const AttributeSpec& spec : type->coefficients) {
      auto row = std::ranges::find(rows, spec.name, [](const auto& each) { return each.first.name; });
      if (row == rows.end()) row = rows.insert(rows.end(), {spec, {}});
      std::vector<Meaning>& meanings = row->second;
      const auto same = std::ranges::find(meanings, spec.text, &Meaning::text);
      if (same == meanings.end()) {
        meanings.push_back({std::string(spec.text), std::string(type->name)});
      } else {
        same->models += ", " + std::string(type->name);
      }
    }
  }
  std::vector<AttributeSpec> specs;
  for (auto& [spec, meanings] : rows) {
    std::string text;
    for (const Meaning& each : meanings) text += (text.empty() ? "" : "; ") + each.models + ": " + each.text;
    spec.text = keep_text(std::move(text));
    specs.push_back(spec);
  }
  return specs;
}

AttributeTable lens_distortion_rows() {
  std::string choices(kNone);
  for (const LensType* const type : lens_types()) choices += ' ' + std::string(type->name);
  return join_tables({{{.name = "distortion",
                        .kind = AttributeKind::choice,
                        .default_value = kNone,
                        .text = "model of the lens; none: the coefficients have no effect",
                        .choices = keep_text(std::move(choices))}},
                      coefficient_rows(),
                      {{.name = "lens_oversampling",
                        .default_value = "1",
                        .text = "pixels rendered per pixel of the image, along x and y, in the middle",
                        .min = 0.25,
                        .max = 16}}});
}

std::unique_ptr<CameraEffect> create_lens_distortion(const CameraEffectContext& context) {
  const LensType* const type = lens_type_of(context.attributes);
  return type == nullptr ? nullptr : std::make_unique<LensDistortion>(*type, context.attributes);
}

const CameraEffectRegistration kLensDistortionRegistration(
    {.type =
         {.name = "lens_distortion",
          .summary = "A lens that bends straight lines, up to a fisheye of 220 degrees.",
          .notes = "Models and coefficients are those of OpenCV (brown_conrady, rational_polynomial with thin prism "
                   "and tilt, kannala_brandt), so that cv::undistort reverses the distortion, of Usenko et al. 2018 "
                   "(double_sphere) and of NVIDIA (ftheta, ftheta_backward; their polynomial has the focal length). "
                   "A coefficient that is not written is 0. The scene "
                   "is rendered as one pinhole view, or on the faces of a cube for fisheyes up to 220 degrees "
                   "(black beyond), and interpolated in linear light. Depth stays metres along Z (negative behind "
                   "the camera), is exact on planes, and is never a mean across an edge. A lens that folds within "
                   "the image is an error. The camera also writes CAMERA.yaml with the intrinsics.",
          .source = "attribute distortion other than none",
          .outputs = kShownInColor | kShownInDepth,
          .knob = "lens_oversampling",
          .reference = "OpenCV 4.6, Camera Calibration and 3D Reconstruction, and its fisheye model; formulas of the "
                       "publications",
          .needs = kHasLens,
          .attributes = lens_distortion_rows()},
     .order = CameraOrder::lens,
     .create = create_lens_distortion});

// Coefficients of other models have no meaning.
void require_own_coefficients(const LensType& type, const AttributeValues& attributes) {
  std::string own;
  for (const AttributeSpec& spec : type.coefficients) own += (own.empty() ? "" : ", ") + std::string(spec.name);
  for (const LensType* const other : lens_types()) {
    for (const AttributeSpec& spec : other->coefficients) {
      if (has_coefficient(type, spec.name) || !attributes.is_set(spec.name)) continue;
      fail_at(attributes.where(spec.name), "attribute " + in_quotes(spec.name) + " is not allowed with distortion=" +
                                               in_quotes(type.name) + ", expected " + own);
    }
  }
}

}  // namespace

LensDistortion::LensDistortion(const LensType& type, const AttributeValues& attributes)
    : type_(type),
      coefficients_(type.read(attributes)),
      model_(type.create(coefficients_)),
      oversampling_(attributes.number("lens_oversampling")),
      oversampling_at_(attributes.where("lens_oversampling")),
      distortion_at_(attributes.where("distortion")) {
  SIMVIS_ASSERT(model_ != nullptr);
  require_own_coefficients(type, attributes);
}

void LensDistortion::configure_rays(CameraLayout& layout) const {
  Pinhole& pinhole = layout.pinhole;
  if (type_.focal_px != nullptr) pinhole.fx_px = pinhole.fy_px = type_.focal_px(coefficients_);
  layout.distortion_model = type_.ros_name;
  layout.distortion_coefficients = coefficients_;
  layout.oversampling = oversampling_;
  layout.oversampling_at = oversampling_at_;

  const Lens lens(pinhole, model_);
  layout.pixel_of = [lens](const glm::dvec3& direction) {
    return lens.shows(direction) ? std::optional(lens.pixel(direction)) : std::nullopt;
  };
  layout.rays.clear();
  layout.rays.reserve(std::size_t{layout.width_px} * layout.height_px);
  for (std::uint32_t y = 0; y < layout.height_px; ++y) {
    for (std::uint32_t x = 0; x < layout.width_px; ++x) {
      const std::optional<glm::dvec3> ray = lens.direction({x + 0.5, y + 0.5});
      if (!ray) {
        fail_at(distortion_at_, "attribute \"distortion\": with these coefficients the lens shows nothing at column " +
                                    std::to_string(x) + " of row " + std::to_string(y) +
                                    ", expected a lens that fills the image: this one folds at " +
                                    decimal(model_->reach() * pinhole.fx_px, 6) + " px from the principal point");
      }
      layout.rays.push_back(*ray);
    }
  }
}

}  // namespace simvis
