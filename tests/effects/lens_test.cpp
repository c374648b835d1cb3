// The lens models against their formulas, their inverses and their folds.
#include "effects/camera/lens.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include <simvis/philox.h>

#ifdef SIMVIS_HAS_OPENCV
#include <opencv2/calib3d.hpp>
#endif

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

constexpr std::uint32_t kPoints = 10'000;

// Tolerance for formulas and inverses: rounding of about twenty operations on pixels below 1000, 20 * 1000 * 2^-53, is
// 2e-12. Newton's method promises to end within 1e-9.
constexpr double kAgree_px = 1e-9;

constexpr double kLensWidth_px = 640, kLensHeight_px = 480;

LensModel brown_conrady(double k1, double k2, double k3, double p1, double p2) {
  return {.kind = LensKind::brown_conrady,
          .pinhole = {420.5, 410.25, 322.75, 236.5},
          .k = {k1, k2, k3, 0},
          .p1 = p1,
          .p2 = p2};
}

LensModel fisheye(double fx_px, double k1, double k2, double k3, double k4) {
  return {.kind = LensKind::kannala_brandt, .pinhole = {fx_px, 0.98 * fx_px, 322.75, 236.5}, .k = {k1, k2, k3, k4}};
}

// Barrel distortions, a pincushion distortion, a lens that is tilted against its chip, and fisheyes. The last one sees
// 220 degrees in a circle of 320 pixels.
const std::vector<LensModel> kModels{brown_conrady(-0.28, 0.09, -0.01, 0, 0), brown_conrady(0.2, 0.05, 0, 0, 0),
                                     brown_conrady(-0.2, 0.03, 0, 2e-3, -3e-3),
                                     fisheye(250, -0.01, 0.002, -0.001, 1e-4), fisheye(166.7, 0, 0, 0, 0)};

// The formulas of OpenCV's documentation, term by term.
glm::dvec2 formula(const LensModel& m, double x, double y, double z) {
  const double *k = m.k, a = x / z, b = y / z;
  double xd = 0, yd = 0;
  if (m.kind == LensKind::brown_conrady) {
    const double r2 = a * a + b * b;
    const double radial = 1 + k[0] * r2 + k[1] * std::pow(r2, 2) + k[2] * std::pow(r2, 3);
    xd = a * radial + 2 * m.p1 * a * b + m.p2 * (r2 + 2 * a * a);
    yd = b * radial + m.p1 * (r2 + 2 * b * b) + 2 * m.p2 * a * b;
  } else {
    const double theta = std::acos(z / std::sqrt(x * x + y * y + z * z)), phi = std::atan2(y, x);
    const double d = theta * (1 + k[0] * std::pow(theta, 2) + k[1] * std::pow(theta, 4) + k[2] * std::pow(theta, 6) +
                              k[3] * std::pow(theta, 8));
    xd = d * std::cos(phi);
    yd = d * std::sin(phi);
  }
  return {m.pinhole.fx_px * xd + m.pinhole.cx_px, m.pinhole.fy_px * yd + m.pinhole.cy_px};
}

}  // namespace

TEST_CASE("directions are projected to the pixels of the formulas") {
  const SensorRandom random(1, "directions");
  for (const LensModel& model : kModels) {
    const Lens lens(model);
    double worst_px = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      // Random directions in a cap of up to 30 degrees, or 109 for fisheyes. acos() is inaccurate near 0 and 180.
      const bool wide = model.kind == LensKind::kannala_brandt;
      const double angle = (0.01 + random.uniform(i, 0, 0)) * (wide ? 1.88 : 0.52);
      const double around = 6.28 * random.uniform(i, 0, 1), far = 0.1 + 10 * random.uniform(i, 0, 2);
      const glm::dvec3 p =
          far * glm::dvec3(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around), std::cos(angle));
      worst_px = std::max(worst_px, glm::length(lens.pixel(p) - formula(model, p.x, p.y, p.z)));
    }
    CHECK(worst_px <= kAgree_px);
  }
}

TEST_CASE("the inverse finds the direction of every pixel") {
  const SensorRandom random(2, "pixels");
  for (const LensModel& model : kModels) {
    const Lens lens(model);
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
      worst_px = std::max(worst_px, glm::length(formula(model, ray->x, ray->y, ray->z) - pixel));
    }
    CHECK(none == 0);
    CHECK((dark > 0) == (model.pinhole.fx_px < 200));
    CHECK(worst_px <= kAgree_px);
    CHECK(worst_length <= 8 * 0x1p-53);  // rounding of a normalisation, or of sine and cosine
  }
}

TEST_CASE("an image ends where its lens folds") {
  // r (1 + k1 r^2) is largest at r = 1 / sqrt(-3 k1), where it is 2 / 3 r.
  const double k1 = -0.3, reach = 2.0 / 3 / std::sqrt(0.9);
  const Lens lens(brown_conrady(k1, 0, 0, 0, 0));
  constexpr double kBracket = 1e-12;  // sixty halvings, and rounding at the flat top of a maximum
  CHECK(std::abs(lens.reach() - reach) <= kBracket);
  const auto at = [&](double d) { return lens.direction({322.75 + 420.5 * d, 236.5}); };
  // The inverse still reaches 1e-9 px a millionth in front of the fold, and finds nothing beyond it.
  REQUIRE(at(reach * (1 - 1e-6)));
  const glm::dvec3 ray = *at(reach * (1 - 1e-6));
  CHECK(ray.x / ray.z < 1 / std::sqrt(0.9));
  CHECK(std::abs(lens.pixel(ray).x - (322.75 + 420.5 * reach * (1 - 1e-6))) <= kAgree_px);
  CHECK_FALSE(at(reach * (1 + 1e-6)));

  // d = theta - 0.2 theta^3 is largest at 1 / sqrt(0.6) = 74 degrees.
  const Lens folded(fisheye(250, -0.2, 0, 0, 0));
  CHECK(std::abs(folded.reach() - 2.0 / 3 / std::sqrt(0.6)) <= kBracket);
  CHECK(folded.direction({322.75 + 250 * 0.85, 236.5}));
  CHECK_FALSE(folded.direction({322.75 + 250 * 0.87, 236.5}));
}

#ifdef SIMVIS_HAS_OPENCV

TEST_CASE("OpenCV projects directions to the same pixels") {
  const SensorRandom random(3, "OpenCV");
  for (const LensModel& model : kModels) {
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
    if (model.kind == LensKind::brown_conrady) {
      const std::vector<double> coefficients{model.k[0], model.k[1], model.p1, model.p2, model.k[2]};
      cv::projectPoints(points, none, none, camera, coefficients, seen);
    } else {
      const std::vector<double> coefficients(model.k, model.k + 4);
      cv::fisheye::projectPoints(points, seen, none, none, camera, coefficients);
    }
    const Lens lens(model);
    double worst_px = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2 own = lens.pixel({points[i].x, points[i].y, points[i].z});
      worst_px = std::max(worst_px, glm::length(own - glm::dvec2(seen[i].x + 0.5, seen[i].y + 0.5)));
    }
    CHECK(worst_px <= kAgree_px);
  }
}

#endif

TEST_SUITE_END();
