// The f-theta model of NVIDIA (DriveWorks: dwFThetaCameraConfig; NCore, "Sensor Models",
// https://nvidia.github.io/ncore/data/sensor_models.html, from which AlpaSim takes its cameras): with theta, the angle
// from the optical axis, and r, the distance from the principal point in pixels,
//   ftheta           r = polynomial[0] + polynomial[1] theta + polynomial[2] theta^2 + ...  ("angle to pixel distance")
//   ftheta_backward  theta = polynomial[0] + polynomial[1] r + polynomial[2] r^2 + ...      ("pixel distance to angle")
// Both have up to six coefficients, the first of which is 0. The polynomial has the focal length in it. The linear
// transformation c, d, e of pixels is the identity.
#include <cmath>
#include <string>

#include "effects/camera/lenses/radial_lens.h"
#include "engine/base/words.h"

namespace simvis {
namespace {

constexpr std::string_view kPolynomial = "polynomial";
constexpr AttributeSpec kForwardRows[] =
    {{.name = kPolynomial,
      .kind = AttributeKind::text,
      .text = "two to six coefficients of angle^0, angle^1, ... in rad; their sum is a distance in px"}},
                        kBackwardRows[] = {
                            {.name = kPolynomial,
                             .kind = AttributeKind::text,
                             .text = "the same of distance^0, distance^1, ... in px; their sum is an angle in rad"}};

constexpr std::size_t kMinCoefficients = 2, kMaxCoefficients = 6;

// A lens has the polynomial only if it is 0 on the axis and rises there. The inverse of the slope must be finite.
bool is_lens(std::span<const double> p) {
  return p.size() >= kMinCoefficients && p.size() <= kMaxCoefficients && p[0] == 0 && p[1] > 0 && std::isnormal(p[1]);
}

std::vector<double> read_polynomial(const AttributeValues& attributes) {
  if (!attributes.is_set(kPolynomial)) {
    fail_at(attributes.where("distortion"),
            "attribute \"distortion\": f-theta needs a polynomial, expected attribute \"polynomial\"");
  }
  const std::string& text = attributes.text(kPolynomial);
  std::vector<double> polynomial(words_of(text).size());
  if (parse_numbers(text, polynomial) && is_lens(polynomial)) return polynomial;
  fail_at(attributes.where(kPolynomial), "attribute \"polynomial\": " + in_quotes(text) +
                                             " is not allowed, expected two to six finite numbers, of which the first "
                                             "is 0 and the second is above 0");
}

// A polynomial whose argument is `scale` times that of the coefficients, divided by `divisor`.
struct Polynomial {
  std::vector<double> coefficients;
  double scale, divisor;

  double value(double x) const {
    double sum = 0;
    for (std::size_t i = coefficients.size(); i-- > 0;) sum = sum * scale * x + coefficients[i];
    return sum / divisor;
  }
  double slope(double x) const {
    double sum = 0;
    for (std::size_t i = coefficients.size(); i-- > 1;) {
      sum = sum * scale * x + static_cast<double>(i) * coefficients[i];
    }
    return sum * scale / divisor;
  }
};

RisingFunction rising(const Polynomial& polynomial, double limit) {
  return {[polynomial](double x) { return polynomial.value(x); },
          [polynomial](double x) { return polynomial.slope(x); }, limit};
}

double forward_focal_px(std::span<const double> p) { return p[1]; }
double backward_focal_px(std::span<const double> p) { return 1 / p[1]; }

std::shared_ptr<const LensModel> ftheta(std::span<const double> p) {
  if (!is_lens(p)) return nullptr;
  const Polynomial radius{{p.begin(), p.end()}, 1, forward_focal_px(p)};
  return std::make_shared<RadialLens>(RadialLens::Gives::radius, rising(radius, kFisheyeLimit_rad));
}

// Where the angle reaches the limit; the search ends at so many times the radius that the axis promises.
double limit_radius(const Polynomial& angle) {
  constexpr double kSteps = 256, kFarthest = 16;
  double radius = 0;
  while (angle.value(radius) < kFisheyeLimit_rad && radius < kFarthest * kFisheyeLimit_rad) {
    radius += kFisheyeLimit_rad / kSteps;
  }
  return radius;
}

std::shared_ptr<const LensModel> ftheta_backward(std::span<const double> p) {
  if (!is_lens(p)) return nullptr;
  const Polynomial angle{{p.begin(), p.end()}, backward_focal_px(p), 1};
  return std::make_shared<RadialLens>(RadialLens::Gives::angle, rising(angle, limit_radius(angle)));
}

}  // namespace

extern const LensType kFTheta;
constinit const LensType kFTheta{.name = "ftheta",
                                 .ros_name = "ftheta",
                                 .coefficients = kForwardRows,
                                 .read = read_polynomial,
                                 .create = ftheta,
                                 .focal_px = forward_focal_px};

extern const LensType kFThetaBackward;
constinit const LensType kFThetaBackward{.name = "ftheta_backward",
                                         .ros_name = "ftheta_backward",
                                         .coefficients = kBackwardRows,
                                         .read = read_polynomial,
                                         .create = ftheta_backward,
                                         .focal_px = backward_focal_px};

}  // namespace simvis
