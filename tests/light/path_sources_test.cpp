// Lamps with a size and skies as sources of paths of light, against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <simvis/simulation.h>
#include "engine/light/sky_sampler.h"
#include "tests/light/path_stage.h"
#include "tests/support/sky_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis::test {
namespace {

constexpr double kBase = 0.5;
constexpr std::uint32_t kSamples = 4000;
// The radiance of a picture of the sky is that of its lights, each stored as float32, over a mean that is.
constexpr double kStoredSky = 1e-6;

Material metal(double roughness) {
  Material material = matte(kBase);
  material.roughness = static_cast<float>(roughness);
  material.metallic = 1;
  return material;
}
// That blocks light from both sides.
Material black() {
  Material material = matte(0);
  material.double_sided = true;
  return material;
}

void add_floor(PathStage& stage, const Material& material = matte(kBase)) {
  stage.add(rectangle_mesh({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), material);
}

// One light for all points of a lamp, at a place.
void add_lamp(PathStage& stage, Light light, const glm::dvec3& at_m = glm::dvec3(0)) {
  stage.list.world_from_node.push_back(glm::translate(glm::dmat4(1), at_m));
  const auto place = static_cast<std::uint32_t>(stage.list.world_from_node.size() - 1);
  light.lamp_points = 2;
  light.intensity /= 2;
  for (light.lamp_point = 0; light.lamp_point < 2; ++light.lamp_point) stage.list.lights.push_back({light, place});
}

// The middle of the floor, seen from beside.
SeenRadiance floor_of(PathStage& stage) { return radiance_at(stage, {3, -2, 1.5}, {0, 0, 0}, kSamples, 1); }

// z / distance^3 is a harmonic function of the place of the light. Therefore its mean over a sphere is that of the
// middle.
TEST_CASE("a ball that shines gives the light of its middle to a plane that it does not touch") {
  constexpr double kIntensity = 10;
  for (const double radius_m : {0.001, 0.1, 1.0, 1.9, 1.99}) {
    CAPTURE(radius_m);
    PathStage stage;
    add_floor(stage);
    // Its light stands on the surface of the ball.
    add_lamp(stage,
             {.kind = LightKind::point,
              .intensity = kIntensity,
              .lamp_shape = LampShape::ball,
              .lamp_radius = radius_m,
              .lamp_middle = {-radius_m, 0, 0}},
             {1 + radius_m, 0, 2});
    const SeenRadiance seen = floor_of(stage);
    CHECK(agree(seen.mean.x, kBase / kPi * kIntensity * 2 / std::pow(5, 1.5), seen.stddev.x, kStored));
    // Evenly distributed points would have more of 1.9 and 1.99, whose nearest points are 0.34 and 0.25 away. These
    // have that of the cosine on the floor, less than half of its mean: 0.5 / sqrt(4000).
    CHECK(seen.stddev.x < 0.01 * seen.mean.x);
  }
}

TEST_CASE("a surface in which a lamp lies does not block it") {
  const auto lit = [](double angle_rad, bool with_wall) {
    PathStage stage;
    add_floor(stage);
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), angle_rad, glm::dvec3(1, 0, 0));
    const glm::dvec3 at_m(turn * glm::dvec4(0.3, 0.2, 0, 1));
    add_lamp(stage, {.kind = LightKind::point, .intensity = 10, .lamp_shape = LampShape::ball, .lamp_radius = 0},
             at_m + glm::dvec3(0, 0, 2));
    const glm::dmat4 up = glm::translate(glm::dmat4(1), {0, 0, 2});
    if (with_wall) stage.add(rectangle_mesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), black(), up * turn);
    return radiance_at(stage, {3, -2, 1.5}, {0, 0, 0}, 4, 1).mean.x;
  };
  // Half of the walls would be hit one rounding before the lamp.
  for (double angle_rad = 0.05; angle_rad < 1; angle_rad += 0.05) {
    CAPTURE(angle_rad);
    const double open = lit(angle_rad, false);
    CHECK(open > 0);
    CHECK(lit(angle_rad, true) == open);
  }
}

