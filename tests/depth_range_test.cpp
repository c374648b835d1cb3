// Ranges from made-up depth: no renderer, so every number is known.
#include "sensors/depth_range.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

using namespace simvis;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNear_m = 1e-4;

// Rounding of the stored float32 depth to nearest: half an ulp, relative.
constexpr double kDepthRounding = 0x1p-24;

// Inverse depth along Z seen at the tangents (x, y) of a face; 0 where nothing is hit.
using World = std::function<double(double x, double y)>;

// The plane through `point` across `normal`, in the face's frame.
World plane(glm::dvec3 normal, glm::dvec3 point) {
  const double h = glm::dot(normal, point);
  return [=](double x, double y) { return std::max(0.0, glm::dot(normal, glm::dvec3(x, y, 1)) / h); };
}

struct Picture {
  ScanLayout layout;
  std::vector<std::vector<float>> faces;

  Picture(const ScanPattern& pattern, double resolution_px, const World& world)
      : layout(lay_out(pattern, resolution_px)) {
    for (const ScanFace& face : layout.faces) {
      std::vector<float>& pixels = faces.emplace_back();
      for (std::uint32_t y = 0; y < face.height_px; ++y) {
        for (std::uint32_t x = 0; x < face.width_px; ++x) {
          const double w = world((x + 0.5 - face.pinhole.cx_px) / face.pinhole.fx_px,
                                 (y + 0.5 - face.pinhole.cy_px) / face.pinhole.fy_px);
          pixels.push_back(static_cast<float>(kNear_m * w));
        }
      }
    }
  }

  FacePixels pixels(const BeamTap& tap) const {
    const ScanFace& face = layout.faces[tap.face];
    return {faces[tap.face].data(),
            face.width_px,
            kNear_m,
            face.pinhole.fx_px,
            static_cast<double>(face.width_px),
            static_cast<double>(face.height_px)};
  }

  RangeEstimate planar(std::size_t beam) const {
    const BeamTap& tap = layout.taps[beam];
    return planar_range(pixels(tap), tap, layout.planar, VertexRounding());
  }

  RangeEstimate nearest(std::size_t beam) const {
    const BeamTap& tap = layout.taps[beam];
    return nearest_range(pixels(tap), tap, layout.faces[tap.face], planar(beam));
  }

  double truth(std::size_t beam, const World& world) const {
    const BeamTap& tap = layout.taps[beam];
    const double w = world(tap.tangent_x, tap.tangent_y);
    return w > 0 ? tap.ray_per_depth / w : kInfinity;
  }
};

const ScanPattern kFan{.samples = 1001, .min_azimuth_rad = -0.7, .max_azimuth_rad = 0.7};
const ScanPattern kLidar{.samples = 301,
                         .rings = 31,
                         .min_azimuth_rad = -0.7,
                         .max_azimuth_rad = 0.7,
                         .min_elevation_rad = -0.3,
                         .max_elevation_rad = 0.3};

}  // namespace

TEST_CASE("on planes of any slant the range is exact up to the rounding of the depth, and the bound holds") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ScanPattern& pattern : {kFan, kLidar}) {
    for (int trial = 0; trial < 40; ++trial) {
      const glm::dvec3 normal = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)));
      const World world = plane(normal, glm::dvec3(0, 0, 1 + 10 * std::abs(unit(random))));
      const Picture picture(pattern, 700, world);
      std::size_t hits = 0;
      for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
        const RangeEstimate estimate = picture.planar(beam);
        const double truth = picture.truth(beam, world);
        if (estimate.error_bound_m == kInfinity) continue;  // beside the plane's horizon
        REQUIRE((estimate.range_m == kInfinity) == (truth == kInfinity));
        if (truth == kInfinity) continue;
        REQUIRE(std::abs(estimate.range_m - truth) <= estimate.error_bound_m);
        ++hits;
        // Interpolation weighs depths that are each off by their own rounding; the weights' sum is that of the depths.
        REQUIRE(std::abs(estimate.range_m - truth) <= kDepthRounding * truth * (1 + 1e-6));
      }
      CHECK(hits > 0);
    }
  }
}

