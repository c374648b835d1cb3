// Follows the beams of a scan one by one, for effects that need more than a range: directions, surfaces and returned
// power.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include <simvis/scan_effect.h>

namespace simvis {

/// The largest number of reflections and transmissions of a ray; light that continues after that returns nothing.
inline constexpr std::uint32_t kMaxTurns = 16;

class TracedScan {
 public:
  /// `directions` of the beams are unit vectors in the sensor frame. The effects must outlive this object.
  TracedScan(std::vector<glm::dvec3> directions, std::span<const ChosenScanEffect> effects);

  /// Returns the reported echo of each beam; valid until the next call. The caster's world must be `list`.
  std::span<const Echo> trace(const ScanContext& context, const DrawList& list, RayCaster& caster);

  /// Number of rays of the last trace().
  std::uint64_t rays() const { return rays_cast_; }

 private:
  void follow(const ScanContext& context, const DrawList& list, RayCaster& caster);
  void cast(const glm::dmat4& world_from_sensor, RayCaster& caster);
  void meet(const ScanContext& context, const DrawList& list, const BeamRay& ray, const RayHit& hit);
  void detect(const ScanContext& context);

  std::vector<glm::dvec3> directions_;
  std::span<const ChosenScanEffect> effects_;
  double pulse_length_m_;
  std::vector<BeamRay> rays_, onward_;
  std::vector<glm::dvec3> cast_origins_m_, cast_directions_;  // of rays_
  std::vector<double> cast_t_min_m_;                          // of rays_; empty if all are 0
  std::vector<RayHit> hits_;
  std::vector<std::vector<Echo>> echoes_;  // by beam
  std::vector<Echo> detected_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace simvis
