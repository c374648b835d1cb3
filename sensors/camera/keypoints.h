// The sensor `keypoints`: where named points of the scene are in the picture of a camera, and whether it sees them.
//
//   <sensor type="keypoints" name="SEATS" insert_at="ROBOT" points="CHAIR_?/seat" width="640" height="480" hfov="60"/>
//
// Points   are the insertion points whose names match the pattern `points`, in which * stands for any text and ? for
//          any character. One that is switched off has no row.
// Camera   The sensor stands where the camera stands, and has its width, height, hfov, near, lens and shutter: nothing
//          but these decides where a point is. It draws nothing.
// Values   a table with a row for each point, in the order of their names: point, its number; x_px and y_px, from the
//          picture's corner, x to the right, y down, also beyond its edges; NaN where the image plane has no such
//          place, as behind a pinhole; in_picture and visible, 0 or 1; distance_m from the camera; x_m, y_m, z_m, the
//          point in the sensor frame (x forward, y left, z up). The number is the point's place by name among all that
//          match the pattern, from 0 on; the report has the names of the points of the last table.
// Visible  is a point in the picture, not nearer than `near`, if a ray of the camera meets no surface before it.
//          Surfaces at most `radius` nearer than the point belong to it and hide nothing.
// Shutter  With row_time, a point is where it is when the rows are exposed at whose height it then is. Between two
//          measurements a point goes along a screw, as objects do. A point that passes between two rows, so that no row
//          meets it, is not in the picture.
// Message  sensor_msgs/PointCloud2.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/reading_sensor.h>
#include <simvis/state_archive.h>
#include "engine/base/program_api.h"
#include "sensors/camera/camera_moment.h"
#include "sensors/camera/camera_views.h"
#include "sensors/camera/moved_world.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/surface_rays.h"
#include "sensors/described_sensor.h"

namespace simvis {

struct KeypointsDesc {
  std::string points = "*";
  PinholeDesc pinhole{};
  double radius_m = 0.01;
  std::vector<ChosenCameraEffect> effects{};

  static AttributeRows<KeypointsDesc> rows();
  void complete(const SensorContext& context);
};

/// The names of points by their numbers, from the report of the sensor.
SIMVIS_PROGRAM_API std::map<std::uint32_t, std::string> keypoint_names(const SensorReport& report);

class Keypoints : public ReadingSensor, public Stateful {
 public:
  /// Throws InputError if the lens does not say where it shows a direction.
  Keypoints(std::string name, const KeypointsDesc& desc);

  SensorNeeds needs() const override { return {.points = desc_.points, .item_moves = is_late()}; }
  void begin(const FrameTime& time) override;
  void archive(StateArchive& state) override {
    state(before_ns_, last_ns_);
    for (const std::optional<std::int64_t>& each : {before_ns_, last_ns_}) {
      if (each) state.require_past(*each);
    }
    state.require(!before_ns_ || (last_ns_ && *before_ns_ <= *last_ns_));
  }
  void sense(const SensedWorld& world) override;
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime&, const FramePlan&, std::span<const PassResult>) override {}
  void cast(RayCaster& caster) override;
  Measurement measurement() const override;
  std::string method() const override { return "raycast"; }
  SensorReport report() const override;

 private:
  struct Row {
    std::optional<glm::dvec2> pixel;
    bool in_picture = false, visible = false;
    glm::dvec3 place_m{0};  // view frame of the camera
  };
  // A ray to a point.
  struct Sight {
    std::size_t point = 0, rows = 0;  // indices: of points_, of the rows of the moment
    glm::dvec3 direction{0};          // unit length, view frame of the camera
    double near_range_m = 0, range_m = 0;
  };
  bool is_late() const { return layout_.row_time_s > 0; }
  CameraMoment moment() const;
  Row find(const SensedPoint& point, const CameraMoment& moment, std::size_t& rows) const;
  std::optional<Sight> sight_of(const Row& row) const;
  void look(RayCaster& caster, const CameraMoment& moment, std::vector<Sight>& sights, std::vector<Row>& table);

  std::string name_;
  KeypointsDesc desc_;
  CameraLayout layout_;
  CameraViews views_;
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
  FrameTime time_;
  std::vector<SensedPoint> points_;                  // of this frame
  std::span<const ItemMove> moves_;                  // of this frame, with a rolling shutter
  const MotionPath* path_ = nullptr;                 // of the camera in this frame, the same
  const DrawList* list_ = nullptr;                   // of this frame
  std::optional<std::int64_t> before_ns_, last_ns_;  // the measurement before time_, and the last one
  MovedWorld moved_;
  SurfaceRays rays_;
};

}  // namespace simvis
