// The sensor `rgbd_camera`: depth by triangulation between two viewpoints, and colour.
//
//   <sensor type="rgbd_camera" name="DEPTH" insert_at="ROBOT" preset="realsense_d435"/>
//
// Frames   The sensor frame is that of the first viewpoint, an imager: it looks along +x; image x points to the
//          right, y down. The second viewpoint, another imager or a projector, stands `baseline` to its right, at
//          (0, -baseline, 0), and looks in the same direction. All images are those of the first viewpoint.
// Depth    Along the optical axis, of the surface at the centre of the pixel, cast exactly as that of a camera. A pixel
//          has a depth only if the second viewpoint sees the same point: nothing stands on the straight line between
//          them, whichever side of a surface it shows, and the point lies in the image of the second viewpoint. Of two
//          equal imagers the first therefore has no depth in a band at its left edge, which is f baseline / Z pixels
//          wide, and beside the left edge of an object at Z1 before a wall at Z2 in a shadow of
//          f baseline (1 / Z1 - 1 / Z2) pixels, with the focal length f in pixels. Objects nearer than `near` hide
//          nothing from either viewpoint.
// Errors   What is measured is the disparity d = f baseline / Z, with Gaussian noise of the standard deviation
//          `disparity_noise` and rounded to multiples of `disparity_step`; depth is f baseline / d again. For small
//          noise s the standard deviation of a depth is therefore Z^2 s / (f baseline). With neither, the depths are
//          the floats that a camera with normals gives.
// State    0: measured; 1: nothing is seen; 2: hidden from the second viewpoint; 3: outside its image; 4: beyond
//          depth_min or depth_max, or with a disparity that is not above 0. Where it is not 0, depth is +infinity.
// Splats   The surface of a pixel, from either viewpoint, is the splat behind which at most half of the light is left,
//          if it comes before what the ray hits (engine/splats/splat_rays.h). Where the surface of a pixel, or what the
//          second viewpoint sees in the direction of that surface, is a splat, the pixel is hidden if their disparities
//          differ by more than a pixel: two viewpoints see the half of a soft cloud at slightly different places.
//          Splats send their own light: a projected pattern is taken to be seen on them as on any surface.
// Effects  Those of the image sensor affect colour alone.
// Lens     That of the first viewpoint is also that of the second one, unless it has a field of view of its own, which
//          is that of a pinhole. Images are not rectified. Disparities are those of the rectified pair, whose pinhole
//          is that of the calibration, so that only surfaces in front of the viewpoints are measured.
// Values   value("depth_error_bound_m") bounds the errors of all depths before noise and rounding; +infinity with
//          depths of splats.
// Limits   The matching of images is not simulated: no windows, no texture, no interference of projectors. Surfaces
//          whose distance is below a millionth of that from the second viewpoint do not hide each other.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/philox.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "sensors/camera/camera_eye.h"
#include "sensors/camera/camera_splats.h"
#include "sensors/camera/pixel_optics.h"
#include "sensors/described_sensor.h"

namespace simvis {

struct RgbdCameraDesc {
  PinholeDesc pinhole{};
  std::optional<double> second_hfov_rad{};               ///< of the second viewpoint; empty: as pinhole.hfov_rad
  double baseline_m = 0.05;                              ///< above 0
  double disparity_noise_px = 0, disparity_step_px = 0;  ///< at least 0; 0: none
  double depth_min_m = 0;
  double depth_max_m = std::numeric_limits<double>::infinity();
  bool color = true, depth = true, state = false;
  ColorSampling sampling{};
  std::vector<ChosenCameraEffect> effects{};
  std::uint64_t seed = 0;

  static AttributeRows<RgbdCameraDesc> rows();
  void complete(const SensorContext& context);
};

class RgbdCamera : public Sensor, public Stateful {
 public:
  RgbdCamera(std::string name, const RgbdCameraDesc& desc);

  void check(const TargetLimits& limits) const override { optics_.check(eye_desc_, limits); }
  HistoryDependence history_dependence() const override { return eye_.history_dependence(); }
  void begin(const FrameTime& time) override { eye_.begin(time); }
  void archive(StateArchive& state) override { eye_.archive(state); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& caster) override;
  Measurement measurement() const override;
  std::vector<NumberOnRequest> on_request() const override;
  std::string method() const override { return "raycast"; }
  bool shows_splats() const override { return eye_.shows_splats(); }

 private:
  enum class State : std::uint8_t { measured, nothing, hidden, outside, beyond };

  /// Rays of the second viewpoint to the surfaces of pixels, which its image has. All but `pixels` by ray.
  struct Sights {
    std::vector<std::uint32_t> pixels;        // ascending
    std::vector<glm::dvec3> directions;       // view frame, unit length
    std::vector<double> distances_m, near_m;  // to the surfaces; where `near` is along the rays
    std::vector<RayHit> hits;
  };

  bool casts() const { return desc_.depth || desc_.state; }
  glm::dvec3 second_m() const { return {desc_.baseline_m, 0, 0}; }  // view frame
  void plan_casts(const DrawList& list, FramePlan& plan);
  void cast_first(RayCaster& caster, const PixelRows& rows);
  void cast_second(RayCaster& caster, const glm::dmat4& world_from_view);
  Sights second_sights();
  void stop_at_splats(const glm::dmat4& world_from_second, unsigned threads, Sights& sights) const;
  bool is_hidden(const Sights& sights, std::size_t ray) const;
  bool in_second_image(const glm::dvec3& point_m) const;
  double disparity_times_depth() const { return optics_.layout.pinhole.fx_px * desc_.baseline_m; }
  double measured_depth(std::size_t pixel) const;
  void measure();

  std::string name_;
  RgbdCameraDesc desc_;
  EyeDesc eye_desc_;  // of colour
  EyeOptics optics_;
  EyeWorld world_;
  CameraEye eye_;
  PixelRays rays_;
  std::optional<CameraSplats> splats_;  // of depth from the first viewpoint; made when first needed
  bool looks_at_splats_ = false;        // in this frame, for depth
  Pinhole second_;                      // of the second viewpoint, unless it has the lens of the first
  SensorRandom random_;
  std::vector<SeenSurface> seen_;   // by pixel
  std::vector<State> states_;       // by pixel
  SensorMoment moment_, measured_;  // of this frame, of the last measurement
  Image depth_;
  SharedArray<std::uint8_t> state_;
  double bound_m_ = std::numeric_limits<double>::quiet_NaN();
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
};

}  // namespace simvis
