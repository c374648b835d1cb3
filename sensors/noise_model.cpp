#include "sensors/noise_model.h"

#include <cmath>
#include <limits>

namespace simvis {

namespace {

// What the random numbers of a quantity are for. Those of a drift are named by their time instead of the frame.
constexpr std::uint32_t kWhite = 0, kTurnOn = 1, kMarkovDrift = 2, kWalkDrift = 3;

// Drift is known at time 0 and then at this time, after which no clock of a simulation runs.
constexpr std::uint64_t kDriftEnd_ns = std::uint64_t{1} << 63;

/// Variance of a Markov process after `seconds`, from a known value on.
double driven_variance(double density, double correlation_time_s, double seconds) {
  if (std::isinf(correlation_time_s)) return density * density * seconds;
  return -density * density * correlation_time_s / 2 * std::expm1(-2 * seconds / correlation_time_s);
}

void check_drift(const NoiseDesc& desc, const std::string& prefix, const AttributeValues& attributes) {
  const bool has_noise = desc.dynamic_bias_stddev > 0, has_time = desc.dynamic_bias_correlation_time_s > 0;
  if (has_noise == has_time) return;
  const std::string noise = prefix + "dynamic_bias_stddev", time = prefix + "dynamic_bias_correlation_time";
  const std::string &name = has_noise ? noise : time, &other = has_noise ? time : noise;
  fail_at(attributes.where(name),
          "attribute \"" + name + "\" is not allowed without \"" + other + "\", expected both above 0 or none");
}

}  // namespace

double NoiseDesc::white_variance(double sample_period_s) const {
  return stddev * stddev + noise_density * noise_density / sample_period_s;
}

double NoiseDesc::walk_density() const { return std::hypot(random_walk, dynamic_bias_stddev); }

AttributeRows<NoiseDesc> noise_rows(std::string_view prefix, std::string_view quantity, std::string_view unit) {
  const std::string of = " of " + std::string(quantity), units(unit), walk_unit = units + "/s/sqrt(Hz)";
  const auto number = [&](double NoiseDesc::*member, const char* name, const std::string& row_unit,
                          const std::string& text, const AttributeLimits& limits = kNotNegative) {
    return row(member, keep_text(std::string(prefix) + name), keep_text(row_unit), limits, keep_text(text));
  };
  using Noise = NoiseDesc;
  return {number(&Noise::stddev, "stddev", units, "standard deviation of the white noise" + of),
          number(&Noise::noise_density, "noise_density", units + "/sqrt(Hz)",
                 "density of the white noise" + of + ", added to stddev in squares"),
          number(&Noise::bias_mean, "bias_mean", units, "mean of the turn-on bias" + of, kAnyNumber),
          number(&Noise::bias_stddev, "bias_stddev", units,
                 "standard deviation of the turn-on bias" + of + ", which is drawn once"),
          number(&Noise::dynamic_bias_stddev, "dynamic_bias_stddev", walk_unit,
                 "density of the noise that drives the Gauss-Markov drift" + of),
          number(&Noise::dynamic_bias_correlation_time_s, "dynamic_bias_correlation_time", "s",
                 "time constant of the Gauss-Markov drift" + of),
          number(&Noise::random_walk, "random_walk", walk_unit,
                 "density of the noise that drives the unlimited drift" + of),
          number(&Noise::precision, "precision", units, "step to which values" + of + " are rounded; 0: none"),
          checked<Noise>([prefix](const Noise& desc, const AttributeValues& attributes) {
            check_drift(desc, std::string(prefix), attributes);
          })};
}

double NoiseModel::with_noise(double truth, std::uint32_t axis, std::uint32_t number, const FrameTime& time,
                              double sample_period_s) const {
  double value = truth + desc_.bias_mean;
  const double white = desc_.white_variance(sample_period_s);
  if (white > 0) value += std::sqrt(white) * random_.gaussian(random_key(time), number, kWhite);
  value += turn_on(axis);
  value += drift(axis, time.time_ns);
  return desc_.precision > 0 ? std::round(value / desc_.precision) * desc_.precision : value;
}

double NoiseModel::bias(std::uint32_t axis, std::int64_t time_ns) const {
  return desc_.bias_mean + turn_on(axis) + drift(axis, time_ns);
}

double NoiseModel::turn_on(std::uint32_t axis) const {
  return desc_.bias_stddev > 0 ? desc_.bias_stddev * random_.gaussian(0, axis, kTurnOn) : 0;
}

double NoiseModel::drift(std::uint32_t axis, std::int64_t time_ns) const {
  const auto time = static_cast<std::uint64_t>(time_ns);
  double sum = 0;
  if (desc_.dynamic_bias_stddev > 0) {
    sum += markov(axis, kMarkovDrift, desc_.dynamic_bias_stddev, desc_.dynamic_bias_correlation_time_s, time);
  }
  if (desc_.random_walk > 0) {
    sum += markov(axis, kWalkDrift, desc_.random_walk, std::numeric_limits<double>::infinity(), time);
  }
  return sum;
}

double NoiseModel::markov(std::uint32_t axis, std::uint32_t draw, double density, double correlation_time_s,
                          std::uint64_t time_ns) const {
  std::uint64_t half = kDriftEnd_ns, from = 0;
  double start = 0;
  double end = std::sqrt(driven_variance(density, correlation_time_s, static_cast<double>(kDriftEnd_ns) / 1e9)) *
               random_.gaussian(kDriftEnd_ns, axis, draw);
  while (time_ns != from) {
    half /= 2;
    const std::uint64_t middle_ns = from + half;
    const double seconds = static_cast<double>(half) / 1e9;
    // The share of a value that is left after `seconds`. Given both ends, the middle is normally distributed.
    const double left = std::isinf(correlation_time_s) ? 1 : std::exp(-seconds / correlation_time_s);
    const double spread = 1 + left * left;
    const double middle =
        left / spread * (start + end) + std::sqrt(driven_variance(density, correlation_time_s, seconds) / spread) *
                                            random_.gaussian(middle_ns, axis, draw);
    if (time_ns < middle_ns) {
      end = middle;
    } else {
      from = middle_ns;
      start = middle;
    }
  }
  return start;
}

}  // namespace simvis
