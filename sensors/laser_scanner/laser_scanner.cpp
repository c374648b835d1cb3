#include "sensors/laser_scanner/laser_scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <sstream>

#include <simvis/pose.h>
#include "engine/base/assert.h"
#include "engine/base/decimal.h"
#include "engine/splats/seen_splats.h"
#include "sensors/laser_scanner/casting_order.h"

namespace simvis {

namespace {

constexpr double kMaxCost_ns = 1e12;  // of a unit of work, in a state

// True if a rendered range can be exact enough.
bool can_render(const LaserScannerDesc& desc) {
  return !casts(desc.method) || (desc.method != ScanMethod::raycast && desc.max_error_rel >= min_planar_bound());
}

std::vector<double> resolutions(const LaserScannerDesc& desc) {
  if (!can_render(desc)) return {};
  if (desc.resolution_px > 0) return {desc.resolution_px};
  if (desc.method != ScanMethod::automatic) return {default_resolution_px(desc.pattern)};
  if (desc.pattern.rings == 1) return {std::begin(kPlanarResolutions), std::end(kPlanarResolutions)};
  return {std::begin(kRingsResolutions), std::end(kRingsResolutions)};
}

}  // namespace

const EffectType* beam_following_effect(const LaserScannerDesc& desc) {
  const auto found = std::ranges::find_if(
      desc.effects, [](const auto& each) { return each.called_for == nullptr && each.effect->traces(); });
  return found == desc.effects.end() ? nullptr : found->type;
}

LaserScanner::LaserScanner(std::string name, const LaserScannerDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      limits_{desc.range_min_m, desc.range_max_m},
      tolerance_{desc.max_error_m, desc.max_error_rel, desc.where_max_error_m, desc.where_max_error_rel},
      scan_(desc.pattern.rings, desc.pattern.beams) {
  if (desc.method != ScanMethod::automatic && can_render(desc)) {
    rendered_ = std::make_unique<RenderedScan>(desc.pattern, resolutions(desc).front());
  }
  if (desc.table != nullptr && desc.table_beams > 0) {
    running_.emplace(*desc.table, desc.table_beams);
    beams_ = running_->at(0);
  } else {
    beams_ = desc.table == nullptr ? grid_beams(desc.pattern) : table_beams(*desc.table);
  }
  SIMVIS_ASSERT(beams_.rings == scan_.rings && beams_.beams == scan_.beams);
  describe_beams();
  scan_.constants = {{"range_min_m", limits_.min_m}, {"range_max_m", limits_.max_m}};
  readings_.resize(beams_.size());
  context_.rings = scan_.rings;
  context_.beams = scan_.beams;
  context_.range_max_m = desc.range_max_m;
  context_.firing_age_s = beams_.age_s;
  if (casts(desc.method) || desc_.truth.any()) order_beams();
  SIMVIS_ASSERT(desc.method == ScanMethod::raycast ||
                (beam_following_effect(desc) == nullptr && desc.table == nullptr));
}

// What the public scan says of its beams.
void LaserScanner::describe_beams() {
  scan_.set_angles(beams_.azimuth_rad, beams_.elevation_rad, beams_.azimuth_deg, beams_.elevation_deg);
  if (!beams_.ring.empty()) scan_.set_rings(beams_.ring);
  if (!running_) scan_.beam_table = desc_.table;
  if (beams_.origin_m.empty()) return;
  std::vector<double> origins_m;
  for (const glm::dvec3& origin : beams_.origin_m) {
    for (glm::length_t axis = 0; axis < 3; ++axis) origins_m.push_back(origin[axis]);
  }
  scan_.set_origins(std::move(origins_m));
}

void LaserScanner::order_beams() {
  if (!cast_.order.empty()) return;
  cast_ = cast_order(beams_, desc_.table == nullptr ? casting_order(desc_.pattern) : std::vector<std::uint32_t>());
}

// The beams of a table that runs on are those of the frame's time.
void LaserScanner::select_beams() {
  if (!running_) return;
  beams_ = running_->at(context_.time.time_ns);
  context_.firing_age_s = beams_.age_s;
  cast_ = cast_order(beams_);
  if (traced_) aim_traced();
}

void LaserScanner::aim_traced() {
  std::vector<glm::dvec3> directions;
  for (std::size_t beam = 0; beam < beams_.size(); ++beam) directions.push_back(beams_.direction(beam));
  traced_->set_beams(std::move(directions), beams_.origin_m);
}

// Examines the scene only if something changed that effects depend on.
void LaserScanner::update_effects(const DrawList& list) {
  const bool same = list_ == &list && list.revisions.structure == effects_of_.structure &&
                    list.revisions.materials == effects_of_.materials && list.medium == context_.medium;
  if (same) return;
  list_ = &list;
  effects_of_ = list.revisions;
  context_.medium = list.medium;
  effects_ = called_for(desc_.effects, list);
  hits_splats_ = has_splats(list);
  if (hits_splats_) order_beams();
  traced_.reset();
  if (!any_traces(effects_)) return;
  order_beams();
  traced_ = std::make_unique<TracedScan>(std::vector<glm::dvec3>(beams_.size()), effects_);
  aim_traced();
}

// The names of effects that require cast beams because of the scene, not because of the scanner's own attributes.
std::string LaserScanner::traced_for() const {
  std::string names;
  for (const ChosenScanEffect& each : effects_) {
    if (each.called_for == nullptr || !each.effect->traces()) continue;
    names += (names.empty() ? "" : " ") + std::string(each.type->name);
  }
  if (hits_splats_) names += (names.empty() ? "" : " ") + std::string("gaussian_splats");
  return names;
}

HistoryDependence LaserScanner::history_dependence() const {
  if (desc_.method == ScanMethod::automatic) return HistoryDependence::measurements;
  return looks_back() || desc_.truth.looks_back() ? HistoryDependence::poses : HistoryDependence::none;
}

bool LaserScanner::looks_back() const {
  return std::ranges::any_of(desc_.effects,
                             [](const ChosenScanEffect& each) { return each.effect->uses_previous_pose(); });
}

std::string LaserScanner::others() const {
  for (const ChosenScanEffect& each : desc_.effects) {
    if (std::string pattern = each.effect->others(); !pattern.empty()) return pattern;
  }
  return {};
}

void LaserScanner::sense(const SensedWorld& world) {
  if (looks_back()) {
    context_.moves = world.item_moves();
    context_.path = &world.sensor_path();
  }
  others_.clear();
  if (!others().empty()) {
    for (const SensedPoint& point : world.points()) others_.push_back({point.number, point.world_from_point});
  }
  context_.others = others_;
  world_ = &world;
}

void LaserScanner::skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  context_.before = {time.time_ns, world_from_sensor};
}

void LaserScanner::archive(StateArchive& state) {
  if (desc_.method == ScanMethod::automatic) archive_choice(state);
  bool has_before = context_.before.has_value();
  state(has_before);
  if (!has_before) return context_.before.reset();
  if (!context_.before) context_.before.emplace();
  state(context_.before->time_ns);
  state.require_past(context_.before->time_ns);
  state.finite(context_.before->world_from_sensor);
}

// Costs are known once a scanner is on. A state has none if it was saved before that: those that are known here stay.
void LaserScanner::archive_choice(StateArchive& state) {
  CostModel costs = costs_;
  for (double& each : costs.of) {
    state.finite(each);
    state.require(each >= 0 && (!state.is_reading() || each <= kMaxCost_ns));
  }
  if (costs != CostModel{}) costs_ = costs;
  choice_.archive(state, resolutions(desc_), tolerance_);
  if (!state.is_reading()) return;
  survey_.reset();
  const double resolution_px = choice_.resolution_px();
  rendered_ = resolution_px == 0 ? nullptr : std::make_unique<RenderedScan>(desc_.pattern, resolution_px);
}

void LaserScanner::use_cost_model(const std::function<const CostModel&()>& costs) {
  if (desc_.method == ScanMethod::automatic) costs_ = costs();
}

void LaserScanner::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  context_.world_from_sensor = world_from_sensor;
  update_effects(list);
  const glm::dmat4 sensor_from_world = rigid_inverse(world_from_sensor);
  survey_.reset();
  if (desc_.method == ScanMethod::automatic && !traced_ && !hits_splats_ && choice_.is_due(list)) {
    SIMVIS_ASSERT(costs_ != CostModel{});
    survey_ = std::make_unique<MethodSurvey>(desc_.pattern, resolutions(desc_));
    if (can_render(desc_)) rounding_ = VertexRounding(list, sensor_from_world);
    survey_->plan(name_, sensor_from_world, plan);
  } else if (renders()) {
    rounding_ = VertexRounding(list, sensor_from_world);
    rendered_->plan(name_, desc_.method == ScanMethod::automatic ? ", by " + choice_.text() : "", sensor_from_world,
                    plan, name_);
  }
  if (may_cast() || traced_ || desc_.truth.any()) {
    std::uint64_t max_rays = cast_.directions.size();
    for (const ChosenScanEffect& each : effects_) max_rays *= each.effect->rays_per_ray();
    if (!may_cast() && !traced_) max_rays = 0;
    if (desc_.truth.any() && !casts_every_beam()) max_rays += cast_.directions.size();
    plan.casts.push_back({.name = name_, .reason = cast_reason(), .max_rays = max_rays, .colors = traced_ != nullptr});
  }
  for (const ChosenScanEffect& each : effects_) {
    plan.effects.push_back({name_, std::string(each.type->name), std::string(each.type->source)});
  }
}

