#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <tuple>
#include <utility>

#include <simvis/scan_effect.h>
#include "effects/scanner/moved_items.h"
#include "effects/scanner/reflectance.h"
#include "effects/scanner/returns.h"
#include "engine/base/assert.h"

namespace simvis {
namespace {

// The error of a ray's end point in addition to the caster's own bound. It changes the range by this error divided by
// the cosine of incidence. An origin is transformed to the world as a sum of three products and the sensor's position,
// with an error of 4 u of each component (u = 2^-53). This gives 4 sqrt(3) u of the length of either vector, and
// another sqrt(3) u of the length of the former.
double displacement_m(const ScanContext& context, const BeamRay& ray, double range_m) {
  constexpr double kPlacing = 12 * 0x1p-53;
  const double placed_m =
      ray.origin_m == glm::dvec3(0)
          ? 0
          : kPlacing * (glm::length(ray.origin_m) + glm::length(glm::dvec3(context.world_from_sensor[3])));
  return placed_m + ray.origin_error_m + ray.error_rad * range_m;
}

// How much farther than `range_m` along its axis a cone of light may meet a plane.
double within_cone_m(double range_m, double cosine, double half_angle_rad) {
  if (half_angle_rad == 0) return 0;
  const double incidence_rad = std::acos(std::clamp(cosine, 0.0, 1.0));
  const double farthest = std::cos(incidence_rad + half_angle_rad);
  return farthest > 0 ? range_m * (cosine / farthest - 1) : std::numeric_limits<double>::infinity();
}

// Keeps the echoes beyond the receiver's range only if there are no nearer ones.
void listen_until(double range_max_m, std::vector<Echo>& echoes) {
  const auto beyond = std::ranges::upper_bound(echoes, range_max_m, {}, &Echo::range_m);
  if (beyond != echoes.begin()) echoes.erase(beyond, echoes.end());
}

}  // namespace

TracedScan::TracedScan(std::vector<glm::dvec3> directions, std::span<const ChosenScanEffect> effects)
    : directions_(std::move(directions)), effects_(effects), pulse_length_m_(kPulseLength_m) {
  for (const ChosenScanEffect& each : effects)
    pulse_length_m_ = each.effect->pulse_length_m().value_or(pulse_length_m_);
}

TracedScan::~TracedScan() = default;

void TracedScan::set_beams(std::vector<glm::dvec3> directions, std::vector<glm::dvec3> origins_m) {
  SIMVIS_ASSERT(directions.size() == directions_.size());
  SIMVIS_ASSERT(origins_m.empty() || origins_m.size() == directions.size());
  directions_ = std::move(directions);
  origins_m_ = std::move(origins_m);
}

// Rays with the same origin stand side by side, which is faster to cast.
void TracedScan::place_origins() {
  for (BeamRay& ray : rays_) ray.origin_m = origins_m_[ray.beam];
  const auto place = [](const BeamRay& ray) { return std::tuple(ray.origin_m.x, ray.origin_m.y, ray.origin_m.z); };
  std::ranges::stable_sort(rays_, {}, place);
}

std::span<const Echo> TracedScan::trace(const ScanContext& of_sensor, const DrawList& list, RayCaster& caster) {
  ScanContext context = of_sensor;
  context.scene = &list;
  rays_cast_ = 0;
  rays_.clear();
  for (std::uint32_t beam = 0; beam < directions_.size(); ++beam) {
    rays_.push_back({.beam = beam, .direction = directions_[beam]});
  }
  if (!origins_m_.empty()) place_origins();
  for (const ChosenScanEffect& each : effects_) each.effect->aim(context, rays_);
  echoes_.resize(directions_.size());
  for (std::vector<Echo>& echoes : echoes_) echoes.clear();
  for (std::uint32_t turns = 0; turns <= kMaxTurns && !rays_.empty(); ++turns) follow(context, list, caster);
  detect(context);
  return detected_;
}

// Casts one segment of every ray.
void TracedScan::follow(const ScanContext& context, const DrawList& list, RayCaster& caster) {
  cast(context.world_from_sensor, caster);
  cast_moved(context, list, caster);
  onward_.clear();
  for (std::size_t i = 0; i < rays_.size(); ++i) meet(context, list, i);
  rays_.swap(onward_);
}

void TracedScan::cast(const glm::dmat4& world_from_sensor, RayCaster& caster) {
  hits_.resize(rays_.size());
  cast_origins_m_.clear();
  cast_directions_.clear();
  cast_t_min_m_.clear();
  for (const BeamRay& ray : rays_) {
    cast_origins_m_.push_back(ray.origin_m);
    cast_directions_.push_back(ray.direction);
    if (ray.t_min_m > 0) cast_t_min_m_.resize(rays_.size());
  }
  for (std::size_t i = 0; i < cast_t_min_m_.size(); ++i) cast_t_min_m_[i] = rays_[i].t_min_m;
  const glm::dvec3& origin_m = cast_origins_m_.front();
  if (std::ranges::all_of(cast_origins_m_, [&](const glm::dvec3& each) { return each == origin_m; })) {
    caster.cast(glm::translate(world_from_sensor, origin_m), cast_directions_, hits_, cast_t_min_m_);
  } else {
    caster.cast_from(world_from_sensor, cast_origins_m_, cast_directions_, hits_, cast_t_min_m_);
  }
  rays_cast_ += rays_.size();
}

void TracedScan::cast_moved(const ScanContext& context, const DrawList& list, RayCaster& caster) {
  if (context.moves.empty()) {
    moved_.reset();
    return;
  }
  if (moved_ == nullptr) moved_ = std::make_unique<MovedItems>();
  moved_->cast(context, list, rays_, caster, hits_);
  rays_cast_ += moved_->rays();
}

void TracedScan::meet(const ScanContext& context, const DrawList& list, std::size_t number) {
  const BeamRay& ray = rays_[number];
  const RayHit& hit = hits_[number];
  if (hit.range_m == std::numeric_limits<double>::infinity()) return;
  const MovedItems::Seen* const seen = moved_ == nullptr ? nullptr : moved_->seen(number);
  const BeamRay& cast = seen == nullptr ? ray : seen->ray;
  SurfacePoint surface =
      surface_point(list, glm::translate(context.world_from_sensor, cast.origin_m), cast.direction, hit);
  if (seen != nullptr) surface.normal = seen->ray_from_seen * surface.normal;
  const double range_m = ray.travelled_m + hit.range_m;
  const double cosine = -glm::dot(surface.normal, ray.direction);
  const double displaced_m = displacement_m(context, cast, hit.range_m);
  Echo echo{.range_m = range_m,
            .error_bound_m = ray.error_m + hit.error_bound_m + (displaced_m > 0 ? displaced_m / cosine : 0),
            .within_cone_m = within_cone_m(range_m, cosine, ray.half_angle_rad),
            .power = ray.share * reflectance(surface) * cosine / (range_m * range_m)};
  if (ray.asked_by != nullptr) return ray.asked_by->meet(context, ray, surface, echo, onward_);
  for (const ChosenScanEffect& each : effects_) each.effect->meet(context, ray, surface, echo, onward_);
  if (echo.range_m < std::numeric_limits<double>::infinity()) echoes_[ray.beam].push_back(echo);
}

void TracedScan::detect(const ScanContext& context) {
  detected_.assign(directions_.size(), {});
  for (std::uint32_t beam = 0; beam < directions_.size(); ++beam) {
    std::vector<Echo>& echoes = echoes_[beam];
    std::ranges::stable_sort(echoes, {}, &Echo::range_m);
    for (const ChosenScanEffect& each : effects_) each.effect->receive(context, beam, echoes);
    listen_until(context.range_max_m, echoes);
    merge_pulses(pulse_length_m_, echoes);
    const bool found = std::ranges::any_of(effects_, [&](const ChosenScanEffect& each) {
      return each.effect->detect(context, beam, echoes, detected_[beam]);
    });
    if (!found && !echoes.empty()) detected_[beam] = *std::ranges::max_element(echoes, {}, &Echo::power);
  }
}

}  // namespace simvis
