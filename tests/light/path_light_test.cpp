// Radiance by paths of light against closed forms, within the standard deviation that cameras give with it.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <simvis/error.h>
#include "tests/light/path_stage.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis::test {
namespace {

Mesh floor_mesh(double half_m = 50) {
  return rectangle_mesh({-half_m, -half_m, 0}, {2 * half_m, 0, 0}, {0, 2 * half_m, 0});
}
// At the height, with its front below.
Mesh ceiling_mesh(double half_x_m, double half_y_m, double height_m) {
  return rectangle_mesh({-half_x_m, -half_y_m, height_m}, {0, 2 * half_y_m, 0}, {2 * half_x_m, 0, 0});
}

// The inside of a cube around the origin.
void add_room(PathStage& stage, double half_m, const Material& material) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 corner(-half_m), first(0), second(0);
      corner[axis] = side * half_m;
      first[(axis + 1) % 3] = second[(axis + 2) % 3] = 2 * half_m;
      stage.add(side < 0 ? rectangle_mesh(corner, first, second) : rectangle_mesh(corner, second, first), material);
    }
  }
}

// The share of the light that reaches a point of a plane from a rectangle in a parallel plane at the distance 1, with a
// corner above the point and the sides x and y.
double parallel_corner(double x, double y) {
  const double X = std::sqrt(1 + x * x), Y = std::sqrt(1 + y * y);
  return (x / X * std::atan(y / X) + y / Y * std::atan(x / Y)) / (2 * kPi);
}

TEST_CASE("a matte surface in light from all around has the radiance of this light times its base colour") {
  PathStage stage;
  stage.list.environment.ambient = {0.5f, 1, 2};
  stage.add(floor_mesh(), matte(0.75));
  const SeenRadiance seen = radiance_at(stage, {1, 0, 2}, {0, 0, 0}, 16, 3);
  // Each path has the same radiance.
  for (int c = 0; c < 3; ++c) {
    CHECK(std::abs(seen.mean[c] - 0.75 * static_cast<double>(stage.list.environment.ambient[c])) <= kStored);
    CHECK(seen.stddev[c] <= kStored);
  }
}

TEST_CASE("in a closed room that shines, light of n bounces is a geometric series") {
  constexpr double kBase = 0.5, kEmission = 0.25;  // exact as float32
  PathStage stage;
  Material wall = matte(kBase);
  wall.emissive = glm::vec3(static_cast<float>(kEmission));
  add_room(stage, 1, wall);
  double expected = 0;
  for (std::uint32_t bounces = 0; bounces <= 5; ++bounces) {
    CAPTURE(bounces);
    expected += kEmission * std::pow(kBase, bounces);
    const SeenRadiance seen = radiance_at(stage, {0.2, 0.1, -0.3}, {0.9, 1, 0.4}, 2000, bounces);
    CHECK(agree(seen.mean.x, expected, seen.stddev.x, kStored));
    CHECK(seen.stddev.x < 0.01);
  }
}

TEST_CASE("a rectangular lamp over a floor: the form factor of parallel plates") {
  constexpr double kRadiance = 3, kBase = 0.5;
  PathStage stage;
  stage.add(floor_mesh(), matte(kBase));
  stage.add(ceiling_mesh(0.5, 1, 1), lamp(kRadiance));
  for (const glm::dvec2 at : {glm::dvec2(0, 0), glm::dvec2(0.4, -0.7)}) {
    double share = 0;
    for (const double x : {0.5 - at.x, 0.5 + at.x}) {
      for (const double y : {1 - at.y, 1 + at.y}) share += parallel_corner(x, y);
    }
    const SeenRadiance seen = radiance_at(stage, {at.x + 3, at.y, 0.5}, glm::dvec3(at, 0), 4000, 1);
    CHECK(agree(seen.mean.x, kBase * kRadiance * share, seen.stddev.x, kStored));
    CHECK(seen.stddev.x < 0.02);
  }
  // Its back is dark and hides the front.
  const SeenRadiance above = radiance_at(stage, {0, 0, 5}, {2, 0, 0}, 4000, 1);
  CHECK(above.mean.x > 0);
}