std::string LaserScanner::cast_reason() const {
  std::ostringstream reason;
  if (!may_cast() && !traced_) return "every beam of laser scanner " + name_ + ", for truth";
  reason << (renders() ? "beams" : "every beam") << " of laser scanner " << name_;
  if (traced_ || hits_splats_) {
    if (const std::string names = traced_for(); !names.empty()) reason << ", for " << names;
    return reason.str();
  }
  if (survey_) {
    reason << ", to see what it would cost";
  } else if (renders()) {
    reason << " whose bound is above " << to_string(tolerance_);
  } else if (!can_render(desc_) && desc_.method != ScanMethod::raycast) {
    reason << ": no rendered range has a bound below " << decimal(min_planar_bound(), 6) << " of itself";
  }
  if (!survey_ && desc_.method == ScanMethod::automatic) reason << ", by " << choice_.text();
  return reason.str();
}

void LaserScanner::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  context_.time = time;
  select_beams();
  to_cast_.clear();
  const ShapeRanges* const shapes = survey_ || renders() ? cast_shapes(plan.threads) : nullptr;
  if (survey_) survey_->collect(plan, results, list_->items.size(), rounding_, limits_, tolerance_, shapes);
  if (!renders()) return;
  rendered_->collect(plan, results, rounding_, shapes);
  for (std::uint32_t beam = 0; beam < readings_.size(); ++beam) {
    const bool nearest = desc_.method == ScanMethod::nearest;
    readings_[beam] = read_range(nearest ? rendered_->nearest(beam) : rendered_->planar(beam), limits_);
  }
  if (casts(desc_.method)) {
    for (std::uint32_t i = 0; i < cast_.order.size(); ++i) {
      if (!tolerance_.met(readings_[cast_.order[i]])) to_cast_.push_back(i);
    }
  }
  if (!casts(desc_.method) && !traced_ && !desc_.truth.any()) publish();
}

