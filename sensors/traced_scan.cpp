#include "sensors/traced_scan.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "effects/reflectance.h"

namespace simvis {

TracedScan::TracedScan(std::span<const glm::dvec3> directions, std::span<const ChosenScanEffect> effects)
    : directions_(directions), effects_(effects) {}

std::span<const Echo> TracedScan::trace(const ScanMoment& moment, const DrawList& list, RayCaster& caster) {
  rays_cast_ = 0;
  rays_.clear();
  for (std::uint32_t beam = 0; beam < directions_.size(); ++beam) {
    rays_.push_back({.beam = beam, .direction = directions_[beam]});
  }
  for (const ChosenScanEffect& each : effects_) each.effect->aim(moment, rays_);
  echoes_.resize(directions_.size());
  for (std::vector<Echo>& echoes : echoes_) echoes.clear();
  for (std::uint32_t turns = 0; turns <= kMostTurns && !rays_.empty(); ++turns) follow(moment, list, caster);
  detect(moment);
  return detected_;
}

// One stretch of every ray.
void TracedScan::follow(const ScanMoment& moment, const DrawList& list, RayCaster& caster) {
  cast(moment.world_from_sensor, caster);
  onward_.clear();
  for (std::size_t i = 0; i < rays_.size(); ++i) meet(moment, list, rays_[i], hits_[i]);
  rays_.swap(onward_);
}

// Rays that leave from one place go together.
void TracedScan::cast(const glm::dmat4& world_from_sensor, RayCaster& caster) {
  hits_.resize(rays_.size());
  for (std::size_t first = 0, end = 0; first < rays_.size(); first = end) {
    together_.clear();
    beyond_m_.clear();
    for (end = first; end < rays_.size() && rays_[end].origin_m == rays_[first].origin_m; ++end) {
      together_.push_back(rays_[end].direction);
      beyond_m_.push_back(rays_[end].beyond_m);
    }
    const bool whole = std::ranges::count(beyond_m_, 0.0) == static_cast<std::ptrdiff_t>(beyond_m_.size());
    caster.cast(glm::translate(world_from_sensor, rays_[first].origin_m), together_,
                std::span(hits_).subspan(first, end - first), whole ? std::span<const double>() : beyond_m_);
  }
  rays_cast_ += rays_.size();
}

void TracedScan::meet(const ScanMoment& moment, const DrawList& list, const BeamRay& ray, const RayHit& hit) {
  if (hit.range_m == std::numeric_limits<double>::infinity()) return;
  const SurfacePoint surface =
      surface_point(list, glm::translate(moment.world_from_sensor, ray.origin_m), ray.direction, hit);
  const double range_m = ray.travelled_m + hit.range_m;
  const double cosine = -glm::dot(surface.normal, ray.direction);
  Echo echo{.range_m = range_m,
            .error_bound_m = ray.error_m + hit.error_bound_m,
            .power = ray.share * reflectance(surface) * cosine / (range_m * range_m)};
  for (const ChosenScanEffect& each : effects_) each.effect->meet(moment, ray, surface, echo, onward_);
  if (echo.range_m < std::numeric_limits<double>::infinity()) echoes_[ray.beam].push_back(echo);
}

void TracedScan::detect(const ScanMoment& moment) {
  detected_.assign(directions_.size(), {});
  for (std::uint32_t beam = 0; beam < directions_.size(); ++beam) {
    std::vector<Echo>& echoes = echoes_[beam];
    std::ranges::stable_sort(echoes, {}, &Echo::range_m);
    for (const ChosenScanEffect& each : effects_) each.effect->receive(moment, beam, echoes);
    const bool found = std::ranges::any_of(effects_, [&](const ChosenScanEffect& each) {
      return each.effect->detect(moment, beam, echoes, detected_[beam]);
    });
    if (!found && !echoes.empty()) detected_[beam] = *std::ranges::max_element(echoes, {}, &Echo::power);
  }
}

}  // namespace simvis
