// A camera: colour, depth or both, of a pinhole or through a lens.
//
//   <sensor type="camera" name="CAM" insert_at="ROBOT" width="640" height="480" hfov="60" outputs="color depth"/>
//
// Frames   the camera looks along +x of its sensor frame; image x to the right, y down. Pixels are square, the
//          optical axis goes through the middle of the image.
// Units    depth is metres along the optical axis (depth along Z, not range along the ray); +infinity: nothing.
// Samples  with supersampling or msaa the colour of a pixel is the mean, in linear light, over its square, see Pass.
//          Depth is never averaged: it is that of the pixel's centre, and has a pass of its own then.
// Effects  see effects/camera_effect.h. Through a lens or a rolling shutter a pixel's depth is along the Z that the
//          camera had at the row's time, of what is met at the pixel itself: see resampled_image.h. With a lens
//          samples are those of rendered pixels, a wide lens takes several views, each with `near` along its own axis,
//          and the file SENSOR.yaml holds the intrinsics (see camera_info.h).
// Values   value("depth_error_bound_m"), of cameras with depth: at least the error of every depth of the last image,
//          for what depth_error_bound.h, or with a lens resampled_image.h, speaks of. The former is worked out when it
//          is asked for.
// Faces    back faces of single-sided materials are not drawn, as glTF says, in colour and depth alike.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/sensor.h>
#include "sensors/camera/camera_views.h"
#include "sensors/camera/depth_error_bound.h"
#include "sensors/camera/pinhole_view.h"

namespace simvis {

struct CameraDesc {
  std::uint32_t width_px = 640, height_px = 480;
  double hfov_rad = 1;  ///< (0, pi)
  double near_m = 0.05;
  bool color = true, depth = false;
  ColorSampling sampling{};
  bool visualization = false;  ///< for people: sees beams, paths and the like, which no simulated sensor sees
  std::vector<ChosenCameraEffect> effects{};
};

class Camera : public Sensor {
 public:
  Camera(std::string name, const CameraDesc& desc);

  void check(const TargetLimits& limits) const override;
  HistoryDependence history_dependence() const override;
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void begin(const FrameTime& time) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  const Image* color() const override { return desc_.color ? &color_ : nullptr; }
  const Image* depth() const override { return desc_.depth ? &depth_ : nullptr; }
  std::span<const NamedValue> values() const override;
  void write(OutputSink& sink) const override;
  bool visualization() const override { return desc_.visualization; }
  std::string method() const override { return "rasterised"; }

 private:
  glm::dmat4 world_from_camera(double time_s) const;
  void add_passes(bool color, bool depth, const std::string& what, const char* why, FramePlan& plan) const;
  void collect_depth(std::span<const Pass> passes, std::span<const PassResult> results);
  bool resamples() const { return !views_.taps.empty(); }

  std::string name_;
  CameraDesc desc_;
  CameraLayout layout_;
  CameraViews views_;
  FrameTime time_;                     // that is planned or was taken last
  glm::dmat4 world_from_sensor_{1.0};  // at that time
  struct Past {
    std::int64_t time_ns = 0;
    glm::dmat4 world_from_sensor{1.0};
  };
  std::optional<Past> before_, last_;            // the measurement before that time, and the last that was taken
  std::size_t color_pass_ = 0, depth_pass_ = 0;  // the first of each in this frame's plan
  Image color_, depth_;
  std::vector<DepthView> depth_views_;  // by view
  mutable bool bound_due_ = false;      // the value is older than the image
  mutable NamedValue bound_{kDepthErrorBound, std::numeric_limits<double>::quiet_NaN()};
};

}  // namespace simvis
