#include "sensors/thermal_camera/bolometer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sensors/thermal_camera/band_radiance.h"

namespace simvis {

AttributeRows<BolometerDesc> BolometerDesc::rows() {
  using Desc = BolometerDesc;
  constexpr AttributeLimits kKelvin{.min = 0, .max = 100};
  return {row(&Desc::netd_k, "netd", "K", kKelvin,
              "standard deviation of the noise, as a temperature of a black body of 300 K"),
          row(&Desc::fixed_pattern_k, "fixed_pattern", "K", kKelvin,
              "standard deviation of the offsets of pixels, as a temperature of a black body of 300 K"),
          row(&Desc::time_constant_s, "time_constant", "s", AttributeLimits{.min = 0, .max = 1000},
              "time in which a pixel follows a step of radiance to a share of 1 - 1/e")};
}

Bolometer::Bolometer(const BolometerDesc& desc, std::uint64_t seed, const std::string& sensor, std::size_t pixels)
    : desc_(desc), noise_(seed, sensor + "/netd"), pixels_(pixels) {
  if (desc.fixed_pattern_k == 0) return;
  const SensorRandom random(seed, sensor + "/fixed_pattern");
  const double deviation = desc.fixed_pattern_k * band_radiance_slope(kNetdTemperature_k);
  pattern_.reserve(pixels);
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) pattern_.push_back(deviation * random.gaussian(0, pixel, 0));
}

void Bolometer::read(const FrameTime& time, std::vector<double>& radiance) {
  if (desc_.time_constant_s > 0) lag(time.time_ns, radiance);
  for (std::size_t pixel = 0; pixel < pattern_.size(); ++pixel) radiance[pixel] += pattern_[pixel];
  if (desc_.netd_k == 0) return;
  const double deviation = desc_.netd_k * band_radiance_slope(kNetdTemperature_k);
  for (std::uint32_t pixel = 0; pixel < radiance.size(); ++pixel) {
    radiance[pixel] += deviation * noise_.gaussian(random_key(time), pixel, 0);
  }
}

void Bolometer::lag(std::int64_t time_ns, std::vector<double>& radiance) {
  if (!last_.signal.empty() && time_ns > last_.time_ns) before_ = std::move(last_);
  last_ = {.time_ns = time_ns, .radiance = radiance, .signal = {}};
  if (!before_.signal.empty()) {
    const double between_s = static_cast<double>(time_ns - before_.time_ns) / 1e9, constant_s = desc_.time_constant_s;
    const double left = std::exp(-between_s / constant_s);
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      const double behind = (radiance[i] - before_.radiance[i]) / between_s * constant_s;
      radiance[i] += -behind + (before_.signal[i] - before_.radiance[i] + behind) * left;
    }
  }
  last_.signal = radiance;
}

void Bolometer::archive(StateArchive& state) {
  for (State* const each : {&before_, &last_}) {
    state(*each);
    for (const std::vector<double>& all : {each->radiance, each->signal}) {
      state.require(all.size() == (each->signal.empty() ? 0 : pixels_));
      state.require(std::ranges::all_of(all, [](double number) { return std::isfinite(number); }));
    }
    state.require_past(each->time_ns);
  }
  state.require(before_.signal.empty() || (!last_.signal.empty() && before_.time_ns < last_.time_ns));
}

}  // namespace simvis
