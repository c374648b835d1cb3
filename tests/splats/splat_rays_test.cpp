// Splats along rays, compared with the published formula: covariances and their inverses in double, all splats of a ray
// sorted and mixed to the last one.
#include "engine/splats/splat_rays.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "engine/base/srgb.h"
#include "engine/splats/ray_cone.h"
#include "tests/splats/random_splats.h"

TEST_SUITE_BEGIN("engine/splats");

namespace simvis {
namespace {

using test::random_splats;
using test::shuffled;

constexpr double kFar = std::numeric_limits<double>::infinity();

struct PlacedCloud {
  SplatCloud cloud;
  glm::dmat4 world_from_mesh{1.0};
};

DrawList list_of(const std::vector<PlacedCloud>& clouds) {
  DrawList list;
  list.world_from_node.emplace_back(1.0);
  list.materials.push_back(std::make_shared<const Material>());
  list.material_revision.push_back(0);
  for (const PlacedCloud& placed : clouds) {
    Mesh mesh;
    mesh.splats = std::make_shared<const SplatCloud>(placed.cloud);
    const auto number = static_cast<std::uint32_t>(list.meshes.size());
    list.meshes.push_back(std::make_shared<const Mesh>(mesh));
    list.world_from_node.push_back(placed.world_from_mesh);
    list.items.push_back({number, 0, number + 1});
  }
  return list;
}

std::vector<glm::dvec3> pinhole_rays(std::uint32_t width, std::uint32_t height, double focal_px) {
  std::vector<glm::dvec3> rays;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      rays.push_back(
          glm::normalize(glm::dvec3((x + 0.5 - width / 2.0) / focal_px, (y + 0.5 - height / 2.0) / focal_px, 1)));
    }
  }
  return rays;
}

// Equidistant, up to 170 degrees from the axis; corners see nothing.
std::vector<glm::dvec3> fisheye_rays(std::uint32_t width, std::uint32_t height) {
  std::vector<glm::dvec3> rays;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width * 2 - 1, v = (y + 0.5) / height * 2 - 1, radius = std::hypot(u, v);
      const double angle = radius * 170 * std::numbers::pi / 180, beside = std::sin(angle) / radius;
      rays.push_back(radius > 1 ? glm::dvec3(0) : glm::normalize(glm::dvec3(u * beside, v * beside, std::cos(angle))));
    }
  }
  return rays;
}

struct RayImage {
  std::vector<glm::dvec3> rays;
  std::uint32_t width = 0;
  double near_m = 0.05;
  double end_m = kFar;
};

std::vector<SplatSight> look(const DrawList& list, const RayImage& image, unsigned threads = 2,
                             const glm::dmat4& world_from_view = glm::dmat4(1)) {
  ThreadPool pool(threads);
  const std::vector<double> near_m(image.rays.size(), image.near_m), end_m(image.rays.size(), image.end_m);
  std::vector<SplatSight> sights(image.rays.size());
  see_through(see_splats(list, world_from_view, {}),
              {.width_px = image.width, .directions = image.rays, .near_m = near_m, .end_m = end_m}, pool, sights);
  return sights;
}

// The rotation of a unit quaternion, by its product with vectors.
glm::dmat3 rotation_of(const glm::dvec4& q) {
  const glm::dvec3 v(q);
  glm::dmat3 columns;
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 e(0);
    e[i] = 1;
    columns[i] = e + 2.0 * glm::cross(v, glm::cross(v, e) + q.w * e);
  }
  return columns;
}

struct ReferenceHit {
  double range_m, alpha;
  glm::dvec3 color;
  SplatEncoding encoding;
  std::uint32_t item;
};

