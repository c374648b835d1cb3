// A position sensitive device: an infrared distance sensor that triangulates the spot of its own light.
//
//   <sensor type="psd" name="IR_LEFT" insert_at="ROBOT" pose_offset="0.1 0.1 0.05 0 0 30" noise="0.01"/>
//
// How it measures  light goes out in a narrow cone about +x of the sensor frame, equally in all directions of the cone;
//          a lens throws what comes back onto a strip of silicon, which gives the centroid of the light on it. A
//          surface element seen at depth Z along the axis is imaged at a place proportional to 1 / Z (triangulation),
//          with the light of its solid angle dw, weaker with the square of its distance r along the ray. So the device
//          reports
//              1 / range = sum(dw / r^2 * 1 / Z) / sum(dw / r^2)
//          over the cone: of a wall square to the axis its distance; of things at several distances something between,
//          nearer to the near one. Where nothing is hit no light comes back, and nothing counts. The sums go over the
//          pixels of a small depth view whose centres lie in the cone.
//          Colour and slant of the surface do not matter, ambient light does not disturb, and any light is enough.
// Voltage  from the curve of a datasheet, see voltage_curve.h; then noise is added, not clipped.
// Values   value("range_m"): along the axis, before noise; 0: nearer than range_min, +infinity: farther than range_max
//          or nothing there. value("voltage_v"): what the device gives, whether or not the range is within its limits.
// Files    SENSOR.csv with the columns range_m and voltage_v.
#pragma once

#include <array>
#include <string>

#include <simvis/philox.h>
#include <simvis/sensor.h>
#include "sensors/psd/voltage_curve.h"

namespace simvis {

struct PsdDesc {
  double opening_rad = glm::radians(5.0);  ///< of the cone, from side to side, (0, pi/2]
  std::uint32_t resolution_px = 16;        ///< pixels of the depth view across the cone
  double range_min_m = 0.1, range_max_m = 0.8;
  double noise_v = 0;  ///< standard deviation
  std::uint64_t seed = 0;
};

/// What the attributes of a psd ask for. Throws InputError at a range_max below range_min.
PsdDesc psd_desc(const SensorContext& context);

class Psd : public Sensor {
 public:
  Psd(std::string name, const PsdDesc& desc, VoltageCurve curve);

  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::span<const NamedValue> values() const override { return values_; }
  void write(OutputSink& sink) const override;
  std::string method() const override { return "centroid"; }

 private:
  double range_of(std::span<const float> depth) const;

  std::string name_;
  PsdDesc desc_;
  VoltageCurve curve_;
  SensorRandom random_;
  Pinhole pinhole_;
  std::size_t pass_ = 0;  // of this frame's plan
  std::array<NamedValue, 2> values_;
};

}  // namespace simvis
