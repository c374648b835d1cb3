// Sensors that measure a few numbers, or rows of them.
#pragma once

#include <initializer_list>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>

namespace simvis {

/// A sensor whose measurement is a Reading. A derived class gives the columns to the constructor and calls
/// set_reading() once in each measurement, in collect() or cast(). Files, values, messages and clients follow from the
/// reading.
class SIMVIS_API ReadingSensor : public Sensor {
 public:
  /// Keeps the pose. A sensor that draws or casts overrides it and calls it first.
  void plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan&) override {
    world_from_sensor_ = world_from_sensor;
  }
  /// A sensor that adds views overrides it.
  bool draws() const override { return false; }
  const Reading* reading() const override { return &reading_; }
  Measurement measurement() const override { return reading_; }
  /// Motion is followed in skipped frames too.
  HistoryDependence history_dependence() const override {
    const SensorNeeds needs = this->needs();
    const bool looks_back = needs.motion || needs.item_motion || needs.item_moves || !needs.joints_of.empty();
    return looks_back ? HistoryDependence::poses : HistoryDependence::none;
  }

 protected:
  /// `one_row` is false for a table whose number of rows varies.
  explicit ReadingSensor(const std::vector<TableColumn>& columns, bool one_row = true);
  /// Replaces the columns and makes the reading one row of them; for a sensor that learns them from the scene.
  void set_columns(const std::vector<TableColumn>& columns);
  /// Sets a number of the reading beside its columns; `name` is static text.
  void set_constant(std::string_view name, double value);
  /// Publishes whole rows, measured at the pose of plan(). Their number of values must be a multiple of the number of
  /// columns (asserted).
  void set_reading(const FrameTime& time, std::vector<double> values);
  /// As set_reading(), for one row; it allocates nothing.
  void set_reading(const FrameTime& time, std::initializer_list<double> row);
  /// The pose of the last plan().
  const glm::dmat4& world_from_sensor() const { return world_from_sensor_; }

 private:
  void stamp(const FrameTime& time);
  Reading reading_;
  glm::dmat4 world_from_sensor_{1.0};
};

}  // namespace simvis
