#include "exchange/fidelity/range_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {
namespace {

// Standard deviations that are assumed before the fit, far above the errors of any scanner.
constexpr double kPriorBias_m = 0.5, kPriorPosition_m = 0.2;
// The same for the parameters of the variance.
constexpr double kPriorVariance_m2 = 1, kPriorShare2 = 1, kPriorAngle_rad2 = 0.01;

// The first step leaves the square of an error in angle, below 1 mm for a degree at 6 m; each further one squares it.
constexpr int kSteps = 4;
constexpr int kNoiseSteps = 3;  // of weights that follow from the noise

// A range farther off than this, and than so many deviations, is that of another surface.
constexpr double kOtherSurface_m = 0.5, kOtherDeviations = 8;
constexpr double kMinDeviation_m = 1e-5;

// Errors of beams within so much azimuth in one ring may depend on each other.
constexpr double kClusterAzimuth_rad = 0.5 * 0.017453292519943295;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

class RangeFitter {
 public:
  RangeFitter(const BeamRecording& recording, SceneBeams& scene, bool fit_pose)
      : recording_(recording), scene_(scene), fit_pose_(fit_pose) {
    fit_.rings = recording.rings <= kMaxFittedRings ? recording.rings : 0;
    fit_.corrections.rings.resize(fit_.rings);
    prior_.push_back(kPriorBias_m);
    if (fit_pose) {
      prior_.insert(prior_.end(), 3, kPriorPosition_m);
      prior_.insert(prior_.end(), 2, kPriorAngle_rad);
    }
    prior_.insert(prior_.end(), std::size_t{2} * fit_.rings, kPriorAngle_rad);
  }

  RangeFit fit() {
    cast_beams();
    for (int step = 0; step < kSteps; ++step) {
      if (!fit_angles()) return std::move(fit_);
    }
    fit_noise();
    if (!fit_angles()) return std::move(fit_);  // with the weights that follow from the noise
    fit_noise();
    fit_.residual_m.assign(scene_.size(), std::numeric_limits<double>::quiet_NaN());
    for (const std::size_t i : used_) fit_.residual_m[i] = residual(i);
    // The values are the sums of all steps.
    fit_.angles.value = total_;
    return std::move(fit_);
  }

 private:
  double residual(std::size_t i) const { return recording_.beams[i].range_m - scene_[i].range_m - fit_.bias_m; }

  void cast_beams() {
    scene_.cast(fit_.corrections);
    choose_beams();
  }

  // One step of Gauss and Newton, after which the beams are cast with the new corrections. False: no beam can be used.
  bool fit_angles() {
    if (used_.empty()) return false;
    fit_.angles = least_squares(used_.size(), prior_, [&](std::size_t i) { return row(used_[i]); });
    take(fit_.angles);
    cast_beams();
    return true;
  }

  void choose_beams() {
    std::vector<std::size_t> candidates;
    std::vector<double> distances;
    for (std::size_t i = 0; i < scene_.size(); ++i) {
      if (scene_[i].use != BeamUse::fitted || !std::isfinite(recording_.beams[i].range_m)) continue;
      candidates.push_back(i);
      distances.push_back(std::abs(residual(i)));
    }
    used_.clear();
    if (candidates.empty()) return;
    constexpr double kDeviationOfMedian = 1.4826;  // of the absolute values of a normal distribution
    deviation_m_ = std::max(kDeviationOfMedian * median_of(distances), kMinDeviation_m);
    const double limit_m = std::max(kOtherSurface_m, kOtherDeviations * deviation_m_);
    for (const std::size_t i : candidates) {
      if (std::abs(residual(i)) <= limit_m) used_.push_back(i);
    }
  }

  std::uint64_t cluster(std::size_t i) const {
    const RecordedBeam& beam = recording_.beams[i];
    return std::uint64_t{beam.ring} << 32 | azimuth_cluster(beam.azimuth_rad);
  }

  // For weights. A fitted variance may come near 0 or below for some beams, which would then count for all others.
  double variance(std::size_t i) const {
    constexpr double kMinShare = 0.1;
    const double usual_m2 = deviation_m_ * deviation_m_;
    if (!has_noise_) return usual_m2;
    return std::max(fit_.variance.at(scene_[i].range_m, slope_of(scene_[i])), kMinShare * usual_m2);
  }

