// The light of a picture of the sky: its parts and their sum, against integrals over the picture that are computed
// here; surfaces in its light, against closed forms; and the picture behind everything.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "elements/sky_regions.h"
#include "engine/base/even_points.h"
#include "engine/draw/sky_sphere.h"
#include "simvis/scene_builder.h"
#include "tests/support/element_scene.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sky_files.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

// Relative: sums of some thousand products of doubles.
constexpr double kSums = 1e-12;
// Of the mean light of all surfaces: a picture in n parts errs by less than this divided by n in the root mean square.
// A part of the sphere with the share 1 / n has a radius r of about 2 / sqrt(n), and the cosine at its middle differs
// from the mean of the cosine by r^2 / 4, which is 1 / n. Where the surface's horizon crosses a part, by up to r / 4 of
// the part's light, to either side: of the 2 sqrt(n) parts there, 1 / (4 n^0.75) of the whole in the root mean square.
constexpr double kPartsError = 1.25;
// The light of a single surface errs by less than twice that of all in the root mean square.
constexpr double kSurfaceError = 2 * kPartsError;

const std::string kNothing = "nothing was thrown";

double value_of(const glm::vec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

SkyPicture random_sky(std::uint32_t height) {
  Random random;
  const auto share = [&] { return static_cast<float>(random.below(1000) + 1) / 1000; };
  return sky_picture(height, [&](std::uint32_t, std::uint32_t) { return glm::vec3(share(), share(), share()); });
}

// Smooth, with a bright side.
SkyPicture evening_sky(std::uint32_t height) {
  SkyPicture picture{2 * height, height, {}};
  return sky_picture(height, [&](std::uint32_t column, std::uint32_t row) {
    const glm::dvec3 way = sky_direction(picture, column + 0.5, row + 0.5);
    const double glow = std::pow(std::max(0.0, glm::dot(way, reference::beam_direction(1, 0.2))), 8);
    return glm::vec3(0.2 + 3 * glow, 0.3 + 2 * glow, 0.4 + std::max(0.0, way.z));
  });
}

TEST_CASE("the pixels of a picture of the sky are patches of the sphere") {
  const SkyPicture picture = random_sky(12);
  const SkySphere sphere(picture);
  double all = 0, upper = 0;
  glm::dvec3 sum(0), left_half(0);
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    for (std::uint32_t column = 0; column < picture.width; ++column) {
      const glm::dvec3 integral = sphere.direction_integral(column, row);
      all += sphere.solid_angle_sr(row);
      if (row < picture.height / 2) upper += integral.z;
      sum += integral;
      if (column < picture.width / 2) left_half += integral;
      // A patch of 15 degrees at a pole is a triangle, whose middle is a sixth of its height from that of its height.
      const glm::dvec3 middle = sky_direction(picture, column + 0.5, row + 0.5);
      CHECK(glm::length(integral / sphere.solid_angle_sr(row) - middle) < glm::radians(15.0) / 6);
    }
  }
  CHECK(all == doctest::Approx(4 * kPi).epsilon(kSums));
  CHECK(upper == doctest::Approx(kPi).epsilon(kSums));  // the cosine's integral over half of a sphere
  CHECK(glm::length(sum) < kSums);
  CHECK(glm::length(left_half - glm::dvec3(0, kPi, 0)) < kSums * kPi);  // +y is on the left
}

TEST_CASE("the lights of a picture of the sky together have its light, for any number of them") {
  SkyPicture picture = random_sky(32);
  picture.radiance[777] = glm::vec3(1e5f, 9e4f, 8e4f);  // a sun of one pixel
  const glm::dvec3 exact = sky_integral(picture, [](const glm::dvec3&) { return 1.0; });
  CHECK(glm::length(4 * kPi * mean_radiance(picture) - exact) < kSums * glm::length(exact));
  for (const std::uint32_t most : {1u, 2u, 7u, 16u, 64u, 256u}) {
    CAPTURE(most);
    const std::vector<SkyRegion> regions = cut_sky(picture, most);
    CHECK(regions.size() == most);
    glm::dvec3 sum(0);
    for (const SkyRegion& region : regions) {
      CHECK(glm::length(region.towards) == doctest::Approx(1).epsilon(kSums));
      CHECK(value_of(region.irradiance) > 0);
      sum += region.irradiance;
    }
    CHECK(glm::length(sum - exact) < kSums * glm::length(exact));
  }
}

