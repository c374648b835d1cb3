#include "effects/scanner/crosstalk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <simvis/error.h>
#include <simvis/pose.h>
#include "effects/scanner/onward_ray.h"
#include "effects/scanner/reflectance.h"
#include "engine/draw/splat_item.h"
#include "engine/light/surface_shares.h"

namespace simvis {
namespace {

constexpr double kLight_mps = 299'792'458;
// Beams of a table start this near to the scanner's origin at most; pulses are looked for with this margin.
constexpr double kMargin_m = 1;

constexpr AttributeSpec kCrosstalkAttributes[] = {
    {.name = "crosstalk",
     .kind = AttributeKind::objects,
     .text =
         "insertion points of other scanners of this type, whose pulses are taken for echoes: names and patterns with "
         "* for any text and ? for any character; default: none"},
};

const ScanEffectRegistration kCrosstalkRegistration(
    {.type = {.name = "crosstalk",
              .summary = "Pulses of other scanners of the same type are taken for echoes.",
              .notes =
                  "Other scanners stand at the insertion points that the pattern names and send the same beams, in a "
                  "turn that begins at a time of its own in each scan. A false echo comes from a surface that both "
                  "scanners light up, or directly, if the pulse arrives while the beam listens; parts hide light. "
                  "Beams have the diameter beam_diameter and grow by the divergence. They need times: a sweep, or "
                  "firing=\"pattern\".",
              .source = "attribute crosstalk",
              .outputs = kShownInRanges,
              .reference = "beams that cross at a target: Popko, Gaylord and Valenta, Opt. Eng. 59 (2020)",
              .needs = kCastsBeams,
              .attributes = kCrosstalkAttributes},
     .order = ScanOrder::detection,
     .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
       if (!context.attributes.is_set("crosstalk") || context.attributes.text("crosstalk").empty()) return nullptr;
       return std::make_unique<Crosstalk>(context);
     }});

double dimmed(const Medium& medium, double way_m) { return std::exp(-medium.laser_extinction_per_m * way_m); }

}  // namespace

Crosstalk::Crosstalk(const ScanEffectContext& context)
    : others_(context.attributes.text("crosstalk")),
      where_(context.attributes.where("crosstalk")),
      times_(context.attributes),
      beam_diameter_m_(context.attributes.number("beam_diameter")),
      spread_(2 * std::tan(glm::radians(context.attributes.number("divergence")) / 2)),
      range_max_m_(context.range_max_m),
      random_(context.random("crosstalk")) {
  if (times_.together()) {
    fail_at(where_,
            "attribute \"crosstalk\": all beams leave at the same time, expected a sweep above 0 or "
            "firing=\"pattern\"");
  }
}

void Crosstalk::order_firings(const ScanContext& context) const {
  std::vector<double> fired_s(axes_.size());
  for (std::uint32_t beam = 0; beam < fired_s.size(); ++beam) fired_s[beam] = -times_.age_s(context, beam);
  const double first_s = fired_s.empty() ? 0 : std::ranges::min(fired_s);
  for (double& time_s : fired_s) time_s -= first_s;
  if (fired_s == fired_s_) return;
  fired_s_ = std::move(fired_s);
  in_order_.resize(fired_s_.size());
  for (std::uint32_t i = 0; i < in_order_.size(); ++i) in_order_[i] = i;
  std::ranges::stable_sort(in_order_, {}, [&](std::uint32_t beam) { return fired_s_[beam]; });
  std::size_t intervals = 0;
  for (std::size_t i = 1; i < in_order_.size(); ++i) intervals += fired_s_[in_order_[i]] > fired_s_[in_order_[i - 1]];
  const double last_s = in_order_.empty() ? 0 : fired_s_[in_order_.back()];
  turn_s_ = last_s + (intervals == 0 ? 0 : last_s / static_cast<double>(intervals));
  if (turn_s_ > 2 * (range_max_m_ + kMargin_m) / kLight_mps) return;
  fired_s_.clear();
  fail_at(where_, "attribute \"crosstalk\": a turn of " + format_number(turn_s_) +
                      " s is shorter than the way of light to range_max and back, expected a longer sweep");
}

void Crosstalk::aim(const ScanContext& context, std::vector<BeamRay>& rays) const {
  axes_ = beam_axes(rays);
  nearest_m_.assign(axes_.size(), std::numeric_limits<double>::infinity());
  pulses_.clear();
  sorted_ = false;
  order_firings(context);
  seen_.clear();
  const glm::dmat4 sensor_from_world = rigid_inverse(context.world_from_sensor);
  for (const OtherScanner& other : context.others) {
    const glm::dmat4 pose = sensor_from_world * other.world_from_scanner;
    if (glm::length(glm::dvec3(pose[3])) < beam_diameter_m_) continue;
    seen_.push_back({pose, turn_s_ * random_.uniform(random_key(context.time), other.number, 0)});
  }
}

