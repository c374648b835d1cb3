// A sensor behind timing faults: what it gives is what has arrived. sensors/timing_faults.h describes the faults.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/philox.h>
#include <simvis/scan.h>
#include <simvis/sensor.h>
#include "sensors/sensor_state.h"
#include "sensors/timing_faults.h"

namespace simvis {

/// A sensor whose measurements reach their consumers through these faults. What it gives is the last measurement that
/// has arrived; before the first one its outputs have no numbers. Reports are those of the last measurement that was
/// taken, which may still be under way or lost.
class DelayedSensor : public Sensor, public Stateful {
 public:
  DelayedSensor(std::unique_ptr<Sensor> sensor, const TimingFaults& faults, const SensorRandom& random);

  /// Called in each frame in which the sensor is on, after its cast() if it `has_measured`. Returns whether a
  /// measurement arrives in the frame. A frame that is made again gives the same.
  bool pass_on(const FrameTime& time, bool has_measured);
  /// In place of pass_on(), in a frame in which the sensor is off: loses what is under way.
  void lose(const FrameTime& time);
  /// Returns true if the last call of pass_on() or lose() was for the same frame as the call before it.
  bool is_made_again() const { return is_made_again_; }

  /// The true simulated times of the measurement that has arrived, in seconds; NaN: none has.
  double capture_time_s() const;
  double arrival_time_s() const;

  bool draws() const override { return sensor_->draws(); }
  void check(const TargetLimits& limits) const override { sensor_->check(limits); }
  void use_cost_model(const std::function<const CostModel&()>& costs) override { sensor_->use_cost_model(costs); }
  HistoryDependence history_dependence() const override { return HistoryDependence::measurements; }
  void skip_frame(const FrameTime& time, const glm::dmat4& pose) override { sensor_->skip_frame(time, pose); }
  void archive(StateArchive& state) override;
  SensorNeeds needs() const override { return sensor_->needs(); }
  void begin(const FrameTime& time) override;
  void sense(const SensedWorld& world) override { sensor_->sense(world); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override {
    sensor_->plan(world_from_sensor, list, plan);
  }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override {
    sensor_->collect(time, plan, results);
  }
  void cast(RayCaster& caster) override { sensor_->cast(caster); }
  Measurement measurement() const override { return state_.arrived->measurement; }
  std::vector<NumberOnRequest> on_request() const override;
  const Scan* scan() const override { return state_.arrived->scan ? &*state_.arrived->scan : nullptr; }
  const Reading* reading() const override { return state_.arrived->reading ? &*state_.arrived->reading : nullptr; }
  bool visualization() const override { return sensor_->visualization(); }
  std::string method() const override { return sensor_->method(); }
  bool shows_splats() const override { return sensor_->shows_splats(); }
  SensorReport report() const override { return sensor_->report(); }

 private:
  /// What a sensor gives of one measurement.
  struct Given {
    Measurement measurement;
    std::optional<Scan> scan;
    std::optional<Reading> reading;
    std::vector<NumberOnRequest> on_request;
    std::int64_t captured_ns = 0, arrives_ns = 0;  // true times; captured earlier than measured if it is a repetition
  };
  using SharedGiven = std::shared_ptr<const Given>;
  struct State {
    SharedGiven arrived;                // what consumers have; never null
    SharedGiven kept;                   // what a repetition gives; null: nothing yet
    std::deque<SharedGiven> under_way;  // by arrival
    std::int64_t latest_ns = 0;         // of all arrivals so far
    bool has_arrived = false;           // whether `arrived` is a measurement
  };

  void begin_frame(const FrameTime& time);
  void archive(StateArchive& state, State& all) const;
  void archive(StateArchive& state, SharedGiven& given) const;
  Given take() const;
  void capture(std::int64_t time_ns);
  void stamp(Given& given, std::int64_t measured_ns) const;

  std::unique_ptr<Sensor> sensor_;
  TimingFaults faults_;
  SensorRandom random_;
  SharedGiven nothing_;                   // what consumers have before the first measurement arrives
  State state_, before_;                  // now, and before the frame of frame_ns_
  std::optional<std::int64_t> frame_ns_;  // of the last begin_frame()
  bool is_made_again_ = false;
};

}  // namespace simvis
