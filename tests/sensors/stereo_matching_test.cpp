// Whether a stereo algorithm for real pictures finds the true disparity in rendered ones: OpenCV's semi-global matching
// on pairs of SimVis.
#include <doctest/doctest.h>

#include <filesystem>

#include "tests/support/skip.h"

TEST_SUITE_BEGIN("sensors");

#ifndef SIMVIS_HAS_OPENCV

TEST_CASE("stereo matching") { simvis::test::skip("OpenCV's calib3d was not found when this was built"); }

#else

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>
#include <string>

#include <simvis/philox.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "sensors/camera/stereo_camera.h"
#include "tests/support/measured_images.h"
#include "tests/support/renderer_scene.h"

using namespace simvis;

namespace {

/// A rectified pair with the truth, all of one size.
struct Pair {
  const Image &left, &right, &left_depth, &right_depth, &disparity;
};

/// Shares of pixels whose disparity was found to within kClose_px.
struct Score {
  double of_all = 0;        ///< of the pixels with a true disparity, which the right camera may not see
  double of_both_seen = 0;  ///< of those that the right camera sees too
  double both_seen = 0;     ///< how many of all those are
};

constexpr double kClose_px = 1;

// Lower limits of `of_both_seen`.
//
// Every window of 5 x 5 pixels on textured planes is unique, so only windows across a silhouette should fail, within 2
// pixels of it. The outlines of the two plates are 1,300 pixels long together: 5,200 pixels on both sides, 1.9 % of the
// 276,000 that count. Slightly more than the same amount is added for the strips that only one camera sees, which
// disturb their neighbours, and for the floor, where a window does not fit the other picture exactly.
constexpr double kTexturedPlanes = 0.95;
// Leaves are narrower than a window, and many look alike, so no figure can be derived. Half transparent ones show two
// surfaces in one pixel, of which the nearer is the truth. Chance gives 3 / 64.
constexpr double kOutdoors = 0.5;

/// A result picture of a stereo camera by its name.
Pair pair_of(const auto& picture) {
  return {picture("left"), picture("right"), picture("left_depth"), picture("right_depth"), picture("disparity")};
}

/// Grey levels of a camera: sRGB codes, weighted as in OpenCV.
cv::Mat to_grey(const Image& color) {
  cv::Mat grey(static_cast<int>(color.height), static_cast<int>(color.width), CV_8UC1);
  for (std::size_t i = 0; i < grey.total(); ++i) {
    const float* const rgb = color.pixels.data() + 4 * i;
    const double level = 0.299 * srgb_code(rgb[0]) + 0.587 * srgb_code(rgb[1]) + 0.114 * srgb_code(rgb[2]);
    grey.data[i] = static_cast<std::uint8_t>(std::lround(level));
  }
  return grey;
}

/// Sixteenths of a pixel. The parameters are those that OpenCV's documentation recommends for a block of 5 x 5 pixels.
/// No filter discards results, so every pixel has one.
cv::Mat match(const Pair& pair, int disparities) {
  constexpr int kBlock = 5, kSmallStep = 8 * kBlock * kBlock, kLargeStep = 32 * kBlock * kBlock;
  const auto matcher = cv::StereoSGBM::create(0, disparities, kBlock, kSmallStep, kLargeStep);
  cv::Mat found;
  matcher->compute(to_grey(pair.left), to_grey(pair.right), found);
  return found;
}

/// Whether the right camera sees the same surface as the left one at column x of row y.
bool seen_by_both(const Pair& pair, std::size_t x, std::size_t y) {
  // At a step in depth the footprint of the pixel covers both sides, so one of the nearest two columns decides.
  constexpr double kSameSurface = 0.02;  // relative; surfaces behind each other are farther apart or hardly matter
  const std::size_t i = y * pair.disparity.width + x;
  const double column = static_cast<double>(x) - static_cast<double>(pair.disparity.pixels[i]);
  for (const double each : {std::floor(column), std::ceil(column)}) {
    if (each < 0) return false;
    const double other_m = pair.right_depth.pixels[y * pair.disparity.width + static_cast<std::size_t>(each)];
    if (std::abs(other_m / static_cast<double>(pair.left_depth.pixels[i]) - 1) <= kSameSurface) return true;
  }
  return false;
}

/// The search range: a multiple of 16, as OpenCV requires, above the largest true disparity.
int search_range(const Pair& pair) {
  const double largest = *std::ranges::max_element(pair.disparity.pixels);
  return 16 * (static_cast<int>(largest + kClose_px) / 16 + 1);
}

/// Excludes the columns at the left edge where OpenCV does not search: most of their content is outside the right
/// picture.
Score evaluate(const Pair& pair) {
  const int disparities = search_range(pair);
  const cv::Mat found = match(pair, disparities);
  double all = 0, all_right = 0, both = 0, both_right = 0;
  for (std::size_t y = 0; y < pair.disparity.height; ++y) {
    for (auto x = static_cast<std::size_t>(disparities); x < pair.disparity.width; ++x) {
      const double truth = pair.disparity.pixels[y * pair.disparity.width + x];
      if (truth <= 0) continue;
      const double px = found.at<std::int16_t>(static_cast<int>(y), static_cast<int>(x)) / 16.0;
      const bool right = std::abs(px - truth) <= kClose_px;
      const bool seen = seen_by_both(pair, x, y);
      all += 1;
      all_right += right;
      both += seen;
      both_right += seen && right;
    }
  }
  REQUIRE(both > 0);
  return {all_right / all, both_right / both, both / all};
}

void report(const std::string& scene, const Score& score) {
  std::printf("%s: %.2f %% of all pixels within %g px; %.2f %% of those that both cameras see (%.2f %% of all)\n",
              scene.c_str(), 100 * score.of_all, kClose_px, 100 * score.of_both_seen, 100 * score.both_seen);
}

/// Sets the transparency of all foliage as a share of its range, from 0 to 1. Returns the number of elements.
int fade_leaves(Simulation& simulation, double share) {
  Parameters& parameters = simulation.parameters();
  int count = 0;
  for (const ElementDescriptor& element : parameters.elements()) {
    if (element.type != "foliage") continue;
    const std::size_t index = parameters.index(element.name, "transparency");
    const AttributeSpec& spec = parameters.spec(index);
    parameters.set(index, spec.min + share * (spec.max - spec.min));
    ++count;
  }
  return count;
}

/// Grey noise with several grain sizes, so that it has structure at any distance.
std::shared_ptr<Texture> noise_texture(std::uint32_t size_px, const char* name) {
  const SensorRandom random(1, name);
  auto texture = std::make_shared<Texture>();
  texture->name = name;
  texture->width = texture->height = size_px;
  for (std::uint32_t y = 0; y < size_px; ++y) {
    for (std::uint32_t x = 0; x < size_px; ++x) {
      double level = 128;
      for (std::uint32_t grain = 0; grain < 5; ++grain) {
        level += 22 * random.gaussian(grain, x >> grain, y >> grain);
      }
      const auto code = static_cast<std::uint8_t>(std::clamp(level, 0.0, 255.0));
      texture->rgba.insert(texture->rgba.end(), {code, code, code, 255});
    }
  }
  return texture;
}

/// A wall, a floor and two plates in front of them, seen from the origin along +x.
test::RendererScene textured_scene() {
  test::RendererScene scene;
  Material material;
  material.unlit = material.double_sided = true;
  material.base_color_texture = noise_texture(512, "noise");
  const std::uint32_t paint = scene.add_material(material);
  const auto add = [&](float half_m, const glm::dmat4& view_from_plate) {
    scene.add(scene.add_mesh(test::rectangle(-half_m, -half_m, half_m, half_m)), paint,
              sensor_from_view() * view_from_plate);
  };
  const auto turned_about_x = [](double angle) {
    glm::dmat4 m(1);
    m[1] = {0, std::cos(angle), std::sin(angle), 0};
    m[2] = {0, -std::sin(angle), std::cos(angle), 0};
    return m;
  };
  add(6, test::at(0, 0, 6));
  add(3, test::at(0, 1, 4) * turned_about_x(1.5707963267948966));
  add(0.4f, test::at(-0.5, 0.3, 2));
  add(0.5f, test::at(0.9, -0.2, 3) * turned_about_x(0.6));
  return scene;
}

}  // namespace

