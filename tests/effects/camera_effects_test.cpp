// How effects change the colour of images, and that effects that are off or shown by no sensor change nothing.
#include <simvis/camera_effect.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <simvis/simulation.h>
#include "effects/camera/exposure.h"
#include "effects/camera/sensor_noise.h"
#include "effects/camera/vignetting.h"
#include "scenes/showcase/effect_examples.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

constexpr std::uint32_t kNoiseWidth_px = 600, kNoiseHeight_px = 560;  // three channels: a million samples
constexpr double kSamples = 3.0 * kNoiseWidth_px * kNoiseHeight_px;
constexpr double kNoiseSigmas = 5;  // tolerance of a statistic, in its own standard deviations; the seed is fixed

Image flat(double light) {
  std::vector<float> pixels;
  for (std::uint32_t i = 0; i < kNoiseWidth_px * kNoiseHeight_px; ++i) {
    const auto value = static_cast<float>(light);
    pixels.insert(pixels.end(), {value, value, value, 1});
  }
  return {kNoiseWidth_px, kNoiseHeight_px, 4, std::move(pixels)};
}

CameraLayout layout() {
  return {.width_px = kNoiseWidth_px, .height_px = kNoiseHeight_px, .pinhole = {400, 410, 290, 285}};
}

struct PictureMoments {
  double mean = 0, variance = 0;
};

PictureMoments picture_moments(const Image& image) {
  PictureMoments m;
  const auto each = [&](const auto& action) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      if (i % 4 < 3) action(static_cast<double>(image.pixels[i]));
    }
  };
  each([&](double v) { m.mean += v / kSamples; });
  each([&](double v) { m.variance += (v - m.mean) * (v - m.mean) / kSamples; });
  return m;
}

// A wall at 4 m with one more sensor, simulated for one frame.
struct Run {
  Image color, depth;
  FrameCounters counters;
  FramePlan plan;
  std::vector<Image> more;
};

Run run(const std::string& type, const std::string& attributes, const std::string& before = "") {
  const TemporaryFolder folder;
  const auto scene = write_wall_scene(
      folder.path(), before + "<sensor type=\"" + type +
                         R"(" name="C" insert_at="ROOT" width="64" height="48" pose_offset="0 0 0 0 20 30" )" +
                         attributes + "/>");
  Simulation simulation = Simulation::load(scene);
  simulation.step();
  simulation.step();
  Run result;
  const bool color = attributes.find("outputs=\"depth\"") == std::string::npos;
  if (color) result.color = simulation.color("C");
  result.depth = simulation.depth("C");
  result.counters = simulation.diagnostics().counters();
  result.plan = simulation.diagnostics().frame_plan();
  if (type == "stereo_camera" && color) result.more.push_back(simulation.picture("C", "right"));
  return result;
}

void check_same(const Run& a, const Run& b) {
  CHECK(a.color.pixels == b.color.pixels);
  CHECK(a.depth.pixels == b.depth.pixels);
  REQUIRE(a.more.size() == b.more.size());
  for (std::size_t i = 0; i < a.more.size(); ++i) CHECK(a.more[i].pixels == b.more[i].pixels);
  CHECK(a.counters == b.counters);
  CHECK(a.plan.effects.size() == b.plan.effects.size());
}

}  // namespace

