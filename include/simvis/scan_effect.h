// Effects on the measurement of a laser scanner.
//
// A scan passes through stages, and an effect may take part in any of them:
//
//   aim      rays at their origin: turned, moved, split
//   meet     a ray hits a surface: how much light returns, and which rays continue
//   receive  the echoes of a beam: attenuated, added, dropped;
//            echoes that overlap are merged afterwards, see effects/scanner/returns.h
//   detect   selects the echo that the scanner reports
//   finish   the whole scan: noise, rounding, columns
//
// Without an effect that traces, beams are measured by the scanner's method, and only finish() is called. Otherwise
// every beam is cast by a TracedScan. An effect whose source is in the scene (fog, mirrors) is
// active in the frames whose draw list contains the source: the beams of these frames are cast, whatever the scanner's
// method, and the plan states the reason.
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
#include <simvis/export.h>
#include <simvis/frame_time.h>
#include <simvis/motion_path.h>
#include <simvis/output_spec.h>
#include <simvis/philox.h>
#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/scan.h>
#include <simvis/surface_point.h>

namespace simvis {

/// The pose of a sensor at its previous measurement.
struct PastPose {
  std::int64_t time_ns = 0;           ///< simulated time of that measurement
  glm::dmat4 world_from_sensor{1.0};  ///< rigid
};

/// Where another scanner stands that an effect asks for.
struct OtherScanner {
  std::uint32_t number = 0;            ///< among all that match ScanEffect::others(), those that are off included
  glm::dmat4 world_from_scanner{1.0};  ///< rigid
};

/// The scan that is being taken.
struct ScanContext {
  FrameTime time;                     ///< of the frame
  glm::dmat4 world_from_sensor{1.0};  ///< rigid, at time.time_ns, the end of the sweep
  std::optional<PastPose> before{};   ///< empty at the sensor's first measurement
  /// The path of the sensor since then. Null: it moves on the screw from that pose to `world_from_sensor`. Valid as
  /// long as the draw list.
  const MotionPath* path = nullptr;
  /// What has moved since then. Empty unless an effect uses previous poses. Valid as long as the draw list.
  std::span<const ItemMove> moves{};
  std::uint32_t rings = 0,  ///< of the scan
      beams = 0;            ///< per ring
  double range_max_m = 0;   ///< largest range that is reported
  Medium medium{};          ///< the medium that fills the air
  /// How long before the frame's time each beam fires, in seconds, by the scanner's beam table; empty: it does not say.
  std::span<const double> firing_age_s{};
  /// The scene, from aim() to detect(); null before and after.
  const DrawList* scene = nullptr;
  /// At the insertion points that ScanEffect::others() names. Valid as long as the draw list.
  std::span<const OtherScanner> others{};
};

class ScanEffect;

/// A ray on its path. Frame S: of the sensor at the end of the sweep.
struct BeamRay {
  std::uint32_t beam = 0;         ///< [ring * beams + number in the ring]
  glm::dvec3 origin_m{0};         ///< S
  glm::dvec3 direction{1, 0, 0};  ///< S, unit length
  double share = 1;               ///< share of the beam's energy that it carries
  double half_angle_rad = 0;      ///< of the cone of light that it stands for; 0: it is a line
  double travelled_m = 0;         ///< length of the path before its origin: 0 when it leaves the scanner
  double error_m = 0;             ///< error bound of travelled_m
  double origin_error_m = 0;      ///< error bound of its origin, in any direction
  double error_rad = 0;           ///< error bound of its direction
  double t_min_m = 0;             ///< surfaces at or before this range from its origin are ignored
  double back = 0;                ///< how long before the frame's time it left, as a share of the time since `before`
  std::uint32_t turns = 0;        ///< number of reflections and transmissions since it left the scanner
  /// An effect that asks what this ray meets: the ray carries no light, and only this effect's meet() is called. Null:
  /// a ray of the beam.
  const ScanEffect* asked_by = nullptr;
  std::uint32_t question = 0;  ///< a number for that effect
};

/// The light that returns along a beam from one place.
struct Echo {
  double range_m = std::numeric_limits<double>::infinity();  ///< along the path, one way; +infinity: no echo
  double error_bound_m = 0;                                  ///< of range_m; covers surfaces and paths, not noise
  /// How much farther than range_m a flat surface may be within the cone of light that the ray stands for; 0: it is a
  /// line. +infinity: the cone may miss the surface.
  double within_cone_m = 0;
  /// share x reflectance x cosine / range^2, in 1/m^2: a white matte wall at 1 m at normal incidence gives 1.
  double power = 0;
  std::uint32_t returns = 0;  ///< number of echoes among which it was detected, if a receiver counts them
};

/// One effect of one laser scanner.
///
/// State    the effect's settings, which do not change. A stage may leave something for a later stage of the same scan,
///          in members that are mutable: no scan may depend on an earlier one, because frames can be left out. What is
///          expensive and follows from the settings and the scene alone may be kept from scan to scan.
/// Order    in a scan, aim(); meet() for each hit; receive() and detect(), beam by beam; finish(). Without an effect
///          that traces beams, finish() alone.
/// Threads  calls for one scanner come from one thread at a time. Scanners of several simulations may be used in
///          several threads at once.
class SIMVIS_API ScanEffect {
 public:
  virtual ~ScanEffect() = default;

