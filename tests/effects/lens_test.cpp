// The lens models against their formulas, their inverses and their folds.
#include "effects/camera/lens.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include <simvis/philox.h>
#include "tests/support/made_lens.h"

#ifdef SIMVIS_HAS_OPENCV
#include <opencv2/calib3d.hpp>
#endif

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

using test::MadeLens;

constexpr std::uint32_t kPoints = 10'000;

// Tolerance for formulas and inverses: rounding of about twenty operations on pixels below 1000, 20 * 1000 * 2^-53, is
// 2e-12. Newton's method promises to end within 1e-9.
constexpr double kAgree_px = 1e-9;

constexpr double kLensWidth_px = 640, kLensHeight_px = 480;

MadeLens brown_conrady(double k1, double k2, double k3, double p1, double p2) {
  return {"brown_conrady", {420.5, 410.25, 322.75, 236.5}, {k1, k2, p1, p2, k3}};
}

MadeLens rational(std::vector<double> coefficients) {
  return {"rational_polynomial", {420.5, 410.25, 322.75, 236.5}, std::move(coefficients)};
}

MadeLens fisheye(std::string_view model, double fx_px, std::vector<double> coefficients, double square = 0.98) {
  return {model, {fx_px, square * fx_px, 322.75, 236.5}, std::move(coefficients)};
}

// Barrel distortions, a pincushion distortion, a lens that is tilted against its chip, and fisheyes. The fifth sees 220
// degrees in a circle of 320 pixels. Then the rational model with 8, 12 and 14 coefficients, double spheres whose
// pinhole is in front of and behind the sphere, and f-theta both ways.
const std::vector<MadeLens> kModels{brown_conrady(-0.28, 0.09, -0.01, 0, 0),
                                    brown_conrady(0.2, 0.05, 0, 0, 0),
                                    brown_conrady(-0.2, 0.03, 0, 2e-3, -3e-3),
                                    fisheye("kannala_brandt", 250, {-0.01, 0.002, -0.001, 1e-4}),
                                    fisheye("kannala_brandt", 166.7, {0, 0, 0, 0}),
                                    rational({0.5, 0.1, 1e-3, -2e-3, 0.01, 0.7, 0.15, 0.02}),
                                    rational({0.5, 0.1, 1e-3, -2e-3, 0.01, 0.7, 0.15, 0.02, 3e-3, -1e-3, 2e-3, 5e-4}),
                                    rational({-0.2, 0.03, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.06, -0.04}),
                                    fisheye("double_sphere", 200, {-0.2, 0.6}),
                                    fisheye("double_sphere", 400, {0.2, 0.3}),
                                    fisheye("ftheta", 300, {0, 300, -12, 5, -1}, 1),
                                    fisheye("ftheta_backward", 1 / 0.004, {0, 0.004, -4e-7, 5e-10}, 1)};

// Beyond the axis, where the fisheye models look; acos() is inaccurate near 0 and 180 degrees.
bool is_wide(const MadeLens& lens) { return lens.model != "brown_conrady" && lens.model != "rational_polynomial"; }

glm::dvec3 at_angle(double angle_rad, double around_rad = 0) {
  return {std::sin(angle_rad) * std::cos(around_rad), std::sin(angle_rad) * std::sin(around_rad), std::cos(angle_rad)};
}

}  // namespace

TEST_CASE("directions are projected to the pixels of the formulas") {
  const SensorRandom random(1, "directions");
  for (const MadeLens& model : kModels) {
    CAPTURE(model.model);
    const Lens lens = test::made(model);
    double worst_px = 0;
    std::uint32_t shown = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      // Random directions in a cap of up to 30 degrees, or 109 for fisheyes.
      const double angle = (0.01 + random.uniform(i, 0, 0)) * (is_wide(model) ? 1.88 : 0.52);
      const glm::dvec3 p = (0.1 + 10 * random.uniform(i, 0, 2)) * at_angle(angle, 6.28 * random.uniform(i, 0, 1));
      if (!lens.shows(p)) continue;
      ++shown;
      worst_px = std::max(worst_px, glm::length(lens.pixel(p) - test::formula_pixel(model, p)));
    }
    CHECK(shown == kPoints);
    CHECK(worst_px <= kAgree_px);
  }
}

