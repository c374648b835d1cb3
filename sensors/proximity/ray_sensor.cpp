#include "sensors/proximity/ray_sensor.h"

#include <utility>

#include "effects/reported_range.h"

namespace simvis {

RaySensor::RaySensor(std::vector<TableColumn> columns, std::string name, std::string_view purpose, const Value& value,
                     std::vector<glm::dvec3> directions)
    : ReadingSensor(std::move(columns)),
      name_(std::move(name)),
      reason_(std::string(purpose) + " " + name_),
      noise_(value.noise, {value.seed, name_ + "/" + std::string(value.what)}),
      directions_(std::move(directions)),
      hits_(directions_.size()) {}

void RaySensor::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
  plan.casts.push_back({.name = name_, .reason = reason_, .max_rays = directions_.size()});
}

std::span<const RayHit> RaySensor::hits_of(RayCaster& rays) {
  rays.cast(world_from_sensor(), directions_, hits_);
  return hits_;
}

double RaySensor::noisy(double value) const { return noise_.apply(value, 0, time_, sample_period_s(rate_hz, time_)); }

double RaySensor::reported_range(const MeasuredLimits& limits, double range_m) const {
  const double limited_m = limited_range(limits, range_m);
  return is_between_limits(limited_m) ? reported_range_m(noisy(limited_m)) : limited_m;
}

double RaySensor::white_variance() const { return noise_.desc().white_variance(sample_period_s(rate_hz, time_)); }

}  // namespace simvis
