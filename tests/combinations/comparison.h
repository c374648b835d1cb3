// Compares every value that the sensors of a scene measured with the test's own geometry and with the stated bounds.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/measurement.h>
#include <simvis/scan.h>
#include "tests/combinations/exact_world.h"

namespace simvis::combined {

/// What the sensors of a scene measured, by frame and sensor.
struct Measured {
  std::array<std::vector<Measurement>, kFrames> frames{};
  std::vector<SceneItem> items{};
};

/// A value that is wrong: by which check, and where.
struct Failure {
  std::string check, text;
};

/// What was checked.
struct Tally {
  std::map<std::string, std::size_t> values;  ///< by check
  std::size_t at_edges = 0;                   ///< values that belong to another surface within the stated distance
  std::size_t narrow = 0;                     ///< of surfaces that are narrower than a bound covers
  std::size_t unbounded = 0;                  ///< without a finite bound
};

/// A number for a message.
std::string text_of(Real value);

/// The values that differ from the test's own geometry.
std::vector<Failure> compare_with_geometry(const CombinedScene& scene, const Measured& measured, Tally& tally);

inline constexpr Real kFloat = 0x1p-24L;  // half a unit in the last place of float32, relative
// Numbers in double that have no stated bound: a hundred roundings of ranges
// and poses.
inline constexpr Real kDoubles = 128 * 0x1p-53L;
inline constexpr Real kInfinite = std::numeric_limits<Real>::infinity();
inline constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();

/// Which surfaces a sensor sees.
enum class Seen : std::uint8_t { half, any, opaque };

/// The first surface along a ray beyond a range.
ExactHit first_of(const CombinedScene& scene, const std::vector<ExactHit>& hits, Seen seen, Real behind_m);

/// Where splats have stopped half of the light of a ray.
struct HalfOfSplats {
  ExactHit hit{};            ///< without a body: they leave more
  bool is_doubtful = false;  ///< rounding decides
};
/// `splats` are all along the ray, the nearest first; those between the two ranges count.
HalfOfSplats half_of(const std::vector<SplatHit>& splats, Real near_m, Real end_m);

inline bool same_surface(const ExactHit& a, const ExactHit& b) { return a.body == b.body && a.face == b.face; }

/// Calls visit(dx, dy) for the directions around one that are so far from it, as shares of a pixel or radians: rings
/// of 16.
template <class Visit>
void around(Real reach, const Visit& visit) {
  for (const Real share : {Real(0.25), Real(0.5), Real(0.75), Real(1)}) {
    for (int i = 0; i < 16; ++i) {
      const Real angle = i * std::numbers::pi_v<Real> / 8;
      visit(share * reach * std::cos(angle), share * reach * std::sin(angle));
    }
  }
}

/// One sensor in one frame, and what its values are compared with.
struct Comparison {
  const CombinedScene& scene;
  const Measured& measured;
  const ExactWorld& world;
  std::size_t frame = 0, sensor = 0;
  Tally& tally;
  std::vector<Failure>& failures;

  const SensorDesc& desc() const { return scene.sensors[sensor]; }
  const Measurement& measurement() const { return measured.frames[frame][sensor]; }
  const Body& body(const ExactHit& hit) const { return scene.bodies[static_cast<std::size_t>(hit.body)]; }

  void count(const std::string& check) const { ++tally.values[check]; }
  Failure failure(const std::string& check, const std::string& place, const std::string& text) const;
  void fail(const std::string& check, const std::string& place, Real value, Real expected, Real allowed) const;

  /// The share of the way from the frame before at this age.
  Real share_of_age(Real age_s) const { return frame == 0 ? Real(1) : 1 - age_s * Real(kRate_hz); }

  /// Ids are those of the item with the body's part: "instance", "shape" or "semantic".
  Real id(const std::string& kind, int body) const;

  /// The rounding of a range, from that of poses and that of the point on a slanted surface.
  Real rounding_m(const ExactHit& hit) const;
  /// A normal is wrong by the way of the point over the radius of the surface, and by rounding.
  Real normal_rounding(const ExactHit& hit, Real point_m) const;
};

void compare_beams(const Comparison& comparison);
void compare_pixels(const Comparison& comparison);
void compare_keypoints(const Comparison& comparison);
void compare_motion(const Comparison& comparison);

}  // namespace simvis::combined
