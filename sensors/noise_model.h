// The noise of one measured quantity: white noise, turn-on bias, drift, quantisation. Every quantity of a sensor has
// the same attributes with a prefix of its own.
//
//   measured = quantised(true + white + turn-on bias + drift)
//
//   stddev                    white noise of each sample. SDF: <stddev>
//   noise_density             white noise in continuous units, unit / sqrt(Hz): a sample has the standard deviation
//                             noise_density / sqrt(time from sample to sample). Kalibr: noise_density
//   bias_mean, bias_stddev    turn-on bias: drawn once for the run, for each axis. SDF: <bias_mean> (and <mean>),
//                             <bias_stddev>. Its sign is not drawn a second time, as Gazebo does
//   dynamic_bias_stddev, dynamic_bias_correlation_time
//                             Gauss-Markov drift, as SDF names it and as gz-sensors and RotorS compute it: the first is
//                             the density of the noise that drives it, in unit / (s sqrt(Hz)), the second its time
//                             constant T in seconds. The variance of the drift is stddev^2 T / 2 (1 - exp(-2 t / T))
//   random_walk               drift without a limit, T infinite: variance random_walk^2 t. In unit / (s sqrt(Hz)).
//                             Kalibr: gyroscope_random_walk, accelerometer_random_walk
//   precision                 values are rounded to multiples of this. SDF: <precision> of gaussian_quantized
//
// Model    Kalibr's wiki, "IMU Noise Model"; IEEE Std 952-1997, annex C (Allan variance: white noise, random walk,
//          Markov noise).
// Drift is a function of time. Both drifts are Gaussian Markov processes that begin at 0 at time 0. Between two known
//          values such a process has a known normal distribution (a bridge), so the value at any nanosecond follows
//          from halving the interval from 0 to 2^63 ns 63 times at most, with one random number for each middle, named
//          by its time (P. Levy's construction). There is no state: a sample does not depend on which frames were made
//          before, on threads or on the order of calls, and two sensors of one name and seed drift alike at any rate.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/frame_time.h>
#include <simvis/philox.h>
#include "scenegraph/language/attribute_rows.h"
#include "sensors/sample_period.h"

namespace simvis {

struct NoiseDesc {
  double stddev = 0, noise_density = 0;
  double bias_mean = 0, bias_stddev = 0;
  double dynamic_bias_stddev = 0, dynamic_bias_correlation_time_s = 0;
  double random_walk = 0;
  double precision = 0;

  /// Variance of one sample's white noise.
  double white_variance(double sample_period_s) const;
  /// The density of the random walk whose driving noise is that of both drifts together, in the quantity's unit
  /// /s/sqrt(Hz).
  double walk_density() const;

  bool operator==(const NoiseDesc&) const = default;
};

/// The rows of one quantity: `prefix` stands in front of their names ("gyroscope_"), `quantity` ("the angular
/// velocity") and `unit` in their texts. Reading them throws InputError if only one of the two of the Gauss-Markov
/// drift is above 0.
AttributeRows<NoiseDesc> noise_rows(std::string_view prefix, std::string_view quantity, std::string_view unit);

class NoiseModel {
 public:
  /// `random` belongs to this quantity alone.
  NoiseModel(const NoiseDesc& desc, const SensorRandom& random) : desc_(desc), random_(random) {}

  /// The measured value of axis `axis`. `sample_period_s` is the time from sample to sample.
  double apply(double truth, std::uint32_t axis, const FrameTime& time, double sample_period_s) const {
    return with_noise(truth, axis, axis, time, sample_period_s);
  }
  /// The measured value number `number` of several that one instrument measures in a frame: each has white noise of its
  /// own, and all have the bias and the drift of axis 0.
  double apply_to_one(double truth, std::uint32_t number, const FrameTime& time, double sample_period_s) const {
    return with_noise(truth, 0, number, time, sample_period_s);
  }
  /// The true bias of an axis at a time, which is not negative: the sum of turn-on bias and drift.
  double bias(std::uint32_t axis, std::int64_t time_ns) const;
  /// The sum of both drifts of an axis at a time, which is not negative.
  double drift(std::uint32_t axis, std::int64_t time_ns) const;
  const NoiseDesc& desc() const { return desc_; }

 private:
  /// `number` names the white noise among that of the frame.
  double with_noise(double truth, std::uint32_t axis, std::uint32_t number, const FrameTime& time,
                    double sample_period_s) const;
  /// The drawn part of the turn-on bias, without its mean.
  double turn_on(std::uint32_t axis) const;
  double markov(std::uint32_t axis, std::uint32_t draw, double density, double correlation_time_s,
                std::uint64_t time_ns) const;

  NoiseDesc desc_;
  SensorRandom random_;
};

}  // namespace simvis