TEST_CASE("a crease is met where the planes cross, convex and concave") {
  const World left = plane({0.6, 0, -0.8}, {0, 0, 4}), right = plane({-0.7, 0, -0.714}, {0, 0, 4});
  for (const bool convex : {true, false}) {
    const World world = [&](double x, double y) {
      return convex ? std::min(left(x, y), right(x, y)) : std::max(left(x, y), right(x, y));
    };
    for (const ScanPattern& pattern : {kFan, kLidar}) {
      const Picture picture(pattern, 1000, world);
      for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
        const RangeEstimate estimate = picture.planar(beam);
        const double truth = picture.truth(beam, world);
        REQUIRE(std::isfinite(estimate.error_bound_m));
        REQUIRE(std::abs(estimate.range_m - truth) <= estimate.error_bound_m);
        // Both planes are extended over at most a pixel in each direction: five roundings.
        REQUIRE(std::abs(estimate.range_m - truth) <= 5 * kDepthRounding * truth + 1e-15 * truth);
      }
    }
  }
}

TEST_CASE("beside a step the range is of one of the two surfaces, never between, and the bound is infinite") {
  const World near = plane({0, 0, -1}, {0, 0, 2}), far = plane({0, 0, -1}, {0, 0, 5});
  for (const double edge : {0.1, 0.10037, 0.2}) {
    const World world = [&](double x, double y) { return x < edge ? near(x, y) : far(x, y); };
    for (const ScanPattern& pattern : {kFan, kLidar}) {
      const Picture picture(pattern, 500, world);
      int steps = 0;
      for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
        const BeamTap& tap = picture.layout.taps[beam];
        const RangeEstimate estimate = picture.planar(beam);
        const double depth = estimate.range_m / tap.ray_per_depth;
        REQUIRE(std::min(std::abs(depth - 2), std::abs(depth - 5)) < 5 * 5 * kDepthRounding);
        const bool within_a_pixel = std::abs(tap.tangent_x - edge) <= 1 / 250.0;
        if (estimate.error_bound_m == kInfinity) {
          ++steps;
          REQUIRE(within_a_pixel);
        } else {
          REQUIRE(std::abs(estimate.range_m - picture.truth(beam, world)) <= estimate.error_bound_m);
        }
      }
      CHECK(steps > 0);
    }
  }
}

TEST_CASE("nothing there reads infinity with certainty, and beside something without") {
  const World nothing = [](double, double) { return 0.0; };
  const Picture empty(kFan, 500, nothing);
  CHECK(empty.planar(500).range_m == kInfinity);
  CHECK(empty.planar(500).error_bound_m == 0);
  CHECK(empty.nearest(500).range_m == kInfinity);
  CHECK(empty.nearest(500).error_bound_m == 0);

  const World post = [](double x, double) { return std::abs(x) < 0.05 ? 0.5 : 0.0; };
  const Picture picture(kFan, 500, post);
  int uncertain = 0;
  for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
    const RangeEstimate estimate = picture.planar(beam);
    if (estimate.error_bound_m == kInfinity) {
      ++uncertain;
    } else {
      REQUIRE((estimate.range_m == kInfinity) == (picture.truth(beam, post) == kInfinity));
    }
  }
  CHECK(uncertain > 0);
  CHECK(uncertain < 20);
}

TEST_CASE("nearest errs by the slant of half a pixel, and its bound says so") {
  const World wall = plane({0.95, 0, -0.31}, {0, 0, 3});
  const Picture picture(kFan, 300, wall);
  double worst = 0;
  for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
    const RangeEstimate estimate = picture.nearest(beam);
    const double truth = picture.truth(beam, wall);
    if (!std::isfinite(estimate.error_bound_m)) continue;
    if (truth == kInfinity) continue;
    REQUIRE(std::abs(estimate.range_m - truth) <= estimate.error_bound_m);
    worst = std::max(worst, std::abs(estimate.range_m - truth) / truth);
  }
  // Half a pixel is 1/300 of tangent; the wall's range changes by tan(incidence) > 1 times that at the very least.
  CHECK(worst > 1.0 / 300);
}
