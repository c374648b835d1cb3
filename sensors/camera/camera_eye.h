// One eye of a camera: what is drawn and cast for one image, and what is measured in it. A camera has one, a stereo
// camera two.
//
// Frames   C = frame of the eye: it looks along +x; V = its view frame: x right, y down, z forward.
// Order    begin(), begin_plan(), draw() for each drawing, finish_plan(), collect(), cast(), add_to().
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "sensors/camera/camera_splats.h"
#include "sensors/camera/depth_error_bound.h"
#include "sensors/camera/eye_optics.h"
#include "sensors/camera/object_table.h"
#include "sensors/camera/open_pixels.h"
#include "sensors/camera/pixel_truth.h"

namespace simvis {

/// The world that the eyes of one camera see in a frame.
struct EyeWorld {
  explicit EyeWorld(const TruthDesc& truth) : layers(truth.layer), scenes(truth.layer) {}

  /// `needs` are those of the camera.
  void sense(const SensedWorld& world, const SensorNeeds& needs);
  void begin(const DrawList& of_frame);
  IdentifiedList identified() const { return {*list, ids, objects}; }

  LayerWorld layers;
  SceneKeeper scenes;
  std::span<const ItemMove> moves{};              ///< if rows or samples are taken before the frame's time
  const MotionPath* path = nullptr;               ///< of the camera, the same; null: it moves on one screw
  ItemIds ids{};                                  ///< if any are needed
  std::span<const SceneObject> objects{};         ///< if they are needed
  std::shared_ptr<const KeptScene> kept_scene{};  ///< for flow
  const DrawList* drawn = nullptr;                ///< the list of the frame
  const DrawList* list = nullptr;                 ///< the same as rays see it
};

class CameraEye {
 public:
  /// `optics` and `world` must live as long as the eye.
  CameraEye(EyeDesc desc, EyeOptics& optics, const EyeWorld& world);

  HistoryDependence history_dependence() const;
  SensorNeeds needs() const;
  void begin(const FrameTime& time);
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_camera);
  /// As that of Stateful. `beside` is another eye of the same camera, which the state has before; null: there is none.
  void archive(StateArchive& state, const CameraEye* beside = nullptr);