TEST_CASE("behind a straight edge, the light of a distant ball is linear in the place of the edge") {
  constexpr double kHeight_m = 100, kRadius_m = 0.5, kEdge_m = 50, kIntensity = 10000;
  for (const double part : {-1.1, -0.5, 0.0, 0.6, 1.1}) {
    CAPTURE(part);
    PathStage stage;
    add_floor(stage);
    add_lamp(
        stage,
        {.kind = LightKind::point, .intensity = kIntensity, .lamp_shape = LampShape::ball, .lamp_radius = kRadius_m},
        {0, 0, kHeight_m});
    const double edge_m = kEdge_m / kHeight_m * kRadius_m * part;
    stage.add(rectangle_mesh({edge_m, -9, kEdge_m}, {9, 0, 0}, {0, 18, 0}), black());
    const double share = std::clamp((1 + part) / 2, 0.0, 1.0),
                 whole = kBase / kPi * kIntensity / (kHeight_m * kHeight_m);
    const SeenRadiance seen = floor_of(stage);
    // Distances and angles vary by the ratio of the radius to the height over the ball.
    CHECK(agree(seen.mean.x, whole * share, seen.stddev.x, whole * 3 * kRadius_m / kHeight_m));
  }
}

TEST_CASE("a disc in the sky: the cosine in the mean over the disc, and a segment behind an edge") {
  constexpr double kIlluminance = 3, kWide = 0.5, kNarrow = 0.01;
  const auto add_sun = [](PathStage& stage, double radius) {
    const glm::dvec3 down(0, 0, -1);
    add_lamp(stage, {.intensity = kIlluminance,
                     .direction = glm::normalize(glm::dvec3(std::tan(radius), 0, -1)),
                     .lamp_shape = LampShape::disc,
                     .lamp_radius = radius,
                     .lamp_middle = down});
  };
  PathStage wide;
  add_floor(wide);
  add_sun(wide, kWide);
  const double square = std::pow(std::tan(kWide), 2), cosine = 2 / square * (std::sqrt(1 + square) - 1);
  const SeenRadiance whole = floor_of(wide);
  CHECK(agree(whole.mean.x, kBase / kPi * kIlluminance * cosine, whole.stddev.x, kStored));
  for (const double part : {-0.7, 0.2, 1.1}) {
    CAPTURE(part);
    PathStage stage;
    add_floor(stage);
    add_sun(stage, kNarrow);
    stage.add(rectangle_mesh({std::tan(kNarrow) * part, -9, 1}, {1, 0, 0}, {0, 18, 0}), black());
    const double at = std::min(part, 1.0), share = 1 - (std::acos(at) - at * std::sqrt(1 - at * at)) / kPi;
    const SeenRadiance seen = floor_of(stage);
    // Cosines of the disc are 1 to the square of its radius.
    CHECK(agree(seen.mean.x, kBase / kPi * kIlluminance * share, seen.stddev.x, kIlluminance * kNarrow * kNarrow));
  }
}

TEST_CASE("under a white sky a floor beside a wall lacks the form factor of the wall") {
  constexpr double kAway_m = 0.7, kWide_m = 3, kHigh_m = 2;
  PathStage stage;
  add_floor(stage);
  stage.add(rectangle_mesh({-kAway_m, -kWide_m / 2, 0}, {0, kWide_m, 0}, {0, 0, kHigh_m}), black());
  add_lamp(stage, {.color = {0.5f, 1, 2}, .intensity = 4 * kPi, .lamp_shape = LampShape::even_sky});
  stage.list.environment.ambient = {0.25f, 0, 0};
  const double slant = std::hypot(kHigh_m, kAway_m), half = kWide_m / 2;
  const double hidden = (std::atan(half / kAway_m) - kAway_m / slant * std::atan(half / slant)) / kPi;
  const SeenRadiance seen = floor_of(stage);
  const glm::dvec3 radiance(0.75, 1, 2);
  for (int c = 0; c < 3; ++c) {
    CHECK(agree(seen.mean[c], kBase * radiance[c] * (1 - hidden), seen.stddev[c], kStored));
  }
}

// One bright pixel of the sky, which is turned by 30 degrees.
struct OnePixelSky {
  static constexpr std::uint32_t kRow = 1, kColumn = 9, kHeight_px = 8;
  static constexpr double kRadiance = 64;
  glm::dmat4 turn = glm::rotate(glm::dmat4(1), kPi / 6, glm::dvec3(0, 0, 1));
  std::shared_ptr<const SkyPicture> picture =
      std::make_shared<SkyPicture>(sky_picture(kHeight_px, [](std::uint32_t column, std::uint32_t row) {
        return glm::vec3(row == kRow && column == kColumn ? float{kRadiance} : 0.0f);
      }));

