// The sensor `event_camera`: an event for each change of light in a pixel, with the time of its crossing.
//
//   <sensor type="event_camera" name="EVENTS" insert_at="ROBOT" threshold_on="0.2" threshold_off="0.2"/>
//
// Frames   The camera looks along +x of its sensor frame; image x points to the right, y down. Pixels are square, and
//          the optical axis goes through the middle of the image.
// Optics   The light of a pixel is the mean luminance over its square, see pixel_light.h and surface_light.h, at any
//          time between the last measurement and this one; the camera and objects move in between as screws of constant
//          speed. It is followed in pixels in which something moves, at times between which no surface moves by more
//          than `step` pixels, and at more where the light is not linear, see light_curve.h. Other pixels cost nothing.
//          Whatever changes otherwise (what appears, changes its shape or material; lights) changes at the time of the
//          last measurement, and then all pixels are looked at.
// Sensor   See event_pixels.h. The first measurement sets the references and has no events.
// Values   a table with a row for each event since the last measurement, by time, row and column: time_s, t_us (whole
//          microseconds of the simulated time, rounded down), x and y from the corner of the image, polarity (1:
//          brighter, 0: darker). With latencies an event belongs to the measurement in whose time it is sent.
// Picture  grey; red where the last event in the measurement is positive, blue where it is negative.
// Lens     The square of a pixel is that of the lens to first order, see PixelSquare.
// Limits   one point of view, no motion blur in the light itself (pixels have no exposure time).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <simvis/philox.h>
#include <simvis/reading_sensor.h>
#include <simvis/state_archive.h>
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_optics.h"
#include "sensors/described_sensor.h"
#include "sensors/event_camera/event_pixels.h"
#include "sensors/event_camera/pixel_light.h"
#include "sensors/event_camera/scene_over_time.h"

namespace simvis {

struct EventCameraDesc {
  PinholeDesc pinhole{.width_px = 346, .height_px = 260};
  double step_px = 0.25;       ///< above 0
  double time_error_s = 5e-7;  ///< above 0
  EventModelDesc model{};
  bool picture = false;
  std::vector<ChosenCameraEffect> effects{};  ///< of the lens
  std::uint64_t seed = 0;

  static AttributeRows<EventCameraDesc> rows();
  void complete(const SensorContext& context);
};

class EventCamera : public ReadingSensor, public Stateful {
 public:
  EventCamera(std::string name, const EventCameraDesc& desc);

  HistoryDependence history_dependence() const override { return HistoryDependence::measurements; }
  SensorNeeds needs() const override { return {.item_moves = true, .moves_in_one_piece = true}; }
  void sense(const SensedWorld& world) override {
    moves_ = world.item_moves();
    path_ = &world.sensor_path();
  }
  void archive(StateArchive& state) override;
  void begin(const FrameTime& time) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime&, const FramePlan&, std::span<const PassResult>) override {}
  void cast(RayCaster& threads) override;
  Measurement measurement() const override;
  std::string method() const override { return "exact areas"; }
  SensorReport report() const override;

 private:
  /// What a measurement leaves for the next one.
  struct Memory {
    std::int64_t time_ns = 0;
    std::shared_ptr<const DrawList> tables{};  // of its list, without places; null: restored, see tables_hash
    std::uint64_t tables_hash = 0;             // of the content of the tables, if there are none
    std::vector<glm::dmat4> world_from_node{};
    std::vector<double> light{};  // by pixel; empty before the first measurement
    EventPixels pixels;
    std::vector<PixelEvent> delayed{};  // not sent yet
  };
  bool is_first() const { return memory_.light.empty(); }
  void archive(StateArchive& state, Memory& memory) const;
  static void forget(Memory& memory);
  bool has_same_tables(const DrawList& list) const;
  bool has_changed_otherwise(const DrawList& list) const;
  /// What a thread needs to follow pixels.
  struct Worker {
    PixelWork light;
    std::vector<LightKnot> knots;
  };
  void begin_light(RayCaster& threads);
  std::vector<PixelEvent> follow_all(RayCaster& threads);
  void follow(std::uint32_t pixel, Worker& worker, std::vector<PixelEvent>& events);
  void publish(std::vector<PixelEvent> events);
  void draw(const std::vector<PixelEvent>& events);

  std::string name_;
  EventCameraDesc desc_;
  PixelOptics optics_;
  PixelLight light_;
  SceneOverTime scene_;
  Memory memory_, before_;
  FrameTime time_;
  std::span<const ItemMove> moves_;
  const MotionPath* path_ = nullptr;  // of the camera
  const DrawList* list_ = nullptr;    // of this frame
  bool all_pixels_ = false;           // of this frame
  std::uint64_t pixels_sampled_ = 0, samples_ = 0;
  std::vector<Worker> workers_;
  Image picture_;
};

}  // namespace simvis
