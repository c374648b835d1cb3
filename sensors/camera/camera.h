// The sensor `camera`: colour, depth, and truth about what it sees, of a pinhole camera or through a lens.
//
//   <sensor type="camera" name="CAM" insert_at="ROBOT" width="640" height="480" hfov="60" outputs="color depth"/>
//
// Frames   The camera looks along +x of its sensor frame; image x points to the right, y down. Pixels are square, and
//          the optical axis goes through the middle of the image.
// Units    Depth is depth along Z in metres, not range along the ray; +infinity where nothing is hit.
// Samples  With supersampling or msaa the colour of a pixel is the mean over its square in linear light, see Pass.
//          Depth is never averaged: it is taken at the centre of the pixel, and has a pass of its own in this case.
// Exposure With motion_blur, depth_of_field or chromatic_aberration colour is made of several pictures, see
//          color_samples.h. Depth and truth then have a pass of their own, at the row's time, from the centre of the
//          lens and with the magnification of the pinhole.
// Levels   With max_error_px above 0 meshes are drawn at coarser levels in colour, see View. Depth is that of every
//          triangle, and has a pass of its own in this case. With a lens, pixels are those of the rendered views.
// Effects  See simvis/camera_effect.h. With a lens or a rolling shutter the depth of a pixel is along the camera's Z
//          axis at the time of its row, for the surface at the pixel's centre: see resampled_image.h. With a lens,
//          samples are those of the rendered pixels; a wide lens takes several views, each with `near` along its own
//          axis.
// Files    SENSOR.yaml holds the intrinsics (see camera_info.h).
// Values   value("depth_error_bound_m") exists for cameras with depth. It is an upper bound on the error of every depth
//          of the last image, under the assumptions of depth_error_bound.h, or with a lens of resampled_image.h. The
//          former is computed when the value is read.
// Truth    `instance`, `semantic`, `range`, `normal`, `object_coordinates` and `depth_error_bound` are of the surface
//          at the pixel's centre: see pixel_truth.h; flow is that of this point: see pixel_flow.h. Where they are cast,
//          depth is cast with them.
// Boxes    `boxes` is a table of the things with a class, and `silhouettes` are theirs: see object_table.h.
// Splats   See camera_splats.h. They are looked at in cast(), and colour passes its effects after that.
// Faces    Back faces of single-sided materials are not drawn, as glTF defines, in colour and in depth.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/sensor.h>
#include "sensors/camera/camera_splats.h"
#include "sensors/camera/camera_views.h"
#include "sensors/camera/color_samples.h"
#include "sensors/camera/depth_error_bound.h"
#include "sensors/camera/object_table.h"
#include "sensors/camera/open_pixels.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_truth.h"

namespace simvis {

struct CameraDesc {
  std::uint32_t width_px = 640, height_px = 480;
  double hfov_rad = glm::radians(60.0);  ///< (0, pi)
  double near_m = 0.05;
  bool color = true, depth = false;
  TruthDesc truth{};
  ColorSampling sampling{};
  double max_error_px = 0;     ///< at least 0, see View; colour only
  bool visualization = false;  ///< also draws what no simulated sensor sees, such as beams and paths, for human viewers
  std::vector<ChosenCameraEffect> effects{};
};

/// Reads the attributes of a camera. Throws InputError at an attribute that another attribute does not allow.
CameraDesc camera_desc(const SensorContext& context);

class Camera : public Sensor {
 public:
  Camera(std::string name, const CameraDesc& desc);

  void check(const TargetLimits& limits) const override;
  HistoryDependence history_dependence() const override;
  SensorNeeds needs() const override;
  void sense(const SensedWorld& world) override;
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void begin(const FrameTime& time) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& of_list) override;
  Measurement measurement() const override;
  std::vector<NumberOnRequest> on_request() const override;
  bool visualization() const override { return desc_.visualization; }
  std::string method() const override { return "rasterised"; }

 private:
  /// Whether some rows are exposed before the frame's time.
  bool is_late() const;
  double share_before(double time_s) const;
  glm::dmat4 world_from_camera(double time_s) const;
  std::vector<ItemPlace> places(double time_s, const DrawList& list) const;
  void add_passes(bool color, bool depth, const std::string& what, const char* why, const DrawList& list,
                  FramePlan& plan, const ColorSample& sample = {}) const;
  void check_one_axis() const;
  void check_samples() const;
  void add_color_samples(const DrawList& list, FramePlan& plan);
  bool moves() const;
  void read_color_of(std::span<const Pass> passes, std::span<const PassResult> results);
  std::function<double()> depth_bound() const;
  void collect_depth(std::span<const Pass> passes, std::span<const PassResult> results);
  void read_truth(const Pass& pass, const PassResult& result);
  CameraMoment moment() const;
  void cast_open_pixels(RayCaster& caster);
  void plan_rays(FramePlan& plan) const;
  void cast_pixels(RayCaster& caster);
  std::vector<PixelRows> all_rows(std::vector<std::vector<ItemPlace>>& moved) const;
  void add_splats(unsigned threads);
  void add_objects();
  bool resamples() const { return !views_.taps.empty(); }
  bool may_show_splats() const { return desc_.color || desc_.depth || desc_.truth.of_surfaces(); }
  bool reads_depth() const { return desc_.depth || shows_splats_; }
  bool draws_depth() const { return !rays_ && (reads_depth() || desc_.truth.any()); }
  bool draws_items() const { return !rays_ && desc_.truth.needs_items(); }

  std::string name_;
  CameraDesc desc_;
  CameraLayout layout_;
  CameraViews views_;
  std::vector<ColorSample> samples_, still_samples_;  // of colour; the latter where nothing moves
  std::span<const ColorSample> taken_samples_;        // of this frame
  ColorMean mean_;
  FrameTime time_;                     // of the planned frame, or of the last measurement
  glm::dmat4 world_from_sensor_{1.0};  // at time_
  struct Past {
    std::int64_t time_ns = 0;
    glm::dmat4 world_from_sensor{1.0};
  };
  std::optional<Past> before_, last_;            // the measurement before time_, and the last measurement
  std::span<const ItemMove> moves_;              // of this frame
  ItemIds ids_;                                  // of this frame
  const DrawList* drawn_list_ = nullptr;         // of this frame
  const DrawList* list_ = nullptr;               // the same as rays see it
  std::size_t color_pass_ = 0, depth_pass_ = 0;  // index of the first pass of each kind in this frame's plan
  Image color_, depth_;
  std::vector<DepthView> depth_views_;     // one for each view of this frame
  std::vector<DepthView> measured_views_;  // of depth_
  std::optional<double> whole_bound_m_;    // of the depth of a resampled or cast image
  Past measured_;                          // when and where the images were taken
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
  LayerWorld layer_world_;
  PixelTruth truth_;
  std::optional<PixelLayers> layers_;  // empty if none are asked for
  std::optional<PixelFlow> flow_;      // empty if none is asked for
  SceneKeeper scenes_;
  std::shared_ptr<const KeptScene> kept_scene_;  // of this frame, for flow
  std::optional<OpenPixels> open_;               // empty unless items are drawn
  std::optional<PixelRays> rays_;                // empty if truth is drawn
  std::vector<SeenSurface> seen_;                // by pixel, if rays are cast
  std::optional<PixelCanvas> canvas_;            // with boxes
  std::optional<ItemSilhouettes> silhouettes_;   // with boxes
  ObjectTable objects_;
  bool shows_splats_ = false;           // in this frame
  std::optional<CameraSplats> splats_;  // made when first needed
};

}  // namespace simvis
