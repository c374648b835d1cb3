// The effects of a laser scanner on scans that a test makes up, without a scene or a device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <simvis/command.h>
#include <simvis/scan_effect.h>
#include <simvis/sensor.h>

namespace simvis::test {

/// Samples of a statistical test, and its size: a right program fails one such check in a million, and always or never.
/// Two-sided quantile of the normal distribution; one-sided for kNormalQuantile.
inline constexpr std::uint32_t kSamples = 1'000'000;
inline constexpr double kSigmas = 4.892, kNormalQuantile = 4.753;

/// What these attributes of a laser scanner call for.
inline std::vector<ChosenScanEffect> effects_of(const std::string& attributes, std::uint64_t seed = 0,
                                                const std::string& name = "SCAN") {
  const std::string xml = R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" )" + attributes + "/>";
  const std::vector<Command> commands = parse_commands(xml, "<string>", ".");
  const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type("laser_scanner"));
  const AttributeValues values(commands.at(0), table, kSensorCommonAttributes);
  return scan_effects({values, 1, kSamples, values.number("range_max"), seed, name});
}

/// A scan of these numbers, which have the shapes of those of Scan. Bounds are 0 without `bounds_m`.
inline Scan scan_of_numbers(SharedArray<double> azimuths_rad, SharedArray<double> elevations_rad,
                            const std::vector<float>& ranges_m, const std::vector<float>& bounds_m = {}) {
  Scan scan(static_cast<std::uint32_t>(elevations_rad.size()), static_cast<std::uint32_t>(azimuths_rad.size()));
  scan.set_angles(std::move(azimuths_rad), std::move(elevations_rad));
  const auto [ranges, bounds] = scan.edit_ranges();
  std::ranges::copy(ranges_m, ranges.begin());
  std::ranges::copy(bounds_m, bounds.begin());
  return scan;
}

/// One ring that reads `range_m` throughout.
inline Scan even_scan(float range_m, std::uint32_t beams = kSamples) {
  Scan scan(1, beams);
  std::ranges::fill(scan.edit_ranges().range_m, range_m);
  return scan;
}

/// The scan when all effects are through with it, in frame `frame`.
inline Scan finished(const std::vector<ChosenScanEffect>& effects, Scan scan, std::uint64_t frame = 0) {
  const ScanContext moment{.time = {.index = frame}, .rings = 1, .beams = scan.beams};
  for (const ChosenScanEffect& each : effects) each.effect->finish(moment, {}, scan);
  return scan;
}

/// P(X < x) of the standard normal distribution: the density, integrated by the midpoint rule (error below 1e-9).
inline double normal_below(double x) {
  constexpr double kStep = 1e-4, kDensity = 0.39894228040143268;  // 1 / sqrt(2 pi)
  double area = 0.5;
  const int steps = static_cast<int>(std::ceil(std::abs(x) / kStep));
  const double width = steps > 0 ? x / steps : 0;
  for (int i = 0; i < steps; ++i) area += width * kDensity * std::exp(-0.5 * std::pow((i + 0.5) * width, 2));
  return area;
}

/// What at most this many of n independent events of probability p differ from n p by.
inline double binomial_bound(double n, double p) { return kSigmas * std::sqrt(n * p * (1 - p)) + 1; }

}  // namespace simvis::test