TEST_CASE("noise has the mean and the variance of a linear camera") {
  struct Case {
    double light;
    PixelElectronics electronics;
  };
  const Case cases[] = {{0.3, {.full_well_e = 1e4}},
                        {0.002, {.full_well_e = 1e4, .read_noise_e = 6}},
                        {0.25, {.full_well_e = 1000, .read_noise_e = 20, .gain = 2}},
                        {0.25, {.full_well_e = 1000, .read_noise_e = 20, .gain = 2, .adc_bits = 8}}};
  for (const Case& c : cases) {
    Image image = flat(c.light);
    SensorNoise(c.electronics, SensorRandom(3, "noise")).post_process({}, layout(), image);
    const PictureMoments m = picture_moments(image);
    const PixelElectronics& e = c.electronics;
    const double scale = e.gain / e.full_well_e;
    const double mean_e = static_cast<double>(static_cast<float>(c.light)) * e.full_well_e;
    const double level = e.adc_bits == 0 ? 0 : 1 / (std::exp2(e.adc_bits) - 1);
    // Beyond the range of poisson.h's exact means, rounding and skewness add 5 / 36 of an electron's square.
    const double electrons = mean_e + e.read_noise_e * e.read_noise_e + (mean_e > 64 ? 5.0 / 36 : 0);
    const double variance = scale * scale * electrons + level * level / 12;
    CHECK(std::abs(m.mean - scale * mean_e) <= kNoiseSigmas * std::sqrt(variance / kSamples));
    // The distribution is almost Gaussian: the fourth moment is 3 variance^2, and the Poisson part adds that of a mean
    // of at least 20.
    CHECK(std::abs(m.variance - variance) <= kNoiseSigmas * variance * std::sqrt((2 + 1.0 / 20) / kSamples));
    if (level == 0) continue;
    bool whole = true;
    for (const float v : image.pixels) {
      const double n = static_cast<double>(v) / level;
      whole = whole && v >= 0 && v <= 1 && std::abs(n - std::round(n)) <= 255 * 0x1p-23;
    }
    CHECK(whole);
  }
}

TEST_CASE("a full pixel stays full, and dark pixels are clipped only by a converter") {
  Image bright = flat(1e30), dark = flat(0);
  const PixelElectronics electronics{.full_well_e = 1000, .read_noise_e = 5};
  SensorNoise({.full_well_e = 1000}, SensorRandom(3, "noise")).post_process({}, layout(), bright);
  CHECK(std::ranges::count(bright.pixels, 1.0f) == std::ssize(bright.pixels));
  SensorNoise(electronics, SensorRandom(3, "noise")).post_process({}, layout(), dark);
  CHECK(std::abs(picture_moments(dark).mean) <= kNoiseSigmas * 0.005 / std::sqrt(kSamples));
  CHECK(*std::ranges::min_element(dark.pixels) < 0);
}

TEST_CASE("frames, channels and eyes have different noise, and other sensors do not change it") {
  const PixelElectronics electronics{.full_well_e = 1000};
  const auto noise = [&](const char* camera, std::uint64_t frame) {
    Image image = flat(0.5);
    SensorNoise(electronics, SensorRandom(3, camera)).post_process({.index = frame}, layout(), image);
    return image;
  };
  const Image a = noise("A", 1), b = noise("B", 1), later = noise("A", 2);
  const auto correlation = [&](const Image& one, std::size_t c1, const Image& other, std::size_t c2) {
    double sum = 0;
    const std::size_t n = std::size_t{kNoiseWidth_px} * kNoiseHeight_px;
    for (std::size_t i = 0; i < n; ++i) {
      sum +=
          (static_cast<double>(one.pixels[4 * i + c1]) - 0.5) * (static_cast<double>(other.pixels[4 * i + c2]) - 0.5);
    }
    return sum / static_cast<double>(n) / (0.5 / 1000);  // the variance is mu / full_well^2 with mu = 500
  };
  const double most = kNoiseSigmas / std::sqrt(kSamples / 3);
  CHECK(std::abs(correlation(a, 0, b, 0)) <= most);
  CHECK(std::abs(correlation(a, 0, later, 0)) <= most);
  CHECK(std::abs(correlation(a, 0, a, 1)) <= most);
  CHECK(correlation(a, 0, a, 0) > 0.99);
  CHECK(noise("A", 1).pixels == a.pixels);

  const std::string noisy = R"(outputs="color depth" full_well_e="200")";
  const Run alone = run("camera", noisy);
  const Run among = run("camera", noisy, R"(<sensor type="camera" name="B" insert_at="ROOT" full_well_e="100"/>)");
  CHECK(alone.color.pixels == among.color.pixels);
  const Run eyes = run("stereo_camera", R"(outputs="color depth" baseline="1e-9" full_well_e="200")");
  CHECK(eyes.color.pixels != eyes.more[0].pixels);
}

