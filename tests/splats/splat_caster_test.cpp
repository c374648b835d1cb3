// Rays that hit Gaussian splats where half of their light is left, compared with all splats in order, and with cameras.
#include "engine/splats/splat_caster.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <memory>
#include <vector>

#include <simvis/surface_point.h>
#include "engine/splats/splat_rays.h"
#include "tests/splats/random_splats.h"

TEST_SUITE_BEGIN("engine/splats");

namespace simvis {
namespace {

using test::random_splats;
using test::shuffled;
using test::uniform;
using test::uniform_vec;

constexpr double kNone = std::numeric_limits<double>::infinity();

struct CloudPart {
  SplatCloud cloud;
  glm::dmat4 world_from_mesh{1.0};
};

/// Clouds, and a square wall across z at `wall_m`, with the last number among the items.
struct SplatWorld {
  explicit SplatWorld(const std::vector<CloudPart>& clouds, double wall_m = 0) {
    list.world_from_node.emplace_back(1.0);
    list.materials.push_back(std::make_shared<const Material>());
    list.material_revision.push_back(0);
    for (const CloudPart& part : clouds) {
      Mesh mesh;
      mesh.splats = std::make_shared<const SplatCloud>(part.cloud);
      add(mesh, part.world_from_mesh);
    }
    if (wall_m > 0) {
      Mesh wall;
      const auto z = static_cast<float>(wall_m);
      wall.positions = {{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}};
      wall.indices = {0, 1, 2, 0, 2, 3};
      wall.bounds_min = {-9, -9, z};
      wall.bounds_max = {9, 9, z};
      add(wall, glm::dmat4(1));
    }
    caster.set_world(list, *surfaces);
  }
  void add(const Mesh& mesh, const glm::dmat4& place) {
    list.meshes.push_back(std::make_shared<const Mesh>(mesh));
    list.world_from_node.push_back(place);
    const auto number = static_cast<std::uint32_t>(list.meshes.size());
    list.items.push_back({number - 1, 0, number});
  }
  RayHit along(const glm::dvec3& origin_m, const glm::dvec3& way, double t_min_m = 0) {
    RayHit hit;
    caster.cast(glm::translate(glm::dmat4(1), origin_m), {&way, 1}, {&hit, 1}, {&t_min_m, 1}, {}, HitSides::both);
    return hit;
  }

