// The sensor `stereo_camera`: two rectified pinhole views and the true disparity between them.
//
//   <sensor type="stereo_camera" name="EYES" insert_at="ROBOT" baseline="0.12" outputs="color disparity"/>
//
// Frames   The sensor frame is that of the left camera: it looks along +x; image x points to the right, y down. The
//          right camera stands `baseline` to its right, at (0, -baseline, 0), and looks in the same direction: the rows
//          of both images correspond.
// Disparity  Disparity of the left image, in pixels, positive: a point at column u in the left image is at u -
//            disparity in the right image. disparity = fx * baseline / Z with the true depth Z; 0 where nothing is hit.
//            Points that the right camera cannot see also have a disparity.
// Samples  As for a camera: colour may be a mean over the pixel; depth and disparity are those of its centre.
// Levels   As for a camera: max_error_px affects colour; depth and disparity are those of every triangle.
// Effects  See simvis/camera_effect.h; the noise of the left and the right camera is independent.
// Truth    As for a camera, of each view. Where they are cast, disparity is cast too.
// Boxes    As for a camera; the column `view` of the table says which view a row belongs to.
// Splats   As for a camera; disparity is that of their depth.
// Names    Images are "left" and "right" (colour), "left_depth", "right_depth" and "disparity" (one channel);
//          those of truth are "left_instance" and so on.
// Values   As for a camera, over the depth of both views.
// Files    SENSOR_left and SENSOR_right hold images as a camera writes them, SENSOR_disparity holds EXR images with the
//          one channel `disparity`; SENSOR_left.yaml and SENSOR_right.yaml hold the intrinsics (see camera_info.h).
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/sensor.h>
#include "sensors/camera/camera_splats.h"
#include "sensors/camera/depth_error_bound.h"
#include "sensors/camera/object_table.h"
#include "sensors/camera/open_pixels.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_truth.h"

namespace simvis {

struct StereoCameraDesc {
  std::uint32_t width_px = 640, height_px = 480;  ///< of each view
  double hfov_rad = glm::radians(60.0);           ///< (0, pi)
  double near_m = 0.05;
  double baseline_m = 0.12;  ///< above 0
  bool color = true, depth = false, disparity = true;
  TruthDesc truth{};
  ColorSampling sampling{};
  double max_error_px = 0;                                          ///< at least 0, see View; colour only
  std::vector<ChosenCameraEffect> left_effects{}, right_effects{};  ///< none of them changes the rays
};

/// Reads the attributes of a stereo camera. Throws InputError at an attribute that another attribute does not allow.
StereoCameraDesc stereo_camera_desc(const SensorContext& context);

class StereoCamera : public Sensor {
 public:
  StereoCamera(std::string name, const StereoCameraDesc& desc);

  void check(const TargetLimits& limits) const override;
  HistoryDependence history_dependence() const override;
  SensorNeeds needs() const override { return {.item_ids = desc_.truth.needs_ids(), .scene = desc_.truth.flow.any()}; }
  void begin(const FrameTime& time) override {
    time_ = time;
    time_ns_ = time.time_ns;
  }
  void sense(const SensedWorld& world) override;
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& of_list) override;
  Measurement measurement() const override;
  std::vector<NumberOnRequest> on_request() const override;
  std::string method() const override { return "rasterised"; }

 private:
  struct Place {
    std::size_t pass = 0, view = 0;  // in this frame's plan
  };
  struct Eye {
    PixelTruth truth;
    std::optional<PixelFlow> flow{};      // empty if none is asked for
    std::optional<PixelLayers> layers{};  // the same
    std::optional<OpenPixels> open{};     // empty unless items are drawn
    Place color_at{}, depth_at{};         // in this frame's plan
    Image color{}, depth{};
    double cast_bound_m = std::numeric_limits<double>::quiet_NaN();  // of `depth`, if it is cast
    DepthView depth_view{}, measured_view{};                         // of this frame, and of `depth`
    std::span<const ChosenCameraEffect> effects{};                   // of desc_
    bool shows_splats = false;                                       // in this frame
    std::optional<CameraSplats> splats{};                            // made when first needed
  };
  struct Eyes {
    Place left, right;
  };
  View make_view(const char* side, const glm::dmat4& world_from_camera, const char* why) const;
  Eyes plan_eyes(const glm::dmat4& world_from_sensor, bool color, bool depth, const char* why, FramePlan& plan) const;
  bool draws_depth() const {
    return !rays_ && (desc_.depth || desc_.disparity || desc_.truth.any() || left_.shows_splats);
  }
  bool reads_depth(const Eye& eye) const { return desc_.depth || eye.shows_splats; }
  /// Whether the right view is planned without colour.
  bool right_has_depth() const { return desc_.depth || desc_.truth.any() || right_.shows_splats; }
  void plan_splats(const DrawList& list, FramePlan& plan);
  void add_splats(const PixelRows& rows, unsigned threads, Eye& eye);
  static bool has_splat_depth(const Eye& eye) { return eye.shows_splats && eye.splats->in_depth(); }
  bool draws_items() const { return !rays_ && desc_.truth.needs_items(); }
  void collect_depth(const Pass& pass, const PassResult& result, Eye& eye);
  void cast_open_pixels(RayCaster& caster);
  void set_depth(Eye& eye, std::uint32_t pixel, double depth_m);
  void cast_disparity();
  void add_objects();
  void read_depth(const PixelRows& rows, Eye& eye);
  void begin_truth(FramePlan& plan);
  CameraMoment moment(const Eye& eye) const;
  glm::dmat4 world_from_right(const glm::dmat4& world_from_sensor) const;
  void cast(RayCaster& caster, const glm::dmat4& world_from_camera, Eye& eye);
  void collect_disparity(const FramePlan& plan, std::span<const PassResult> results);

  std::string name_;
  StereoCameraDesc desc_;
  Pinhole pinhole_;
  CameraLayout layout_;  // of both views
  CameraViews views_;    // of each view
  LayerWorld layer_world_;
  Eye left_, right_;
  Image disparity_;
  std::optional<PixelCanvas> canvas_;           // with boxes
  std::optional<ItemSilhouettes> silhouettes_;  // with boxes
  ObjectTable objects_;
  ItemIds ids_;                           // of this frame
  const DrawList* drawn_list_ = nullptr;  // of this frame
  const DrawList* list_ = nullptr;        // the same as rays see it
  std::optional<PixelRays> rays_;         // empty if truth is drawn
  std::vector<SeenSurface> seen_;         // by pixel of a view, if rays are cast
  SceneKeeper scenes_;
  std::shared_ptr<const KeptScene> kept_scene_;        // of this frame, for flow
  FrameTime time_;                                     // of this frame
  std::int64_t time_ns_ = 0;                           // the same, also of one that is skipped
  std::int64_t measured_ns_ = 0;                       // when and where the images were taken
  glm::dmat4 planned_from_{1.0}, measured_from_{1.0};  // world_from_sensor of this frame, of the last measurement
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
};

}  // namespace simvis