// Calls `heard` for the beams of the other scanner whose pulses arrive by about this way while the beam listens.
void Crosstalk::hear(const Other& other, std::uint32_t beam, double way_m,
                     const std::function<void(const Fired&)>& heard) const {
  const double from_s = fired_s_[beam] - other.begins_s - (way_m + kMargin_m) / kLight_mps;
  const double to_s = from_s + 2 * (range_max_m_ + kMargin_m) / kLight_mps;
  const auto fired = [&](std::uint32_t each) { return fired_s_[each]; };
  for (double turn = std::floor(from_s / turn_s_); turn * turn_s_ <= to_s; ++turn) {
    auto each = std::ranges::lower_bound(in_order_, from_s - turn * turn_s_, {}, fired);
    for (; each != in_order_.end() && fired_s_[*each] <= to_s - turn * turn_s_; ++each) {
      const BeamAxis& axis = axes_[*each];
      heard({.origin_m = glm::dvec3(other.sensor_from_other * glm::dvec4(axis.origin_m, 1)),
             .direction = glm::dmat3(other.sensor_from_other) * axis.direction,
             .time_s = other.begins_s + turn * turn_s_ + fired_s_[*each]});
    }
  }
}

// The range that a pulse reads; 0 if the beam does not listen when it arrives.
double Crosstalk::range_m(std::uint32_t beam, const Fired& fired, double way_m) const {
  const double range_m = (kLight_mps * (fired.time_s - fired_s_[beam]) + way_m) / 2;
  return range_m > 0 && range_m <= range_max_m_ ? range_m : 0;
}

// Whether the point lies in the cone of a beam.
bool Crosstalk::lights_up(const glm::dvec3& origin_m, const glm::dvec3& direction, const glm::dvec3& point_m) const {
  const glm::dvec3 reach_m = point_m - origin_m;
  const double along_m = glm::dot(reach_m, direction);
  return along_m > 0 && glm::length(reach_m - along_m * direction) < diameter_m(along_m) / 2;
}

void Crosstalk::meet(const ScanContext& context, const BeamRay& ray, const SurfacePoint& surface, Echo&,
                     std::vector<BeamRay>& onward) const {
  if (ray.asked_by == this) {
    Pulse& pulse = pulses_[ray.question];
    pulse.hidden |= surface.range_m < pulse.way_m;
    return;
  }
  if (ray.turns > 0) return;
  nearest_m_[ray.beam] = std::min(nearest_m_[ray.beam], surface.range_m);
  if (is_splat_item(*context.scene, surface.item)) return;  // see Limits
  const double cosine = -glm::dot(surface.normal, ray.direction), reflects = reflectance(surface);
  const glm::dvec3 point_m = ray.origin_m + surface.range_m * ray.direction;
  const double seen = ray.share * reflects * surface_shares(*surface.material, reflects, cosine).matte * cosine;
  const double width_m = diameter_m(surface.range_m);
  for (const Other& other : seen_) {
    const double about_m = glm::length(glm::dvec3(other.sensor_from_other[3]) - point_m) + surface.range_m;
    hear(other, ray.beam, about_m, [&](const Fired& fired) {
      const glm::dvec3 to_other_m = fired.origin_m - point_m;
      const double way_m = glm::length(to_other_m), lit = glm::dot(surface.normal, to_other_m) / way_m;
      const double false_m = range_m(ray.beam, fired, way_m + surface.range_m);
      if (false_m == 0 || !(lit > 0) || !lights_up(fired.origin_m, fired.direction, point_m)) return;
      const double ratio = width_m / (diameter_m(way_m) * surface.range_m);
      const double power = seen * ratio * ratio * dimmed(context.medium, way_m + surface.range_m);
      BeamRay& question = onward.emplace_back(onward_ray(ray, surface, to_other_m / way_m, lit));
      question.asked_by = this;
      question.question = static_cast<std::uint32_t>(pulses_.size());
      pulses_.push_back({ray.beam, {.range_m = false_m, .power = power}, way_m});
    });
  }
}

void Crosstalk::add_direct(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const {
  const BeamAxis& axis = axes_[beam];
  for (const Other& other : seen_) {
    const glm::dvec3 place_m(other.sensor_from_other[3]);
    const double about_m = glm::length(place_m - axis.origin_m);
    if (nearest_m_[beam] < about_m || !lights_up(axis.origin_m, axis.direction, place_m)) continue;
    hear(other, beam, about_m, [&](const Fired& fired) {
      if (!lights_up(fired.origin_m, fired.direction, axis.origin_m)) return;
      const double way_m = glm::length(fired.origin_m - axis.origin_m), false_m = range_m(beam, fired, way_m);
      if (false_m == 0) return;
      const double lit_m = diameter_m(way_m);
      echoes.push_back({.range_m = false_m, .power = 4 / (lit_m * lit_m) * dimmed(context.medium, way_m)});
    });
  }
}

void Crosstalk::receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const {
  if (!sorted_) std::ranges::stable_sort(pulses_, {}, &Pulse::beam);
  sorted_ = true;
  const std::size_t before = echoes.size();
  auto pulse = std::ranges::lower_bound(pulses_, beam, {}, &Pulse::beam);
  for (; pulse != pulses_.end() && pulse->beam == beam; ++pulse) {
    if (!pulse->hidden) echoes.push_back(pulse->echo);
  }
  if (beam < axes_.size() && !seen_.empty()) add_direct(context, beam, echoes);
  if (echoes.size() > before) std::ranges::stable_sort(echoes, {}, &Echo::range_m);
}

}  // namespace simvis