TEST_CASE("the inverse finds the direction of every pixel") {
  const SensorRandom random(2, "pixels");
  for (const MadeLens& model : kModels) {
    CAPTURE(model.model);
    const Lens lens = test::made(model);
    double worst_px = 0, worst_length = 0;
    int none = 0, dark = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const glm::dvec2 pixel(kLensWidth_px * random.uniform(i, 0, 0), kLensHeight_px * random.uniform(i, 0, 1));
      const std::optional<glm::dvec3> ray = lens.direction(pixel);
      none += !ray;
      if (!ray) continue;
      if (*ray == glm::dvec3(0)) {
        ++dark;
        // Beyond 110 degrees. With k = 0 it is an ellipse about the principal point.
        const glm::dvec2 off((pixel.x - model.pinhole.cx_px) / model.pinhole.fx_px,
                             (pixel.y - model.pinhole.cy_px) / model.pinhole.fy_px);
        CHECK(glm::length(off) > kFisheyeLimit_rad);
        continue;
      }
      worst_length = std::max(worst_length, std::abs(glm::length(*ray) - 1));
      worst_px = std::max(worst_px, glm::length(test::formula_pixel(model, *ray) - pixel));
    }
    CHECK(none == 0);
    CHECK((dark > 0) == (model.pinhole.fx_px < 200));
    CHECK(worst_px <= kAgree_px);
    CHECK(worst_length <= 8 * 0x1p-53);  // rounding of a normalisation, or of sine and cosine
  }
}

// Whether the lens shows the direction just before this angle from the axis, and not the one just after it.
void check_ends_at(const Lens& lens, double angle_rad) {
  constexpr double kBeside_rad = 1e-7;  // the fold is bisected to rounding, where the slope is flat
  CHECK(lens.shows(at_angle(angle_rad - kBeside_rad)));
  CHECK_FALSE(lens.shows(at_angle(angle_rad + kBeside_rad)));
}

TEST_CASE("an image ends where its lens folds") {
  // r (1 + k1 r^2) is largest at r = 1 / sqrt(-3 k1), where it is 2 / 3 r.
  const double k1 = -0.3, reach = 2.0 / 3 / std::sqrt(0.9);
  const Lens lens = test::made(brown_conrady(k1, 0, 0, 0, 0));
  check_ends_at(lens, std::atan(1 / std::sqrt(0.9)));
  const auto at = [&](double d) { return lens.direction({322.75 + 420.5 * d, 236.5}); };
  // The inverse still reaches 1e-9 px a millionth in front of the fold, and finds nothing beyond it.
  REQUIRE(at(reach * (1 - 1e-6)));
  const glm::dvec3 ray = *at(reach * (1 - 1e-6));
  CHECK(ray.x / ray.z < 1 / std::sqrt(0.9));
  CHECK(std::abs(lens.pixel(ray).x - (322.75 + 420.5 * reach * (1 - 1e-6))) <= kAgree_px);
  CHECK_FALSE(at(reach * (1 + 1e-6)));

  // d = theta - 0.2 theta^3 is largest at 1 / sqrt(0.6) = 74 degrees.
  const Lens folded = test::made(fisheye("kannala_brandt", 250, {-0.2, 0, 0, 0}));
  check_ends_at(folded, 1 / std::sqrt(0.6));
  CHECK(folded.direction({322.75 + 250 * 0.85, 236.5}));
  CHECK_FALSE(folded.direction({322.75 + 250 * 0.87, 236.5}));
}

// The largest angle from the axis that the lens shows in this direction around it.
double end_rad(const Lens& lens, double around_rad) {
  double shown = 0, beyond = std::numbers::pi / 2;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (shown + beyond) / 2;
    (lens.shows(at_angle(middle, around_rad)) ? shown : beyond) = middle;
  }
  return shown;
}

TEST_CASE("a tangential lens ends where it first folds in a direction around the axis") {
  // At x = 0, y'' = y + k1 y^3 + 3 p1 y^2 turns where 1 + 3 k1 y^2 + 6 p1 y = 0: nearest to the axis on the side of
  // negative y, as p1 is positive.
  const double k1 = -0.3, p1 = 0.01;
  const double turns_at = (-6 * p1 + std::sqrt(36 * p1 * p1 - 12 * k1)) / (-6 * k1);
  const Lens lens = test::made(brown_conrady(k1, 0, 0, p1, 0));
  // Somewhat earlier: the determinant may be less between two directions that are looked at, by 1.1 % of its range.
  // That is 0.09 around the fold, and the determinant falls by 1.3 with each tangent.
  constexpr double kEarlier = 1.1e-2 * 0.09 / 1.3;
  const double end = end_rad(lens, 0);
  CHECK(end < std::atan(turns_at));
  CHECK(end > std::atan(turns_at - kEarlier));
  for (int i = 1; i < 16; ++i) {
    CHECK(std::abs(end_rad(lens, i * std::numbers::pi / 8) - end) <= 8 * 0x1p-53);  // rounding of two angles
  }
}

