// Images of solid clouds: what pixels see is cast and exact, and what is drawn is as large as the spheres or discs.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr int kCloudWidth = 120, kCloudHeight = 80;
constexpr double kCloudRadius_m = 0.08;
// A float32 of below 8 m, rounded once, and of a depth that is a product of two.
constexpr double kCloudRounding_m = 2 * 2.4e-7;

const double kCloudFocal_px = kCloudWidth / 2.0 / std::tan(30 * std::numbers::pi / 180);

std::string pcd_of(const std::vector<glm::vec3>& points) {
  std::string text = "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nPOINTS " +
                     std::to_string(points.size()) + "\nDATA ascii\n";
  for (const glm::vec3& p : points) {
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + " 16711680\n";
  }
  return text;
}

Simulation cloud_scene_with(const std::vector<glm::vec3>& points, const std::string& outputs,
                            const std::filesystem::path& folder) {
  write_text(folder / "c.pcd", pcd_of(points));
  return Simulation::from_string(
      "<part name='C' insert_at='ROOT' file='c.pcd' point_radius='" + std::to_string(kCloudRadius_m) +
          "'/><sensor type='camera' name='CAM' insert_at='ROOT' width='120' height='80' hfov='60' outputs='" + outputs +
          "'/>",
      {}, folder);
}

// The ray of a pixel's centre in the frame of the camera: x forward, y left, z up.
glm::dvec3 cloud_pixel_ray(int x, int y) {
  return glm::normalize(
      glm::dvec3(1, -(x + 0.5 - kCloudWidth / 2.0) / kCloudFocal_px, -(y + 0.5 - kCloudHeight / 2.0) / kCloudFocal_px));
}

// The range of the nearest sphere of this radius along a ray from the origin; infinity if there is none.
double range_to_spheres(const std::vector<glm::vec3>& points, const glm::dvec3& ray, double radius_m) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::vec3& point : points) {
    const glm::dvec3 c(point);
    const double along = glm::dot(c, ray), beside = glm::length(c - along * ray);
    if (beside < radius_m) nearest = std::min(nearest, along - std::sqrt(radius_m * radius_m - beside * beside));
  }
  return nearest;
}

std::vector<glm::vec3> random_points() {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> step(-40, 40);
  std::vector<glm::vec3> points;  // multiples of 1/32, which text holds exactly
  for (int i = 0; i < 150; ++i) {
    points.emplace_back(4 + step(random) / 32.0f, step(random) / 16.0f, step(random) / 32.0f);
  }
  return points;
}

std::vector<double> numbers_of(const Simulation& simulation, const std::string& name) {
  const Measurement measurement = simulation.measurement("CAM");
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE(array != nullptr);
  std::vector<double> all;
  for (std::size_t i = 0; i < array->count(); ++i) all.push_back(array->number(i));
  return all;
}

}  // namespace

TEST_CASE("a camera that measures what pixels show sees the spheres of a cloud exactly") {
  const TemporaryFolder folder;
  const std::vector<glm::vec3> points = random_points();
  Simulation simulation = cloud_scene_with(points, "color depth range instance", folder.path());
  simulation.step();
  const std::vector<double> depth = numbers_of(simulation, "depth"), range = numbers_of(simulation, "range"),
                            instance = numbers_of(simulation, "instance");
  int hits = 0, empty = 0;
  for (int y = 0; y < kCloudHeight; ++y) {
    for (int x = 0; x < kCloudWidth; ++x) {
      const glm::dvec3 ray = cloud_pixel_ray(x, y);
      const double expected_m = range_to_spheres(points, ray, kCloudRadius_m);
      constexpr double kOutline_m = 1e-6;  // a pixel this near to an outline may show either side
      if (std::abs(expected_m - range_to_spheres(points, ray, kCloudRadius_m + kOutline_m)) > 1e-2 ||
          std::isinf(expected_m) != std::isinf(range_to_spheres(points, ray, kCloudRadius_m + kOutline_m))) {
        continue;
      }
      const auto at = static_cast<std::size_t>(y * kCloudWidth + x);
      CAPTURE(x);
      CAPTURE(y);
      if (std::isinf(expected_m)) {
        CHECK(std::isinf(range[at]));
        CHECK(std::isinf(depth[at]));
        CHECK(instance[at] == 0);
        ++empty;
      } else {
        // Beside an outline the root of the rounding of 1e-16 m^2 counts.
        CHECK(std::abs(range[at] - expected_m) < kCloudRounding_m);
        CHECK(std::abs(depth[at] - expected_m * ray.x) < kCloudRounding_m);
        CHECK(instance[at] > 0);
        ++hits;
      }
    }
  }
  CHECK(hits > 500);
  CHECK(empty > 500);
}