std::vector<ReferenceHit> reference_hits(const std::vector<PlacedCloud>& clouds, const glm::dmat4& world_from_view,
                                         const glm::dvec3& ray, const RayImage& image) {
  std::vector<ReferenceHit> hits;
  for (std::uint32_t item = 0; item < clouds.size(); ++item) {
    const auto& [cloud, world_from_mesh] = clouds[item];
    const glm::dmat4 view_from_mesh = glm::inverse(world_from_view) * world_from_mesh;
    const glm::dmat3 linear(view_from_mesh);
    const glm::dvec3 camera(glm::inverse(view_from_mesh)[3]);
    const std::size_t coefficients = harmonics_count(cloud.degree);
    for (std::size_t i = 0; i < cloud.splats.size(); ++i) {
      const Splat& splat = cloud.splats[i];
      const glm::dvec3 s(splat.sigma), c(view_from_mesh * glm::dvec4(splat.center, 1));
      const glm::dmat3 axes = rotation_of(glm::normalize(glm::dvec4(splat.rotation)));
      const glm::dmat3 squares(s.x * s.x, 0, 0, 0, s.y * s.y, 0, 0, 0, s.z * s.z);
      const glm::dmat3 precision =
          glm::inverse(linear * axes * squares * glm::transpose(axes) * glm::transpose(linear));
      const double range_m = glm::dot(ray, precision * c) / glm::dot(ray, precision * ray);
      const glm::dvec3 off = range_m * ray - c;
      const double alpha = static_cast<double>(splat.opacity) * std::exp(-glm::dot(off, precision * off) / 2);
      if (alpha < 1.0 / 255 || range_m <= image.near_m || range_m >= image.end_m) continue;
      const std::span<const glm::vec3> harmonics(cloud.harmonics.data() + i * coefficients, coefficients);
      hits.push_back({range_m, std::min(alpha, 0.99),
                      splat_color(harmonics, glm::normalize(glm::dvec3(splat.center) - camera)), cloud.encoding, item});
    }
  }
  std::ranges::sort(hits, {}, &ReferenceHit::range_m);
  return hits;
}

SplatSight mixed(const std::vector<ReferenceHit>& hits) {
  SplatSight sight;
  glm::dvec3 encoded(0);
  double weight = 0;
  for (const ReferenceHit& hit : hits) {
    const double share = sight.transmittance * hit.alpha;
    if (hit.encoding == SplatEncoding::srgb) {
      encoded += share * hit.color;
      weight += share;
    } else {
      sight.color += share * hit.color;
    }
    sight.transmittance *= 1 - hit.alpha;
    if (sight.half_item != kNoItem || sight.transmittance > 0.5) continue;
    sight.half_m = hit.range_m;
    sight.half_item = hit.item;
  }
  for (int i = 0; weight > 0 && i < 3; ++i) sight.color[i] += weight * decode_srgb(encoded[i] / weight);
  return sight;
}

// What is left out behind a transmittance of 1e-4 has colours below 3.2: 0.5 and 16 harmonics of 0.8, which are
// below 1.5, in the mean; decoded below 14. The mixture before it changes by as much.
constexpr double kColorTolerance = 3e-3, kTransmittanceTolerance = 1.1e-4;
// The reference inverts covariances whose axes are up to 200 : 1, stretched 2 : 1: conditions of 2e5, times the
// rounding of double, times a factor for the number of operations.
constexpr double kRangeTolerance = 1e-9;

void compare(const std::vector<PlacedCloud>& clouds, const RayImage& image,
             const glm::dmat4& world_from_view = glm::dmat4(1)) {
  const std::vector<SplatSight> sights = look(list_of(clouds), image, 2, world_from_view);
  std::size_t halves = 0, touched = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    CAPTURE(i);
    if (image.rays[i] == glm::dvec3(0)) {
      CHECK(sights[i].transmittance == 1);
      continue;
    }
    const SplatSight expected = mixed(reference_hits(clouds, world_from_view, image.rays[i], image));
    REQUIRE(std::abs(sights[i].transmittance - expected.transmittance) <= kTransmittanceTolerance);
    REQUIRE(glm::length(sights[i].color - expected.color) <= kColorTolerance);
    REQUIRE(sights[i].half_item == expected.half_item);
    touched += expected.transmittance < 1;
    if (expected.half_item == kNoItem) continue;
    ++halves;
    REQUIRE(std::abs(sights[i].half_m - expected.half_m) <= kRangeTolerance * expected.half_m);
  }
  CHECK(halves > 30);  // the scene shows something
  CHECK(touched > sights.size() / 4);
}