TEST_CASE("the inverse finds every direction that a lens shows") {
  // The first one has a strip of falling radii between rising ones, where its radial part is almost flat. The second
  // one has a pole, near which a pixel is less than the rounding of a tangent.
  std::vector<MadeLens> models = kModels;
  models.push_back(brown_conrady(-0.39444, -0.059524, 0.074521, 0.0011737, -0.0079929));
  models.push_back(rational({0, 0, 1e-3, -2e-3, 0, -0.5, 0, 0}));
  const SensorRandom random(4, "shown directions");
  // The inverse leaves 1e-12 focal lengths. At a thousandth before the fold the slope is at least 1e-4.
  constexpr double kBeforeFold = 0.999, kDirection = 1e-12 / 1e-4;
  for (const MadeLens& model : models) {
    CAPTURE(model.model);
    CAPTURE(model.coefficients[0]);
    const Lens lens = test::made(model);
    const double end = is_wide(model) ? 1.9 : kBeforeFold * end_rad(lens, 0);
    int shown = 0, missed = 0;
    double worst = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const glm::dvec3 direction = at_angle(end * random.uniform(i, 0, 0), 6.28 * random.uniform(i, 0, 1));
      if (!lens.shows(direction)) continue;
      ++shown;
      const std::optional<glm::dvec3> found = lens.direction(lens.pixel(direction));
      missed += !found;
      if (found) worst = std::max(worst, glm::length(*found - direction));
    }
    CHECK(shown > kPoints / 2);
    CHECK(missed == 0);
    CHECK(worst <= kDirection);
  }
}

TEST_CASE("a rational lens ends at the pole of its divisor, and a tilted one where its sensor is edge-on") {
  // 1 - r^2 / 2 is 0 at r = sqrt(2). Radii grow without bound before it, so that each pixel has a ray.
  const Lens pole = test::made(rational({0, 0, 0, 0, 0, -0.5, 0, 0}));
  check_ends_at(pole, std::atan(std::numbers::sqrt2));
  const std::optional<glm::dvec3> far = pole.direction({322.75 + 420.5 * 100, 236.5});
  REQUIRE(far);
  CHECK(far->x / far->z < std::numbers::sqrt2);
  // Tilted about y by tau: w3 = sin(tau) x'' + cos(tau), which is 0 at x'' = -cot(tau).
  const double tau = 0.7;
  const Lens tilted = test::made(rational({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, tau}));
  const double end = -1 / std::tan(tau);
  CHECK(tilted.shows({end + 1e-9, 0, 1}));
  CHECK_FALSE(tilted.shows({end - 1e-9, 0, 1}));
}

TEST_CASE("double spheres show what their pinhole sees of the second sphere") {
  for (const glm::dvec2& spheres : {glm::dvec2(-0.5, 0.2), {0, 0.9}, {-0.3, 0.8}, {-0.6, 0.3}}) {
    const double xi = spheres.x, alpha = spheres.y;
    CAPTURE(xi);
    CAPTURE(alpha);
    // The pinhole sees the second sphere up to xi + cos = -w1 d2, w1 as in Usenko et al. 2018. Squared, with
    // d2^2 = 1 + 2 xi cos + xi^2, this is a quadratic equation for the cosine of the angle.
    const double w1 = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
    const double end_rad = std::acos(-xi * (1 - w1 * w1) - w1 * std::sqrt(1 - xi * xi * (1 - w1 * w1)));
    REQUIRE(end_rad < kFisheyeLimit_rad);
    const Lens lens = test::made(fisheye("double_sphere", 200, {xi, alpha}));
    check_ends_at(lens, end_rad);
    if (alpha <= 0.5) continue;  // every pixel has a ray
    // r^2 <= 1 / (2 alpha - 1)
    const double reach = 1 / std::sqrt(2 * alpha - 1);
    CHECK(lens.direction({322.75 + 200 * reach * (1 - 1e-9), 236.5}));
    CHECK_FALSE(lens.direction({322.75 + 200 * reach * (1 + 1e-9), 236.5}));
  }
  // Special cases: a pinhole, a stereographic and an orthographic projection.
  for (const double angle : {0.1, 0.7, 1.2}) {
    const auto radius = [&](double alpha) {
      const Lens lens = test::made(fisheye("double_sphere", 1, {0, alpha}));
      return lens.pixel(at_angle(angle)).x - 322.75;
    };
    constexpr double kPlaces = 2 * 322.75 * 0x1p-53;  // rounding of a place beside the principal point, and of radii
    CHECK(std::abs(radius(0) - std::tan(angle)) <= kPlaces);
    CHECK(std::abs(radius(0.5) - 2 * std::tan(angle / 2)) <= kPlaces);
    CHECK(std::abs(radius(1) - std::sin(angle)) <= kPlaces);
  }
}