TEST_CASE("semi-global matching finds the disparity of textured planes") {
  StereoCamera camera("S", {.pinhole = {.width_px = 640, .height_px = 480, .hfov_rad = 1.2},
                            .baseline_m = 0.12,
                            .color = true,
                            .depth = true,
                            .disparity = true});
  Renderer renderer(test::device());
  const test::RendererScene scene = textured_scene();
  FramePlan plan;
  camera.plan(glm::dmat4(1), scene.list, plan);
  camera.collect({}, plan, renderer.render(scene.list, plan));
  const Pair pair = pair_of([&](const char* name) { return image_of(camera, name); });
  const Score score = evaluate(pair);
  report("textured planes", score);
  CHECK(score.of_both_seen >= kTexturedPlanes);
}

TEST_CASE("semi-global matching in the outdoor scene while its leaves fade") {
  const std::filesystem::path file = SIMVIS_SOURCE_DIR "/scenes/ravon/ravon.xml";
  if (!std::filesystem::exists(file)) return test::skip("the scene ravon is not here");
  SimulationDesc desc;
  desc.overrides.push_back({"stereo_camera", "outputs", "color depth disparity", ""});
  Simulation simulation = Simulation::load(file, desc);
  std::string eyes;
  for (const SensorInfo& sensor : simulation.sensors()) {
    simulation.enable(sensor.name, sensor.type == "stereo_camera");
    if (sensor.type == "stereo_camera") eyes = sensor.name;
  }
  REQUIRE_MESSAGE(eyes != "", "the scene has no stereo camera");
  for (const double transparency : {0.0, 0.5, 1.0}) {
    const int faded = fade_leaves(simulation, transparency);
    simulation.step();
    const Pair pair = pair_of([&](const char* name) { return simulation.picture(eyes, name); });
    const Score score = evaluate(pair);
    report("ravon, leaves " + std::to_string(std::lround(100 * transparency)) + " % transparent", score);
    CHECK(score.of_both_seen >= kOutdoors);
    if (faded == 0) break;
  }
}

#endif

TEST_SUITE_END();