glm::dmat4 some_place() {
  glm::dmat4 place = glm::translate(glm::dmat4(1), {0.1, -0.2, 0.3});
  place = glm::rotate(place, 0.4, glm::normalize(glm::dvec3(1, 2, -1)));
  return glm::scale(place, {1.2, 0.6, 0.9});
}

bool same_bytes(const std::vector<SplatSight>& a, const std::vector<SplatSight>& b) {
  return std::ranges::equal(a, b, [](const SplatSight& x, const SplatSight& y) {
    return x.color == y.color && x.transmittance == y.transmittance && x.half_m == y.half_m &&
           x.half_item == y.half_item;
  });
}

// A round splat on the axis of the view.
Splat round_splat(double range_m, double opacity, double sigma_m = 0.01) {
  Splat splat;
  splat.center = {0, 0, range_m};
  splat.sigma = glm::vec3(static_cast<float>(sigma_m));
  splat.opacity = static_cast<float>(opacity);
  return splat;
}

// Along the axis of the view.
SplatSight look_along_axis(const std::vector<Splat>& splats, double near_m = 0.05, double end_m = kFar) {
  SplatCloud cloud{.splats = splats, .harmonics = std::vector<glm::vec3>(splats.size(), glm::vec3(0))};
  return look(list_of({{cloud}}), {.rays = {{0, 0, 1}}, .width = 1, .near_m = near_m, .end_m = end_m})[0];
}

}  // namespace

