#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "exchange/fidelity/light_fit.h"

namespace simvis {
namespace {

constexpr double kBinWidth = 0.002;  // of the logarithm of the power, far below the width of any threshold
constexpr double kMinNoise = 1e-3, kMaxNoise = 3;
constexpr int kScoringSteps = 200;
constexpr double kMinChance = 1e-9;
constexpr double kConverged = 1e-13;  // rounding of the sum of the likelihoods

// The probability that an echo is kept by the receiver's threshold, and its derivative by the argument.
double kept(double z) { return std::erfc(-z / std::numbers::sqrt2) / 2; }
double kept_slope(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }

/// Probability of a loss by chance d, log of the threshold, log of its noise.
struct LossModel {
  double chance = 0, log_power = 0, log_noise = 0;

  double z(double power) const { return (power * std::exp(-log_power) - 1) * std::exp(-log_noise); }
  double loss(double power) const { return 1 - (1 - chance) * kept(z(power)); }
  std::array<double, 3> slope(double power) const {
    const double at = z(power), down = -(1 - chance) * kept_slope(at);
    return {kept(at), down * -power * std::exp(-log_power - log_noise), down * -at};
  }
};

double clamped(double probability) { return std::clamp(probability, kMinChance, 1 - kMinChance); }

double log_likelihood(const std::vector<LossBin>& bins, const LossModel& model) {
  double sum = 0;
  for (const LossBin& bin : bins) {
    const double loss = clamped(model.loss(bin.power));
    sum += bin.lost * std::log(loss) + (bin.beams - bin.lost) * std::log1p(-loss);
  }
  return sum;
}

struct Information {
  double matrix[3][3]{};
  double score[3]{};
};

Information information_of(const std::vector<LossBin>& bins, const LossModel& model) {
  Information information;
  for (const LossBin& bin : bins) {
    const double loss = clamped(model.loss(bin.power));
    const std::array<double, 3> slope = model.slope(bin.power);
    for (std::size_t a = 0; a < 3; ++a) {
      information.score[a] += slope[a] * (bin.lost - bin.beams * loss) / (loss * (1 - loss));
      for (std::size_t b = 0; b < 3; ++b) {
        information.matrix[a][b] += bin.beams * slope[a] * slope[b] / (loss * (1 - loss));
      }
    }
  }
  return information;
}

// Where the likelihood would rise below a chance of 0, the chance stays there.
void hold_chance(const LossModel& model, Information& information) {
  if (model.chance > 0 || information.score[0] >= 0) return;
  for (int a = 1; a < 3; ++a) information.matrix[0][a] = information.matrix[a][0] = 0;
  information.matrix[0][0] = 1;
  information.score[0] = 0;
}

// The inverse of a symmetric matrix; false if it is singular as far as numbers go.
bool invert(const double (&m)[3][3], double (&inverse)[3][3]) {
  const auto minor = [&](int r, int c) {
    const int r0 = (r + 1) % 3, r1 = (r + 2) % 3, c0 = (c + 1) % 3, c1 = (c + 2) % 3;
    return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  if (!(determinant > 1e-12 * m[0][0] * m[1][1] * m[2][2])) return false;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) inverse[r][c] = minor(c, r) / determinant;
  }
  return true;
}

FittedNumber of_logarithm(double value, double deviation) {
  return {std::exp(value), std::exp(value - kDeviationsOf95 * deviation), std::exp(value + kDeviationsOf95 * deviation),
          std::isfinite(deviation)};
}

// Fisher's scoring with halved steps. False: the threshold is not determined.
bool maximise(const std::vector<LossBin>& bins, LossModel& model) {
  double likelihood = log_likelihood(bins, model);
  for (int step = 0; step < kScoringSteps; ++step) {
    Information information = information_of(bins, model);
    hold_chance(model, information);
    double inverse[3][3];
    if (!invert(information.matrix, inverse)) return false;
    double move[3]{};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) move[a] += inverse[a][b] * information.score[b];
    }
    double share = 1;
    LossModel next = model;
    for (; share > 1e-6; share /= 2) {
      next = {std::clamp(model.chance + share * move[0], 0.0, 0.999), model.log_power + share * move[1],
              std::clamp(model.log_noise + share * move[2], std::log(kMinNoise), std::log(kMaxNoise))};
      if (log_likelihood(bins, next) >= likelihood) break;
    }
    const double reached = log_likelihood(bins, next);
    if (!(reached > likelihood + kConverged * std::abs(likelihood))) return true;
    model = next;
    likelihood = reached;
  }
  return true;
}

