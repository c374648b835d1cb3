// The sensor `laser_scanner`: planar, tilted or with many rings, up to the whole sphere.
//
//   <sensor type="laser_scanner" name="FRONT" insert_at="ROBOT" pose_offset="0.3 0 0.1 0 0 0" samples="361"/>
//
// The default method is `raycast`; a scanner with a tolerance (max_error_m, max_error_rel) and no method is `hybrid`.
//   nearest, planar  cover the field of view with virtual cameras of at most 90 degrees and take ranges from their
//                    reversed depth: depth_range.h describes the method and the error bound.
//   raycast  renders nothing and casts every beam: see ray_caster.h.
//   hybrid   renders as `planar` does and casts the beams whose bound is above the tolerance. If the tolerance is too
//            small for any rendered range, as the default tolerance is, it renders nothing.
//   auto     uses the cheapest of `hybrid`, at some resolutions, and `raycast` in this scene and pose: method_survey.h
//            lists the candidates, and method_selector.h says when it chooses. A frame with a survey casts every beam.
// In the scans of `hybrid` and `auto` every beam meets the tolerance; otherwise an error says which tolerance can be
// met. If an effect follows beams (see simvis/scan_effect.h), every beam is cast, with any method, in those frames
// whose scene calls for the effect. So it is in frames with Gaussian splats: beams hit them where half of the light is
// left (engine/splats/splat_caster.h).
//
// Beams stand in an even grid, or as a beam table says (sensors/beam_tables), which is cast. A laser hits surfaces from
// either side; surfaces that are blended with less than half coverage or masked out let it pass; it does not see lines
// and points.
#pragma once

#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <simvis/location.h>
#include <simvis/scan_effect.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "engine/base/program_api.h"
#include "sensors/described_sensor.h"
#include "sensors/laser_scanner/cast_beams.h"
#include "sensors/laser_scanner/method_selector.h"
#include "sensors/laser_scanner/method_survey.h"
#include "sensors/laser_scanner/rendered_scan.h"
#include "sensors/laser_scanner/scan_beams.h"
#include "sensors/laser_scanner/scan_layout.h"
#include "sensors/laser_scanner/scan_tolerance.h"
#include "sensors/laser_scanner/scan_truth.h"
#include "sensors/laser_scanner/scanner_columns.h"
#include "sensors/raster_depth/shape_ranges.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

enum class ScanMethod : std::uint8_t { nearest, planar, hybrid, raycast, automatic };

/// The name in a scene file: "nearest", ..., "auto".
SIMVIS_PROGRAM_API std::string_view to_string(ScanMethod method);

/// The inverse of to_string(); empty if no method has this name.
SIMVIS_PROGRAM_API std::optional<ScanMethod> find_scan_method(std::string_view name);

/// True if the method reads max_error_m and max_error_rel. With any other method a tolerance is an error.
constexpr bool takes_tolerance(ScanMethod method) {
  return method == ScanMethod::hybrid || method == ScanMethod::automatic;
}

/// True if the method needs a ray caster.
constexpr bool casts(ScanMethod method) { return method >= ScanMethod::hybrid; }

struct LaserScannerDesc {
  /// The even grid of a scanner without a beam table; with one, only the numbers of rings and beams are used.
  ScanPattern pattern{.beams = 361, .min_azimuth_rad = -std::numbers::pi / 2, .max_azimuth_rad = std::numbers::pi / 2};
  double range_min_m = 0.05, range_max_m = 80;  ///< along the ray; a nearer surface blocks the beam and reads 0
  ScanMethod method = ScanMethod::raycast;
  double max_error_rel = kDefaultMaxErrorRel;           ///< hybrid, auto: largest bound / range; infinity: no limit
  ScanTruthDesc truth{};                                ///< further channels
  double resolution_px = 0;                             ///< pixels across 90 degrees; 0: default_resolution_px()
  std::optional<double> max_error_m{};                  ///< hybrid, auto: largest bound along the ray
  Location where_max_error_m{}, where_max_error_rel{};  ///< where the attributes stand in the scene, for messages
  std::vector<ChosenScanEffect> effects{};              ///< if one follows beams in every scene, `method` is raycast
  std::shared_ptr<const BeamTable> table{};             ///< the beams; `method` is then raycast. Null: an even grid
  std::uint32_t table_beams = 0;                        ///< beams of a scan of a table that runs on; 0: all of them

  static AttributeRows<LaserScannerDesc> rows();
  /// Throws InputError at an attribute that another attribute does not allow.
  void complete(const SensorContext& context);
};

/// Priced: nearest, planar and hybrid at several resolutions, hybrid also with several tolerances, and raycast; the
/// resolution and tolerance of the command, and the variant that it selects, are included. By method: all but auto, at
/// the resolution of the command; the tolerance of hybrid is one at which it both renders and casts. If an effect of
/// the scanner follows beams, only raycast can measure.
ScanVariants laser_scanner_variants(const SensorContext& context);