TEST_CASE("a sun of one pixel has a light of its own, which comes from that pixel") {
  SkyPicture picture = sky_picture(32, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); });
  constexpr std::uint32_t kColumn = 16, kRow = 8;  // of 64 x 32: azimuth 87 degrees, elevation 42
  picture.radiance[kRow * 64 + kColumn] = glm::vec3(1e6f);
  const std::vector<SkyRegion> regions = cut_sky(picture, 16);
  const auto sun =
      std::ranges::max_element(regions, {}, [](const SkyRegion& region) { return value_of(region.irradiance); });
  const double half_a_pixel = kPi / 64;
  const glm::dvec3 there = sky_direction(picture, kColumn + 0.5, kRow + 0.5);
  CHECK(std::acos(glm::dot(sun->towards, there)) < half_a_pixel);
  CHECK(there.y > 0.5);
  // The rest of the sky still has many lights.
  CHECK(std::ranges::count_if(regions, [](const SkyRegion& region) { return region.irradiance.x < 4; }) >= 11);
}

TEST_CASE("pictures that cannot be cut as often as is asked for") {
  const SkyPicture dark = sky_picture(4, [](std::uint32_t, std::uint32_t) { return glm::vec3(0); });
  CHECK(cut_sky(dark, 16).size() == 1);
  CHECK(cut_sky(dark, 16)[0].irradiance == glm::dvec3(0));
  const SkyPicture tiny = sky_picture(1, [](std::uint32_t column, std::uint32_t) { return glm::vec3(column + 1.0f); });
  CHECK(cut_sky(tiny, 16).size() == 2);
  const SkyPicture half = sky_picture(4, [](std::uint32_t, std::uint32_t row) { return glm::vec3(row < 1); });
  for (const SkyRegion& region : cut_sky(half, 256)) CHECK(region.towards.z > 0);
  CHECK(cut_sky(half, 256).size() == 8);
}

// The root mean square over surfaces in all directions of the error of their light, relative to its mean.
double error_of_parts(const SkyPicture& picture, std::uint32_t parts) {
  constexpr std::uint32_t kSurfaces = 100;
  const std::vector<SkyRegion> regions = cut_sky(picture, parts);
  double squares = 0, mean = 0;
  for (std::uint32_t i = 0; i < kSurfaces; ++i) {
    const glm::dvec3 normal = even_point_of_ball(i, kSurfaces);
    const double exact =
        sky_integral(picture, [&](const glm::dvec3& way) { return std::max(0.0, glm::dot(normal, way)); }).y;
    double sum = 0;
    for (const SkyRegion& region : regions)
      sum += region.irradiance.y * std::max(0.0, glm::dot(normal, region.towards));
    squares += (sum - exact) * (sum - exact) / kSurfaces;
    mean += exact / kSurfaces;
  }
  return std::sqrt(squares) / mean;
}

TEST_CASE("the light of surfaces under a picture converges to its integral with the number of lights") {
  for (const SkyPicture& picture :
       {evening_sky(64), sky_picture(64, [](std::uint32_t, std::uint32_t row) { return glm::vec3(row < 32); }),
        sky_picture(64, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); })}) {
    for (const std::uint32_t parts : {4u, 16u, 64u, 256u}) {
      CAPTURE(parts);
      const double error = error_of_parts(picture, parts);
      CHECK(error < kPartsError / parts);
    }
  }
}

// A wall at x = 4 m that faces -x, and the light of a picture that is turned by roll, pitch and yaw in degrees.
class SkyWorld {
 public:
  SkyWorld(const SkyPicture& picture, const std::string& turn, const std::string& attributes,
           const std::string& more = "") {
    write_text(folder_ / "sky.exr", sky_exr(picture));
    GltfBuilder file;
    add_plate(file, {}, file.append("materials", painted("Paint", glm::vec4(1))));
    world_.emplace(std::vector<std::pair<std::string, GltfBuilder>>{{"wall.gltf", file}},
                   R"(<part name="TURN" insert_at="ROOT" pose_offset="0 0 0 )" + turn + R"("/>)" + kDark +
                       R"(<element type="sky_light" name="DAY" insert_at="TURN" picture=")" +
                       (folder_ / "sky.exr").string() + "\" " + attributes + "/>" + more);
  }
  World& operator*() { return *world_; }
  World* operator->() { return &*world_; }

 private:
  TemporaryFolder folder_;
  std::optional<World> world_;
};

const std::string kWall = kCamera + R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)";