std::vector<LossBin> bins_of(const BeamRecording& recording, const SceneBeamOf& scene, const Medium& medium,
                             const std::vector<bool>& counted) {
  std::map<long, LossBin> bins;
  for (std::size_t i = 0; i < recording.beams.size(); ++i) {
    if (!counted[i]) continue;
    const double power = power_of(scene(i), medium);
    if (!(power > 0)) continue;
    LossBin& bin = bins[std::lround(std::log(power) / kBinWidth)];
    bin.power += power;
    bin.beams += 1;
    bin.lost += std::isfinite(recording.beams[i].range_m) ? 0 : 1;
  }
  std::vector<LossBin> all;
  for (auto& [number, bin] : bins) {
    bin.power /= bin.beams;
    all.push_back(bin);
  }
  return all;
}

struct Share {
  double beams = 0, lost = 0;
};

// Of the beams whose power ranks from `from` to `to`, as shares of all.
Share share_of(const std::vector<LossBin>& bins, double all, double from, double to) {
  Share share;
  double before = 0;
  for (const LossBin& bin : bins) {
    if (before >= from * all && before < to * all) {
      share.beams += bin.beams;
      share.lost += bin.lost;
    }
    before += bin.beams;
  }
  return share;
}

// The power of the strongest beams that are lost more often than not.
double first_threshold(const std::vector<LossBin>& bins, double all) {
  constexpr int kParts = 50;
  double threshold = bins.front().power, before = 0;
  for (int part = 0; part < kParts; ++part) {
    const Share share = share_of(bins, all, static_cast<double>(part) / kParts, (part + 1.0) / kParts);
    if (share.lost < share.beams / 2 || share.beams == 0) continue;
    before = 0;
    for (const LossBin& bin : bins) {
      before += bin.beams;
      if (before >= all * (part + 1.0) / kParts) {
        threshold = bin.power;
        break;
      }
    }
  }
  return threshold;
}

}  // namespace

FittedNumber wilson_interval(double hits, double tries) {
  if (!(tries > 0)) return {};
  const double z2 = kDeviationsOf95 * kDeviationsOf95, share = hits / tries;
  const double middle = (share + z2 / (2 * tries)) / (1 + z2 / tries);
  const double half =
      kDeviationsOf95 / (1 + z2 / tries) * std::sqrt(share * (1 - share) / tries + z2 / (4 * tries * tries));
  return {share, std::max(0.0, middle - half), std::min(1.0, middle + half), true};
}

double LossFit::at(double power_value) const {
  if (power.value == 0) return chance.value;
  return LossModel{chance.value, std::log(power.value), std::log(noise.value)}.loss(power_value);
}

LossFit fit_losses(const BeamRecording& recording, const SceneBeamOf& scene, const Medium& medium,
                   const std::vector<bool>& counted) {
  LossFit fit{.bins = bins_of(recording, scene, medium, counted)};
  double all = 0, lost = 0;
  for (const LossBin& bin : fit.bins) {
    all += bin.beams;
    lost += bin.lost;
  }
  if (all == 0) return fit;
  fit.chance = wilson_interval(lost, all);
  // Is there a threshold at all? The weakest beams against the stronger half.
  constexpr double kWeakest = 0.02, kDeviations = 5;
  const Share weak = share_of(fit.bins, all, 0, kWeakest), strong = share_of(fit.bins, all, 0.5, 1);
  if (weak.beams == 0 || strong.beams == 0) return fit;
  const double usual = (strong.lost + 1) / (strong.beams + 2);
  if (weak.lost - weak.beams * usual < kDeviations * std::sqrt(weak.beams * usual) + kDeviations) return fit;
  LossModel model{std::max(strong.lost / strong.beams, kMinChance), std::log(first_threshold(fit.bins, all)),
                  std::log(0.1)};
  if (!maximise(fit.bins, model)) return fit;
  double inverse[3][3];
  if (!invert(information_of(fit.bins, model).matrix, inverse)) return fit;
  fit.power = of_logarithm(model.log_power, std::sqrt(inverse[1][1]));
  fit.noise = of_logarithm(model.log_noise, std::sqrt(inverse[2][2]));
  // Seen from one side alone, a far threshold with much noise looks as a near one with little.
  constexpr double kMinLost = 0.6;
  if (weak.lost < kMinLost * weak.beams) fit.power.determined = fit.noise.determined = false;
  // As if it were a share of so many beams as have its standard deviation.
  const double variance = inverse[0][0], chance = std::max(model.chance, 0.5 / all);
  const double tries = chance * (1 - chance) / variance;
  fit.chance = wilson_interval(model.chance * tries, tries);
  return fit;
}

}  // namespace simvis