TEST_CASE("a wall that shines beside a floor: the form factor of a corner") {
  constexpr double kRadiance = 2, kBase = 0.75, kWidth = 3, kHeight = 2, kAway = 0.7;
  PathStage stage;
  stage.add(floor_mesh(), matte(kBase));
  stage.add(rectangle_mesh({0, -kWidth / 2, 0}, {0, kWidth, 0}, {0, 0, kHeight}), lamp(kRadiance));
  const double slant = std::hypot(kHeight, kAway), half = kWidth / 2;
  const double share = (std::atan(half / kAway) - kAway / slant * std::atan(half / slant)) / kPi;
  const SeenRadiance seen = radiance_at(stage, {kAway, 0, 4}, {kAway, 0, 0}, 4000, 1);
  CHECK(agree(seen.mean.x, kBase * kRadiance * share, seen.stddev.x, kStored));
}

TEST_CASE("large parallel plates light each other as a geometric series") {
  constexpr double kFloor = 0.5, kCeiling = 0.25, kRadiance = 1;
  PathStage stage;
  stage.add(floor_mesh(5000), matte(kFloor));
  Material shining = matte(kCeiling);
  shining.emissive = glm::vec3(static_cast<float>(kRadiance));
  stage.add(ceiling_mesh(5000, 5000, 1), shining);
  // B_floor = kFloor B_ceiling, B_ceiling = kRadiance + kCeiling B_floor; 1e-7 of the light passes the edges.
  double expected = 0;
  for (int n = 0; n <= 2; ++n) expected += kRadiance * kFloor * std::pow(kFloor * kCeiling, n);
  const SeenRadiance seen = radiance_at(stage, {0, 0, 0.5}, {0.3, 0, 0}, 4000, 5);
  CHECK(agree(seen.mean.x, expected, seen.stddev.x, 1e-6));
}

TEST_CASE("lamps without a size: the laws of Lambert and of the inverse square, and shadows") {
  PathStage stage;
  stage.add(floor_mesh(), matte(0.5));
  stage.list.world_from_node.push_back(glm::translate(glm::dmat4(1), {0, 0, 2}));
  const auto above = static_cast<std::uint32_t>(stage.list.world_from_node.size() - 1);
  stage.list.lights = {{{.kind = LightKind::point, .intensity = 10}, above}};
  const glm::dvec3 eye(0.5, 0, 1);
  const double cosine = 2 / std::sqrt(5.0), expected = 0.5 / kPi * 10 / 5 * cosine;
  CHECK(std::abs(radiance_at(stage, eye, {1, 0, 0}, 4, 1).mean.x - expected) <= kStored);
  // A sheet that covers a quarter lets three quarters pass; one with a mask that keeps it lets none pass.
  Material sheet = matte(0);
  sheet.opacity = 0.25f;
  sheet.double_sided = true;
  stage.add(ceiling_mesh(5, 5, 1.5), sheet);
  CHECK(std::abs(radiance_at(stage, eye, {1, 0, 0}, 4, 1).mean.x - 0.75 * expected) <= kStored);
  sheet = matte(1);
  sheet.alpha_mode = AlphaMode::mask;
  stage.list.materials.back() = std::make_shared<Material>(sheet);
  ++stage.list.revisions.materials;
  ++stage.list.revisions.structure;
  CHECK(radiance_at(stage, eye, {1, 0, 0}, 4, 1).mean.x == 0);
}

TEST_CASE("a surface that covers a share of a lamp shows the lamp through it") {
  PathStage stage;
  stage.add(ceiling_mesh(5, 5, 3), lamp(2));
  Material leaf = lamp(0.5);
  leaf.base_color.a = 0.25f;
  leaf.alpha_mode = AlphaMode::blend;
  leaf.double_sided = true;
  stage.add(ceiling_mesh(5, 5, 2), leaf);
  const SeenRadiance seen = radiance_at(stage, {0, 0, 0}, {0, 0, 3}, 4000, 0);
  CHECK(agree(seen.mean.x, 0.25 * 0.5 + 0.75 * 2, seen.stddev.x, kStored));
}

