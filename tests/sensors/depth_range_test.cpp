// Ranges from made-up depth without a renderer, so that every number is known.
#include "sensors/raster_depth/depth_range.h"
#include "sensors/laser_scanner/scan_layout.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/infinity.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

constexpr double kNear_m = 1e-4;

// Rounding of the stored float32 depth to nearest: half an ulp, relative.
constexpr double kDepthRounding = 0x1p-24;

// Inverse depth along Z at the tangents (x, y) of a face; 0 where nothing is hit.
using World = std::function<double(double x, double y)>;

// The plane through `point` with this normal, in the face's frame.
World plane(glm::dvec3 normal, glm::dvec3 point) {
  const double h = glm::dot(normal, point);
  return [=](double x, double y) { return std::max(0.0, glm::dot(normal, glm::dvec3(x, y, 1)) / h); };
}

struct Picture {
  ScanLayout layout;
  std::vector<std::vector<float>> faces;
  double snap_px = 0, depth_snap_px = 0;

  Picture(const ScanPattern& pattern, double resolution_px, const World& world)
      : layout(make_scan_layout(pattern, resolution_px)) {
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
    const double width = face.width_px, height = face.height_px;
    return {.depth = faces[tap.face].data(),
            .stride_px = face.width_px,
            .near_m = kNear_m,
            .focal_x_px = face.pinhole.fx_px,
            .focal_y_px = face.pinhole.fy_px,
            .reach =
                {.x_px = width, .y_px = height, .width_px = width, .height_px = height, .depth_snap_px = depth_snap_px},
            .middle_tangent_x = (width / 2 - face.pinhole.cx_px) / face.pinhole.fx_px,
            .middle_tangent_y = (height / 2 - face.pinhole.cy_px) / face.pinhole.fy_px,
            .snap_px = snap_px};
  }

  RangeEstimate planar(std::size_t beam) const {
    const BeamTap& tap = layout.taps[beam];
    return planar_range(pixels(tap), tap, VertexRounding());
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

const ScanPattern kFan{.beams = 1001, .min_azimuth_rad = -0.7, .max_azimuth_rad = 0.7};
const ScanPattern kLidar{.beams = 301,
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
        // Interpolation weighs depths that each have their own rounding; the sum of the weights is that of the depths.
        REQUIRE(std::abs(estimate.range_m - truth) <= kDepthRounding * truth * (1 + 1e-6));
      }
      CHECK(hits > 0);
    }
  }
}

TEST_CASE("the range at a crease is that of the intersection of the planes, convex and concave") {
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
        // Both planes are extended by at most a pixel in each direction: five roundings.
        REQUIRE(std::abs(estimate.range_m - truth) <= 5 * kDepthRounding * truth + 1e-15 * truth);
      }
    }
  }
}

TEST_CASE("beside a step the range belongs to one of the two surfaces, and the bound is infinite") {
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

TEST_CASE("empty space reads infinity with certainty, and beside a surface without certainty") {
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

TEST_CASE("the error of nearest is the slant over half a pixel, and its bound covers it") {
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
  // Half a pixel is 1/300 of tangent. The wall's range changes by at least tan(incidence) > 1 times that.
  CHECK(worst > 1.0 / 300);
}

// Surfaces three or more pixels wide, side by side along x. Their places and slants often put pixels of neighbours on
// one line, and every pixel has an error of one or several roundings.
TEST_CASE("pixels of different surfaces that are collinear by chance do not mislead") {
  constexpr double kResolution_px = 500, kPixel = 2 / kResolution_px;
  // The error is so small that second differences down the rows, of up to four errors, are accepted: they may be half
  // of the pixel error that planar_range() assumes, at least 10 u.
  constexpr double kRough = kDepthRounding;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t certain = 0, beams = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> edges, offsets, slopes;
    double edge = -1, w = 0.3;
    while (edge < 1) {
      edges.push_back(edge);
      slopes.push_back(0.05 * unit(random));
      offsets.push_back(w);
      edge += kPixel * (3 + 2 * std::abs(unit(random)));
      w += slopes.back() * (edge - edges.back());
      // The next surface begins where this one ends, or joins it one pixel later, or lies somewhere else.
      if (random() % 3 == 0) w += kPixel * 0.05 * unit(random);
      if (random() % 3 == 0) w += 0.01 * unit(random);
    }
    const World world = [&](double x, double) {
      const auto next = std::ranges::upper_bound(edges, x);
      const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - edges.begin() - 1, 0));
      return offsets[i] + slopes[i] * (x - edges[i]);
    };
    Picture picture(kFan, kResolution_px, world);
    for (std::vector<float>& face : picture.faces) {
      for (float& depth : face) depth *= static_cast<float>(1 + kRough * unit(random));
    }
    for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
      const RangeEstimate estimate = picture.planar(beam);
      ++beams;
      if (estimate.error_bound_m == kInfinity) continue;
      ++certain;
      REQUIRE(std::abs(estimate.range_m - picture.truth(beam, world)) <= estimate.error_bound_m);
    }
  }
  CHECK(certain > beams / 20);  // narrow surfaces like these leave few beams certain
}

