// The sensor `barometer`: the static pressure of the air.
//
//   <sensor type="barometer" name="BARO" insert_at="DRONE" elevation="240" stddev="2"/>
//
// Model    International Standard Atmosphere (ISO 2533:1975) up to 20 km: with the geopotential height
//          H = r h / (r + h), r = 6356766 m, T0 = 288.15 K, the lapse rate L = 6.5 K/km, g = 9.80665 m/s2 and
//          R = 287.05287 J/(kg K), the pressure is
//              p = p0 (1 - L H / T0)^(g / (R L))           up to H = 11 km,
//              p = p11 exp(-g (H - 11 km) / (R 216.65 K))  above.
//          h is `elevation`, the height of the world's origin above mean sea level, plus z; from -5 km to
//          80 km, beyond which it counts as the limit. `sea_level_pressure` is p0: the weather.
// Values   pressure_pa. altitude_m: the height h at which the standard atmosphere (101325 Pa at sea level) has the
//          measured pressure, as altimeters display it.
// Noise    of the pressure: sensors/noise_model.h.
// Message  sensor_msgs/FluidPressure.
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {

struct BarometerDesc {
  double elevation_m = 0, sea_level_pressure_pa = 101325;
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<BarometerDesc> rows();
};

/// Pressure at a height above sea level, and the height at a pressure. Both are finite, the pressure is above 0.
double standard_pressure_pa(double height_m, double sea_level_pressure_pa);
double pressure_height_m(double pressure_pa, double sea_level_pressure_pa);

class Barometer : public ReadingSensor {
 public:
  Barometer(const std::string& name, const BarometerDesc& desc);

  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "standard atmosphere"; }

 private:
  BarometerDesc desc_;
  NoiseModel noise_;
};

}  // namespace simvis
