#include "sensors/thermal_camera/band_radiance.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace simvis {
namespace {

constexpr double kPlanck_Js = 6.62607015e-34, kLight_mps = 299792458, kBoltzmann_J_per_k = 1.380649e-23;
constexpr double kSecond_mk = kPlanck_Js * kLight_mps / kBoltzmann_J_per_k;  // h c / k
constexpr double kScale = 2 * (kBoltzmann_J_per_k / kPlanck_Js) * (kBoltzmann_J_per_k / kPlanck_Js) *
                          (kBoltzmann_J_per_k / kPlanck_Js) * kBoltzmann_J_per_k / (kLight_mps * kLight_mps);
constexpr double kMaxExponent = 700;  // e^-700 is close to the smallest double

// The integral of u^3 / (e^u - 1) from x on.
double planck_tail(double x) {
  if (x > kMaxExponent) return 0;
  double sum = 0;
  for (int n = 1;; ++n) {
    const double term = std::exp(-n * x) * (x * x * x + (3 * x * x + (6 * x + 6.0 / n) / n) / n) / n;
    sum += term;
    if (term <= 0x1p-56 * sum) return sum;
  }
}

double exponent(double wavelength_m, double temperature_k) { return kSecond_mk / (wavelength_m * temperature_k); }

// u^4 / (e^u - 1)
double slope_term(double x) { return x > kMaxExponent ? 0 : x * x * x * x / std::expm1(x); }

double fourth_power(double value) { return value * value * value * value; }

// 1 / T by ln L, in steps of kRadianceStep.
class InverseTable {
 public:
  InverseTable() : first_(std::log(band_radiance(kColdest_k))) {
    const double last = std::log(band_radiance(kHottest_k));
    double inverse = 1 / kColdest_k;
    for (int i = 0; first_ + (i - 1) * kRadianceStep < last; ++i) {
      const Node node = solved(first_ + i * kRadianceStep, inverse);
      nodes_.push_back(node);
      inverse = node.inverse_per_k + kRadianceStep * node.slope;
    }
  }

  double temperature_k(double radiance) const {
    const double place = (std::log(radiance) - first_) / kRadianceStep;
    const std::size_t i = std::min(static_cast<std::size_t>(place), nodes_.size() - 2);
    const double t = place - static_cast<double>(i), s = 1 - t;
    const Node &a = nodes_[i], &b = nodes_[i + 1];
    return 1 / (s * s * ((1 + 2 * t) * a.inverse_per_k + t * kRadianceStep * a.slope) +
                t * t * ((1 + 2 * s) * b.inverse_per_k - s * kRadianceStep * b.slope));
  }

 private:
  struct Node {
    double inverse_per_k, slope;  // 1 / T, and its derivative by ln L
  };

  // Newton's method; ln L is nearly straight in 1 / T.
  static Node solved(double log_radiance, double inverse_per_k) {
    Node node{inverse_per_k, 0};
    for (int step = 0; step < 6; ++step) {
      const double t = 1 / node.inverse_per_k, radiance = band_radiance(t);
      node.slope = -radiance / (band_radiance_slope(t) * t * t);
      const double change = node.slope * (log_radiance - std::log(radiance));
      node.inverse_per_k += change;
      if (std::abs(change) < 1e-14 * node.inverse_per_k) break;
    }
    return node;
  }

  double first_;  // ln L of the first node
  std::vector<Node> nodes_;
};

}  // namespace

double band_radiance(double temperature_k) {
  if (temperature_k <= 0) return 0;
  const double longest = planck_tail(exponent(kBandMax_m, temperature_k));
  if (longest == 0) return 0;
  return kScale * fourth_power(temperature_k) * (longest - planck_tail(exponent(kBandMin_m, temperature_k)));
}

double band_radiance_slope(double temperature_k) {
  if (temperature_k <= 0) return 0;
  const double of_band =
      slope_term(exponent(kBandMax_m, temperature_k)) - slope_term(exponent(kBandMin_m, temperature_k));
  const double cube = temperature_k * temperature_k * temperature_k;
  return 4 * band_radiance(temperature_k) / temperature_k + kScale * cube * of_band;
}

double band_temperature_k(double radiance) {
  static const double coldest = band_radiance(kColdest_k), hottest = band_radiance(kHottest_k);
  static const InverseTable table;
  if (!(radiance >= coldest)) return 0;
  return radiance >= hottest ? kHottest_k : table.temperature_k(radiance);
}

}  // namespace simvis