TEST_CASE("harmonics are the real ones with the Condon-Shortley phase") {
  for (const glm::dvec3& d : {glm::dvec3(0.2, -0.5, 0.7), glm::dvec3(-0.9, 0.1, -0.3), glm::dvec3(0, 0, 1)}) {
    const glm::dvec3 direction = glm::normalize(d);
    const double polar = std::acos(direction.z), azimuth = std::atan2(direction.y, direction.x);
    for (std::uint32_t degree = 0, number = 0; degree <= kMaxHarmonicsDegree; ++degree) {
      for (int order = -static_cast<int>(degree); order <= static_cast<int>(degree); ++order, ++number) {
        std::vector<glm::vec3> coefficients(harmonics_count(kMaxHarmonicsDegree), glm::vec3(0));
        coefficients[number] = {0.25f, 0, -8};
        const double legendre = std::sph_legendre(degree, static_cast<unsigned>(std::abs(order)), polar);
        const double turn = order == 0  ? 1
                            : order > 0 ? std::numbers::sqrt2 * std::cos(order * azimuth)
                                        : std::numbers::sqrt2 * std::sin(-order * azimuth);
        const glm::dvec3 color = splat_color(coefficients, direction);
        CAPTURE(number);
        CHECK(color.r == doctest::Approx(0.5 + 0.25 * legendre * turn).epsilon(1e-12));
        CHECK(color.g == 0.5);
        CHECK(color.b == doctest::Approx(std::max(0.0, 0.5 - 8 * legendre * turn)).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("rays of a pinhole and of a fisheye see what the formula says") {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    const std::vector<PlacedCloud> clouds{{random_splats(seed, 150, 3)},
                                          {random_splats(seed + 10, 80, 1, SplatEncoding::linear), some_place()}};
    compare(clouds, {.rays = pinhole_rays(50, 37, 45), .width = 50});
    compare(clouds, {.rays = pinhole_rays(50, 37, 45), .width = 50, .near_m = 1.8, .end_m = 2.6});
    compare(clouds, {.rays = fisheye_rays(41, 40), .width = 41}, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 2.3)));
  }
}

TEST_CASE("long splats that begin near and peak far are mixed behind the short ones between") {
  SplatCloud cloud;
  for (int i = 0; i < 120; ++i) {
    Splat needle = round_splat(3 + 0.01 * i, 0.02, 0.05), round = round_splat(1.4 + 0.008 * i, 0.05, 0.05);
    needle.sigma.z = 0.8f;
    cloud.splats.insert(cloud.splats.end(), {needle, round});
    cloud.harmonics.insert(cloud.harmonics.end(),
                           {glm::vec3(1, -1, 0.5), glm::vec3(-1, 1, -0.01f * static_cast<float>(i))});
  }
  compare({{cloud}}, {.rays = pinhole_rays(12, 12, 400), .width = 12});
}

TEST_CASE("far from the origin of the world nothing changes but the rounding of places") {
  // Places of 1e6 m are rounded to 1.2e-10 m, and the smallest axis is 1e-3 m: alphas change by up to 1e-6.
  const glm::dvec3 far(1e6, -3e5, 2e5);
  const RayImage image{.rays = pinhole_rays(30, 20, 30), .width = 30};
  const SplatCloud cloud = random_splats(4, 100, 2);
  const auto near_sights = look(list_of({{cloud}}), image);
  const auto far_sights =
      look(list_of({{cloud, glm::translate(glm::dmat4(1), far)}}), image, 2, glm::translate(glm::dmat4(1), far));
  for (std::size_t i = 0; i < near_sights.size(); ++i) {
    CHECK(std::abs(near_sights[i].transmittance - far_sights[i].transmittance) < 1e-5);
    CHECK(near_sights[i].half_item == far_sights[i].half_item);
  }
}

TEST_CASE("the order of splats and the number of threads change no byte") {
  const SplatCloud cloud = random_splats(7, 400, 1), other = random_splats(8, 100, 0);
  const RayImage image{.rays = pinhole_rays(90, 70, 80), .width = 90};
  const auto sights = look(list_of({{cloud}, {other, some_place()}}), image, 1);
  for (const unsigned threads : {1u, 2u, 5u}) {
    CAPTURE(threads);
    const auto again =
        look(list_of({{shuffled(cloud, threads)}, {shuffled(other, threads), some_place()}}), image, threads);
    CHECK(same_bytes(sights, again));
  }
}

TEST_CASE("splats at one range are mixed in one order") {
  SplatCloud cloud;
  for (int i = 0; i < 12; ++i) {
    cloud.splats.push_back(round_splat(2, 0.1 + 0.02 * (i % 5), 0.3));
    cloud.harmonics.emplace_back(0.1f * static_cast<float>(i % 7), -0.2f * static_cast<float>(i % 3), 0.3f);
  }
  const RayImage image{.rays = pinhole_rays(16, 16, 20), .width = 16};
  const auto sights = look(list_of({{cloud}}), image);
  CHECK(sights[136].transmittance < 0.5);
  for (std::uint32_t seed = 1; seed < 6; ++seed) {
    CHECK(same_bytes(sights, look(list_of({{shuffled(cloud, seed)}}), image)));
  }
}

TEST_CASE("a ray ends where half of the light is left, and surfaces hide what is behind them") {
  // Behind the splats: 0.7, 0.35, 0.175.
  const std::vector<Splat> splats{round_splat(1, 0.3), round_splat(2, 0.5), round_splat(3, 0.5)};
  constexpr double kOfFloat = 2e-7;  // opacities are float32
  SplatSight sight = look_along_axis(splats);
  CHECK(std::abs(sight.transmittance - 0.175) < kOfFloat);
  CHECK(sight.half_m == 2);
  CHECK(sight.half_item == 0);
  sight = look_along_axis(splats, 0.05, 1.5);
  CHECK(std::abs(sight.transmittance - 0.7) < kOfFloat);
  CHECK(sight.half_item == kNoItem);
  CHECK(std::isinf(sight.half_m));
  sight = look_along_axis(splats, 1.5);
  CHECK(std::abs(sight.transmittance - 0.25) < kOfFloat);
  CHECK(sight.half_m == 2);
  sight = look_along_axis(splats, 2, 3);  // peaks at the limits are none
  CHECK(sight.transmittance == 1);
  CHECK(look_along_axis({round_splat(-1, 1)}).transmittance == 1);
}

TEST_CASE("the smallest and the largest share that a splat stops") {
  CHECK(look_along_axis({round_splat(1, 0.0039)}).transmittance == 1);
  CHECK(look_along_axis({round_splat(1, 0.004)}).transmittance < 1);
  CHECK(look_along_axis({round_splat(1, 1)}).transmittance == doctest::Approx(0.01).epsilon(1e-12));
}

TEST_CASE("colours are mixed in their encoding and counted in linear light") {
  SplatCloud cloud{.splats = {round_splat(1, 0.5), round_splat(2, 0.5)}, .harmonics = {}};
  constexpr double kDegree0 = 0.28209479177387814;
  for (const double value : {1.0, 0.0}) cloud.harmonics.emplace_back(static_cast<float>((value - 0.5) / kDegree0));
  const auto color_of = [&](SplatEncoding encoding) {
    cloud.encoding = encoding;
    return look(list_of({{cloud}}), {.rays = {{0, 0, 1}}, .width = 1})[0].color.r;
  };
  CHECK(color_of(SplatEncoding::srgb) == doctest::Approx(0.75 * decode_srgb(0.5 / 0.75)).epsilon(1e-6));
  CHECK(color_of(SplatEncoding::linear) == doctest::Approx(0.5).epsilon(1e-6));
}

TEST_CASE("a cone leaves out no splat that a ray in it meets, and most of the others") {
  SplatCloud cloud = random_splats(21, 600, 0);
  for (std::size_t i = 0; i < cloud.splats.size(); i += 2) cloud.splats[i].sigma = {0.01f, 0.3f, 0.01f};  // needles
  const DrawList list = list_of({{cloud}});
  const std::vector<SeenSplat> splats = see_splats(list, glm::dmat4(1), {});
  const std::vector<glm::dvec3> rays = pinhole_rays(64, 64, 60);
  std::size_t kept = 0, met = 0;
  for (std::size_t tile = 0; tile < 64; ++tile) {
    std::vector<glm::dvec3> of_tile;
    for (std::size_t i = 0; i < 64; ++i) of_tile.push_back(rays[(tile / 8 * 8 + i / 8) * 64 + tile % 8 * 8 + i % 8]);
    const RayCone cone = cone_of(of_tile);
    for (const SeenSplat& splat : splats) {
      const bool is_met = std::ranges::any_of(of_tile, [&](const glm::dvec3& ray) {
        const SplatPeak peak = peak_along(splat, ray.x, ray.y, ray.z);
        return peak.range_m > 0 && alpha_at(splat, peak.square_distance) > 0;
      });
      const bool is_kept = may_meet(cone, splat);
      REQUIRE((is_kept || !is_met));
      REQUIRE((may_overlap(cone, cone_of(splat)) || !is_met));
      kept += is_kept;
      met += is_met;
    }
  }
  CHECK(met > 1000);
  CHECK(2 * kept < 3 * met);  // a bound on cost, not on results
}

TEST_CASE("no splat, no ray, and items that are flat or hidden") {
  CHECK(look(list_of({}), {.rays = {{0, 0, 1}}, .width = 1})[0].transmittance == 1);
  CHECK(look(list_of({{random_splats(1, 3, 0)}}), {.rays = {}, .width = 1}).empty());
  std::vector<SplatSight> sights{{.color = glm::dvec3(1), .transmittance = 0.5, .half_m = 2, .half_item = 3}};
  ThreadPool pool(1);
  const std::vector<glm::dvec3> away{{0, 0, -1}};
  const std::vector<double> near_m{0.05}, end_m{kFar};
  see_through(see_splats(list_of({{random_splats(1, 3, 0)}}), glm::dmat4(1), {}),
              {.width_px = 1, .directions = away, .near_m = near_m, .end_m = end_m}, pool, sights);
  CHECK(same_bytes(sights, {SplatSight{}}));
  DrawList list = list_of({{random_splats(1, 50, 0)}});
  CHECK(has_splats(list));
  list.items[0].visible = false;
  CHECK_FALSE(has_splats(list));
  CHECK(see_splats(list, glm::dmat4(1), {}).empty());
  CHECK(see_splats(list_of({{random_splats(1, 50, 0), glm::dmat4(0)}}), glm::dmat4(1), {}).empty());
}

TEST_SUITE_END();

}  // namespace simvis
