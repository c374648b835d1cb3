// What the sensors range, touch and sonar share: rays from the sensor's origin, and one noisy value made of their hits.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include "sensors/noise_model.h"
#include "sensors/range_limits.h"

namespace simvis {

class RaySensor : public ReadingSensor {
 public:
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { time_ = time; }
  std::string method() const override { return "raycast"; }

 protected:
  struct Value {
    std::string_view what;  ///< of the random numbers: "range"
    NoiseDesc noise;
    std::uint64_t seed = 0;
  };
  /// `purpose` says what the rays are: "beam of range sensor". `directions` are unit vectors in the sensor frame.
  RaySensor(std::vector<TableColumn> columns, std::string name, std::string_view purpose, const Value& value,
            std::vector<glm::dvec3> directions = {{1, 0, 0}});

  /// The hits of the rays, in the order of directions(), in cast() only.
  std::span<const RayHit> hits_of(RayCaster& rays);
  double noisy(double value) const;
  /// The range that is reported of a true one: 0 below the limits, +infinity beyond them, between them noisy and at
  /// least 0, as reported_range_m().
  double reported_range(const MeasuredLimits& limits, double range_m) const;
  double white_variance() const;
  void set_row(std::vector<double> values) { set_reading(time_, std::move(values)); }
  const std::vector<glm::dvec3>& directions() const { return directions_; }
  const DrawList& list() const { return *list_; }  ///< of this frame

 private:
  std::string name_, reason_;
  NoiseModel noise_;
  std::vector<glm::dvec3> directions_;
  std::vector<RayHit> hits_;
  const DrawList* list_ = nullptr;
  FrameTime time_;
};

}  // namespace simvis
