// Attributes, geometry, images and effects that sensors with pinhole cameras share.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/camera_effect.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/image.h>
#include <simvis/measurement.h>

namespace simvis {

inline constexpr AttributeSpec kWidthAttribute{.name = "width",
                                               .kind = AttributeKind::integer,
                                               .default_value = "640",
                                               .unit = "px",
                                               .text = "columns of the image",
                                               .min = 1,
                                               .max = 16384};
inline constexpr AttributeSpec kHeightAttribute{.name = "height",
                                                .kind = AttributeKind::integer,
                                                .default_value = "480",
                                                .unit = "px",
                                                .text = "rows of the image",
                                                .min = 1,
                                                .max = 16384};
/// The same attribute for a sensor with another default.
constexpr AttributeSpec with_default(AttributeSpec attribute, std::string_view value) {
  attribute.default_value = value;
  return attribute;
}
inline constexpr AttributeSpec kHfovAttribute{
    .name = "hfov",
    .default_value = "60",
    .unit = "deg",
    .text = "horizontal field of view, from the left edge of the image to the right",
    .min = 0,
    .max = 180,
    .open_min = true,
    .open_max = true};
inline constexpr AttributeSpec kNearAttribute{.name = "near",
                                              .default_value = "0.05",
                                              .unit = "m",
                                              .text = "what is nearer along the optical axis is not seen",
                                              .min = 0,
                                              .open_min = true};

inline constexpr AttributeSpec kSupersamplingAttribute{
    .name = "supersampling",
    .kind = AttributeKind::choice,
    .default_value = "1",
    .text = "samples of colour per pixel, on a regular grid; depth is always that of the pixel's centre",
    .choices = "1 4 16"};
inline constexpr AttributeSpec kMsaaAttribute{
    .name = "msaa",
    .kind = AttributeKind::choice,
    .default_value = "1",
    .text = "samples of coverage per sample of colour: smooth edges of shapes; how many depends on the device",
    .choices = "1 2 4 8"};

inline constexpr AttributeSpec kMaxErrorPxAttribute{
    .name = "max_error_px",
    .default_value = "0",
    .unit = "px",
    .text =
        "pixels by which surfaces in colour may be displaced: meshes are drawn at coarser levels whose error stays "
        "below it; 0: every triangle is drawn",
    .min = 0};

/// The most pixels of a camera that casts several rays for each. Real devices have fewer; each pixel takes 100 to
/// 200 bytes while the camera measures.
inline constexpr std::int64_t kMaxCastPixels = std::int64_t{1} << 22;

/// Throws InputError at `height` if the image has more than kMaxCastPixels.
void check_cast_pixels(const AttributeValues& attributes);

/// Number of samples that are averaged for the colour of a pixel, see Pass.
struct ColorSampling {
  std::uint32_t supersampling = 1;  ///< samples per pixel along x and along y; the attribute holds the square
  std::uint32_t msaa = 1;
  Location supersampling_at, msaa_at;  ///< where the attributes stand in the scene, for messages

  bool several() const { return supersampling > 1 || msaa > 1; }
};

/// Appended to the reason of a view that is drawn for depth alone next to a view for colour; null if one view serves
/// both. Depth is that of pixel centres, and of every triangle.
const char* why_depth_apart(const ColorSampling& sampling, double max_error_px);

ColorSampling color_sampling(const AttributeValues& attributes);

/// The value of max_error_px. Throws InputError if it is above 0 for a sensor without colour, which alone it affects.
double max_error_px(const AttributeValues& attributes, bool color);

/// Throws InputError, with the location and the allowed values, if the device does not support that many samples, or
/// cannot render to a target that holds the samples of an image of this size.
void check_sampling(const ColorSampling& sampling, std::uint32_t width_px, std::uint32_t height_px,
                    const TargetLimits& limits);

/// Reads the colour image of one view of a pass: linear RGBA.
void read_color(const Pass& pass, const View& view, const PassResult& result, Image& image);

/// Reads the depth image of one view of a pass: depth along Z in metres; +infinity where nothing is hit.
void read_depth(const Pass& pass, const View& view, const PassResult& result, Image& image);

/// Bits of EffectOutput.
std::uint8_t shown_outputs(bool color, bool depth);

/// The layout of a pinhole camera after configure_rays() of its effects. Throws InputError if an effect cannot be
/// applied.
CameraLayout camera_layout(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad,
                           std::span<const ChosenCameraEffect> effects);

/// The calibration of the images of a camera with this layout.
CameraCalibration calibration_of(const CameraLayout& layout);

/// The calibrations of a sensor's images, for its measurements.
std::shared_ptr<const std::vector<Calibration>> calibrations(std::vector<Calibration> of_views);

/// Lists the effects of a camera in the plan.
void plan_effects(const std::string& sensor, std::span<const ChosenCameraEffect> effects, FramePlan& plan);

/// Whether images depend on those before them.
bool remembers(std::span<const ChosenCameraEffect> effects);

/// Applies post_process() of the effects to a colour image.
void post_process(std::span<const ChosenCameraEffect> effects, const FrameTime& time, const CameraLayout& layout,
                  Image& color);

}  // namespace simvis
