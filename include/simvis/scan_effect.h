// Effects on what a laser scanner measures.
//
// A scan goes through stages, and an effect takes part in any of them:
//
//   aim      rays as they leave: turned, moved, split
//   meet     what a ray meets: how much comes back, and which rays go onward
//   receive  the echoes of a beam: weakened, added, dropped
//            then those that overlap become one, see effects/returns.h
//   detect   which of them the scanner reports
//   finish   the scan as a whole: noise, rounding, columns
//
// Without an effect that traces, beams are measured by the scanner's method, and only finish() is called. Otherwise
// every beam is cast, see sensors/traced_scan.h. An effect whose source is in the scene (fog, mirrors) takes part in
// the frames whose draw list has it: whatever the scanner's method, its beams are then cast, and the plan says why.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/effect.h>
#include <simvis/frame_time.h>
#include <simvis/philox.h>
#include <simvis/scan.h>
#include <simvis/surface_point.h>

namespace simvis {

/// Where a sensor stood when it measured before.
struct PastPose {
  std::int64_t time_ns = 0;
  glm::dmat4 world_from_sensor{1.0};
};

/// The scan that is being taken.
struct ScanContext {
  FrameTime time;
  glm::dmat4 world_from_sensor{1.0};  ///< rigid, at time.time_ns, the end of the sweep
  std::optional<PastPose> before{};   ///< empty at the sensor's first measurement
  std::uint32_t rings = 0, columns = 0;
  double range_max_m = 0;
  Medium medium{};  ///< what fills the air
};

/// A ray on its way. Frame S: of the sensor at the end of the sweep.
struct BeamRay {
  std::uint32_t beam = 0;         ///< [ring * columns + column]
  glm::dvec3 origin_m{0};         ///< S
  glm::dvec3 direction{1, 0, 0};  ///< S, unit length
  double share = 1;               ///< of the beam's energy that it carries
  double travelled_m = 0;         ///< before its origin: 0 as it leaves the scanner
  double error_m = 0;             ///< by how much that may be off
  double origin_error_m = 0;      ///< by how much its origin may be off, across the way too
  double error_rad = 0;           ///< by how much its direction may be off
  double t_min_m = 0;             ///< what it meets at or before this range from its origin it passes
  std::uint32_t turns = 0;        ///< how often it was turned or let through since it left
};

/// What comes back along a beam from one place.
struct Echo {
  double range_m = std::numeric_limits<double>::infinity();  ///< along the path, one way; +infinity: nothing
  double error_bound_m = 0;                                  ///< of range_m, of surfaces and paths without noise
  double power = 0;  ///< share x reflectance x cosine / range^2, in 1/m^2: a white matte wall at 1 m, square on, is 1
  std::uint32_t returns = 0;  ///< among how many it was detected, where a receiver counts them
};

class ScanEffect {
 public:
  virtual ~ScanEffect() = default;

  /// Whether beams have to be followed one by one.
  virtual bool traces() const { return false; }

  /// Whether it has a say only where another effect has beams followed.
  virtual bool only_traced() const { return false; }

  /// Whether it asks for ScanContext::before.
  virtual bool uses_previous_pose() const { return false; }

  /// Into how many rays aim() splits each.
  virtual std::uint32_t rays_per_ray() const { return 1; }

  /// `rays` come with one ray per beam, in order; later effects get what earlier ones made of them.
  virtual void aim(const ScanContext&, std::vector<BeamRay>&) const {}

  /// `echo` is what a matte surface returns; with an infinite range none comes back. Rays added to `onward` are
  /// followed as well.
  virtual void meet(const ScanContext&, const BeamRay&, const SurfacePoint&, Echo&,
                    std::vector<BeamRay>& /*onward*/) const {}

  /// `echoes` of one beam by range, as they have to stay; without an echo: empty.
  virtual void receive(const ScanContext&, std::uint32_t /*beam*/, std::vector<Echo>& /*echoes*/) const {}

  /// How far apart echoes have to be for the receiver to tell them apart; empty: leaves that to others.
  virtual std::optional<double> pulse_length_m() const { return {}; }

  /// Takes one of the echoes, by range, or makes one of several; false: leaves that to others.
  virtual bool detect(const ScanContext&, std::uint32_t /*beam*/, std::span<const Echo>, Echo& /*detected*/) const {
    return false;
  }

  /// `detected` by beam as the scan; empty unless beams were traced. A range that is 0 or infinite stays so.
  virtual void finish(const ScanContext&, std::span<const Echo> /*detected*/, Scan&) const {}
};

/// In which order effects are called at each stage; those of one place by their names.
enum class ScanOrder : std::uint8_t { direction, pose, spread, path, medium, detection, disturbance, rounding };

/// What an effect is made of.
struct ScanEffectContext {
  const AttributeValues& attributes;
  std::uint32_t rings = 0, columns = 0;
  std::uint64_t seed = 0;
  std::string sensor;

  /// The numbers of one effect of this sensor, unrelated to those of its others.
  SensorRandom random(std::string_view effect) const { return {seed, sensor + '/' + std::string(effect)}; }
};

/// Whether the scene calls for an effect. Of the list it looks at items, materials and the medium alone.
using CalledFor = bool (*)(const DrawList& list);

struct ScanEffectType {
  EffectType type;  ///< its `sensors` are "laser_scanner"
  ScanOrder order = ScanOrder::disturbance;
  /// Null where the sensor's attributes do not call for it.
  std::unique_ptr<ScanEffect> (*create)(const ScanEffectContext& context);
  /// Where its source is in the scene: in frames in which that is not there, the scanner measures as without it. Null:
  /// the attributes decide alone.
  CalledFor called_for = nullptr;
};

/// As EffectRegistration.
struct ScanEffectRegistration {
  explicit ScanEffectRegistration(const ScanEffectType& type);
};

/// An effect that a scanner has.
struct ChosenScanEffect {
  const EffectType* type = nullptr;
  std::shared_ptr<const ScanEffect> effect;
  CalledFor called_for = nullptr;  ///< as in its type
};

/// What the attributes call for, in the order in which they are called.
std::vector<ChosenScanEffect> scan_effects(const ScanEffectContext& context);

}  // namespace simvis