  DrawList list;
  std::unique_ptr<RayCaster> surfaces = make_host_ray_caster();
  SplatCaster caster;
};

Splat ball(double range_m, double opacity, double sigma_m = 0.01) {
  Splat splat;
  splat.center = {0, 0, range_m};
  splat.sigma = glm::vec3(static_cast<float>(sigma_m));
  splat.opacity = static_cast<float>(opacity);
  return splat;
}
CloudPart cloud_of(const std::vector<Splat>& splats) {
  return {{.splats = splats, .harmonics = std::vector<glm::vec3>(splats.size(), glm::vec3(0))}};
}
const glm::dvec3 kAlong(0, 0, 1);

TEST_CASE("a ray hits the splat at which half of its light is left, or the wall") {
  const auto range = [](const std::vector<Splat>& splats, double wall_m = 0, double t_min_m = 0) {
    return SplatWorld({cloud_of(splats)}, wall_m).along({0, 0, 0}, kAlong, t_min_m).range_m;
  };
  constexpr double kRounding = 1e-15 * 8;  // of ranges below 8 m
  CHECK(range({ball(2, 0.9)}) == doctest::Approx(2).epsilon(kRounding));
  CHECK(range({ball(2, 0.51)}) == doctest::Approx(2).epsilon(kRounding));
  CHECK(range({ball(2, 0.49)}) == kNone);
  CHECK(range({ball(2, 0.49)}, 5) == 5);
  CHECK(range({ball(2, 0.9)}, 1.5) == 1.5);
  // 0.7 of the light is left behind the first one, 0.49 behind the second one.
  CHECK(range({ball(2, 0.3), ball(3, 0.3), ball(4, 0.3)}) == doctest::Approx(3).epsilon(kRounding));
  CHECK(range({ball(4, 0.3), ball(3, 0.3), ball(2, 0.3)}) == doctest::Approx(3).epsilon(kRounding));
  CHECK(range({ball(2, 0.3), ball(3, 0.3)}, 2.5) == 2.5);
  // A ray that continues behind 2.5 m has lost 0.3 of its light before, and hits nothing there.
  CHECK(range({ball(2, 0.3), ball(3, 0.3)}, 0, 2.5) == doctest::Approx(3).epsilon(kRounding));
  CHECK(range({ball(2, 0.3), ball(3, 0.2)}, 5, 2.5) == 5);
  CHECK(range({ball(2, 0.9)}, 0, 2.5) == kNone);
  CHECK(range({ball(2, 0.9), ball(3, 0.3)}, 0, 2.5) == doctest::Approx(3).epsilon(kRounding));
  CHECK(range({ball(-2, 0.9)}, 5) == 5);
}

TEST_CASE("beside the centre a splat stops what its Gaussian says") {
  SplatWorld world({cloud_of({ball(3, 0.9, 0.4)})});
  // 0.9 exp(-m^2 / 2) is a half at m = 1.0842.
  const double edge_m = 0.4 * std::sqrt(2 * std::log(0.9 / 0.5));
  CHECK(world.along({edge_m * (1 - 1e-6), 0, 0}, kAlong).range_m == doctest::Approx(3).epsilon(1e-14));
  CHECK(world.along({edge_m * (1 + 1e-6), 0, 0}, kAlong).range_m == kNone);
  const RayHit hit = world.along({0, 0, 0}, kAlong);
  CHECK(hit.item == 0);
  CHECK(hit.primitive == 0);
  const SurfacePoint point = surface_point(world.list, glm::dmat4(1), kAlong, hit);
  CHECK(point.normal == -kAlong);
  CHECK(point.base_color.x == doctest::Approx(0.21404114).epsilon(1e-6));  // 0.5 of sRGB
}

struct AllSplats {
  double range_m = kNone;
  std::uint32_t item = 0;
  double margin = 1;  // how near the transmittance comes to a half
};

// All splats by covariances and their inverses.
AllSplats half_of_all(const std::vector<CloudPart>& clouds, const glm::dvec3& origin_m, const glm::dvec3& way) {
  struct Peak {
    double range_m, alpha;
    std::uint32_t item;
  };
  std::vector<Peak> peaks;
  for (std::uint32_t item = 0; item < clouds.size(); ++item) {
    const glm::dmat3 linear(clouds[item].world_from_mesh);
    for (const Splat& splat : clouds[item].cloud.splats) {
      const glm::dvec4 q = glm::normalize(glm::dvec4(splat.rotation));
      const glm::dvec3 v(q), s(splat.sigma);
      glm::dmat3 axes;
      for (int i = 0; i < 3; ++i) {
        glm::dvec3 e(0);
        e[i] = 1;
        axes[i] = s[i] * (e + 2.0 * glm::cross(v, glm::cross(v, e) + q.w * e));
      }
      const glm::dmat3 precision = glm::inverse(linear * axes * glm::transpose(linear * axes));
      const glm::dvec3 to_center(clouds[item].world_from_mesh * glm::dvec4(glm::dvec3(splat.center), 1));
      const double range_m = glm::dot(way, precision * (to_center - origin_m)) / glm::dot(way, precision * way);
      const glm::dvec3 off = origin_m + range_m * way - to_center;
      const double alpha = static_cast<double>(splat.opacity) * std::exp(-glm::dot(off, precision * off) / 2);
      if (range_m > 0 && alpha >= 1.0 / 255) peaks.push_back({range_m, std::min(alpha, 0.99), item});
    }
  }
  std::ranges::sort(peaks, {}, &Peak::range_m);
  AllSplats half;
  double left = 1;
  for (const Peak& peak : peaks) {
    left *= 1 - peak.alpha;
    half.margin = std::min(half.margin, std::abs(left - 0.5));
    if (left > 0.5) continue;
    half.range_m = peak.range_m;
    half.item = peak.item;
    break;
  }
  return half;
}

glm::dmat4 stretched() {
  glm::dmat4 place = glm::translate(glm::dmat4(1), {0.3, 0.4, -0.6});
  place = glm::rotate(place, 0.8, glm::normalize(glm::dvec3(1, -2, 0.5)));
  return glm::scale(place, {1.3, 0.5, 0.9});
}

TEST_CASE("rays from any place hit what all splats in order say, within their bounds") {
  // The reference inverts covariances with conditions of up to 1e5 to 1e6, see splat_rays_test.cpp.
  constexpr double kReference = 1e-9;
  std::size_t hits = 0, misses = 0, second = 0;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const std::vector<CloudPart> clouds{{random_splats(seed, 400, 1)}, {random_splats(seed + 10, 200, 0), stretched()}};
    SplatWorld world(clouds);
    std::mt19937 numbers(seed);
    std::vector<glm::dvec3> origins_m, ways;
    for (int i = 0; i < 500; ++i) {
      origins_m.push_back(uniform_vec(numbers, -3, 3));
      ways.push_back(glm::normalize(glm::dvec3(0, 0, 2.5) + uniform_vec(numbers, -1, 1) - origins_m.back()));
    }
    std::vector<RayHit> from(ways.size());
    const glm::dmat4 pose = glm::rotate(glm::translate(glm::dmat4(1), {0.1, 0.2, 0.3}), 0.7, {0, 0.6, 0.8});
    const glm::dmat3 back = glm::transpose(glm::dmat3(pose));
    std::vector<glm::dvec3> own_origins_m, own_ways;
    for (std::size_t i = 0; i < ways.size(); ++i) {
      own_origins_m.push_back(back * (origins_m[i] - glm::dvec3(pose[3])));
      own_ways.push_back(glm::normalize(back * ways[i]));
    }
    world.caster.cast_from(pose, own_origins_m, own_ways, from, {});
    for (std::size_t i = 0; i < ways.size(); ++i) {
      CAPTURE(i);
      const AllSplats expected = half_of_all(clouds, origins_m[i], ways[i]);
      if (expected.margin < 1e-6) continue;
      const RayHit hit = world.along(origins_m[i], ways[i]);
      REQUIRE(std::isinf(hit.range_m) == std::isinf(expected.range_m));
      REQUIRE(std::isinf(from[i].range_m) == std::isinf(expected.range_m));
      if (std::isinf(hit.range_m)) {
        ++misses;
        continue;
      }
      ++hits;
      second += hit.item == 1;
      REQUIRE(hit.item == expected.item);
      REQUIRE(hit.error_bound_m < 1e-9);
      REQUIRE(std::abs(hit.range_m - expected.range_m) <= kReference * expected.range_m + hit.error_bound_m);
      REQUIRE(std::abs(hit.range_m - from[i].range_m) <= hit.error_bound_m + from[i].error_bound_m);
    }
  }
  CHECK(hits > 300);
  CHECK(misses > 300);
  CHECK(second > 50);
}

// The range at which a ray from the world's origin comes nearest to a round splat, in its standard deviations.
double peak_in_long_double(const CloudPart& part, const glm::dvec3& way) {
  using Vector = glm::vec<3, long double>;
  using Matrix = glm::mat<3, 3, long double>;
  const Matrix mesh_from_world = glm::inverse(Matrix(part.world_from_mesh));
  const Vector direction = mesh_from_world * Vector(way),
               to_center = Vector(part.cloud.splats[0].center) + mesh_from_world * Vector(part.world_from_mesh[3]);
  return static_cast<double>(glm::dot(to_center, direction) / glm::dot(direction, direction));
}

TEST_CASE("the bound of a range covers the rounding of directions in a cloud that is stretched a thousandfold") {
  constexpr double kSigma_m = 1e-3, kStretch = 1000;
  constexpr int kRays = 200;
  std::mt19937 numbers(1);
  int tested = 0;
  for (; tested < kRays; ++tested) {
    CAPTURE(tested);
    const int longest = tested % 3;
    glm::dvec3 stretch(1), center = uniform_vec(numbers, -2 * kSigma_m, 2 * kSigma_m);
    stretch[longest] = kStretch;
    center[longest] = 0.01;  // 10 m in the world
    const double turn = uniform(numbers, 0, 3);
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1), turn, glm::normalize(uniform_vec(numbers, -1, 1)));
    CloudPart part = cloud_of({ball(0, 0.99, kSigma_m)});
    part.cloud.splats[0].center = glm::vec3(center);
    part.world_from_mesh = glm::scale(turned, stretch);
    // At most sqrt(3) / 2 standard deviations beside the centre, where 0.68 of the light stops.
    const glm::dvec3 beside = center + 0.5 * kSigma_m * uniform_vec(numbers, -1, 1);
    const glm::dvec3 way = glm::normalize(glm::dvec3(part.world_from_mesh * glm::dvec4(beside, 1)));
    const RayHit hit = SplatWorld({part}).along({0, 0, 0}, way);
    REQUIRE(std::abs(hit.range_m - peak_in_long_double(part, way)) <= hit.error_bound_m);
    REQUIRE(hit.error_bound_m < 1e-6);
  }
  CHECK(tested == kRays);
}