TEST_CASE("edges of a surface whose vertices are displaced do not mislead, along the rows nor along the columns") {
  // The upper half of the view is a surface 5 m away whose mesh has its origin 10,000 km away: at that range float32
  // displaces vertices by more than 5 roundings of that distance, 3 m, which is more than all pixels around a beam.
  constexpr double kFace_m = 5, kWall_m = 20, kAway_m = 1e7, kEdge = 0.1;
  auto mesh = std::make_shared<Mesh>();
  for (const float side : {-1.0f, 1.0f}) {
    for (const float end : {-1.0f, 1.0f}) mesh->positions.emplace_back(kAway_m, 5 * side, 5 * end);
  }
  mesh->indices = {0, 1, 2, 2, 1, 3};
  compute_bounds(*mesh);
  DrawList list;
  list.meshes.push_back(mesh);
  list.world_from_node = {glm::dmat4(1), glm::translate(glm::dmat4(1), glm::dvec3(kFace_m - kAway_m, 0, 0))};
  list.items.push_back({.mesh = 0, .material = 0, .transform = 1});
  const VertexRounding rounding(list, glm::dmat4(1));
  REQUIRE(rounding.at(kFace_m * 1.02) > 1);
  REQUIRE(rounding.at(kWall_m) == 0);
  for (const bool along_rows : {false, true}) {
    const World world = [&](double x, double y) { return (along_rows ? x : y) > kEdge ? 1 / kFace_m : 1 / kWall_m; };
    const Picture picture(kLidar, 700, world);
    int beside = 0;
    for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
      const BeamTap& tap = picture.layout.taps[beam];
      const Pinhole& k = picture.layout.faces[tap.face].pinhole;
      const double away_px = along_rows ? (kEdge - tap.tangent_x) * k.fx_px : (kEdge - tap.tangent_y) * k.fy_px;
      if (!(away_px > 0.5 && away_px < 1.4)) continue;  // a pixel around the beam is beyond the edge
      ++beside;
      CHECK(planar_range(picture.pixels(tap), tap, rounding).error_bound_m == kInfinity);
    }
    CHECK(beside > 0);
  }
}

TEST_CASE("edges that snapping has moved across the centre of a pixel do not mislead") {
  constexpr double kResolution_px = 500, kSnap_px = 1.0 / 16;  // the coarsest that Vulkan allows
  constexpr double kPixel = 2 / kResolution_px;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  const World near = plane({0.1, 0, -1}, {0, 0, 2}), far = plane({0.2, 0, -1}, {0, 0, 5});
  const World nothing = [](double, double) { return 0.0; };
  const ScanPattern dense{.beams = 20001, .min_azimuth_rad = -0.3, .max_azimuth_rad = 0.3};
  for (const ScanPattern& pattern : {dense, kLidar}) {
    for (int trial = 0; trial < 100; ++trial) {
      // Within the snapping distance of a centre: centres lie at whole pixels of tangent.
      const double edge = kPixel * (std::floor(30 * unit(random)) + kSnap_px * unit(random));
      const double moved = edge + kPixel * kSnap_px * unit(random);
      const World& beyond = trial % 2 == 0 ? far : nothing;
      const auto split = [&](double at) {
        return World([&near, &beyond, at](double x, double y) { return x < at ? near(x, y) : beyond(x, y); });
      };
      Picture picture(pattern, kResolution_px, split(moved));
      picture.snap_px = kSnap_px;
      for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
        const RangeEstimate estimate = picture.planar(beam);
        const double truth = picture.truth(beam, split(edge));
        if (estimate.error_bound_m == kInfinity || estimate.range_m == truth) continue;
        REQUIRE(std::abs(estimate.range_m - truth) <= estimate.error_bound_m);
      }
    }
  }
}

TEST_CASE("depth that a device computes from snapped vertices stays within the bound") {
  constexpr double kResolution_px = 500, kSnap_px = 1.0 / 256;
  const World wall = plane({0.9, 0.3, -0.31}, {0, 0, 3});
  for (const ScanPattern& pattern : {kFan, kLidar}) {
    const Picture exact(pattern, kResolution_px, wall);
    const Pinhole& pinhole = exact.layout.faces[0].pinhole;
    Picture picture(pattern, kResolution_px, [&](double x, double y) {
      return wall(x + kSnap_px / pinhole.fx_px, y + kSnap_px / pinhole.fy_px);
    });
    picture.snap_px = picture.depth_snap_px = kSnap_px;
    double worst_use = 0;
    for (std::size_t beam = 0; beam < picture.layout.taps.size(); ++beam) {
      const RangeEstimate estimate = picture.planar(beam);
      const double truth = picture.truth(beam, wall);
      if (!std::isfinite(estimate.error_bound_m) || truth == kInfinity) continue;
      REQUIRE(std::abs(estimate.range_m - truth) <= estimate.error_bound_m);
      worst_use = std::max(worst_use, std::abs(estimate.range_m - truth) / estimate.error_bound_m);
    }
    CHECK(worst_use > 0.1);  // without the term for snapping it would be far above 1
  }
}

TEST_SUITE_END();