TEST_CASE("vignetting follows its law, and exposure scales the colours") {
  // Products of float32 colours in double, rounded once. The test applies the law in another order of operations.
  constexpr double kRounding = 0x1p-23;
  const CameraLayout l = layout();
  Image natural = flat(0.8), polynomial = flat(0.8), longer = flat(0.8);
  Vignetting(VignettingLaw::natural, {}, {}).post_process({}, l, natural);
  Vignetting(VignettingLaw::polynomial, {-0.3, 0.1, -0.05}, {}).post_process({}, l, polynomial);
  Exposure(2.5).post_process({}, l, longer);
  double worst = 0;
  for (std::uint32_t y = 0; y < kNoiseHeight_px; ++y) {
    for (std::uint32_t x = 0; x < kNoiseWidth_px; ++x) {
      const std::size_t i = 4 * (std::size_t{y} * kNoiseWidth_px + x);
      const double light = static_cast<double>(0.8f);
      const double angle = std::atan(std::hypot((x + 0.5 - 290) / 400, (y + 0.5 - 285) / 410));
      const double r = std::hypot(x + 0.5 - 290, y + 0.5 - 285) / (std::hypot(kNoiseWidth_px, kNoiseHeight_px) / 2);
      const double law = 1 - 0.3 * std::pow(r, 2) + 0.1 * std::pow(r, 4) - 0.05 * std::pow(r, 6);
      for (std::size_t c = 0; c < 3; ++c) {
        worst = std::max({worst,
                          std::abs(static_cast<double>(natural.pixels[i + c]) - light * std::pow(std::cos(angle), 4)),
                          std::abs(static_cast<double>(polynomial.pixels[i + c]) - light * law),
                          std::abs(static_cast<double>(longer.pixels[i + c]) - 2.5 * light)});
      }
      if (natural.pixels[i + 3] != 1 || polynomial.pixels[i + 3] != 1 || longer.pixels[i + 3] != 1) FAIL("alpha");
    }
  }
  CHECK(worst <= 2 * kRounding);  // 2.5 * 0.8 is 2
  const auto error = error_of([] { run("camera", R"(outputs="color depth" vignetting="polynomial" v1="-1.2")"); });
  CHECK(contains(error, "scene.xml:3:"));
  CHECK(contains(error, "attribute \"vignetting\": the polynomial of v1, v2, v3 is -0.1"));
}

TEST_CASE("an effect that is off or that no sensor shows leaves bytes and counters unchanged") {
  for (const EffectType* effect : effect_types()) {
    for (const std::string type : {"camera", "stereo_camera"}) {
      const EffectExample* const example = find_effect_example(effect->name);
      REQUIRE(example != nullptr);
      if (!may_have(type, *effect) || !example->commands.empty()) continue;
      CAPTURE(effect->name);
      CAPTURE(type);
      const std::string both = R"(outputs="color depth" )", on(example->attributes);
      const Run plain = run(type, both), off = run(type, both + std::string(example->off_attributes));
      check_same(plain, off);
      CHECK(off.plan.effects.empty());
      const Run shown = run(type, both + on);
      REQUIRE(shown.plan.effects.size() == 1);
      CHECK(shown.plan.effects[0].sensor == "C");
      CHECK(shown.plan.effects[0].effect == effect->name);
      CHECK(shown.plan.effects[0].reason == effect->source);
      // A camera at rest shows no rolling shutter, but its rows are drawn separately, which rounds differently. It
      // shows no motion blur either.
      const bool needs_motion = effect->name == "rolling_shutter" || effect->name == "motion_blur";
      if (!needs_motion) CHECK(shown.color.pixels != plain.color.pixels);
      if ((effect->outputs & kShownInDepth) != 0) continue;
      CHECK(shown.depth.pixels == plain.depth.pixels);
      const std::string deep = R"(outputs="depth" )";
      check_same(run(type, deep), run(type, deep + on));
    }
  }
}

TEST_SUITE_END();
