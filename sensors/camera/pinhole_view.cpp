#include "sensors/camera/pinhole_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "effects/camera/lens.h"

namespace simvis {

namespace {

constexpr double kFirstCentre_px = 0.5;  // from the corner of the first pixel

constexpr std::string_view kUnscaled = "with a lens that has no focal length of its own";

bool has_unscaled_lens(const PinholeDesc& desc) { return !desc.lens_has_focal_length; }

/// All numbers of the image, to be written.
float* all_of(Image& image, const View& view, std::uint32_t channels) {
  image.width = view.width_px;
  image.height = view.height_px;
  image.channels = channels;
  std::vector<float>& pixels = image.pixels.overwrite();
  pixels.resize(std::size_t{view.width_px} * view.height_px * channels);
  return pixels.data();
}

std::size_t first_of_row(const Pass& pass, const View& view, std::uint32_t row) {
  return std::size_t{view.y_px + row} * pass.width_px + view.x_px;
}

}  // namespace

AttributeRows<PinholeDesc> PinholeDesc::rows() {
  using Desc = PinholeDesc;
  constexpr AttributeLimits kPixels{.min = 1, .max = 16384},
      kBelowHalfTurn{.min = 0, .max = 180, .open_min = true, .open_max = true};
  return {row(&Desc::width_px, "width", "px", kPixels, "columns of the image"),
          row(&Desc::height_px, "height", "px", kPixels, "rows of the image"),
          checked<Desc>([](Desc& desc, const AttributeValues& attributes) {
            const LensType* const lens = lens_type_of(attributes);
            desc.lens_has_focal_length = lens != nullptr && lens->focal_px != nullptr;
          }),
          row(&Desc::hfov_rad, "hfov", kDegrees, kBelowHalfTurn,
              "horizontal field of view of a pinhole in the middle, from the left edge of the image to the right; not "
              "with fx")
              .only("without fx, and with a lens that has no focal length of its own",
                    [](const Desc& desc) { return !desc.fx_px && has_unscaled_lens(desc); }),
          row(&Desc::fx_px, "fx", "px", kAboveZero, "focal length along x; default: from hfov")
              .only(kUnscaled, has_unscaled_lens),
          row(&Desc::fy_px, "fy", "px", kAboveZero, "focal length along y; default: that along x")
              .only(kUnscaled, has_unscaled_lens),
          row(&Desc::column_px, "cx", "px", kAnyNumber,
              "principal point, from the centre of the first pixel; default: the middle"),
          row(&Desc::row_px, "cy", "px", kAnyNumber, "principal point along y; default: the middle"),
          row(&Desc::near_m, "near", "m", kAboveZero, "what is nearer along the optical axis is not seen")};
}

Pinhole pinhole_of(const PinholeDesc& desc) {
  Pinhole pinhole = centred_pinhole(desc.width_px, desc.height_px, desc.hfov_rad);
  if (desc.fx_px) pinhole.fx_px = *desc.fx_px;
  pinhole.fy_px = desc.fy_px.value_or(pinhole.fx_px);
  if (desc.column_px) pinhole.cx_px = *desc.column_px + kFirstCentre_px;
  if (desc.row_px) pinhole.cy_px = *desc.row_px + kFirstCentre_px;
  return pinhole;
}

AttributeRows<ColorSampling> ColorSampling::rows() {
  using Desc = ColorSampling;
  return {row(&Desc::supersampling, "supersampling", {{1, "1"}, {2, "4"}, {4, "16"}},
              "samples of colour per pixel, on a regular grid; depth is always that of the pixel's centre"),
          row(&Desc::msaa, "msaa", {{1, "1"}, {2, "2"}, {4, "4"}, {8, "8"}},
              "samples of coverage per sample of colour: smooth edges of shapes; how many depends on the device"),
          row(&Desc::max_error_px, "max_error_px", "px", kNotNegative,
              "pixels by which surfaces in colour may be displaced: meshes are drawn at coarser levels whose error "
              "stays below it; 0: every triangle is drawn"),
          checked<Desc>([](Desc& desc, const AttributeValues& attributes) {
            desc.supersampling_at = attributes.where("supersampling");
            desc.msaa_at = attributes.where("msaa");
          })};
}

void check_cast_pixels(const PinholeDesc& desc, const AttributeValues& attributes) {
  if (std::int64_t{desc.width_px} * desc.height_px <= kMaxCastPixels) return;
  fail_at(attributes.where("height"), "attribute \"height\": " + std::to_string(desc.width_px) + " x " +
                                          std::to_string(desc.height_px) + " are too many pixels, expected at most " +
                                          std::to_string(kMaxCastPixels));
}

void check_max_error_px(const ColorSampling& sampling, bool color, const AttributeValues& attributes) {
  if (sampling.max_error_px == 0 || color) return;
  fail_at(attributes.where("max_error_px"),
          "attribute \"max_error_px\": depth is always exact, expected 0, or outputs with color");
}

const char* why_depth_apart(const ColorSampling& sampling) {
  if (sampling.several()) return ", apart: at the centres of pixels, of which colour takes several samples";
  if (sampling.max_error_px > 0) return ", apart: of every triangle, where colour draws coarser levels";
  return nullptr;
}

void check_sampling(const ColorSampling& sampling, const PinholeDesc& pinhole, const TargetLimits& limits) {
  if (std::ranges::find(limits.msaa, sampling.msaa) == limits.msaa.end()) {
    std::string allowed;
    for (const std::uint32_t count : limits.msaa) allowed += (allowed.empty() ? "" : ", ") + std::to_string(count);
    fail_at(sampling.msaa_at, "attribute \"msaa\": this device cannot take " + std::to_string(sampling.msaa) +
                                  " samples, expected one of " + allowed);
  }
  const std::uint32_t widest = limits.width_px / sampling.supersampling,
                      highest = limits.height_px / sampling.supersampling;
  if (pinhole.width_px > widest || pinhole.height_px > highest) {
    fail_at(sampling.supersampling_at,
            "attribute \"supersampling\": with " + std::to_string(sampling.supersampling * sampling.supersampling) +
                " this device can take pictures of up to " + std::to_string(widest) + " x " + std::to_string(highest) +
                " pixels, not of " + std::to_string(pinhole.width_px) + " x " + std::to_string(pinhole.height_px));
  }
}

void read_color(const Pass& pass, const View& view, const PassResult& result, Image& image) {
  float* const pixels = all_of(image, view, 4);
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const auto seen = result.color.subspan(first_of_row(pass, view, row), view.width_px);
    float* const out = pixels + std::size_t{row} * view.width_px * 4;
    std::memcpy(out, seen.data(), seen.size_bytes());
    for (std::uint32_t column = 0; pass.items && column < view.width_px; ++column) out[4 * column + 3] = 1;
  }
}

