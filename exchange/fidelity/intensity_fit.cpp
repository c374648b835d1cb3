#include <algorithm>
#include <cmath>
#include <numeric>

#include "exchange/fidelity/light_fit.h"

namespace simvis {
namespace {

constexpr int kGaussSteps = 12;
constexpr double kPriorLogGain = 20, kPriorExponent = 10;
constexpr double kMinAngle_rad = 1e-9;  // a ring without any error still has that of its numbers

// What a surface reflects differs from place to place.
constexpr double kClusterAngle_rad = 20 * 0.017453292519943295;

std::uint64_t light_cluster(const RecordedBeam& beam) {
  const auto across = static_cast<std::uint64_t>((beam.azimuth_rad + 4) / kClusterAngle_rad);
  return across << 32 | static_cast<std::uint64_t>((beam.elevation_rad + 2) / kClusterAngle_rad);
}

struct LightSample {
  std::uint64_t cluster;
  double intensity, log_reflectance, log_cosine, log_range;
  std::uint32_t ring;
  double by_azimuth, by_elevation;  // derivatives of log_cosine by the angles of the ring
};

// The optical depth of the scene's fog on the way out and back: the share exp(-depth) of the light remains.
double fog_depth(const SceneBeam& beam, const Medium& medium) {
  return 2 * medium.laser_extinction_per_m * beam.range_m;
}

double modelled(const LightSample& sample, const double (&unknown)[3]) {
  return std::exp(unknown[0] + sample.log_reflectance + unknown[1] * sample.log_cosine - unknown[2] * sample.log_range);
}

double sum_of_squares(const std::vector<LightSample>& samples, const double (&unknown)[3]) {
  double sum = 0;
  for (const LightSample& sample : samples) {
    const double residual = sample.intensity - modelled(sample, unknown);
    sum += residual * residual;
  }
  return sum;
}

// One step of Gauss and Newton.
LeastSquaresFit light_step(const std::vector<LightSample>& samples, const std::vector<RingDeviation>& rings,
                           const double (&unknown)[3]) {
  std::vector<double> prior = {kPriorLogGain, kPriorExponent, kPriorExponent};
  for (const RingDeviation& ring : rings) {
    prior.push_back(std::max(ring.azimuth_rad, kMinAngle_rad));
    prior.push_back(std::max(ring.elevation_rad, kMinAngle_rad));
  }
  const double count = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0,
                                      [](double sum, const LightSample& sample) { return sum + sample.intensity; }) /
                      count;
  constexpr double kMinRelative = 1e-9;  // an intensity without any error still has that of its number
  const double variance = std::max(sum_of_squares(samples, unknown) / count, kMinRelative * kMinRelative * mean * mean);
  return least_squares(samples.size(), prior, [&](std::size_t i) {
    const LightSample& sample = samples[i];
    const double model = modelled(sample, unknown);
    LeastSquaresRow row{.cluster = sample.cluster, .value = sample.intensity - model, .weight = 1 / variance};
    row.add(0, model);
    row.add(1, model * sample.log_cosine);
    row.add(2, -model * sample.log_range);
    if (sample.ring >= rings.size()) return row;
    row.add(3 + 2 * sample.ring, model * unknown[1] * sample.by_azimuth);
    row.add(4 + 2 * sample.ring, model * unknown[1] * sample.by_elevation);
    return row;
  });
}

}  // namespace

double power_of(const SceneBeam& beam, const Medium& medium) {
  return beam.reflectance * beam.cosine / (beam.range_m * beam.range_m) * std::exp(-fog_depth(beam, medium));
}

double IntensityFit::at(const SceneBeam& beam, const Medium& medium) const {
  return std::exp(fit.value[0] - fog_depth(beam, medium)) * beam.reflectance * std::pow(beam.cosine, fit.value[1]) /
         std::pow(beam.range_m / kReferenceRange_m, fit.value[2]);
}

std::optional<IntensityFit> fit_intensity(const BeamRecording& recording, const SceneBeamOf& scene,
                                          const Medium& medium, const std::vector<bool>& used,
                                          const std::vector<RingDeviation>& rings) {
  IntensityFit result;
  std::vector<LightSample> samples;
  for (std::size_t i = 0; i < recording.beams.size(); ++i) {
    const double intensity = recording.beams[i].intensity;
    const SceneBeam beam = scene(i);
    if (!used[i] || !std::isfinite(intensity) || !(beam.reflectance > 0)) continue;
    if (intensity >= recording.max_intensity) {
      ++result.saturated;
      continue;
    }
    samples.push_back({light_cluster(recording.beams[i]), intensity,
                       std::log(beam.reflectance) - fog_depth(beam, medium), std::log(beam.cosine),
                       std::log(beam.range_m / kReferenceRange_m), recording.beams[i].ring,
                       -glm::dot(beam.normal, by_azimuth(beam.direction)) / beam.cosine,
                       -glm::dot(beam.normal, by_elevation(beam.direction)) / beam.cosine});
  }
  if (samples.size() < kMinIntensities) return std::nullopt;
  // Begins with a matte surface whose intensity falls with the square of the range, or does not fall: what fits better.
  double unknown[3] = {0, 1, 0}, best = std::numeric_limits<double>::infinity();
  for (const double range_exponent : {0.0, 1.0, 2.0}) {
    double trial[3] = {0, 1, range_exponent}, product = 0, square = 0;
    for (const LightSample& sample : samples) {
      const double model = modelled(sample, trial);
      product += sample.intensity * model;
      square += model * model;
    }
    if (!(product > 0)) return std::nullopt;
    trial[0] = std::log(product / square);
    const double sum = sum_of_squares(samples, trial);
    if (sum < best) std::copy(std::begin(trial), std::end(trial), unknown);
    best = std::min(best, sum);
  }
  std::ranges::stable_sort(samples, {}, &LightSample::cluster);
  for (int step = 0; step < kGaussSteps; ++step) {
    result.fit = light_step(samples, rings, unknown);
    for (std::size_t k = 0; k < 3; ++k) unknown[k] += result.fit.value[k];
  }
  if (recording.intensity_unit > 0) {
    // Rounding errs in the same way wherever the intensity is the same, on all surfaces.
    for (LightSample& sample : samples) {
      sample.cluster = static_cast<std::uint64_t>(sample.intensity / recording.intensity_unit);
    }
    std::ranges::stable_sort(samples, {}, &LightSample::cluster);
    const LeastSquaresFit by_code = light_step(samples, rings, unknown);
    for (std::size_t k = 0; k < 3; ++k) {
      const double deviation = by_code.deviation[k] * by_code.half_width / result.fit.half_width;
      result.fit.deviation[k] = std::max(result.fit.deviation[k], deviation);
    }
  }
  result.fit.value.assign(std::begin(unknown), std::end(unknown));
  return result;
}

}  // namespace simvis