  /// Views of one kind in the plan of a frame: they fill a pass for each of CameraViews::pass_size_px.
  struct Drawing {
    bool color = false, depth = false;
    std::string what{};          ///< is drawn, for people
    const char* why = "";        ///< it is a drawing of its own
    ColorSample sample{};        ///< of colour
    std::size_t first_pass = 0,  ///< in the plan, as soon as it is drawn
        first_view = 0;          ///< in the pass, the same
  };
  /// Decides what is drawn. The list of the frame is that of `world`.
  void begin_plan(const glm::dmat4& world_from_camera);
  const std::vector<Drawing>& drawings() const { return drawings_; }
  /// Adds the views of a drawing to the plan. `beside` is one of another eye with the same sizes and kind: the views
  /// stand to the right of its views if both fit into one pass.
  void draw(std::size_t drawing, FramePlan& plan, const Drawing* beside = nullptr);
  /// Adds the rays.
  void finish_plan(FramePlan& plan);

  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results);
  /// What the last image by paths of light has reached.
  SensorReport report() const { return paths_ ? paths_->report() : SensorReport(); }
  /// Takes colour by paths of light. `caster`'s world is the list of the frame. Errors as PathImage::begin().
  void trace(RayCaster& caster);
  /// `caster`'s world is EyeWorld::list.
  void cast(RayCaster& caster);
  /// Whether the last image shows splats; after cast().
  bool shows_splats() const { return looks_at_splats_ && splats_->in_color(); }
  /// Adds the rows of the table of objects, on so many threads; after cast().
  void add_objects(ObjectTable& objects, std::size_t view, unsigned threads) const;
  /// Adds all images but disparity and silhouettes.
  void add_to(Measurement& measurement) const;
  const Image& disparity() const { return disparity_; }
  /// Bounds the errors of all depths of the last image, whenever it is called.
  std::function<double()> depth_bound() const;

  std::int64_t measured_ns() const { return measured_.time_ns; }
  /// The frame of the eye at the time of the last image.
  const glm::dmat4& measured_from() const { return measured_.world_from_camera; }

 private:
  struct Past {
    std::int64_t time_ns = 0;
    glm::dmat4 world_from_camera{1.0};
    void archive(StateArchive& state) {
      state(time_ns);
      state.finite(world_from_camera);
      state.require_past(time_ns);
    }
  };
  /// A drawing's passes and their results.
  struct Drawn {
    std::span<const Pass> passes;
    std::span<const PassResult> results;
    std::size_t first_view;

    const View& view(std::size_t i) const { return passes[0].views[first_view + i]; }  // of a direct image
  };
  bool is_late() const;
  bool moves() const;
  double share_before(double time_s) const;
  glm::dmat4 world_from_camera(double time_s) const;
  std::vector<ItemPlace> places(double time_s) const;
  CameraMoment moment() const;
  std::vector<PixelRows> all_rows(std::vector<std::vector<ItemPlace>>& moved, double time_s = 0) const;
  void choose_samples();
  void choose_drawings();
  View view_of(const CameraView& seen, const Drawing& drawing) const;
  void plan_rays(FramePlan& plan) const;
  Drawn drawn(const Drawing& drawing, const FramePlan& plan, std::span<const PassResult> results) const;
  void collect_color(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results);
  void collect_depth(const Drawn& drawn);
  void read_color_of(const Drawn& drawn);
  void read_truth(const Drawn& drawn);
  std::vector<double> depth_bounds(std::size_t view) const;
  void read_disparity(const Drawn& drawn);
  void cast_open_pixels(RayCaster& caster);
  void cast_pixels(RayCaster& caster);
  void set_disparity(std::size_t pixel, double depth_m);
  void keep_drawn_depth();
  void add_splats(unsigned threads);
  bool may_show_splats() const {
    return !paths_ && (desc_.color || desc_.depth || desc_.disparity() || desc_.truth.of_surfaces());
  }
  bool reads_depth() const {
    return desc_.depth || looks_at_splats_ || (desc_.disparity() && optics_.resamples() && !optics_.rays);
  }
  bool draws_depth() const { return !optics_.rays && (reads_depth() || desc_.disparity() || desc_.truth.any()); }
  bool draws_items() const {
    return !optics_.rays && (desc_.truth.needs_items() || desc_.truth.needs_bounds() || shows_round_);
  }
  double disparity_times_depth() const { return optics_.layout.pinhole.fx_px * desc_.baseline_m; }

  EyeDesc desc_;
  EyeOptics& optics_;
  const EyeWorld& world_;
  FrameTime time_;                              // of the planned frame, or of the last measurement
  glm::dmat4 world_from_camera_{1.0};           // at time_
  std::optional<Past> before_, last_;           // the measurement before time_, and the last measurement
  std::vector<Drawing> drawings_;               // of this frame: samples of colour, or colour, then depth
  std::span<const ColorSample> taken_samples_;  // of this frame
  ColorMean mean_;
  Image color_, depth_, disparity_;
  Image drawn_depth_;                      // depth_ before rays and splats have changed it; empty: they have not
  std::vector<DepthView> depth_views_;     // one for each view of this frame
  std::vector<DepthView> measured_views_;  // of the depth that was drawn
  std::optional<double> whole_bound_m_;    // of the depth of a resampled or cast image
  Past measured_;                          // when and where the images were taken
  PixelTruth truth_;
  std::optional<PixelLayers> layers_;   // empty if none are asked for
  std::optional<PixelFlow> flow_;       // empty if none is asked for
  std::optional<OpenPixels> open_;      // empty unless pixels of the image are drawn with a depth
  bool shows_round_ = false;            // in this frame: pixels of round shapes are cast
  bool looks_at_splats_ = false;        // in this frame
  std::optional<CameraSplats> splats_;  // made when first needed
  std::optional<PathImage> paths_;      // empty if colour is drawn
};

}  // namespace simvis