// The bounds of rendered ranges need the true ranges of shapes that are drawn with flat sides. Null: there are none.
const ShapeRanges* LaserScanner::cast_shapes(unsigned threads) {
  if (!can_render(desc_) || !shapes_.find(*list_)) return nullptr;
  if (shape_directions_.empty()) {  // a scanner that renders has the same beams in each frame, from one origin
    for (std::size_t i = 0; i < beams_.size(); ++i) shape_directions_.push_back(beams_.direction(i));
  }
  shapes_.cast(*list_, context_.world_from_sensor, shape_directions_, threads);
  return &shapes_;
}

// Whether the scanner's own rays are those of its truth: all beams, without any effect.
bool LaserScanner::casts_every_beam() const { return may_cast() && !traced_ && (survey_ != nullptr || !renders()); }

void LaserScanner::cast(RayCaster& rays) {
  measures_truth_ = casts_every_beam();
  if (desc_.truth.any() && !measures_truth_) {
    true_hits_.resize(cast_.directions.size());
    cast_in_order(rays, context_.world_from_sensor, cast_, cast_.directions, true_hits_);
  }
  if (traced_) return cast_traced(rays);
  if (!may_cast()) {
    if (desc_.truth.any()) publish();
    return;
  }
  if (survey_) {
    cast_survey(rays);
  } else {
    cast_beams(rays);
  }
  publish();
}