  void add_to(PathStage& stage, double share = 1) const {
    const double all = sky_integral(*picture, [](const glm::dvec3&) { return 1.0; }).x;
    stage.list.world_from_node.push_back(turn);
    stage.list.sky = {.picture = picture,
                      .mean = glm::vec3(static_cast<float>(all / (4 * kPi))),
                      .transform = static_cast<std::uint32_t>(stage.list.world_from_node.size() - 1)};
    add_lamp(stage, {.intensity = all * share, .lamp_shape = LampShape::sky_picture});
  }
  double high_rad() const { return kPi / 2 - kPi * kRow / kHeight_px; }
  double low_rad() const { return high_rad() - kPi / kHeight_px; }
};

TEST_CASE("the sums of a picture of the sky are there once while they are used") {
  const auto day = std::make_shared<const SkyPicture>(sky_picture(2, [](auto, auto) { return glm::vec3(1); }));
  const auto night = std::make_shared<const SkyPicture>(*day);
  std::shared_ptr<const SkySampler> sampler = shared_sky_sampler(day);
  CHECK(sampler->picture() == day);
  CHECK(shared_sky_sampler(day) == sampler);
  CHECK(shared_sky_sampler(night) != sampler);
  const std::weak_ptr<const SkySampler> held = std::exchange(sampler, nullptr);
  CHECK(held.expired());
  CHECK(shared_sky_sampler(day)->picture() == day);
}

TEST_CASE("a sky with one bright pixel lights a matte floor by the integral of the cosine") {
  for (const double share : {1.0, 0.25}) {
    PathStage stage;
    add_floor(stage);
    const OnePixelSky sky;
    sky.add_to(stage, share);
    const double cosines = 2 * kPi / (2 * OnePixelSky::kHeight_px) *
                           (std::pow(std::sin(sky.high_rad()), 2) - std::pow(std::sin(sky.low_rad()), 2)) / 2;
    const double expected = kBase / kPi * OnePixelSky::kRadiance * cosines * share;
    const SeenRadiance seen = floor_of(stage);
    CHECK(agree(seen.mean.x, expected, seen.stddev.x, kStoredSky * expected));
    // Directions that know nothing of the sky would err by 0.09 of the light: one of 33 hits the pixel.
    CHECK(seen.stddev.x < 0.01 * expected);
  }
}

// Highlights that are narrower than the pixel are found by the directions of the surface, others by those of the sky.
TEST_CASE("a sky with one bright pixel lights shiny floors as a quadrature says, with little noise") {
  const OnePixelSky sky;
  const double azimuth = kPi / 6 + kPi - 2 * kPi * (OnePixelSky::kColumn + 0.5) / (2 * OnePixelSky::kHeight_px);
  const double middle = (sky.high_rad() + sky.low_rad()) / 2;
  // The eye is where a mirror would show the middle of the pixel.
  const glm::dvec3 eye(-std::cos(middle) * std::cos(azimuth), -std::cos(middle) * std::sin(azimuth), std::sin(middle));
  for (const double roughness : {0.1, 0.3, 1.0}) {
    CAPTURE(roughness);
    PathStage stage;
    add_floor(stage, metal(roughness));
    sky.add_to(stage);
    const SurfaceReflection metal{.normal = {0, 0, 1},
                                  .base = glm::dvec3(kBase),
                                  .roughness = static_cast<double>(static_cast<float>(roughness)),
                                  .metallic = 1,
                                  .matte = false};
    const auto share = [&](const glm::dvec3& direction) {
      const glm::dvec3 turned(sky.turn * glm::dvec4(direction, 0));
      return turned.z > 0 ? reflected_share(metal, eye, turned).x : 0;
    };
    constexpr std::uint32_t kParts = 64;
    const double expected = sky_integral(*sky.picture, share, kParts).x,
                 coarser = sky_integral(*sky.picture, share, kParts / 2).x;
    const SeenRadiance seen = radiance_at(stage, 4.0 * eye, {0, 0, 0}, kSamples, 1);
    CHECK(agree(seen.mean.x, expected, seen.stddev.x, std::abs(expected - coarser)));
    CHECK(seen.stddev.x < 0.015 * expected);
  }
}