/// The first effect set by the scanner's own attributes that follows beams and so requires `raycast`; null if there is
/// none.
SIMVIS_PROGRAM_API const EffectType* beam_following_effect(const LaserScannerDesc& desc);

/// Default pixels across 90 degrees: for one ring, and for several rings, whose faces are areas.
inline constexpr double kPlanarResolution = 4096, kRingsResolution = 1024;
constexpr double default_resolution_px(const ScanPattern& pattern) {
  return pattern.rings == 1 ? kPlanarResolution : kRingsResolution;
}
/// The resolutions that `auto` chooses from. With its margin, a face of the largest resolution fits targets of 8192
/// pixels.
inline constexpr double kPlanarResolutions[] = {512, 1024, 2048, 4096, 8000};
inline constexpr double kRingsResolutions[] = {256, 512, 1024, 2048};

class LaserScanner : public Sensor, public Stateful {
 public:
  LaserScanner(std::string name, const LaserScannerDesc& desc);

  bool draws() const override { return desc_.method != ScanMethod::raycast; }
  /// For `auto` HistoryDependence::measurements: its choice and its surveys depend on the previous frames.
  HistoryDependence history_dependence() const override;
  SensorNeeds needs() const override {
    return {.motion = desc_.truth.radial_speed,
            .item_motion = desc_.truth.looks_back(),
            .points = others(),
            .item_moves = looks_back(),
            .item_ids = desc_.truth.needs_ids()};
  }
  void sense(const SensedWorld& world) override;
  void skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) override;
  void archive(StateArchive& state) override;
  void use_cost_model(const std::function<const CostModel&()>& costs) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& rays) override;
  const Scan* scan() const override { return &scan_; }
  Measurement measurement() const override { return scan_; }
  std::string method() const override { return std::string(to_string(desc_.method)); }
  SensorReport report() const override;

  /// The share of cast beams in the last scan; empty if the method casts none.
  std::optional<double> cast_share() const;

 private:
  bool looks_back() const;
  std::string others() const;
  bool renders() const { return rendered_ != nullptr && survey_ == nullptr && traced_ == nullptr && !hits_splats_; }
  bool may_cast() const { return casts(desc_.method) || hits_splats_; }
  void archive_choice(StateArchive& state);
  void order_beams();
  void select_beams();
  void aim_traced();
  void describe_beams();
  void update_effects(const DrawList& list);
  std::string traced_for() const;
  std::string cast_reason() const;
  const ShapeRanges* cast_shapes(unsigned threads);
  void cast_beams(RayCaster& rays);
  void cast_survey(RayCaster& rays);
  bool casts_every_beam() const;
  void cast_traced(RayCaster& rays);
  void publish(std::span<const Echo> detected = {});

  std::string name_;
  LaserScannerDesc desc_;
  RangeLimits limits_;
  ScanTolerance tolerance_;
  std::unique_ptr<RenderedScan> rendered_;  // null if only surveys render
  std::unique_ptr<MethodSurvey> survey_;    // of this frame; null if it has no survey
  MethodSelector choice_;
  CostModel costs_;
  std::vector<ChosenScanEffect> effects_;  // the effects that this frame's scene calls for
  DrawList::Revisions effects_of_;         // of the list for which effects_ were chosen
  std::unique_ptr<TracedScan> traced_;     // null if none of effects_ follows beams
  bool hits_splats_ = false;               // the list has splats, which no view draws: every beam is cast
  ScanContext context_;                    // of this frame
  const DrawList* list_ = nullptr;         // of this frame
  const SensedWorld* world_ = nullptr;     // of this frame, if it is needed
  std::vector<OtherScanner> others_;       // of this frame
  VertexRounding rounding_;                // of this frame's scene
  ShapeRanges shapes_;                     // of this frame's scene, if beams are rendered
  std::optional<RunningBeams> running_;    // of a beam table that runs on
  ScanBeams beams_;                        // of this frame
  CastBeams cast_;                         // of this frame; empty until the first cast
  std::vector<std::uint32_t> to_cast_;     // the part of cast_.order that is cast in this frame, if one is rendered
  std::vector<glm::dvec3> cast_directions_;
  std::vector<glm::dvec3> shape_directions_;  // of all beams; empty until a scene has shapes
  std::vector<RayHit> hits_;
  std::vector<RayHit> true_hits_;      // in the order of cast_.order; empty unless `truth` needs rays of its own
  bool measures_truth_ = false;        // whether hits_ of this frame are the true ones
  std::vector<BeamReading> readings_;  // of this frame, until all of them are complete
  Scan scan_;
};

}  // namespace simvis