  LeastSquaresRow row(std::size_t i) const {
    const SceneBeam& beam = scene_[i];
    LeastSquaresRow row{.cluster = cluster(i), .value = residual(i), .weight = 1 / variance(i)};
    const auto moved = [&](const glm::dvec3& displacement) {
      return glm::dot(beam.normal, displacement) / beam.cosine;
    };
    row.add(0, 1);
    if (fit_pose_) {
      for (int axis = 0; axis < 3; ++axis)
        row.add(static_cast<std::uint32_t>(1 + axis), beam.normal[axis] / beam.cosine);
      row.add(4, moved(glm::cross(glm::dvec3(1, 0, 0), beam.point_m)));
      row.add(5, moved(glm::cross(glm::dvec3(0, 1, 0), beam.point_m)));
    }
    if (fit_.rings == 0) return row;
    const std::uint32_t ring = first_ring_unknown(fit_pose_) + 2 * recording_.beams[i].ring;
    row.add(ring, moved(beam.range_m * by_azimuth(beam.direction)));
    row.add(ring + 1, moved(beam.range_m * by_elevation(beam.direction)));
    return row;
  }

  void take(const LeastSquaresFit& step) {
    total_.resize(step.value.size());
    for (std::size_t i = 0; i < total_.size(); ++i) total_[i] += step.value[i];
    fit_.bias_m = total_[0];
    if (fit_pose_) {
      fit_.corrections.position_m = {total_[1], total_[2], total_[3]};
      fit_.corrections.roll_rad = total_[4];
      fit_.corrections.pitch_rad = total_[5];
    }
    const std::uint32_t first = first_ring_unknown(fit_pose_);
    for (std::uint32_t ring = 0; ring < fit_.rings; ++ring) {
      fit_.corrections.rings[ring] = {total_[first + 2 * ring], total_[first + 2 * ring + 1]};
    }
  }

  // The variance of a square is twice the square of the variance.
  void fit_noise() {
    for (int step = 0; step < kNoiseSteps && !used_.empty(); ++step) fit_variance();
  }

  void fit_variance() {
    const double unknowns = static_cast<double>(std::min(total_.size(), used_.size() - 1));
    const double scale = static_cast<double>(used_.size()) / (static_cast<double>(used_.size()) - unknowns);
    const double rounding_m2 = recording_.range_unit_m * recording_.range_unit_m / 12;
    const double prior[] = {kPriorVariance_m2, kPriorShare2, kPriorAngle_rad2};
    fit_.noise = least_squares(used_.size(), prior, [&](std::size_t k) {
      const std::size_t i = used_[k];
      const SceneBeam& beam = scene_[i];
      const double expected = variance(i), slope_m = slope_of(beam);
      LeastSquaresRow row{.cluster = cluster(i),
                          .value = scale * residual(i) * residual(i) - rounding_m2,
                          .weight = 1 / (2 * expected * expected)};
      row.add(0, 1);
      row.add(1, beam.range_m * beam.range_m);
      row.add(2, slope_m * slope_m);
      return row;
    });
    const std::vector<double>& value = fit_.noise.value;
    fit_.variance = {value[0] + rounding_m2, value[1], value[2]};
    has_noise_ = true;
  }

  const BeamRecording& recording_;
  SceneBeams& scene_;
  bool fit_pose_, has_noise_ = false;
  RangeFit fit_;
  std::vector<double> prior_, total_;
  std::vector<std::size_t> used_;
  double deviation_m_ = 0;
};

}  // namespace

double RangeVariance::at(double range_m, double slope_m) const {
  const double variance = constant_m2 + share2 * range_m * range_m + angle_rad2 * slope_m * slope_m;
  return std::max(variance, kMinDeviation_m * kMinDeviation_m);
}

std::uint32_t azimuth_cluster(double azimuth_rad) {
  return static_cast<std::uint32_t>((azimuth_rad + 4) / kClusterAzimuth_rad);  // from -pi
}

double slope_of(const SceneBeam& beam) {
  return beam.range_m / beam.cosine *
         std::hypot(glm::dot(beam.normal, by_azimuth(beam.direction)),
                    glm::dot(beam.normal, by_elevation(beam.direction)));
}

RangeFit fit_ranges(const BeamRecording& recording, SceneBeams& scene, bool fit_pose) {
  return RangeFitter(recording, scene, fit_pose).fit();
}

}  // namespace simvis
