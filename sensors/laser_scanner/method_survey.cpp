#include "sensors/laser_scanner/method_survey.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <simvis/attributes.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

void take_worst(ScanCandidate& candidate, const BeamReading& reading) {
  const double range = reading.range_m, bound = reading.error_bound_m;
  if (bound == 0 || !std::isfinite(range) || !std::isfinite(bound)) return;
  candidate.worst_bound_m = std::max(candidate.worst_bound_m, bound);
  if (range > 0) candidate.worst_bound_rel = std::max(candidate.worst_bound_rel, bound / range);
}

}  // namespace

std::string to_string(const ScanCandidate& candidate) {
  return candidate.resolution_px > 0 ? "hybrid " + format_number(candidate.resolution_px) : "raycast";
}

void add_cast(CostModel& work, std::size_t list_items) {
  work[CostTerm::cast] += 1;
  work[CostTerm::item_cast] += static_cast<double>(list_items);
}

void add_rays(CostModel& work, const RayCounters& before, const RayCounters& after) {
  work[CostTerm::ray] += static_cast<double>(after.rays - before.rays);
  work[CostTerm::item_test] += static_cast<double>(after.item_tests - before.item_tests);
  work[CostTerm::triangle_test] += static_cast<double>(after.triangle_tests - before.triangle_tests);
}

MethodSurvey::MethodSurvey(const ScanPattern& pattern, std::span<const double> resolutions_px) {
  SIMVIS_ASSERT(resolutions_px.size() < 32);
  for (const double resolution_px : resolutions_px) {
    rendered_.push_back(std::make_unique<RenderedScan>(pattern, resolution_px));
    candidates_.push_back({.resolution_px = resolution_px});
  }
  candidates_.emplace_back();
  casts_of_.resize(std::size_t{pattern.beams} * pattern.rings);
}

void MethodSurvey::plan(const std::string& scanner, const glm::dmat4& sensor_from_world, FramePlan& plan) {
  for (const auto& rendered : rendered_) {
    const std::string resolution = format_number(rendered->resolution_px());
    rendered->plan(scanner, " at " + resolution + " px, to see what it would cost", sensor_from_world, plan,
                   scanner + "." + resolution);
  }
}

void MethodSurvey::collect(const FramePlan& plan, std::span<const PassResult> results, std::size_t list_items,
                           const VertexRounding& rounding, const RangeLimits& limits, const ScanTolerance& tolerance,
                           const ShapeRanges* shapes) {
  const std::uint32_t raycast = 1u << rendered_.size();
  std::ranges::fill(casts_of_, raycast);
  for (std::size_t c = 0; c < rendered_.size(); ++c) {
    rendered_[c]->collect(plan, results, rounding, shapes);
    candidates_[c].work = rendered_[c]->work(list_items);
    for (std::size_t beam = 0; beam < casts_of_.size(); ++beam) {
      const BeamReading reading = read_range(rendered_[c]->planar(beam), limits);
      if (tolerance.met(reading)) {
        take_worst(candidates_[c], reading);
      } else {
        casts_of_[beam] |= 1u << c;
      }
    }
  }
}

void MethodSurvey::cast(RayCaster& rays, std::size_t list_items, const glm::dmat4& world_from_sensor,
                        std::span<const std::uint32_t> order, std::span<const glm::dvec3> directions,
                        std::span<RayHit> hits) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> groups;  // by casts_of_: places in `order`
  for (std::uint32_t i = 0; i < order.size(); ++i) groups[casts_of_[order[i]]].push_back(i);
  std::vector<glm::dvec3> group_directions;
  std::vector<RayHit> group_hits;
  for (const auto& [candidates, places] : groups) {
    group_directions.clear();
    for (const std::uint32_t place : places) group_directions.push_back(directions[place]);
    group_hits.resize(places.size());
    const RayCounters before = rays.counters();
    rays.cast(world_from_sensor, group_directions, group_hits);
    const RayCounters after = rays.counters();
    for (std::size_t i = 0; i < places.size(); ++i) hits[places[i]] = group_hits[i];
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if ((candidates >> c & 1) == 0) continue;
      candidates_[c].beams_cast += places.size();
      add_rays(candidates_[c].work, before, after);
    }
  }
  for (ScanCandidate& candidate : candidates_) {
    if (candidate.beams_cast > 0) add_cast(candidate.work, list_items);
  }
}

void MethodSurvey::choose(std::span<const BeamReading> cast, const CostModel& cost) {
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    for (std::size_t beam = 0; beam < casts_of_.size(); ++beam) {
      if ((casts_of_[beam] >> c & 1) != 0) take_worst(candidates_[c], cast[beam]);
    }
    candidates_[c].predicted_ns = predict(candidates_[c].work, cost);
  }
  const auto cheapest = std::ranges::min_element(candidates_, {}, &ScanCandidate::predicted_ns);
  chosen_ = static_cast<std::size_t>(cheapest - candidates_.begin());
}

std::unique_ptr<RenderedScan> MethodSurvey::release_rendered() {
  return chosen_ < rendered_.size() ? std::move(rendered_[chosen_]) : nullptr;
}

}  // namespace simvis
