// Beams traced through a draw list, and what the tests need to know about them.
#pragma once

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <utility>
#include <vector>

#include <simvis/scan_effect.h>
#include "tests/support/ray_casting.h"
#include "tests/support/tested_build.h"

namespace simvis {

/// Rays are about twenty times slower under sanitizers.
inline const std::size_t kFewer = sanitized() ? 20 : 1;

/// Reads what passes: the rays as they leave, and the echoes of each beam before any of them merge.
struct Probe : ScanEffect {
  mutable std::vector<BeamRay> rays;
  mutable std::vector<std::vector<Echo>> echoes;

  void aim(const ScanContext&, std::vector<BeamRay>& all) const override { rays = all; }
  void receive(const ScanContext&, std::uint32_t beam, std::vector<Echo>& all) const override {
    if (beam == 0) echoes.clear();
    echoes.push_back(all);
  }
};

using EffectList = std::vector<std::shared_ptr<const ScanEffect>>;

inline std::vector<ChosenScanEffect> chosen(const EffectList& effects) {
  std::vector<ChosenScanEffect> all;
  for (const auto& effect : effects) all.push_back({nullptr, effect});
  return all;
}

/// A moment of a scanner with one ring, which stands at the world's origin.
inline ScanContext moment_of(std::size_t beams) {
  ScanContext moment;
  moment.rings = 1;
  moment.beams = static_cast<std::uint32_t>(beams);
  moment.range_max_m = 1000;
  return moment;
}

inline std::vector<Echo> trace(const DrawList& list, const std::vector<glm::dvec3>& directions,
                               const EffectList& effects, const ScanContext& moment, RayCaster& caster) {
  const std::vector<ChosenScanEffect> all = chosen(effects);
  TracedScan scan(directions, all);
  caster.set_world(list);
  const std::span<const Echo> detected = scan.trace(moment, list, caster);
  return {detected.begin(), detected.end()};
}

inline std::vector<Echo> trace(const DrawList& list, const std::vector<glm::dvec3>& directions,
                               const EffectList& effects) {
  const std::shared_ptr<RayCaster> caster = make_host_ray_caster();
  return trace(list, directions, effects, moment_of(directions.size()), *caster);
}

/// A white plate at x, from y and z `low` to `high`, of nothing but its front.
inline Mesh plate_mesh(double x, const glm::dvec2& low, const glm::dvec2& high) {
  Mesh mesh;
  mesh.positions = {{x, low.x, low.y}, {x, high.x, low.y}, {x, high.x, high.y}, {x, low.x, high.y}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// What share of the unit disc lies at y above `c`.
inline double disc_share_above(double c) {
  if (c <= -1) return 1;
  if (c >= 1) return 0;
  return (std::acos(c) - c * std::sqrt(1 - c * c)) / std::numbers::pi;
}

struct Moments {
  double sum = 0, squares = 0, count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - mean() * mean()); }
  /// Of the mean.
  double standard_error() const { return std::sqrt(variance() / count); }
};

/// Standard errors that a mean of many is at most off: 6e-7 of all tests that are right fail.
inline constexpr double kSigmas = 5;

}  // namespace simvis
