// The double sphere model of V. Usenko, N. Demmel and D. Cremers, "The double sphere camera model", 3DV 2018,
// equations 40 to 45:
//   d1 = |(X, Y, Z)|, d2 = sqrt(X^2 + Y^2 + (xi d1 + Z)^2), (x'', y'') = (X, Y) / (alpha d2 + (1 - alpha) (xi d1 + Z))
// A point is projected to one sphere, from there to a second one whose centre is xi farther back, and from there to the
// image by a pinhole that stands alpha / (1 - alpha) behind the second centre. xi = 0 and alpha = 0 are a pinhole.
#include <algorithm>
#include <cmath>

#include "effects/camera/lenses/radial_lens.h"

namespace simvis {
namespace {

// At xi = -1 the second sphere's centre is seen through itself, and the axis has no place.
constexpr AttributeSpec kDoubleSphereRows[] = {
    {.name = "xi", .text = "distance of the two spheres' centres, in radii", .min = -1, .max = 1, .open_min = true},
    {.name = "alpha",
     .text = "place of the pinhole, from 0 at the second centre to 1 far behind it",
     .min = 0,
     .max = 1}};

struct DoubleSphere {
  double xi, alpha;

  // The divisor of (X, Y) in the formula above, and d2, of a unit vector whose angle from the axis has this cosine.
  double divisor(double cosine) const { return alpha * second(cosine) + (1 - alpha) * (xi + cosine); }
  double second(double cosine) const { return std::sqrt(std::max(0.0, 1 + xi * (xi + 2 * cosine))); }

  double radius(double angle_rad) const { return std::sin(angle_rad) / divisor(std::cos(angle_rad)); }

  // Beyond the pole, where the divisor is 0, nothing is seen.
  double slope(double angle_rad) const {
    const double sine = std::sin(angle_rad), cosine = std::cos(angle_rad), by = divisor(cosine);
    if (!(by > 0)) return -1;
    return (cosine * by + sine * sine * (alpha * xi / second(cosine) + 1 - alpha)) / (by * by);
  }
};

std::shared_ptr<const LensModel> double_sphere(std::span<const double> coefficients) {
  if (coefficients.size() != std::size(kDoubleSphereRows)) return nullptr;
  const DoubleSphere lens{coefficients[0], coefficients[1]};
  return std::make_shared<RadialLens>(
      RadialLens::Gives::radius,
      RisingFunction([lens](double angle_rad) { return lens.radius(angle_rad); },
                     [lens](double angle_rad) { return lens.slope(angle_rad); }, kFisheyeLimit_rad));
}

}  // namespace

extern const LensType kDoubleSphere;
constinit const LensType kDoubleSphere{
    .name = "double_sphere",
    .ros_name = "double_sphere",
    .coefficients = kDoubleSphereRows,
    .read = [](const AttributeValues& attributes) { return numbers_of(kDoubleSphereRows, attributes); },
    .create = double_sphere};

}  // namespace simvis
