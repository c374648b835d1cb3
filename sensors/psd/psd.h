// The sensor `psd` (position sensitive device): an infrared distance sensor that triangulates the spot of its own
// light.
//
//   <sensor type="psd" name="IR_LEFT" insert_at="ROBOT" pose_offset="0.1 0.1 0.05 0 0 30" noise="0.01"/>
//
// Method   Light leaves in a narrow cone about +x of the sensor frame, uniformly in all directions of the cone. A lens
//          images the returned light onto a strip of silicon, which measures the centroid of the light. A surface
//          element at depth Z along the axis is imaged at a position proportional to 1 / Z (triangulation). Its light
//          is proportional to its solid angle dw and falls with the square of its range r along the ray. The device
//          therefore reports
//              1 / range = sum(dw / r^2 * 1 / Z) / sum(dw / r^2)
//          over the cone: for a wall perpendicular to the axis its distance; for surfaces at several distances a value
//          between them, closer to the near one. Directions that hit nothing return no light and do not count. The sums
//          run over the pixels of a small depth view whose centres lie in the cone.
//          Colour and slope of the surface have no effect, ambient light does not disturb, and any amount of light is
//          enough.
// Splats   A pixel shows the Gaussian splat behind which at most half of the light is left, if it comes before what is
//          drawn (engine/splats/splat_rays.h): it returns light as any surface does.
// Voltage  The voltage follows the curve of a data sheet, see voltage_curve.h; noise is then added without clipping.
// Values   value("range_m") is the range along the axis in metres, before noise; 0 if it is below range_min, +infinity
//          if it is above range_max or nothing is hit. value("voltage_v") is the output voltage, whether or not the
//          range is within its limits.
// Files    SENSOR.csv with the columns range_m and voltage_v.
#pragma once

#include <string>
#include <vector>

#include <simvis/philox.h>
#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/psd/voltage_curve.h"
#include "sensors/range_limits.h"

namespace simvis {

struct PsdDesc {
  double opening_rad = glm::radians(5.0);  ///< full angle of the cone, (0, pi/2]
  std::uint32_t resolution_px = 16;        ///< pixels of the depth view across the cone
  MeasuredLimits limits{0.1, 0.8};
  double noise_v = 0;  ///< standard deviation
  std::uint64_t seed = 0;

  static AttributeRows<PsdDesc> rows();
};

class Psd : public ReadingSensor {
 public:
  Psd(std::string name, const PsdDesc& desc, VoltageCurve curve);

  bool draws() const override { return true; }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& caster) override;
  std::string method() const override { return "centroid"; }
  bool shows_splats() const override { return shows_splats_; }

 private:
  bool is_in_cone(const glm::dvec2& place) const;
  glm::dvec2 place_of(std::size_t pixel) const;
  void stop_at_splats(unsigned threads);
  double range_of(std::span<const double> per_depth) const;
  void measure();

  std::string name_;
  PsdDesc desc_;
  VoltageCurve curve_;
  SensorRandom random_;
  Pinhole pinhole_;
  double rim_squared_;              // square of the cone's radius on the plane at 1 m, in m^2
  const DrawList* list_ = nullptr;  // of this frame, as all that follows
  FrameTime time_;
  std::size_t pass_ = 0;  // in the plan
  bool looks_at_splats_ = false, shows_splats_ = false;
  std::vector<double> per_depth_;  // 1 / Z of each pixel in 1/m
};

}  // namespace simvis