TEST_CASE("a point is drawn as a square as wide as its sphere, and nearer points hide others") {
  const TemporaryFolder folder;
  for (const float away_m : {2.0f, 4.0f}) {
    CAPTURE(away_m);
    Simulation simulation = cloud_scene_with({{away_m, 0, 0}, {away_m + 2, 0, 0}}, "color depth", folder.path());
    simulation.step();
    const Image color = simulation.color("CAM");
    int pixels = 0;
    for (std::size_t i = 0; i < std::size_t{kCloudWidth} * kCloudHeight; ++i) {
      pixels += color.pixels[color.channels * i] > 0.9f && color.pixels[color.channels * i + 1] < 0.1f;
    }
    const double side_px = 2 * kCloudRadius_m * kCloudFocal_px / away_m;
    CHECK(pixels >= std::floor(side_px) * std::floor(side_px));
    CHECK(pixels <= std::ceil(side_px) * std::ceil(side_px));
    const Image depth = simulation.depth("CAM");
    const double middle_m = depth.pixels[std::size_t{kCloudHeight / 2} * kCloudWidth + kCloudWidth / 2];
    CHECK(std::abs(middle_m - away_m) < kCloudRounding_m);
    const double bound_m = simulation.measurement("CAM").value("depth_error_bound_m").value();
    CHECK(bound_m >= kCloudRadius_m);
    CHECK(bound_m < 2 * kCloudRadius_m);
  }
}

namespace {

struct Disc {
  glm::vec3 at, normal;
};

std::string ply_of(const std::vector<Disc>& discs) {
  std::ostringstream text;
  text << std::setprecision(9) << "ply\nformat ascii 1.0\nelement vertex " << discs.size() << "\n";
  for (const char* const name : {"x", "y", "z", "nx", "ny", "nz"}) text << "property float " << name << "\n";
  text << "end_header\n";
  for (const Disc& disc : discs) {
    for (const glm::vec3& v : {disc.at, disc.normal}) text << v.x << " " << v.y << " " << v.z << " ";
    text << "\n";
  }
  return text.str();
}

Simulation disc_scene_with(const std::vector<Disc>& discs, const std::string& outputs, const std::string& others,
                           const std::filesystem::path& folder) {
  write_text(folder / "d.ply", ply_of(discs));
  return Simulation::from_string(
      "<part name='C' insert_at='ROOT' file='d.ply' point_shape='disc' point_radius='" +
          std::to_string(kCloudRadius_m) + "'/>" + others +
          "<sensor type='camera' name='CAM' insert_at='ROOT' width='120' height='80' hfov='60' outputs='" + outputs +
          "'/>",
      {}, folder);
}

// Discs that do not hide each other, each at its own slant. Their squares do not touch either.
std::vector<Disc> discs_apart() {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> step(-8, 8);
  std::vector<Disc> discs;
  for (int y = -3; y <= 3; ++y) {
    for (int z = -2; z <= 2; ++z) {
      const float x = 3 + step(random) / 32.0f;
      glm::vec3 normal(0);
      while (normal == glm::vec3(0)) normal = {step(random) / 8.0f, step(random) / 8.0f, step(random) / 8.0f};
      discs.push_back({{x, y * x / 8, z * x / 8}, normal});
    }
  }
  return discs;
}

struct DiscHit {
  double range_m = std::numeric_limits<double>::infinity(), cosine = 1;  // of incidence
  bool any() const { return std::isfinite(range_m); }
};

// The nearest disc of this radius along a ray from the origin.
DiscHit hit_of_discs(const std::vector<Disc>& discs, const glm::dvec3& ray, double radius_m) {
  DiscHit nearest;
  for (const Disc& disc : discs) {
    const glm::dvec3 middle(disc.at), n = glm::normalize(glm::dvec3(disc.normal));
    const double cosine = glm::dot(n, ray), t = glm::dot(n, middle) / cosine;
    const bool is_hit = t > 0 && t < nearest.range_m && glm::length(t * ray - middle) <= radius_m;
    if (is_hit) nearest = {t, std::abs(cosine)};
  }
  return nearest;
}

}  // namespace