TEST_CASE("f-theta lenses end where their polynomials turn") {
  // 300 theta - 100 theta^2 turns at 1.5 rad, at 225 px.
  const Lens forward = test::made(fisheye("ftheta", 300, {0, 300, -100}, 1));
  check_ends_at(forward, 1.5);
  CHECK(forward.direction({322.75 + 225 - 1e-9, 236.5}));
  CHECK_FALSE(forward.direction({322.75 + 225 + 1e-9, 236.5}));
  // 0.005 r - 1e-5 r^2 turns at 250 px, at 0.625 rad. Angles are flat there: 1e-7 rad are 0.1 px.
  const Lens backward = test::made(fisheye("ftheta_backward", 200, {0, 0.005, -1e-5}, 1));
  check_ends_at(backward, 0.625);
  CHECK(backward.direction({322.75 + 250 - 1e-9, 236.5}));
  CHECK_FALSE(backward.direction({322.75 + 250 + 1e-9, 236.5}));
  // One that does not turn is black beyond 110 degrees, which 0.005 r + 1e-5 r^2 reaches at 254.8 px.
  const Lens wide = test::made(fisheye("ftheta_backward", 200, {0, 0.005, 1e-5}, 1));
  const double end_px = (std::sqrt(0.005 * 0.005 + 4e-5 * kFisheyeLimit_rad) - 0.005) / 2e-5;
  CHECK(wide.direction({322.75 + end_px - 1e-6, 236.5}) != glm::dvec3(0));
  CHECK(wide.direction({322.75 + end_px + 1e-6, 236.5}) == glm::dvec3(0));
  CHECK(wide.direction({322.75 + 5000, 236.5}) == glm::dvec3(0));
  check_ends_at(wide, kFisheyeLimit_rad);
}

TEST_CASE("calibrations with another number of coefficients are no lens") {
  const Pinhole pinhole{100, 100, 50, 50};
  for (std::size_t count = 0; count <= 16; ++count) {
    CAPTURE(count);
    const std::vector<double> zeros(count, 0.0);
    CHECK(lens_of(pinhole, "plumb_bob", zeros).has_value() == (count == 5));
    CHECK(lens_of(pinhole, "equidistant", zeros).has_value() == (count == 4));
    CHECK(lens_of(pinhole, "rational_polynomial", zeros).has_value() == (count == 8 || count == 12 || count == 14));
    CHECK(lens_of(pinhole, "double_sphere", zeros).has_value() == (count == 2));
    std::vector<double> rising(count, 0.0);
    if (count > 1) rising[1] = 1;
    CHECK(lens_of(pinhole, "ftheta", rising).has_value() == (count >= 2 && count <= 6));
    CHECK(lens_of(pinhole, "ftheta_backward", rising).has_value() == (count >= 2 && count <= 6));
    CHECK_FALSE(lens_of(pinhole, "of a plug-in", zeros));
  }
}

#ifdef SIMVIS_HAS_OPENCV

TEST_CASE("OpenCV projects directions to the same pixels") {
  const SensorRandom random(3, "OpenCV");
  int compared = 0;
  for (const MadeLens& model : kModels) {
    if (is_wide(model) && model.model != "kannala_brandt") continue;
    CAPTURE(model.model);
    CAPTURE(model.coefficients.size());
    std::vector<cv::Point3d> points;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const auto between = [&](double low, double high, std::uint32_t draw) {
        return low + (high - low) * random.uniform(i, 0, draw);
      };
      points.emplace_back(between(-1, 1, 0), between(-1, 1, 1), between(1.6, 3, 2));
    }
    // OpenCV counts pixels from the centre of the first one.
    const Pinhole& p = model.pinhole;
    const cv::Matx33d camera(p.fx_px, 0, p.cx_px - 0.5, 0, p.fy_px, p.cy_px - 0.5, 0, 0, 1);
    const cv::Vec3d none(0, 0, 0);
    std::vector<cv::Point2d> seen;
    if (is_wide(model)) {
      cv::fisheye::projectPoints(points, seen, none, none, camera, model.coefficients);
    } else {
      cv::projectPoints(points, none, none, camera, model.coefficients, seen);
    }
    const Lens lens = test::made(model);
    double worst_px = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2 own = lens.pixel({points[i].x, points[i].y, points[i].z});
      worst_px = std::max(worst_px, glm::length(own - glm::dvec2(seen[i].x + 0.5, seen[i].y + 0.5)));
    }
    MESSAGE(std::string(model.model) << ", " << model.coefficients.size() << " coefficients: " << worst_px << " px");
    CHECK(worst_px <= kAgree_px);
    ++compared;
  }
  CHECK(compared == 8);
}

#endif

TEST_SUITE_END();
