// Colour that a camera takes by paths of light: what engine/light/path_tracer.h estimates, in the mean over the square
// of a pixel, the exposure and the lens.
//
// Samples  Each sample is one path through each pixel: through a random point of its square, at one random time of the
//          exposure and from one random point of the lens. Time and point are those of all pixels, so that errors of
//          neighbours are alike where they come from these. Samples of one pixel are independent.
// Error    color_stddev is the standard deviation of the mean of the samples, as their spread shows it.
//          pixel_estimate.h has both, and decides how many samples `noise` needs.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/camera_layout.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/sensor_report.h>
#include "engine/light/path_tracer.h"
#include "scenegraph/language/attribute_rows.h"
#include "sensors/camera/moved_world.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_estimate.h"
#include "sensors/camera/pixel_optics.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/surface_layer.h"

namespace simvis {

/// How a camera gets its colour.
enum class CameraLight : std::uint8_t {
  drawn,  ///< from the renderer
  path    ///< from paths of light
};

/// What the attributes of a camera say of paths.
struct PathSampling {
  CameraLight light = CameraLight::drawn;
  std::optional<std::uint32_t> samples{}, bounces{};
  std::optional<double> noise{};  ///< in place of samples, see PixelEstimate
  bool stddev = false;            ///< color_stddev is measured
  Location light_at{};

  bool by_paths() const { return light == CameraLight::path; }
  /// Through each pixel; with `noise` at most.
  std::uint32_t number_of_samples() const { return noise ? PixelEstimate::kMaxSamples : samples.value_or(16); }
  std::uint32_t number_of_bounces() const { return bounces.value_or(4); }

  static AttributeRows<PathSampling> rows();
  /// Throws InputError at what contradicts the light, or needs more samples.
  void check(const AttributeValues& attributes, bool color, const ColorSampling& sampling) const;
};

/// The standard error of the output of colour `color`.
OutputSpec color_stddev_output(std::string name, const AttributeValues& attributes);

class PathImage {
 public:
  /// Throws InputError for a lens that magnifies colours unequally.
  PathImage(const PathSampling& sampling, const std::string& sensor, std::uint64_t seed, const CameraLayout& layout,
            double near_m);

  /// Adds the rays.
  void plan(const std::string& title, FramePlan& plan) const;

  /// Starts the image of a frame. Throws InputError if the list has Gaussian splats, lines, points without a size, or
  /// several pictures of the sky. The list must live until finish().
  void begin(const DrawList& list, const FrameTime& time);
  /// Whether a sample is to be taken; all samples before it have been.
  bool wants(std::uint32_t sample) { return estimate_.wants(sample); }
  /// The time of a sample relative to that of its rows, at most 0.
  double time_s(std::uint32_t sample) const;
  /// Takes a sample of all rows. `caster`'s world is the list.
  void take(std::uint32_t sample, RayCaster& caster, std::span<const PixelRows> rows);
  /// Sets the image to the mean of the samples: linear RGB, and alpha, which is 1.
  void finish(Image& color);
  const Image& stddev() const { return stddev_; }
  /// With `noise`: what the last image has reached.
  SensorReport report() const;

 private:
  SensorRandom random_of(std::uint32_t sample) const { return {seed_, sensor_ + "/path " + std::to_string(sample)}; }
  void set_scene(RayCaster& caster, std::span<const ItemPlace> places, const glm::dmat4& world_from_view);
  void take_rows(RayCaster& caster, const PixelRows& rows, std::uint32_t sample, const glm::dvec2& lens_m);
  PathStart start(std::uint32_t pixel, const SensorRandom& random, const glm::dvec2& lens_m) const;

  PathSampling sampling_;
  std::string sensor_;
  std::uint64_t seed_;
  ColorExposure exposure_;
  PixelOptics optics_;
  PathTracer tracer_;
  LayerList first_{SurfaceLayer::first};
  MovedWorld world_;
  const DrawList* list_ = nullptr;
  bool is_own_ = false;                   // rays hit what the copy of the list has
  std::optional<glm::dmat4> still_from_;  // V of the tracer's scene, if nothing in it stands elsewhere; of this frame
  std::uint64_t frame_ = 0;
  std::vector<PathStart> starts_;
  std::vector<glm::dvec3> radiance_;  // by start
  PixelEstimate estimate_;
  std::optional<ReachedNoise> reached_;
  Image stddev_;
};

}  // namespace simvis