TEST_CASE("images of discs: cast pixels are exact, and drawn depths of what a disc covers are within their bound") {
  const TemporaryFolder folder;
  const std::vector<Disc> discs = discs_apart();
  Simulation cast = disc_scene_with(discs, "depth range instance", "", folder.path());
  Simulation drawn = disc_scene_with(discs, "depth", "", folder.path());
  cast.step();
  drawn.step();
  const std::vector<double> range = numbers_of(cast, "range"), depth = numbers_of(cast, "depth"),
                            drawn_depth = numbers_of(drawn, "depth");
  const double bound_m = drawn.measurement("CAM").value("depth_error_bound_m").value();
  CHECK(bound_m >= kCloudRadius_m);
  CHECK(bound_m < 1.5 * kCloudRadius_m);
  int hits = 0, empty = 0;
  double largest_m = 0;
  for (int y = 0; y < kCloudHeight; ++y) {
    for (int x = 0; x < kCloudWidth; ++x) {
      const glm::dvec3 ray = cloud_pixel_ray(x, y);
      const DiscHit expected = hit_of_discs(discs, ray, kCloudRadius_m);
      constexpr double kRim_m = 1e-6;  // a pixel this near to a rim may show either side
      if (hit_of_discs(discs, ray, kCloudRadius_m - kRim_m).any() !=
          hit_of_discs(discs, ray, kCloudRadius_m + kRim_m).any()) {
        continue;
      }
      const auto at = static_cast<std::size_t>(y * kCloudWidth + x);
      CAPTURE(x);
      CAPTURE(y);
      if (!expected.any()) {
        CHECK(std::isinf(range[at]));
        CHECK(std::isinf(depth[at]));
        ++empty;
        continue;
      }
      // The normal of the file is rounded to float32, which moves a point of the disc along the ray by its distance
      // from the middle times this angle, over the cosine of incidence.
      constexpr double kNormal_rad = 1.2e-7;
      const double rounding_m = kCloudRounding_m + kCloudRadius_m * kNormal_rad / expected.cosine;
      CHECK(std::abs(range[at] - expected.range_m) < rounding_m);
      CHECK(std::abs(depth[at] - expected.range_m * ray.x) < rounding_m);
      CHECK(std::abs(drawn_depth[at] - expected.range_m * ray.x) <= bound_m);
      largest_m = std::max(largest_m, std::abs(drawn_depth[at] - expected.range_m * ray.x));
      ++hits;
    }
  }
  CHECK(hits > 300);
  CHECK(empty > 3000);
  CHECK(largest_m > 0.5 * kCloudRadius_m);
}

TEST_CASE("a disc is lit on the side that is seen, whichever way the file turns its normal") {
  const TemporaryFolder folder;
  const auto shade = [&](const glm::vec3& normal, const std::string& azimuth) {
    Simulation simulation = disc_scene_with(
        {{{2, 0, 0}, normal}}, "color",
        "<element type='sky' name='SKY' insert_at='ROOT' ambient_red='0' ambient_green='0' ambient_blue='0'/>"
        "<element type='light' name='SUN' insert_at='ROOT' elevation='0' intensity='1' azimuth='" +
            azimuth + "'/>",
        folder.path());
    simulation.step();
    const Image color = simulation.color("CAM");
    return color.pixels[color.channels * (std::size_t{kCloudHeight / 2} * kCloudWidth + kCloudWidth / 2)];
  };
  // White, at 0.6 of the light, over pi; normals have 16 bits.
  const double expected = 0.6 / std::numbers::pi;
  for (const float side : {-1.0f, 1.0f}) {
    CAPTURE(side);
    CHECK(std::abs(shade(side * glm::vec3(0.6f, 0.8f, 0), "180") - expected) < 1e-4);
    CHECK(shade(side * glm::vec3(0.6f, 0.8f, 0), "0") == 0);
  }
}

}  // namespace simvis