TEST_CASE("a surface under a picture of equal radiance shows that radiance, as under the constant sky_light") {
  const glm::vec3 radiance(0.25f, 0.5f, 1);
  const SkyPicture even = sky_picture(16, [&](std::uint32_t, std::uint32_t) { return radiance; });
  constexpr int kLights = 64;
  SkyWorld world(even, "0 0 0", R"(sky_points="64" shadows="no")", kWall);
  const glm::dvec3 seen = world->color();
  check_color(seen, radiance, kSurfaceError / kLights);
  World constant({}, kDark + kCamera +
                         R"(<part shape="box" size="1 20 20" name="WALL" insert_at="ROOT" pose_offset="5 0 0 0 0 0"/>)"
                         R"(<element type="sky_light" name="DAY" insert_at="ROOT" red="0.25" green="0.5" blue="1" )"
                         R"(sky_points="64" shadows="no"/>)");
  check_color(constant.color(), seen, 2 * kSurfaceError / kLights);
  // Twice the radiance, and the lights of the picture as they were cut here.
  check_color(world->color_with("DAY", "intensity", 2), 2.0 * seen, kShading);
  glm::dvec3 sum(0);
  for (const SkyRegion& region : cut_sky(even, kLights)) sum += region.irradiance * std::max(0.0, -region.towards.x);
  check_color(seen, sum / kPi);
}

TEST_CASE("a surface that is tilted against a half-bright sky by the angle t shows (1 + cos t) / 2 of its radiance") {
  const SkyPicture half = sky_picture(16, [](std::uint32_t, std::uint32_t row) { return glm::vec3(row < 8); });
  constexpr int kLights = 256;
  for (const int pitch_deg : {-90, -60, -30, 0, 30, 60}) {
    CAPTURE(pitch_deg);
    SkyWorld world(half, "0 " + std::to_string(pitch_deg) + " 0", R"(sky_points="256" shadows="no")", kWall);
    // The pitch turns the zenith to (sin, 0, cos) of its angle; the wall faces -x.
    const double cosine = -std::sin(glm::radians(static_cast<double>(pitch_deg)));
    CHECK(std::abs(world->color().x - (1 + cosine) / 2) < 0.5 * kSurfaceError / kLights);  // 0.5: the mean
  }
}

TEST_CASE("what is closed in by a box gets no light of the picture, unless its lights have no shadows") {
  const SkyPicture even = sky_picture(2, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); });
  const std::string box = kWall + R"(<part shape="box" size="30 30 30" name="BOX" insert_at="ROOT"/>)";
  SkyWorld dark(even, "0 0 0", R"(sky_points="16")", box),
      bright(even, "0 0 0", R"(shadows="no" sky_points="16")", box);
  CHECK(dark->color() == glm::dvec3(0));
  CHECK(bright->color().x > 0.5);
}

// The pixel of the picture that a direction meets; none if it is beside the edge of one.
std::optional<glm::vec3> met(const SkyPicture& picture, const std::vector<glm::dvec3>& ways) {
  std::optional<std::size_t> found;
  for (const glm::dvec3& way : ways) {
    const double column = (kPi - std::atan2(way.y, way.x)) / (2 * kPi) * picture.width,
                 row = (kPi / 2 - std::asin(way.z)) / kPi * picture.height;
    const std::size_t pixel = static_cast<std::size_t>(row) * picture.width + static_cast<std::size_t>(column);
    if (found && *found != pixel) return std::nullopt;
    found = pixel;
  }
  return picture.radiance[*found];
}

// Checks the picture of a camera that looks along +x at a sky of this frame, and returns how many pixels of the sky's
// picture it has seen.
std::size_t check_background(World& world, const SkyPicture& picture, const glm::dmat3& world_from_sky, double factor) {
  world.color();
  const Image& image = world->color("CAM");
  const double focal_px = image.width / 2.0 / std::tan(glm::radians(50.0));
  std::vector<glm::vec3> seen;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      std::vector<glm::dvec3> corners;
      for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 0), std::pair(1, 1)}) {
        const glm::dvec3 way(focal_px, image.width / 2.0 - x - dx, image.height / 2.0 - y - dy);
        corners.push_back(glm::transpose(world_from_sky) * glm::normalize(way));
      }
      const std::optional<glm::vec3> expected = met(picture, corners);
      if (!expected) continue;
      const float* const pixel = &image.pixels[4 * (std::size_t{y} * image.width + x)];
      CHECK(glm::vec3(pixel[0], pixel[1], pixel[2]) == static_cast<float>(factor) * *expected);
      if (std::ranges::find(seen, *expected) == seen.end()) seen.push_back(*expected);
    }
  }
  return seen.size();
}

const std::string kWideCamera =
    R"(<sensor type="camera" name="CAM" insert_at="ROOT" width="65" height="65" hfov="100" outputs="color depth"/>)";

