// The sensor `radar`: detections with range, direction and radial speed, as an automotive radar gives them.
//
//   <sensor type="radar" name="RADAR" insert_at="CAR" cross_sections="TRUCK:100 PERSON:0.5"/>
//
// Frame    the antenna looks along +x of the sensor frame; azimuth is counter-clockwise about +z, elevation upwards.
// Model    The field of view is a grid of rays, `angle_step` apart. A ray that meets a surface at range R stands for
//          the solid angle w of its cell, and so for the projected area A = R^2 w. Its radar cross section is
//              s = reflectivity A,
//          which makes that of a large conducting sphere its projected area, pi r^2 (geometrical optics). For parts in
//          `cross_sections` (NAME:SQUARE_METRES, all that stands at the part's insertion point), the given cross
//          section is divided among the rays that meet the part, by their areas: a part that is half hidden keeps it.
//          Each ray returns the power
//              P = power G^2 L^2 s / ((4 pi)^3 R^4 losses),   L = c / frequency
//          (radar equation: Skolnik, "Introduction to Radar Systems", 2001, section 1.2), with the antenna gain G alike
//          in the whole field of view. Powers of rays in one cell of range, azimuth and radial speed add up. A cell is
//          detected if its power is at least `threshold` times the noise k T0 bandwidth noise_figure, T0 = 290 K. Cells
//          of a field of view all around fill the turn in even number: their size in azimuth is the nearest such share,
//          and one of them has its middle straight behind the radar.
// Speed    d/dt of the range: the motion of the matter that the ray meets (turning parts too) and that of the sensor,
//          since the previous measurement of the radar. Above 0 it moves away. 0 at the first one.
// Values   a table with a row for each detection, by range, azimuth and speed: range_m, azimuth_rad, elevation_rad and
//          radial_speed_m_s, means of the rays by power; snr_db; cross_section_m2, the sum; x_m, y_m, z_m in the sensor
//          frame, from the measured range and angles.
//          -pi <= azimuth_rad <= pi.
// Noise    of range, azimuth and speed: sensors/noise_model.h. Each row has white noise of its own; the turn-on bias
//          and the drift are those of the radar, alike in all rows. A noisy range is at least 0.
// Message  sensor_msgs/PointCloud2.
// Limits   no echoes over several surfaces, no side lobes, no ambiguity of range or speed.
#pragma once

#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/range_limits.h"

namespace simvis {

struct RadarDesc {
  struct CrossSection {
    std::string part;
    double square_m = 0;
  };
  double frequency_hz = 77e9, power_w = 0.01, gain_db = 25, losses_db = 3;
  double noise_figure_db = 12, bandwidth_hz = 1000, threshold_db = 13;
  double horizontal_fov_rad = glm::radians(60.0), vertical_fov_rad = glm::radians(10.0),
         angle_step_rad = glm::radians(0.5);
  MeasuredLimits limits{0.5, 150};
  double range_resolution_m = 0.5, azimuth_resolution_rad = glm::radians(2.0), speed_resolution_mps = 0.25;
  double reflectivity = 1;
  std::vector<CrossSection> cross_sections{};
  NoiseDesc range{}, azimuth{}, speed{};
  std::uint64_t seed = 0;

  static AttributeRows<RadarDesc> rows();
  /// Throws InputError if it has too many rays.
  void complete(const SensorContext& context);

  /// Received power of a cross section at a range, and the power of the noise, in watts.
  double received_w(double square_m, double range_m) const;
  double noise_w() const;
};

class Radar : public ReadingSensor {
 public:
  Radar(std::string name, const RadarDesc& desc);

  SensorNeeds needs() const override;
  void sense(const SensedWorld& world) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { time_ = time; }
  void cast(RayCaster& rays) override;
  std::string method() const override { return "raycast"; }

 private:
  struct Ray {
    double azimuth_rad, elevation_rad, solid_angle_sr;
  };
  struct Echo {
    std::size_t ray;
    double range_m, speed_mps, square_m, power_w;
  };
  std::vector<Echo> echoes(RayCaster& rays);
  void give_cross_sections(std::vector<Echo>& echoes) const;

  std::string name_;
  RadarDesc desc_;
  NoiseModel range_, azimuth_, speed_;
  std::vector<Ray> rays_;
  std::vector<glm::dvec3> directions_;  // of rays_
  std::vector<RayHit> hits_;            // of rays_
  const SensedWorld* world_ = nullptr;  // of this frame
  FrameTime time_;
};

}  // namespace simvis
