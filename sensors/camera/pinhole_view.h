// Attributes, geometry, images and effects that sensors with pinhole cameras share.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
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
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// The pixels of a camera.
struct PinholeDesc {
  std::uint32_t width_px = 640, height_px = 480;
  double hfov_rad = glm::radians(60.0);    ///< (0, pi); without effect if fx_px is set
  std::optional<double> fx_px{}, fy_px{};  ///< focal lengths; fx_px empty: from hfov_rad, fy_px: as fx_px
  std::optional<double> column_px{},
      row_px{};  ///< principal point, from the centre of the first pixel; empty: the middle
  double near_m = 0.05;
  bool lens_has_focal_length = false;  ///< a focal length of its own, which the scene does not give otherwise

  static AttributeRows<PinholeDesc> rows();
};

/// The most pixels of a camera that casts several rays for each. Real devices have fewer; each pixel takes 100 to
/// 200 bytes while the camera measures.
inline constexpr std::int64_t kMaxCastPixels = std::int64_t{1} << 22;

/// Throws InputError at `height` if the image has more than kMaxCastPixels.
void check_cast_pixels(const PinholeDesc& desc, const AttributeValues& attributes);

/// How colour is drawn; depth and truth are always those of pixel centres, of every triangle.
struct ColorSampling {
  std::uint32_t supersampling = 1;  ///< samples per pixel along x and along y; the attribute holds the square
  std::uint32_t msaa = 1;
  double max_error_px = 0;                 ///< at least 0, see View
  Location supersampling_at{}, msaa_at{};  ///< where the attributes stand in the scene, for messages

  static AttributeRows<ColorSampling> rows();
  bool several() const { return supersampling > 1 || msaa > 1; }
};

/// Throws InputError if max_error_px is above 0 for a sensor without colour, which alone it affects.
void check_max_error_px(const ColorSampling& sampling, bool color, const AttributeValues& attributes);

/// Appended to the reason of a view that is drawn for depth alone next to a view for colour; null if one view serves
/// both.
const char* why_depth_apart(const ColorSampling& sampling);

/// Throws InputError, with the location and the allowed values, if the device does not support that many samples, or
/// cannot render to a target that holds the samples of an image of this size.
void check_sampling(const ColorSampling& sampling, const PinholeDesc& pinhole, const TargetLimits& limits);

/// Reads the colour image of one view of a pass: linear RGBA.
void read_color(const Pass& pass, const View& view, const PassResult& result, Image& image);

/// Reads the depth image of one view of a pass: depth along Z in metres; +infinity where nothing is hit.
void read_depth(const Pass& pass, const View& view, const PassResult& result, Image& image);

/// Bits of EffectOutput.
std::uint8_t shown_outputs(bool color, bool depth);

/// The pinhole of a camera before its effects.
Pinhole pinhole_of(const PinholeDesc& desc);

/// The layout of a pinhole camera after configure_rays() of its effects. Throws InputError if an effect cannot be
/// applied.
CameraLayout camera_layout(const PinholeDesc& desc, std::span<const ChosenCameraEffect> effects);

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
