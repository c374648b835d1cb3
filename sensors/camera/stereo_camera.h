// The sensor `stereo_camera`: two pinhole views side by side, or two through equal lenses, and the disparity between
// them. Each view is a CameraEye.
//
//   <sensor type="stereo_camera" name="EYES" insert_at="ROBOT" baseline="0.12" outputs="color disparity"/>
//
// Frames   The sensor frame is that of the left camera: it looks along +x; image x points to the right, y down. The
//          right camera stands `baseline` to its right, at (0, -baseline, 0), and looks in the same direction: the rows
//          of both images correspond.
// Disparity  Disparity of the left image, in pixels, positive: a point at column u in the left image is at u -
//            disparity in the right image. disparity = fx * baseline / Z with the true depth Z; 0 where nothing is hit.
//            Points that the right camera cannot see also have a disparity.
// Lens       Both cameras have the same lens. Pixels are those of its images, which are not rectified: rows correspond
//            only after rectification. The disparity of a pixel is that of its point in the rectified pair, whose
//            pinhole is that of the calibration: fx * baseline / Z. It is 0 where Z is not above 0.
// Samples  As for a camera: colour may be a mean over the pixel; depth and disparity are those of its centre.
// Levels   As for a camera: max_error_px affects colour; depth and disparity are those of every triangle.
// Effects  As for a camera; the noise of the left and the right camera is independent.
// Truth    As for a camera, of each view. Where they are cast, disparity is cast too.
// Boxes    As for a camera; the column `view` of the table says which view a row belongs to.
// Splats   As for a camera; disparity is that of their depth.
// Names    Images are "left" and "right" (colour), "left_depth", "right_depth" and "disparity" (one channel);
//          those of truth are "left_instance" and so on.
// Values   As for a camera, over the depth of both views.
// Files    SENSOR_left and SENSOR_right hold images as a camera writes them, SENSOR_disparity holds EXR images with the
//          one channel `disparity`; SENSOR_left.yaml and SENSOR_right.yaml hold the intrinsics (see camera_info.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "sensors/camera/camera_eye.h"
#include "sensors/described_sensor.h"

namespace simvis {

struct StereoCameraDesc {
  PinholeDesc pinhole{};     ///< of each view
  double baseline_m = 0.12;  ///< above 0
  bool color = true, depth = false, disparity = true;
  TruthDesc truth{};
  ColorSampling sampling{};
  std::vector<ChosenCameraEffect> left_effects{}, right_effects{};  ///< with equal layouts

  static AttributeRows<StereoCameraDesc> rows();
  void complete(const SensorContext& context);
};

class StereoCamera : public Sensor, public Stateful {
 public:
  StereoCamera(const std::string& name, const StereoCameraDesc& desc);

  void check(const TargetLimits& limits) const override { optics_.check(left_desc_, limits); }
  HistoryDependence history_dependence() const override { return left_.history_dependence(); }
  SensorNeeds needs() const override { return left_.needs(); }
  void sense(const SensedWorld& world) override { world_.sense(world, needs()); }
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void begin(const FrameTime& time) override;
  void archive(StateArchive& state) override {
    left_.archive(state);
    right_.archive(state, &left_);
  }
  bool shows_splats() const override { return left_.shows_splats() || right_.shows_splats(); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& of_list) override;
  Measurement measurement() const override;
  std::vector<NumberOnRequest> on_request() const override;
  std::string method() const override { return "rasterised"; }

 private:
  glm::dmat4 world_from_right(const glm::dmat4& world_from_sensor) const;

  EyeDesc left_desc_, right_desc_;
  double baseline_m_;
  EyeOptics optics_;  // of both eyes
  EyeWorld world_;    // the same
  CameraEye left_, right_;
  ObjectTable objects_;
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
};

}  // namespace simvis