TEST_CASE("a pane lets pass and reflects what Snell's and Fresnel's laws say of its two faces") {
  constexpr double kIndex = 1.5;
  for (const double angle : {0.0, 0.6, 1.2}) {
    CAPTURE(angle);
    PathStage stage;
    stage.add(rectangle_mesh({50, -9, -9}, {0, 0, 18}, {0, 18, 0}), lamp(1));
    Material glass = matte(0.5);
    glass.transmission = 1;
    glass.refractive_index = static_cast<float>(kIndex);
    glass.double_sided = true;
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), angle, glm::dvec3(0, 0, 1));
    stage.add(rectangle_mesh({5, -90, -90}, {0, 0, 180}, {0, 180, 0}), glass, turn);
    const double inside = std::asin(std::sin(angle) / kIndex);
    double reflected = 0;
    for (const bool across : {true, false}) {
      const double near = across ? std::cos(angle) : std::cos(inside),
                   far = across ? std::cos(inside) : std::cos(angle);
      const double amplitude = (near - kIndex * far) / (near + kIndex * far), face = amplitude * amplitude;
      reflected += face / (1 + face);
    }
    const SeenRadiance seen = radiance_at(stage, {0, 0, 0}, {10, 0, 0}, 8000, 2);
    CHECK(agree(seen.mean.x, (1 - reflected) * 0.5, seen.stddev.x, kStored));
  }
}

TEST_CASE("the image in a mirror is that of the mirrored scene") {
  const auto add_half = [](PathStage& stage, double side) {
    const glm::dmat4 mirrored = glm::scale(glm::dmat4(1), {side, 1, 1});
    stage.add(rectangle_mesh({-4, -4, 0}, {4, 0, 0}, {0, 8, 0}), matte(0.5), mirrored);
    stage.add(rectangle_mesh({-2, -1, 1}, {0, 2, 0}, {1, 0, 0}), lamp(4), mirrored);
  };
  PathStage with_mirror, mirrored;
  add_half(with_mirror, 1);
  Material mirror = matte(0);
  mirror.mirror = 1;
  with_mirror.add(rectangle_mesh({0, -50, -50}, {0, 0, 100}, {0, 100, 0}), mirror);
  add_half(mirrored, 1);
  add_half(mirrored, -1);
  const glm::dvec3 eye(-3, 0.5, 0.7), at(1.2, -0.3, 0);
  // The mirror takes one bounce before the floor, and one behind it.
  const SeenRadiance seen = radiance_at(with_mirror, eye, at, 20000, 3),
                     expected = radiance_at(mirrored, eye, at, 20000, 1);
  CHECK(expected.mean.x > 0.1);
  CHECK(agree(seen.mean.x, expected.mean.x, std::hypot(seen.stddev.x, expected.stddev.x), kStored));
}

TEST_CASE("fog attenuates and adds its light on the way to the camera") {
  PathStage stage;
  stage.list.medium = {.extinction_per_m = 0.2, .airlight = {0.5f, 0.5f, 0.5f}};
  stage.add(ceiling_mesh(5, 5, 3), lamp(2));
  const double clear = std::exp(-0.2 * 3);
  CHECK(std::abs(radiance_at(stage, {0, 0, 0}, {0, 0, 3}, 2, 1).mean.x - (2 * clear + 0.5 * (1 - clear))) <= kStored);
  CHECK(std::abs(radiance_at(stage, {0, 0, 0}, {0, 0, -3}, 2, 1).mean.x - 0.5) <= kStored);
}

// The light of a lamp loses on its way to the floor and from there to the camera, which sees the air before the floor.
TEST_CASE("fog attenuates the light of a lamp before and behind the floor that it lights") {
  constexpr double kExtinction_per_m = 0.3, kAir = 0.5, kIntensity = 10, kHeight_m = 2, kAway_m = 1.25;
  PathStage stage;
  stage.list.medium = {.extinction_per_m = kExtinction_per_m, .airlight = glm::vec3(static_cast<float>(kAir))};
  stage.add(floor_mesh(), matte(0.5));
  stage.list.world_from_node.push_back(glm::translate(glm::dmat4(1), {0, 0, kHeight_m}));
  const auto above = static_cast<std::uint32_t>(stage.list.world_from_node.size() - 1);
  stage.list.lights = {{{.kind = LightKind::point, .intensity = kIntensity}, above}};
  const double reflected = 0.5 / kPi * kIntensity / (kHeight_m * kHeight_m);
  const double expected = reflected * std::exp(-kExtinction_per_m * (kHeight_m + kAway_m)) +
                          kAir * (1 - std::exp(-kExtinction_per_m * kAway_m));
  CHECK(std::abs(radiance_at(stage, {0.75, 0, 1}, {0, 0, 0}, 4, 1).mean.x - expected) <= kStored);
}

