// A laser scanner: planar, tilted or with many rings, up to the whole sphere.
//
//   <sensor type="laser_scanner" name="FRONT" insert_at="ROBOT" pose_offset="0.3 0 0.1 0 0 0" samples="361"/>
//
// `nearest` and `planar` cover the field of view with virtual cameras of at most 90 degrees and take ranges from their
// reversed depth: see depth_range.h for how, and for what the error bound says. `raycast` renders nothing and casts
// every beam: see ray_caster.h. `hybrid` renders as `planar` does and casts the beams whose bound is above a share of
// their range or reaches across range_min or range_max; where that share is too small for any rendered range, as it is
// unless a scene says more, it renders nothing. A laser meets matter from either side; what is blended below one half
// or masked out lets it pass; lines and points are not there for it.
#pragma once

#include <string>
#include <vector>

#include "sensors/depth_atlas.h"
#include "sensors/scan_layout.h"
#include "sensors/sensor.h"
#include "sensors/vertex_rounding.h"

namespace simvis {

enum class ScanMethod : std::uint8_t { nearest, planar, hybrid, raycast };

struct LaserScannerDesc {
  ScanPattern pattern;
  double range_min_m = 0.05, range_max_m = 80;  ///< along the ray; a nearer surface blocks the beam and reads 0
  ScanMethod method = ScanMethod::planar;
  double max_error_rel = 1e-6;  ///< hybrid: beams whose bound is above this share of their range are cast
  double resolution_px = 0;     ///< pixels across 90 degrees; 0: kPlanarResolution or kRingsResolution
};

/// Pixels across 90 degrees where a scene does not say: of one ring, and of several (whose faces are areas).
inline constexpr double kPlanarResolution = 4096, kRingsResolution = 1024;

class LaserScanner : public Sensor {
 public:
  LaserScanner(std::string name, const LaserScannerDesc& desc);

  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& rays) override;
  const Scan* scan() const override { return &scan_; }
  void write(OutputSink& sink) const override;
  std::string method() const override;
  std::optional<double> cast_share() const override;

  const ScanLayout& layout() const { return layout_; }

 private:
  void plan_views(const glm::dmat4& sensor_from_world, const DrawList& list, FramePlan& plan);
  void take(std::size_t beam, double range_m, double error_bound_m);
  bool is_good_enough(std::size_t beam) const;

  std::string name_;
  LaserScannerDesc desc_;
  ScanLayout layout_;
  std::vector<AtlasPlace> places_;  // of each face, this frame
  VertexRounding rounding_;         // of this frame's scene
  glm::dmat4 world_from_sensor_{1.0};
  std::vector<glm::dvec3> directions_;  // of all beams, where the method casts any
  std::vector<std::uint32_t> beams_;    // to be cast this frame
  std::vector<glm::dvec3> cast_directions_;
  std::vector<RayHit> hits_;
  Scan scan_;
};

}  // namespace simvis
