#include "effects/camera/lens_distortion.h"

#include <string>

#include "engine/base/decimal.h"

namespace simvis {

namespace {

constexpr AttributeSpec kLensDistortionAttributes[] = {
    {.name = "distortion",
     .kind = AttributeKind::choice,
     .default_value = "none",
     .text = "model of the lens, as OpenCV defines it; none: the coefficients have no effect",
     .choices = "none brown_conrady kannala_brandt"},
    {.name = "k1", .default_value = "0", .text = "radial coefficient of r^2; of theta^2 for kannala_brandt"},
    {.name = "k2", .default_value = "0", .text = "radial coefficient of r^4; of theta^4"},
    {.name = "k3", .default_value = "0", .text = "radial coefficient of r^6; of theta^6"},
    {.name = "k4", .default_value = "0", .text = "radial coefficient of theta^8, kannala_brandt only"},
    {.name = "p1", .default_value = "0", .text = "tangential coefficient, brown_conrady only"},
    {.name = "p2", .default_value = "0", .text = "tangential coefficient, brown_conrady only"},
    {.name = "fx", .unit = "px", .text = "focal length along x; default: from hfov", .min = 0, .open_min = true},
    {.name = "fy", .unit = "px", .text = "focal length along y; default: fx", .min = 0, .open_min = true},
    {.name = "cx", .unit = "px", .text = "principal point, from the centre of the first pixel; default: the middle"},
    {.name = "cy", .unit = "px", .text = "principal point along y; default: the middle"},
    {.name = "lens_oversampling",
     .default_value = "1",
     .text = "pixels rendered per pixel of the image, along x and y, in the middle",
     .min = 0.25,
     .max = 16},
};

// Without distortion these attributes have no meaning.
void require_distortion(const AttributeValues& attributes) {
  for (const char* const name : {"fx", "fy", "cx", "cy"}) {
    if (!attributes.is_set(name)) continue;
    fail_at(attributes.where(name), "attribute \"" + std::string(name) +
                                        "\" is not allowed with distortion=\"none\", expected brown_conrady or "
                                        "kannala_brandt, or hfov alone");
  }
}

std::unique_ptr<CameraEffect> create_lens_distortion(const CameraEffectContext& context) {
  if (context.attributes.choice("distortion") != "none") return std::make_unique<LensDistortion>(context.attributes);
  require_distortion(context.attributes);
  return nullptr;
}

const CameraEffectRegistration kLensDistortionRegistration(
    {.type = {.name = "lens_distortion",
              .summary = "A lens that bends straight lines, up to a fisheye of 220 degrees.",
              .notes = "Models and coefficients are OpenCV's, so that cv::undistort reverses the distortion. The scene "
                       "is rendered as one pinhole view, or on the faces of a cube for fisheyes up to 220 degrees "
                       "(black beyond), and interpolated in linear light. Depth stays metres along Z (negative behind "
                       "the camera), is exact on planes, and is never a mean across an edge. A lens that folds within "
                       "the image is an error. The camera also writes CAMERA.yaml with the intrinsics.",
              .source = "attribute distortion other than none",
              .outputs = kShownInColor | kShownInDepth,
              .knob = "lens_oversampling",
              .reference = "OpenCV 4.6, Camera Calibration and 3D Reconstruction, and its fisheye model",
              .needs = kHasLens,
              .attributes = kLensDistortionAttributes},
     .order = CameraOrder::lens,
     .create = create_lens_distortion});

}  // namespace

LensDistortion::LensDistortion(const AttributeValues& a)
    : oversampling_(a.number("lens_oversampling")),
      oversampling_at_(a.where("lens_oversampling")),
      distortion_at_(a.where("distortion")) {
  model_.kind = a.choice("distortion") == "kannala_brandt" ? LensKind::kannala_brandt : LensKind::brown_conrady;
  const char* const names[] = {"k1", "k2", "k3", "k4"};
  for (std::size_t i = 0; i < std::size(names); ++i) model_.k[i] = a.number(names[i]);
  model_.p1 = a.number("p1");
  model_.p2 = a.number("p2");
  const auto given = [&](const char* name) { return a.is_set(name) ? std::optional(a.number(name)) : std::nullopt; };
  given_ = {given("fx"), given("fy"), given("cx"), given("cy")};
}

void LensDistortion::configure_rays(CameraLayout& layout) const {
  LensModel model = model_;
  Pinhole& pinhole = layout.pinhole;
  pinhole.fx_px = given_.fx_px.value_or(pinhole.fx_px);
  pinhole.fy_px = given_.fy_px.value_or(pinhole.fx_px);
  if (given_.cx_px) pinhole.cx_px = *given_.cx_px + 0.5;
  if (given_.cy_px) pinhole.cy_px = *given_.cy_px + 0.5;
  model.pinhole = pinhole;
  const bool fisheye = model.kind == LensKind::kannala_brandt;
  layout.distortion_model = fisheye ? "equidistant" : "plumb_bob";
  layout.distortion_coefficients = fisheye
                                       ? std::vector<double>{model.k[0], model.k[1], model.k[2], model.k[3]}
                                       : std::vector<double>{model.k[0], model.k[1], model.p1, model.p2, model.k[2]};
  layout.oversampling = oversampling_;
  layout.oversampling_at = oversampling_at_;

  const Lens lens(model);
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
                                    decimal(lens.reach() * pinhole.fx_px, 6) + " px from the principal point");
      }
      layout.rays.push_back(*ray);
    }
  }
}

}  // namespace simvis