// The light that the origin of a floor reflects towards `to_eye` from a square lamp in fog, by the midpoint rule. The
// floor sees the air before the lamp, too.
double light_through_fog(const SurfaceReflection& reflection, const glm::dvec3& to_eye, const glm::dvec3& middle_m,
                         double side_m, double radiance, double extinction_per_m, double air) {
  constexpr int kSteps = 400;
  const double step_m = side_m / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const glm::dvec3 way = middle_m + glm::dvec3((i + 0.5) * step_m - side_m / 2, (j + 0.5) * step_m - side_m / 2, 0);
      const double distance_m = glm::length(way), clear = std::exp(-extinction_per_m * distance_m);
      const double solid_angle_sr = way.z / std::pow(distance_m, 3) * step_m * step_m;
      sum += reflected_share(reflection, to_eye, way / distance_m).x * solid_angle_sr *
             (radiance * clear + air * (1 - clear));
    }
  }
  return sum;
}

// A mirror would show the eye the middle of the lamp: the matte floor finds the lamp by samples of it, and the floor of
// metal by reflected rays.
TEST_CASE("fog attenuates the light of a surface that emits, however the path finds it") {
  constexpr double kExtinction_per_m = 0.5, kAir = 0.25, kRadiance = 4, kSide_m = 0.4;
  // Roughness 1/8 is an alpha of 1/64. Across the plane of reflection the lobe has the width 2/64 x cos 45 degrees, at
  // 1.4 m 31 mm or 31 steps. The midpoint rule errs by 1/24 of the square of a step over the width, of less than 1.
  constexpr double kIntegral = 5e-5;
  const glm::dvec3 eye_m(-1, 0, 1), middle_m(1, 0, 1);
  const double seen_through = std::exp(-kExtinction_per_m * glm::length(eye_m));
  for (const float roughness : {1.0f, 0.125f}) {
    CAPTURE(roughness);
    PathStage stage;
    stage.list.medium = {.extinction_per_m = kExtinction_per_m, .airlight = glm::vec3(static_cast<float>(kAir))};
    Material floor = matte(0.5);
    floor.roughness = roughness;
    floor.metallic = roughness < 1 ? 1.0f : 0.0f;
    stage.add(floor_mesh(), floor);
    const glm::dvec3 corner = middle_m - glm::dvec3(kSide_m / 2, kSide_m / 2, 0);
    stage.add(rectangle_mesh(corner, {0, kSide_m, 0}, {kSide_m, 0, 0}), lamp(kRadiance));
    const SurfaceReflection reflection{.normal = {0, 0, 1},
                                       .base = glm::dvec3(0.5),
                                       .roughness = static_cast<double>(roughness),
                                       .metallic = static_cast<double>(floor.metallic),
                                       .matte = roughness == 1};
    const double lit =
        light_through_fog(reflection, glm::normalize(eye_m), middle_m, kSide_m, kRadiance, kExtinction_per_m, kAir);
    const double expected = lit * seen_through + kAir * (1 - seen_through);
    const SeenRadiance seen = radiance_at(stage, eye_m, {0, 0, 0}, 20000, 1);
    CHECK(agree(seen.mean.x, expected, seen.stddev.x, kIntegral + kStored));
    CHECK(seen.stddev.x < 0.02 * lit * seen_through);
  }
}

TEST_CASE("a pixel is the mean over its square") {
  PathStage stage;
  // The lamp covers the left third of the pixel and the upper half of that.
  stage.add(rectangle_mesh({1, 1.0 / 3, 0}, {0, 0, 10}, {0, 10, 0}), lamp(1));
  Camera camera("C", path_camera(20000, 0, 1, kPi / 2));
  stage.take(camera, glm::dmat4(1));
  const double mean = static_cast<double>(color_of(camera).pixels[0]),
               stddev = static_cast<double>(image_of(camera, "color_stddev").pixels[0]);
  CHECK(agree(mean, 1.0 / 6, stddev));
  // That of a number which is 1 with the chance of 1 / 6; it is known to 1 / sqrt(2 n) and the kurtosis, below 2 %.
  CHECK(std::abs(stddev / std::sqrt(1.0 / 6 * (5.0 / 6) / 20000) - 1) < 0.02);
}

