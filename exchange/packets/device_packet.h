// Data packets of real laser scanners, as bytes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <simvis/scan.h>
#include "effects/scanner/reflectivity.h"

namespace simvis {

/// A datagram that a device sends.
struct DevicePacket {
  std::int64_t time_ns = 0;  ///< when the device sends it, by its own clock: after the last beam that it holds fired
  std::string bytes{};       ///< what follows the header of UDP
};

/// What the clocks of devices show at time 0 of the simulation. The beams of the first scan fire before that.
inline constexpr std::int64_t kDeviceClock_ns = 3'600'000'000'000;

/// A range in units of a device; 0, which means that nothing returned, for no range and for one beyond `max`.
inline std::uint32_t quantised_range(double range_m, double unit_m, std::uint32_t max) {
  if (!(range_m > 0) || !std::isfinite(range_m)) return 0;
  const double units = std::round(range_m / unit_m);
  return units <= max ? static_cast<std::uint32_t>(units) : 0;
}

/// The calibrated_reflectivity() of beam i; 0 without an intensity or a range.
inline std::uint8_t quantised_reflectivity(const Scan& scan, const SharedNumbers<double>& intensity, std::size_t i) {
  const double range_m = scan.range_m[i];
  if (intensity.empty() || !(range_m > 0) || !std::isfinite(range_m)) return 0;
  const double reflectivity = calibrated_reflectivity(intensity[i], range_m);
  return reflectivity > 0 ? static_cast<std::uint8_t>(reflectivity) : 0;  // a plug-in may give NaN
}

/// Photons of a device for an intensity of 1 / m^2. No device states such a number: this one leaves a white wall at
/// 1 m, perpendicular to the beam, in 16 bits.
inline constexpr double kSignalUnit = 10000;

/// The intensity of beam i in photons; 0 without intensities.
inline std::uint16_t quantised_signal(const SharedNumbers<double>& intensity, std::size_t i) {
  if (intensity.empty()) return 0;
  const double photons = std::round(kSignalUnit * intensity[i]);
  return static_cast<std::uint16_t>(photons >= 0xffff ? 0xffff : photons > 0 ? photons : 0);
}

}  // namespace simvis