void LaserScanner::cast_traced(RayCaster& rays) {
  const std::span<const Echo> detected = traced_->trace(context_, *list_, rays);
  ToleranceCheck check(tolerance_);
  for (std::size_t beam = 0; beam < detected.size(); ++beam) {
    const RangeEstimate range{detected[beam].range_m, detected[beam].error_bound_m};
    readings_[beam] = read_range(range, limits_);
    check.add(range, readings_[beam]);
  }
  if (casts(desc_.method) && desc_.method != ScanMethod::raycast) check.require(name_);
  publish(detected);
}

void LaserScanner::cast_beams(RayCaster& rays) {
  const bool every = !renders();
  if (!every) {
    cast_directions_.clear();
    for (const std::uint32_t i : to_cast_) cast_directions_.push_back(cast_.directions[i]);
  }
  const std::span<const glm::dvec3> directions = every ? cast_.directions : cast_directions_;
  hits_.resize(directions.size());
  CostModel work = renders() ? rendered_->work(list_->items.size()) : CostModel{};
  ToleranceCheck check(tolerance_);
  std::mutex checking;
  const auto read = [&](std::size_t first, std::size_t count) {
    ToleranceCheck checked(tolerance_);
    for (std::size_t i = first; i < first + count; ++i) {
      const RangeEstimate range{hits_[i].range_m, hits_[i].error_bound_m};
      BeamReading& reading = readings_[cast_.order[every ? i : to_cast_[i]]];
      reading = read_range(range, limits_);
      if (takes_tolerance(desc_.method)) checked.add(range, reading);
    }
    const std::lock_guard lock(checking);
    check.add(checked);
  };
  if (!directions.empty()) {
    const RayCounters before = rays.counters();
    cast_in_order(rays, context_.world_from_sensor, cast_, directions, hits_, read);
    add_cast(work, list_->items.size());
    add_rays(work, before, rays.counters());
  }
  check.require(name_);
  if (desc_.method == ScanMethod::automatic && !hits_splats_) choice_.measured(work, costs_);
}

// Uses the most exact readings of the survey: every beam as cast.
void LaserScanner::cast_survey(RayCaster& rays) {
  hits_.resize(cast_.directions.size());
  survey_->cast(rays, list_->items.size(), context_.world_from_sensor, cast_.order, cast_.directions, hits_);
  ToleranceCheck check(tolerance_);
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    const RangeEstimate range{hits_[i].range_m, hits_[i].error_bound_m};
    BeamReading& reading = readings_[cast_.order[i]];
    reading = read_range(range, limits_);
    check.add(range, reading);
  }
  check.require(name_);
  survey_->choose(readings_, costs_);
  choice_.take(*survey_, tolerance_);
  rendered_ = survey_->release_rendered();
  survey_.reset();
}

// Only this function changes the public scan, so the scan is always complete.
void LaserScanner::publish(std::span<const Echo> detected) {
  const auto [ranges_m, bounds_m] = scan_.overwrite_ranges();
  for (std::size_t beam = 0; beam < readings_.size(); ++beam) {
    ranges_m[beam] = readings_[beam].range_m;
    bounds_m[beam] = readings_[beam].error_bound_m;
  }
  if (running_) describe_beams();
  scan_.time_ns = context_.time.time_ns;
  scan_.world_from_sensor = context_.world_from_sensor;
  scan_.clear_channels();
  for (const ChosenScanEffect& each : effects_) each.effect->finish(context_, detected, scan_);
  if (desc_.truth.any()) {
    add_truth(desc_.truth,
              {.list = *list_,
               .world = world_,
               .world_from_sensor = context_.world_from_sensor,
               .order = cast_.order,
               .origins_m = cast_.origins_m,
               .directions = cast_.directions,
               .hits = measures_truth_ ? hits_ : true_hits_},
              scan_);
  }
  context_.before = {context_.time.time_ns, context_.world_from_sensor};
}

SensorReport LaserScanner::report() const {
  SensorReport report;
  if (const std::string names = traced_for(); !names.empty()) report.notes.push_back({"cast_for", names});
  if (const std::optional<double> share = cast_share()) report.notes.push_back({"cast_share", *share});
  if (desc_.method == ScanMethod::automatic) choice_.report(name_, report);
  return report;
}

std::optional<double> LaserScanner::cast_share() const {
  if (traced_) return 1;
  if (!may_cast()) return {};
  return static_cast<double>(hits_.size()) / static_cast<double>(cast_.directions.size());
}

}  // namespace simvis