TEST_CASE("where a path leaves its pixel says nothing of where its light comes from") {
  PathStage stage;
  // The floor ends in the middle of the pixel, and the lamp stands on one side.
  const Mesh shining = rectangle_mesh({0, -0.5, 0.3}, {0, 1, 0}, {6, 0, 0});
  stage.add(rectangle_mesh({-50, 0, 0}, {100, 0, 0}, {0, 50, 0}), matte(0.5));
  stage.add(shining, lamp(3));
  const SeenRadiance half = radiance_at(stage, {0, 0, 0.2}, {0, 0, 0}, 20000, 1);
  PathStage without_edge;
  without_edge.add(floor_mesh(), matte(0.5));
  without_edge.add(shining, lamp(3));
  const SeenRadiance whole = radiance_at(without_edge, {0, 0, 0.2}, {0, 0, 0}, 20000, 1);
  CHECK(agree(half.mean.x, whole.mean.x / 2, std::hypot(half.stddev.x, whole.stddev.x / 2), kStored));
}

// Sums of squares of (mean - expected) / stddev are those of Student's distribution with n - 1 degrees of freedom,
// whose variance is (n - 1) / (n - 3).
TEST_CASE("standard deviations are those of the means, over 1,024 pixels and ten seeds") {
  constexpr double kBase = 0.5, kEmission = 0.25, kExpected = kEmission * (1 + kBase + kBase * kBase);
  constexpr std::uint32_t kSamples = 64, kSize_px = 32, kSeeds = 10;
  PathStage stage;
  Material wall = matte(kBase);
  wall.emissive = glm::vec3(static_cast<float>(kEmission));
  add_room(stage, 1, wall);
  double sum = 0, squares = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    CameraDesc desc = path_camera(kSamples, 2, kSize_px, kPi / 2);
    desc.seed = seed;
    Camera camera("C", desc);
    stage.take(camera, glm::dmat4(1));
    const Image color = color_of(camera), stddev = image_of(camera, "color_stddev");
    for (std::size_t i = 0; i < kSize_px * kSize_px; ++i) {
      const double off =
          (static_cast<double>(color.pixels[4 * i]) - kExpected) / static_cast<double>(stddev.pixels[3 * i]);
      sum += off;
      squares += off * off;
    }
  }
  constexpr double kPixels = double{kSize_px} * kSize_px * kSeeds, kVariance = (kSamples - 1.0) / (kSamples - 3.0);
  // The variance of a square is about 2; skewness of single paths shifts the mean by less than a tenth of it.
  CHECK(std::abs(sum / kPixels) < 5 / std::sqrt(kPixels) + 0.1 / std::sqrt(double{kSamples}));
  CHECK(std::abs(squares / kPixels - kVariance) < 5 * std::sqrt(2 / kPixels) + 0.02);
}

TEST_CASE("paths are the same bytes for any number of threads, and others in each frame and for each seed") {
  // With the leaf, rays are those of a caster of its own.
  const auto pixels = [](unsigned threads, std::uint64_t frame, std::uint64_t seed, bool with_leaf = true) {
    PathStage stage;
    stage.caster = make_host_ray_caster({}, threads);
    stage.list.environment.ambient = glm::vec3(0.2f);
    Material glossy = matte(1);
    glossy.roughness = 0.3f;
    stage.add(floor_mesh(), glossy);
    stage.add(ceiling_mesh(1, 1, 1), lamp(3));
    Material leaf = matte(0.5);
    leaf.opacity = 0.5f;
    if (with_leaf) stage.add(ceiling_mesh(2, 0.5, 0.7), leaf);
    CameraDesc desc = path_camera(3, 3, 40, 1.2);
    desc.seed = seed;
    Camera camera("C", desc);
    stage.take(camera, looking({3, 1, 2}, {0, 0, 0}), frame);
    const Image color = color_of(camera);
    return std::vector<float>(color.pixels.begin(), color.pixels.end());
  };
  const std::vector<float> once = pixels(1, 0, 0);
  const std::vector<float> without = pixels(1, 0, 0, false);
  for (const unsigned threads : {2u, 3u, 7u}) {
    CHECK(pixels(threads, 0, 0) == once);
    CHECK(pixels(threads, 0, 0, false) == without);
  }
  CHECK(pixels(1, 1, 0) != once);
  CHECK(pixels(1, 0, 1) != once);
}

}  // namespace
}  // namespace simvis::test
