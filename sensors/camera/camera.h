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
// Boxes    `boxes` is a table of the objects with a class, and `silhouettes` are theirs: see object_table.h.
// Splats   See camera_splats.h. They are looked at in cast(), and colour passes its effects after that.
// Faces    Back faces of single-sided materials are not drawn, as glTF defines, in colour and in depth.
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

struct CameraDesc {
  PinholeDesc pinhole{};
  bool color = true, depth = false;
  TruthDesc truth{};
  ColorSampling sampling{};
  PathSampling paths{};
  bool visualization = false;  ///< also draws what no simulated sensor sees, such as beams and paths, for human viewers
  std::vector<ChosenCameraEffect> effects{};
  std::uint64_t seed = 0;

  static AttributeRows<CameraDesc> rows();
  void complete(const SensorContext& context);
};

class Camera : public Sensor, public Stateful {
 public:
  Camera(const std::string& name, const CameraDesc& desc);

  SensorReport report() const override { return eye_.report(); }
  bool draws() const override { return !desc_.paths.by_paths(); }
  void check(const TargetLimits& limits) const override { optics_.check(desc_, limits); }
  HistoryDependence history_dependence() const override;
  SensorNeeds needs() const override { return eye_.needs(); }
  void sense(const SensedWorld& world) override { world_.sense(world, needs()); }
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override {
    eye_.skip_frame(time, world_from_sensor);
  }
  void begin(const FrameTime& time) override { eye_.begin(time); }
  void archive(StateArchive& state) override { eye_.archive(state); }
  bool shows_splats() const override { return eye_.shows_splats(); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override {
    eye_.collect(time, plan, results);
  }
  void cast(RayCaster& of_list) override;
  Measurement measurement() const override;
  std::vector<NumberOnRequest> on_request() const override;
  bool visualization() const override { return desc_.at_once; }
  std::string method() const override { return draws() ? "rasterised" : "path traced"; }

 private:
  EyeDesc desc_;
  EyeOptics optics_;
  EyeWorld world_;
  CameraEye eye_;
  ObjectTable objects_;
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
};

}  // namespace simvis