  /// Whether beams have to be followed one by one.
  virtual bool traces() const { return false; }

  /// Whether it applies only if another effect traces beams.
  virtual bool only_traced() const { return false; }

  /// Whether it needs ScanContext::before and ScanContext::moves.
  virtual bool uses_previous_pose() const { return false; }

  /// The insertion points at which other scanners stand, for ScanContext::others: a pattern of names, with * for any
  /// text and ? for any character; empty: none. A scanner asks the first of its effects that has one.
  virtual std::string others() const { return {}; }

  /// The number of rays into which aim() splits each ray.
  virtual std::uint32_t rays_per_ray() const { return 1; }

  /// Changes the rays at their origin. The first effect gets one ray per beam, those with one origin side by side and
  /// otherwise in order; each later effect gets the
  /// result of the effects before it.
  virtual void aim(const ScanContext&, std::vector<BeamRay>&) const {}

  /// Handles a hit. `echo` is what a matte surface returns; an infinite range means that no echo returns. Rays added to
  /// `onward` are followed too. For a ray that this effect asks with (BeamRay::asked_by), `echo` is lost; a ray that
  /// meets nothing has no hit.
  virtual void meet(const ScanContext&, const BeamRay&, const SurfacePoint&, Echo&,
                    std::vector<BeamRay>& /*onward*/) const {}

  /// Changes the echoes of one beam. `echoes` are sorted by range and must stay sorted; empty: there is no echo.
  virtual void receive(const ScanContext&, std::uint32_t /*beam*/, std::vector<Echo>& /*echoes*/) const {}

  /// The distance below which the receiver cannot separate two echoes; empty: this effect does not decide.
  virtual std::optional<double> pulse_length_m() const { return {}; }

  /// Selects one of the echoes, which are sorted by range, or combines several into one. Returns false if this effect
  /// does not decide.
  virtual bool detect(const ScanContext&, std::uint32_t /*beam*/, std::span<const Echo>, Echo& /*detected*/) const {
    return false;
  }

  /// Changes the whole scan. `detected` has the shape of the scan; it is empty unless beams were traced. A range that
  /// is 0 or infinite must stay so.
  virtual void finish(const ScanContext&, std::span<const Echo> /*detected*/, Scan&) const {}
};

/// The order in which effects are called at each stage. Effects with the same value are called in the order of their
/// names.
enum class ScanOrder : std::uint8_t {
  direction,    ///< errors of beam directions
  pose,         ///< motion of the scanner during the sweep
  spread,       ///< divergence of beams
  path,         ///< mirrors, glass and retro-reflectors
  medium,       ///< fog, rain, dust
  detection,    ///< selection of echoes
  disturbance,  ///< noise and loss of ranges
  rounding      ///< resolution of ranges, and what is computed last
};

/// What an effect's `create` function gets. It is valid during that call only.
struct ScanEffectContext {
  const AttributeValues& attributes;  ///< of the sensor's command
  std::uint32_t rings = 0,            ///< of the scan
      beams = 0;                      ///< per ring
  double range_max_m = 0;             ///< largest range that is reported
  std::uint64_t seed = 0;             ///< of all random numbers of the run
  std::string sensor;                 ///< the sensor's name