// The radiance of a floor at the origin in a scene with these elements.
glm::dvec3 floor_in_scene(const std::string& elements, glm::dvec3& stddev, const std::filesystem::path& folder = ".") {
  Simulation simulation = Simulation::from_string(
      "<simvis><part name='FLOOR' insert_at='ROOT' shape='plane' size='100 100' color='1 1 1'/>"
      "<element type='sky' name='AIR' insert_at='ROOT' ambient_red='0' ambient_green='0' ambient_blue='0'/>" +
          elements +
          "<sensor type='camera' name='C' insert_at='ROOT' width='1' height='1' hfov='1e-6' light='path' "
          "samples='4000' "
          "bounces='1' outputs='color color_stddev' pose_offset='-3 0 3 0 45 0'/></simvis>",
      {}, folder);
  simulation.step();
  const Measurement measured = simulation.measurement("C");
  glm::dvec3 mean(0);
  for (std::size_t c = 0; c < 3; ++c) {
    mean[static_cast<glm::length_t>(c)] = measured.find("color")->number(c);
    stddev[static_cast<glm::length_t>(c)] = measured.find("color_stddev")->number(c);
  }
  return mean;
}

// A sphere of the radius R whose middle is at the height d has the form factor (R / d)^2 with a plane below it. No
// samples find it, as it is no triangles.
TEST_CASE("an exact sphere that shines lights a floor by its form factor, and by what it covers of both sides") {
  constexpr double kRadiance = 4, kRadius_m = 0.5, kHeight_m = 2;
  const double share = std::pow(kRadius_m / kHeight_m, 2);
  const auto seen = [](const std::string& more, glm::dvec3& stddev) {
    return floor_in_scene(
        "<element type='light' name='OFF' insert_at='ROOT' kind='point' z='5' intensity='0'/>"
        "<part name='BALL' insert_at='ROOT' shape='sphere' radius='0.5' color='0 0 0' pose_offset='0 0 2 0 0 0'/>"
        "<element type='material' name='SHINE' insert_at='ROOT' part='BALL' emission_red='4' " +
            more + "/>",
        stddev);
  };
  glm::dvec3 stddev(0);
  const glm::dvec3 solid = seen("", stddev);
  CHECK(agree(solid.x, kRadiance * share, stddev.x, kStored));
  // One of 16 paths hits it: a mean of 1/16 has the deviation sqrt(1/16 x 15/16 / 4000) = 0.004, times the radiance.
  CHECK(stddev.x < 0.02);
  // Half of the paths that meet the sphere see its front, and half of the others its back.
  const glm::dvec3 half = seen("opacity='0.5'", stddev);
  CHECK(agree(half.x, kRadiance * share * 0.75, stddev.x, kStored));
  CHECK(stddev.x < 0.02);
}

TEST_CASE("elements of lamps and skies are these sources, however many lights stand for them") {
  const TemporaryFolder folder;
  const SkyPicture half =
      sky_picture(8, [](std::uint32_t, std::uint32_t row) { return glm::vec3(row < 4 ? 1.0f : 0.0f); });
  write_text(folder.path() / "half.exr", sky_exr(half));
  const double square = std::pow(std::tan(kPi / 6), 2), cosine = 2 / square * (std::sqrt(1 + square) - 1);
  struct Row {
    std::string element;
    double radiance;
  };
  const std::array rows{
      Row{"kind='point' z='2' radius='1.5' intensity='12' lamp_points='4'", 12 / 4.0 / kPi},
      Row{"kind='spot' z='2' pitch='90' radius='0.1' intensity='12' lamp_points='3' inner_cone='60' outer_cone='60'",
          12 / 4.0 / kPi},
      Row{"kind='directional' elevation='90' angular_radius='30' intensity='3' lamp_points='5'", 3 * cosine / kPi}};
  for (const Row& row : rows) {
    CAPTURE(row.element);
    glm::dvec3 stddev(0);
    const glm::dvec3 mean =
        floor_in_scene("<element type='light' name='L' insert_at='ROOT' " + row.element + "/>", stddev);
    CHECK(agree(mean.x, row.radiance, stddev.x, kStored));
  }
  for (const char* shadows : {"no", "yes"}) {
    glm::dvec3 stddev(0);
    const std::string sky =
        std::string("<element type='sky_light' name='S' insert_at='ROOT' sky_points='16' shadows='") + shadows + "' ";
    const glm::dvec3 even = floor_in_scene(sky + "red='0.25' green='0.5' blue='1'/>", stddev);
    CHECK(glm::length(even - glm::dvec3(0.25, 0.5, 1)) <= 3 * kStored);
    const glm::dvec3 seen = floor_in_scene(sky + "picture='half.exr' intensity='2'/>", stddev, folder.path());
    CHECK(agree(seen.x, 2, stddev.x, 2 * kStoredSky));
  }
}

}  // namespace
}  // namespace simvis::test
