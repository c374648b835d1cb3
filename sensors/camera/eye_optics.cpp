#include "sensors/camera/eye_optics.h"

#include <algorithm>
#include <utility>

#include <simvis/location.h>

namespace simvis {
namespace {

// Pixels of all images whose mean one image is; each takes up to 40 bytes.
constexpr std::uint64_t kMaxSampledPixels = std::uint64_t{1} << 25;

}  // namespace

EyeOptics::EyeOptics(const EyeDesc& desc)
    : layout(camera_layout(desc.pinhole, desc.effects)),
      views(camera_views(layout, desc.draws_color() ? desc.sampling.supersampling : 1)),
      samples(color_samples(layout.exposure)),
      still_samples(simvis::still_samples(layout.exposure)) {
  const bool casts_all = desc.paths.by_paths() && (desc.depth || desc.truth.any());
  check_one_axis();
  if (casts_all || desc.truth.casts() || (desc.truth.any() && resamples()))
    rays.emplace(layout, views, desc.pinhole.near_m);
  if (!desc.truth.boxes) return;
  canvas.emplace(layout, views, desc.pinhole.near_m);
  silhouettes.emplace(*canvas);
}

void EyeOptics::check(const EyeDesc& desc, const TargetLimits& limits) const {
  if (desc.color) check_sampling(desc.sampling, desc.pinhole, limits);
  check_samples();
  if (!resamples() || (rays && !desc.color)) return;
  const std::uint32_t supersampling = desc.color ? desc.sampling.supersampling : 1;
  for (const glm::uvec2& size : views.pass_size_px) {
    if (size.x * supersampling <= limits.width_px && size.y * supersampling <= limits.height_px) continue;
    fail_at(layout.oversampling_at, "attribute \"lens_oversampling\": with " + format_number(layout.oversampling) +
                                        " this lens needs a view of " + std::to_string(size.x * supersampling) + " x " +
                                        std::to_string(size.y * supersampling) + " samples, expected at most " +
                                        std::to_string(limits.width_px) + " x " + std::to_string(limits.height_px) +
                                        " on this device");
  }
}

// The plane of focus is perpendicular to the axis of the camera, and colours are magnified about it, so that only views
// along this axis can be sheared and magnified.
void EyeOptics::check_one_axis() const {
  const bool turned =
      std::ranges::any_of(views.views, [](const CameraView& view) { return view.face_from_view != glm::dmat3(1); });
  if (!turned) return;
  const auto refuse = [](const Location& at, const std::string& attribute) {
    fail_at(at, "attribute \"" + attribute +
                    "\": this lens is so wide that it takes several views, expected a lens of one view, or no " +
                    attribute);
  };
  if (layout.exposure.aperture_m != 0) refuse(layout.exposure.aperture_at, "aperture");
  if (layout.exposure.magnification != glm::dvec3(1)) refuse(layout.exposure.magnification_at, "color_magnification");
}

// Each sample is an image of its own on the device and in memory until their mean is taken.
void EyeOptics::check_samples() const {
  const std::uint64_t pixels = std::uint64_t{layout.width_px} * layout.height_px, most = kMaxSampledPixels / pixels;
  if (samples.size() <= 1 || samples.size() <= most) return;
  const ColorExposure& exposure = layout.exposure;
  fail_at(exposure.samples > 1 ? exposure.samples_at : exposure.magnification_at,
          std::to_string(samples.size()) + " samples of " + std::to_string(layout.width_px) + " x " +
              std::to_string(layout.height_px) + " pixels are too many, expected at most " + std::to_string(most) +
              " for this image");
}

}  // namespace simvis
