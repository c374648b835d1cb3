#include "sensors/camera/pinhole_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace simvis {

namespace {

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

void check_cast_pixels(const AttributeValues& attributes) {
  const std::int64_t columns = attributes.integer(kWidthAttribute.name),
                     rows = attributes.integer(kHeightAttribute.name);
  if (columns * rows <= kMaxCastPixels) return;
  fail_at(attributes.where(kHeightAttribute.name),
          "attribute \"height\": " + std::to_string(columns) + " x " + std::to_string(rows) +
              " are too many pixels, expected at most " + std::to_string(kMaxCastPixels));
}

ColorSampling color_sampling(const AttributeValues& attributes) {
  const std::string& supersampling = attributes.choice(kSupersamplingAttribute.name);
  return {.supersampling = supersampling == "16"  ? 4u
                           : supersampling == "4" ? 2u
                                                  : 1u,
          .msaa = static_cast<std::uint32_t>(std::stoul(attributes.choice(kMsaaAttribute.name))),
          .supersampling_at = attributes.where(kSupersamplingAttribute.name),
          .msaa_at = attributes.where(kMsaaAttribute.name)};
}

double max_error_px(const AttributeValues& attributes, bool color) {
  const double value = attributes.number(kMaxErrorPxAttribute.name);
  if (value > 0 && !color) {
    fail_at(attributes.where(kMaxErrorPxAttribute.name),
            "attribute \"max_error_px\": depth is always exact, expected 0, or outputs with color");
  }
  return value;
}

const char* why_depth_apart(const ColorSampling& sampling, double max_error_px) {
  if (sampling.several()) return ", apart: at the centres of pixels, of which colour takes several samples";
  if (max_error_px > 0) return ", apart: of every triangle, where colour draws coarser levels";
  return nullptr;
}

void check_sampling(const ColorSampling& sampling, std::uint32_t width_px, std::uint32_t height_px,
                    const TargetLimits& limits) {
  if (std::ranges::find(limits.msaa, sampling.msaa) == limits.msaa.end()) {
    std::string allowed;
    for (const std::uint32_t count : limits.msaa) allowed += (allowed.empty() ? "" : ", ") + std::to_string(count);
    fail_at(sampling.msaa_at, "attribute \"msaa\": this device cannot take " + std::to_string(sampling.msaa) +
                                  " samples, expected one of " + allowed);
  }
  const std::uint32_t widest = limits.width_px / sampling.supersampling,
                      highest = limits.height_px / sampling.supersampling;
  if (width_px > widest || height_px > highest) {
    fail_at(sampling.supersampling_at,
            "attribute \"supersampling\": with " + std::to_string(sampling.supersampling * sampling.supersampling) +
                " this device can take pictures of up to " + std::to_string(widest) + " x " + std::to_string(highest) +
                " pixels, not of " + std::to_string(width_px) + " x " + std::to_string(height_px));
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

CameraLayout camera_layout(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad,
                           std::span<const ChosenCameraEffect> effects) {
  CameraLayout layout{
      .width_px = width_px, .height_px = height_px, .pinhole = centred_pinhole(width_px, height_px, hfov_rad)};
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
