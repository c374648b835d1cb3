// The sensor `light_sensor`: the illuminance at a point, in lux, light that surfaces reflect included.
//
//   <sensor type="light_sensor" name="LUX" insert_at="ROBOT" pose_offset="0 0 0.3 0 -90 0"/>
//
// Frame    the light-sensitive plane is that of y and z at the origin, and faces +x of the sensor frame.
// Model    E = integral of L cos(a) over the hemisphere in front, with L the luminance that arrives and a the angle to
// +x
//          (cosine receptor of photometry: ISO/CIE 19476), in two parts:
//          Lights   directional, point and spot lights have no area, so no picture shows them. Each adds its
//          illuminance
//                   by the laws of KHR_lights_punctual: intensity / distance^2, cone and range included, times cos(a).
//                   A light that casts shadows is tested with one ray; any other passes through objects, as in
//                   pictures.
//          Surfaces what the sensor sees is rendered into five sides of a cube of `resolution` pixels, lit, shadowed
//          and
//                   emitting as in a camera. A pixel adds its luminance times cos(a) times its solid angle. The weights
//                   are scaled so that their sum is exactly pi. Where nothing is hit, the environment's ambient
//                   radiance arrives, which also lights surfaces.
//          Luminance is 0.2126 R + 0.7152 G + 0.0722 B of linear colour (ITU-R BT.709), in cd/m2 where lights are in
//          lux and candela.
// Values   illuminance_lx; direct_lx and reflected_lx, its two parts without noise.
// Noise    of the illuminance: sensors/noise_model.h.
// Message  sensor_msgs/Illuminance.
// Limit    light is reflected once, as in pictures: the colour of a wall is not lit by another wall.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

struct LightSensorDesc {
  std::uint32_t resolution_px = 64;  ///< along a side of the cube
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<LightSensorDesc> rows();
};

class LightSensor : public ReadingSensor {
 public:
  LightSensor(std::string name, const LightSensorDesc& desc);

  bool draws() const override { return true; }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  void cast(RayCaster& rays) override;
  std::string method() const override { return "rendered hemisphere"; }

 private:
  double direct_lx(RayCaster& rays) const;

  static constexpr std::uint32_t kSides = 5;
  std::string name_;
  LightSensorDesc desc_;
  NoiseModel noise_;
  std::array<std::vector<double>, kSides> weights_;  // by pixel: cosine times solid angle
  std::size_t pass_ = 0;                             // in this frame's plan
  const DrawList* list_ = nullptr;                   // of this frame
  FrameTime time_;
  double reflected_lx_ = 0;
};

}  // namespace simvis
