// The effects of a laser scanner on scans that a test makes up, without a scene or a device.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
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

/// One ring that reads `range_m` throughout.
inline Scan even_scan(float range_m, std::uint32_t beams = kSamples) {
  Scan scan;
  scan.rings = 1;
  scan.beams = beams;
  scan.range_m.edit().assign(beams, range_m);
  scan.error_bound_m.edit().assign(beams, 0);
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
