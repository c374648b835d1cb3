#include "sensors/navigation/barometer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace simvis {

namespace {

constexpr double kStandardPressure_pa = 101325, kEarthRadius_m = 6356766, kSeaLevel_k = 288.15, kLapse_k_m = 0.0065,
                 kGravity_mps2 = 9.80665, kGas_j_kg_k = 287.05287;
// The tropopause.
constexpr double kTropopause_m = 11000, kTropopause_k = kSeaLevel_k - kLapse_k_m * kTropopause_m;
// Heights beyond these count as these: the formulas have poles, and nothing flies there.
constexpr double kLowest_m = -5000, kHighest_m = 80000;
constexpr double kPressureExponent = kGravity_mps2 / (kGas_j_kg_k * kLapse_k_m);

const std::vector<TableColumn> kBarometerColumns{
    {.name = "pressure_pa", .format = "%.12g", .unit = "Pa", .meaning = "static pressure of the air"},
    {.name = "altitude_m",
     .format = "%.12g",
     .unit = "m",
     .meaning = "height at which the standard atmosphere has this pressure",
     .nothing = std::numeric_limits<double>::quiet_NaN(),
     .in_message = false}};

const SensorRegistration kBarometerRegistration(
    {.name = "barometer",
     .summary = "The static pressure of the air, by the International Standard Atmosphere up to 20 km.",
     .notes = "The altitude is the height at which the standard atmosphere has the measured pressure.",
     .message = "sensor_msgs/msg/FluidPressure",
     .attributes = rows_of<BarometerDesc>().table(),
     .create = create_sensor<Barometer, BarometerDesc>,
     .outputs = column_outputs_of<kBarometerColumns>,
     .sees_shapes = false});

}  // namespace

AttributeRows<BarometerDesc> BarometerDesc::rows() {
  using Desc = BarometerDesc;
  return {row(&Desc::elevation_m, "elevation", "m", {.min = -5000, .max = 20000},
              "height of the world's origin above mean sea level"),
          row(&Desc::sea_level_pressure_pa, "sea_level_pressure", "Pa", {.min = 0, .max = 1e6, .open_min = true},
              "pressure of the air at sea level: the weather"),
          nested(&Desc::noise, noise_rows("", "the pressure", "Pa")), kRateAttribute};
}

double standard_pressure_pa(double height_m, double sea_level_pressure_pa) {
  const double geopotential_m = kEarthRadius_m * height_m / (kEarthRadius_m + height_m);
  const double below_m = std::min(geopotential_m, kTropopause_m), above_m = geopotential_m - below_m;
  return sea_level_pressure_pa * std::pow(1 - kLapse_k_m * below_m / kSeaLevel_k, kPressureExponent) *
         std::exp(-kGravity_mps2 * above_m / (kGas_j_kg_k * kTropopause_k));
}

double pressure_height_m(double pressure_pa, double sea_level_pressure_pa) {
  const double at_tropopause = std::pow(kTropopause_k / kSeaLevel_k, kPressureExponent),
               share = pressure_pa / sea_level_pressure_pa;
  const double geopotential_m =
      share >= at_tropopause
          ? kSeaLevel_k / kLapse_k_m * (1 - std::pow(share, 1 / kPressureExponent))
          : kTropopause_m - std::log(share / at_tropopause) * kGas_j_kg_k * kTropopause_k / kGravity_mps2;
  return kEarthRadius_m * geopotential_m / (kEarthRadius_m - geopotential_m);
}

Barometer::Barometer(const std::string& name, const BarometerDesc& desc)
    : ReadingSensor(kBarometerColumns), desc_(desc), noise_(desc.noise, {desc.seed, name + "/pressure"}) {}

void Barometer::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const double period_s = sample_period_s(rate_hz, time);
  set_constant("pressure_variance", desc_.noise.white_variance(period_s));
  const double height_m = std::clamp(desc_.elevation_m + world_from_sensor()[3].z, kLowest_m, kHighest_m);
  const double pressure_pa =
      noise_.apply(standard_pressure_pa(height_m, desc_.sea_level_pressure_pa), 0, time, period_s);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  set_reading(time, {pressure_pa, pressure_pa > 0 ? pressure_height_m(pressure_pa, kStandardPressure_pa) : kNone});
}

}  // namespace simvis
