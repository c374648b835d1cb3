// The fisheye model of OpenCV (version 4.6, "Fisheye camera model",
// https://docs.opencv.org/4.6.0/db/d58/group__calib3d__fisheye.html):
//   theta is the angle from the optical axis, phi the angle around it,
//   d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), (x'', y'') = d (cos phi, sin phi)
// Source: J. Kannala and S. S. Brandt, "A generic camera model and calibration method for conventional, wide-angle, and
// fish-eye lenses", PAMI 28, 2006.
#include "effects/camera/lenses/radial_lens.h"

namespace simvis {
namespace {

constexpr AttributeSpec kKannalaBrandtRows[] = {{.name = "k1", .text = "of theta^2"},
                                                {.name = "k2", .text = "of theta^4"},
                                                {.name = "k3", .text = "of theta^6"},
                                                {.name = "k4", .text = "of theta^8"}};

std::shared_ptr<const LensModel> kannala_brandt(std::span<const double> coefficients) {
  if (coefficients.size() != std::size(kKannalaBrandtRows)) return nullptr;
  const std::vector<double> k(coefficients.begin(), coefficients.end());
  return std::make_shared<RadialLens>(
      RadialLens::Gives::radius,
      RisingFunction([k](double angle_rad) { return odd_polynomial(angle_rad, k); },
                     [k](double angle_rad) { return slope_of_odd_polynomial(angle_rad, k); }, kFisheyeLimit_rad));
}

}  // namespace

extern const LensType kKannalaBrandt;
constinit const LensType kKannalaBrandt{
    .name = "kannala_brandt",
    .ros_name = "equidistant",
    .coefficients = kKannalaBrandtRows,
    .read = [](const AttributeValues& attributes) { return numbers_of(kKannalaBrandtRows, attributes); },
    .create = kannala_brandt};

}  // namespace simvis