TEST_CASE("a camera sees the picture of the sky behind everything, in its frame and times its intensity") {
  const SkyPicture picture = sky_picture(6, [](std::uint32_t column, std::uint32_t row) {
    return glm::vec3(0.5f + column, 1.0f + row, 1000.0f * row + column);
  });
  SkyWorld straight(picture, "0 0 0", R"(sky_points="16" shadows="no" intensity="2")", kWideCamera);
  CHECK(check_background(*straight, picture, glm::dmat3(1), 2) >= 10);
  const Image& depth = (*straight)->depth("CAM");
  CHECK(std::ranges::all_of(depth.pixels, [](float z) { return std::isinf(z); }));
  (*straight)->set("DAY", "intensity", 0.5);
  CHECK(check_background(*straight, picture, glm::dmat3(1), 0.5) >= 10);
  SkyWorld turned(picture, "10 20 130", R"(sky_points="16" shadows="no")", kWideCamera);
  const auto turn = [](double degrees, const glm::dvec3& axis) {
    return glm::dmat3(glm::rotate(glm::dmat4(1), glm::radians(degrees), axis));
  };
  const glm::dmat3 world_from_sky = turn(130, {0, 0, 1}) * turn(20, {0, 1, 0}) * turn(10, {1, 0, 0});
  CHECK(check_background(*turned, picture, world_from_sky, 1) >= 10);
}

TEST_CASE("what stands before the picture hides it, fog shows the air instead, and it goes with its element") {
  const SkyPicture picture = sky_picture(6, [](std::uint32_t, std::uint32_t) { return glm::vec3(7); });
  const std::string plate =
      R"(<part shape="box" size="0.1 2 2" color="0.5 0.5 0.5" name="PLATE" insert_at="ROOT" pose_offset="4 0 0 0 0 0"/>)";
  SkyWorld world(picture, "0 0 0", R"(sky_points="16" shadows="no")", kWideCamera + plate);
  CHECK(world->color(2, 2).x == 7);
  CHECK(world->color(32, 32).x < 6);
  (*world)->execute(R"(<element type="fog" name="FOG" insert_at="ROOT" visibility="100"/>)");
  CHECK(world->color(2, 2).x == doctest::Approx(0.7));
  (*world)->execute(R"(<remove name="FOG"/>)");
  CHECK(world->color(2, 2).x == 7);
  (*world)->execute(R"(<remove name="DAY"/>)");
  CHECK(world->color(2, 2).x == doctest::Approx(0.55));
}

TEST_CASE("a picture of the sky costs nothing where no sensor of colour is due") {
  const std::string depth =
      R"(<sensor type="camera" name="DEPTH" insert_at="ROOT" width="65" height="65" outputs="depth"/>)"
      R"(<part shape="box" size="0.1 2 2" name="PLATE" insert_at="ROOT" pose_offset="4 0 0 0 0 0"/>)";
  SkyWorld with(random_sky(64), "0 0 0", R"(sky_points="16")", depth);
  World without({}, R"(<part name="TURN" insert_at="ROOT"/>)" + kDark + depth);
  with->operator*().step();
  without->step();
  CHECK((*with)->diagnostics().counters() == without->diagnostics().counters());
  CHECK((*with)->diagnostics().counters().bytes_uploaded > 0);
}

TEST_CASE("pictures and attributes of a sky_light that are refused") {
  TemporaryFolder folder;
  const auto refused = [&](const std::string& attributes, const std::string& before = "") {
    return error_of([&] {
      build_scene(parse_commands(before + "<element type='sky_light' name='S' insert_at='ROOT' " + attributes + "/>",
                                 "s.xml", folder.path()));
    });
  };
  write_text(folder / "even.exr", sky_exr(sky_picture(2, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); })));
  write_text(folder / "text.exr", "no picture");
  CHECK(refused("picture='even.exr'") == kNothing);
  CHECK(contains(refused("picture='gone.exr'"), "s.xml:1:"));
  CHECK(contains(refused("picture='gone.exr'"), "attribute \"picture\": there is no picture"));
  CHECK(contains(refused("picture='text.exr'"), "is of another kind, expected OpenEXR or Radiance HDR"));
  CHECK(contains(refused("picture='even.exr' green='1'"), "attribute \"green\" is allowed only without a picture"));
  CHECK(contains(refused("intensity='1'"), "attribute \"intensity\" is allowed only with a picture"));
  CHECK(contains(refused("picture='even.exr' intensity='-1'"), "intensity"));
  CHECK(contains(refused("picture='even.exr' sky_points='128'"), "too many lights have shadows"));
  CHECK(refused("picture='even.exr' sky_points='128' shadows='no'") == kNothing);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