TEST_CASE("rays and pixels of cameras agree within their rounding") {
  const std::vector<CloudPart> clouds{{random_splats(3, 500, 2)}, {random_splats(13, 200, 0), stretched()}};
  SplatWorld world(clouds);
  std::vector<glm::dvec3> rays;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) rays.push_back(glm::normalize(glm::dvec3((x - 24.5) / 45, (y - 19.5) / 45, 1)));
  }
  const std::vector<double> near_m(rays.size(), 0.05), end_m(rays.size(), kNone);
  std::vector<SplatSight> sights(rays.size());
  ThreadPool pool(2);
  see_through(see_splats(world.list, glm::dmat4(1), {}),
              {.width_px = 50, .directions = rays, .near_m = near_m, .end_m = end_m}, pool, sights);
  std::vector<RayHit> hits(rays.size());
  world.caster.cast(glm::dmat4(1), rays, hits, near_m, {}, HitSides::both);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    CAPTURE(i);
    REQUIRE(std::isinf(hits[i].range_m) == std::isinf(sights[i].half_m));
    if (std::isinf(hits[i].range_m)) continue;
    ++seen;
    REQUIRE(hits[i].item == sights[i].half_item);
    // Each of the two rounds by its bound at most: they have the same operations but for their order.
    REQUIRE(std::abs(hits[i].range_m - sights[i].half_m) <= 2 * hits[i].error_bound_m);
  }
  CHECK(seen > 200);
}