void read_depth(const Pass& pass, const View& view, const PassResult& result, Image& image) {
  float* const pixels = all_of(image, view, 1);
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const auto seen = result.depth.subspan(first_of_row(pass, view, row), view.width_px);
    std::ranges::transform(seen, pixels + std::ptrdiff_t{row} * view.width_px, [near_m = view.near_m](float d) {
      return d > 0 ? static_cast<float>(near_m / d) : std::numeric_limits<float>::infinity();
    });
  }
}

std::uint8_t shown_outputs(bool color, bool depth) {
  return static_cast<std::uint8_t>((color ? kShownInColor : 0) | (depth ? kShownInDepth : 0));
}

CameraLayout camera_layout(const PinholeDesc& desc, std::span<const ChosenCameraEffect> effects) {
  CameraLayout layout{.width_px = desc.width_px, .height_px = desc.height_px, .pinhole = pinhole_of(desc)};
  for (const ChosenCameraEffect& each : effects) each.effect->configure_rays(layout);
  return layout;
}

CameraCalibration calibration_of(const CameraLayout& layout) {
  return {.width_px = layout.width_px,
          .height_px = layout.height_px,
          .pinhole = layout.pinhole,
          .distortion_model = std::string(layout.distortion_model),
          .distortion_coefficients = layout.distortion_coefficients};
}

std::shared_ptr<const std::vector<Calibration>> calibrations(std::vector<Calibration> of_views) {
  return std::make_shared<const std::vector<Calibration>>(std::move(of_views));
}

void plan_effects(const std::string& sensor, std::span<const ChosenCameraEffect> effects, FramePlan& plan) {
  for (const ChosenCameraEffect& each : effects) {
    plan.effects.push_back({sensor, std::string(each.type->name), std::string(each.type->source)});
  }
}

bool remembers(std::span<const ChosenCameraEffect> effects) {
  return std::ranges::any_of(effects, [](const ChosenCameraEffect& each) { return each.effect->remembers(); });
}

void post_process(std::span<const ChosenCameraEffect> effects, const FrameTime& time, const CameraLayout& layout,
                  Image& color) {
  for (const ChosenCameraEffect& each : effects) each.effect->post_process(time, layout, color);
}

}  // namespace simvis