  /// The random numbers of one effect of this sensor. They are independent of those of its other effects.
  SensorRandom random(std::string_view effect) const { return {seed, sensor + '/' + std::string(effect)}; }
};

/// Decides whether the scene contains the source of an effect. It may read the items, the materials and the medium of
/// the list, and nothing else.
using CalledFor = bool (*)(const DrawList& list);

/// The description of a scan effect for the catalogue.
struct ScanEffectType {
  EffectType type;                           ///< its `needs` is kCastsBeams
  ScanOrder order = ScanOrder::disturbance;  ///< when it is called
  /// Returns null if the sensor's attributes do not request the effect. May throw InputError, with the
  /// place.
  std::unique_ptr<ScanEffect> (*create)(const ScanEffectContext& context);
  /// For an effect whose source is in the scene: in frames without the source, the scanner measures without the effect.
  /// Null: the attributes alone decide.
  CalledFor called_for = nullptr;
  /// The channels that finish() adds by Scan::add_channel(), in its order. They live as long as the type.
  std::span<const TableColumn> columns{};
};

/// Adds a scan effect to the catalogue, under the rules of EffectRegistration.
struct SIMVIS_API ScanEffectRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  explicit ScanEffectRegistration(const ScanEffectType& type, std::string_view built_for = kHeaderVersion);
};

/// An effect that a scanner has.
struct ChosenScanEffect {
  const EffectType* type = nullptr;          ///< valid as long as the catalogue has the type
  std::shared_ptr<const ScanEffect> effect;  ///< never null in the result of scan_effects()
  CalledFor called_for = nullptr;            ///< as in its type
};

/// The effects that the attributes request, in calling order.
///
/// Errors   those of the types' `create` functions.
SIMVIS_API std::vector<ChosenScanEffect> scan_effects(const ScanEffectContext& context);

/// The outputs for the channels that effects add, in the order of the scan's channels, for every effect of the
/// catalogue; those of effects that the attributes do not request are not `given`.
///
/// Errors   those of the types' `create` functions.
SIMVIS_API std::vector<OutputSpec> scan_effect_outputs(const ScanEffectContext& context);

/// Those of a scanner's effects that apply in frames of this scene: whose source the scene contains, and, if one of
/// them traces beams, those that apply only then.
SIMVIS_API std::vector<ChosenScanEffect> called_for(std::span<const ChosenScanEffect> effects, const DrawList& list);

/// Whether one of the effects traces beams. Every beam is then measured by a TracedScan.
SIMVIS_API bool any_traces(std::span<const ChosenScanEffect> effects);

/// The largest number of reflections and transmissions of a ray; light that continues after that returns nothing.
inline constexpr std::uint32_t kMaxTurns = 16;

class MovedItems;

/// Follows the beams of a scan one by one and calls the stages from aim() to detect() of its effects. The caller then
/// calls finish() with the result. A ray meets the items of ScanContext::moves where they were when it left.
///
/// Lifetime  the effects must outlive it.
/// Threads   one thread at a time.
class SIMVIS_API TracedScan {
 public:
  /// `directions` of the beams are unit vectors in the sensor frame, in the order of Scan::range_m.
  TracedScan(std::vector<glm::dvec3> directions, std::span<const ChosenScanEffect> effects);
  ~TracedScan();

  /// Replaces the beams by as many others. `origins_m` are in the sensor frame; empty: beams start at its origin.
  void set_beams(std::vector<glm::dvec3> directions, std::vector<glm::dvec3> origins_m);

  /// Returns the reported echo of each beam; valid until the next call. The caster's world must be `list`.
  std::span<const Echo> trace(const ScanContext& context, const DrawList& list, RayCaster& caster);

  /// Number of rays of the last trace().
  std::uint64_t rays() const { return rays_cast_; }

 private:
  void place_origins();
  void follow(const ScanContext& context, const DrawList& list, RayCaster& caster);
  void cast(const glm::dmat4& world_from_sensor, RayCaster& caster);
  void cast_moved(const ScanContext& context, const DrawList& list, RayCaster& caster);
  void meet(const ScanContext& context, const DrawList& list, std::size_t ray);
  void detect(const ScanContext& context);

  std::vector<glm::dvec3> directions_, origins_m_;  // origins_m_ is empty if all are 0
  std::span<const ChosenScanEffect> effects_;
  double pulse_length_m_;
  std::vector<BeamRay> rays_, onward_;
  std::vector<glm::dvec3> cast_origins_m_, cast_directions_;  // of rays_
  std::vector<double> cast_t_min_m_;                          // of rays_; empty if all are 0
  std::vector<RayHit> hits_;
  std::unique_ptr<MovedItems> moved_;      // null as long as nothing has moved
  std::vector<std::vector<Echo>> echoes_;  // by beam
  std::vector<Echo> detected_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace simvis
