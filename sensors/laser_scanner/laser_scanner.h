// A laser scanner: planar, tilted or with many rings, up to the whole sphere.
//
//   <sensor type="laser_scanner" name="FRONT" insert_at="ROBOT" pose_offset="0.3 0 0.1 0 0 0" samples="361"/>
//
// `nearest` and `planar` cover the field of view with virtual cameras of at most 90 degrees and take ranges from their
// reversed depth: see depth_range.h for how, and for what the error bound says. `raycast` renders nothing and casts
// every beam: see ray_caster.h. `hybrid` renders as `planar` does and casts the beams whose bound is above the
// tolerance; where that is too small for any rendered range, as it is unless a scene says more, it renders nothing.
// `auto` is whatever of `hybrid`, at some resolutions, and `raycast` costs the least in this scene and pose: see
// method_survey.h for what it chooses from, and method_selector.h for when. A frame in which it surveys casts every
// beam. The scans of `hybrid` and `auto` keep the tolerance with every beam, or there is an error that names what can
// be kept. With an effect that traces (see effects/scan_effect.h) every beam is cast, by any method in those frames
// whose scene calls for the effect. A laser meets matter from either side; what is blended below one half or masked out
// lets it pass; lines and points are not there for it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/location.h>
#include <simvis/scan_effect.h>
#include <simvis/sensor.h>
#include "sensors/laser_scanner/method_selector.h"
#include "sensors/laser_scanner/method_survey.h"
#include "sensors/laser_scanner/rendered_scan.h"
#include "sensors/laser_scanner/scan_layout.h"
#include "sensors/laser_scanner/scan_tolerance.h"
#include "sensors/laser_scanner/traced_scan.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

enum class ScanMethod : std::uint8_t { nearest, planar, hybrid, raycast, automatic };

/// "nearest", ..., "auto".
std::string_view to_string(ScanMethod method);

/// Whether the method needs a ray caster.
constexpr bool casts(ScanMethod method) { return method >= ScanMethod::hybrid; }

struct LaserScannerDesc {
  ScanPattern pattern;
  double range_min_m = 0.05, range_max_m = 80;  ///< along the ray; a nearer surface blocks the beam and reads 0
  ScanMethod method = ScanMethod::planar;
  double max_error_rel = 1e-6;          ///< hybrid, auto: of no bound, as a share of its range; infinity: any
  double resolution_px = 0;             ///< pixels across 90 degrees; 0: see below
  std::optional<double> max_error_m{};  ///< hybrid, auto: of no bound, along the ray
  Location where_max_error_m{}, where_max_error_rel{};  ///< where a scene says so, for messages
  std::vector<ChosenScanEffect> effects{};              ///< if one traces, whatever the scene, `method` is raycast
};

/// Pixels across 90 degrees where a scene does not say: of one ring, and of several (whose faces are areas).
inline constexpr double kPlanarResolution = 4096, kRingsResolution = 1024;
/// Those that `auto` chooses from. A face of the largest fits targets of 8192 pixels with its margin.
inline constexpr double kPlanarResolutions[] = {512, 1024, 2048, 4096, 8000};
inline constexpr double kRingsResolutions[] = {256, 512, 1024, 2048};

class LaserScanner : public Sensor {
 public:
  LaserScanner(std::string name, const LaserScannerDesc& desc);

  /// `auto` at measurements: what it chose, and when it surveys, follows from the frames before.
  HistoryDependence history_dependence() const override;
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void use_cost_model(const std::function<const CostModel&()>& costs) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& rays) override;
  const Scan* scan() const override { return &scan_; }
  void write(OutputSink& sink) const override;
  std::string method() const override { return std::string(to_string(desc_.method)); }
  SensorReport report() const override;

  /// Of the beams of the last scan; empty if the method casts none.
  std::optional<double> cast_share() const;

 private:
  bool renders() const { return rendered_ != nullptr && survey_ == nullptr && traced_ == nullptr; }
  void make_directions();
  std::vector<glm::dvec3> directions_by_beam() const;
  void update_effects(const DrawList& list);
  std::string traced_for() const;
  std::string cast_reason() const;
  void cast_beams(RayCaster& rays);
  void cast_survey(RayCaster& rays);
  void cast_traced(RayCaster& rays);
  void publish(std::span<const Echo> detected = {});

  std::string name_;
  LaserScannerDesc desc_;
  RangeLimits limits_;
  ScanTolerance tolerance_;
  std::unique_ptr<RenderedScan> rendered_;  // null where nothing is, but for surveys
  std::unique_ptr<MethodSurvey> survey_;    // of this frame, if it has one
  MethodSelector choice_;
  CostModel costs_;
  std::vector<ChosenScanEffect> effects_;  // those that this frame's scene calls for
  DrawList::Revisions effects_of_;         // of the list for which they were chosen
  std::unique_ptr<TracedScan> traced_;     // where one of them traces
  ScanContext moment_;                     // of this frame
  const DrawList* list_ = nullptr;         // of this frame
  VertexRounding rounding_;                // of this frame's scene
  std::vector<std::uint32_t> order_;       // in which beams are cast, once any is
  std::vector<glm::dvec3> directions_;     // in that order
  std::vector<std::uint32_t> to_cast_;     // of that order, in this frame, where something is rendered
  std::vector<glm::dvec3> cast_directions_;
  std::vector<RayHit> hits_;
  std::vector<Reading> readings_;  // of this frame, until all of them are there
  Scan scan_;
};

}  // namespace simvis