TEST_CASE("the order of splats and the number of threads change no range, and ignored clouds are passed") {
  const SplatCloud cloud = random_splats(7, 600, 1), other = random_splats(8, 200, 0);
  std::vector<glm::dvec3> rays;
  for (int i = 0; i < 2000; ++i)
    rays.push_back(glm::normalize(glm::dvec3(std::sin(i * 0.7) * 0.4, std::cos(i * 1.3) * 0.4, 1)));
  const auto ranges = [&](const SplatCloud& a, const SplatCloud& b, bool ignores = false) {
    SplatWorld world({{a}, {b, stretched()}}, 6);
    const std::uint32_t ignored[] = {0, 1};
    if (ignores) world.caster.ignore(ignored);
    std::vector<RayHit> hits(rays.size());
    world.caster.cast(glm::dmat4(1), rays, hits, {}, {}, HitSides::both);
    std::vector<double> all;
    for (const RayHit& hit : hits) all.push_back(hit.range_m + 100 * hit.item);
    return all;
  };
  const std::vector<double> first = ranges(cloud, other);
  for (std::uint32_t seed = 1; seed < 4; ++seed) CHECK(ranges(shuffled(cloud, seed), shuffled(other, seed)) == first);
  std::size_t of_wall = 0;
  for (const double each : ranges(cloud, other, true)) of_wall += each >= 200;
  CHECK(of_wall == rays.size());
  CHECK(std::ranges::count_if(first, [](double each) { return each < 200; }) > 300);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
