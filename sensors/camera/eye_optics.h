// What an eye of a camera is, and the geometry of its images, which the eyes of one camera share.
//
// Frames   V = view frame of the eye: x right, y down, z forward.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/sensor.h>
#include "sensors/camera/camera_views.h"
#include "sensors/camera/color_samples.h"
#include "sensors/camera/object_table.h"
#include "sensors/camera/path_image.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/pixel_truth.h"

namespace simvis {

/// What an eye is, and what it measures.
struct EyeDesc {
  std::string name;          ///< of its views: "CAM", "EYES_left"
  std::string sensor;        ///< the sensor's name
  std::string title;         ///< in reasons: "camera CAM", "left view of stereo camera EYES"
  std::string view{};        ///< its name: Calibration::view
  std::string color_name{},  ///< of the output of colour
      prefix{};              ///< of the names of all other outputs
  PinholeDesc pinhole{};
  bool color = false, depth = false;
  double baseline_m = 0;  ///< above 0: disparity is measured too, to an eye that is so far to the right
  TruthDesc truth{};
  ColorSampling sampling{};
  PathSampling paths{};  ///< of colour
  bool at_once = false;  ///< all rows and samples are taken at the frame's time, whatever effects say
  std::vector<ChosenCameraEffect> effects{};
  std::uint64_t seed = 0;  ///< of paths

  bool draws_color() const { return color && !paths.by_paths(); }
  bool disparity() const { return baseline_m > 0; }
};

/// The geometry of images, which the eyes of one camera share, and what their rays need.
struct EyeOptics {
  /// Throws InputError for an aperture, or a magnification of colours, of a lens that takes several views.
  explicit EyeOptics(const EyeDesc& desc);
  EyeOptics(const EyeOptics&) = delete;
  EyeOptics& operator=(const EyeOptics&) = delete;

  bool resamples() const { return !views.taps.empty(); }
  void check(const EyeDesc& desc, const TargetLimits& limits) const;

  CameraLayout layout;
  CameraViews views;
  std::vector<ColorSample> samples, still_samples;  ///< of colour; the latter where nothing moves
  std::optional<PixelRays> rays;                    ///< empty if what is measured is drawn
  std::vector<SeenSurface> seen;                    ///< by pixel, of the eye that has just cast its rays
  std::optional<PixelCanvas> canvas;                ///< with boxes
  std::optional<ObjectSilhouettes> silhouettes;     ///< the same

 private:
  void check_one_axis() const;
  void check_samples() const;
};

}  // namespace simvis
