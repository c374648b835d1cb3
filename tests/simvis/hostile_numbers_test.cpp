// Scenes with numbers of any size, from 1e-300 to 1e300: each is refused with its place, or measures numbers.
// SIMVIS_TEST_SCENES=100000 tries so many, SIMVIS_TEST_SEED=7 others.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include <simvis/error.h>
#include <simvis/simulation.h>
#include "tests/support/long_count.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// In each line every "NAME?USUAL" becomes NAME="NUMBER": the usual one, or at random any other.
constexpr std::string_view kNumberedScene = R"(
<part file='wall.gltf' name='WALL' insert_at='ROOT' scale?1 pose_offset?0,0,0,0,0,0/>
<part shape='box' size?1,1,1 name='BOX' insert_at='ROOT' pose_offset?2,0,0,0,0,10 color?1,0.5,0/>
<part shape='sphere' radius?0.5 name='BALL' insert_at='BOX' pose_offset?0,1,0,0,0,0/>
<part shape='capsule' radius?0.2 length?1 name='PILL' insert_at='ROOT' pose_offset?3,-1,0,0,40,0/>
<element type='pose' name='MOVE' insert_at='BALL' x?0 y?0.1 yaw?20 roll?0/>
<element type='light' kind='point' name='LAMP' insert_at='ROOT' intensity?10 range?0 x?0 z?2 red?1/>
<element type='light' kind='spot' name='SPOT' insert_at='ROOT' intensity?10 inner_cone?10 outer_cone?30 pitch?10 shadows='yes'/>
<element type='scale' name='SIZE' insert_at='PILL' x?1 y?1 z?1/>
<sensor type='camera' name='CAM' insert_at='ROOT' width='12' height='8' outputs='color depth' hfov?60 near?0.05 exposure?1 k1?0 full_well_e?0 read_noise_e?0 pose_offset?0,0,0,0,0,0/>
<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='9' min_angle?-40 max_angle?40 range_min?0.05 range_max?80 range_noise?0.01/>
<sensor type='laser_scanner' name='PLANAR' insert_at='ROOT' samples='9' method='planar' vertical_samples='3' vertical_min_angle?-5 vertical_max_angle?5 range_max?80 pose_offset?0,0,0,0,0,0/>
<sensor type='imu' name='IMU' insert_at='ROOT'/>
<sensor type='range' name='RANGE' insert_at='ROOT' range_max?5/>)";

class NumberedScenes {
 public:
  explicit NumberedScenes(unsigned seed) : random_(seed) {}

  std::string next() {
    // One number in twenty is strange, on average; otherwise nearly every scene would be refused.
    std::string scene;
    for (std::size_t at = 0; at < kNumberedScene.size();) {
      if (kNumberedScene[at] != '?') {
        scene += kNumberedScene[at++];
        continue;
      }
      std::size_t end = kNumberedScene.find_first_of(" /\n", at);
      scene += "='" + numbers(kNumberedScene.substr(at + 1, end - at - 1)) + "'";
      at = end;
    }
    return scene;
  }

 private:
  std::string numbers(std::string_view usual) {
    std::string all;
    while (!usual.empty()) {
      const std::size_t comma = std::min(usual.find(','), usual.size());
      all += (all.empty() ? "" : " ") + (random_() % 20 == 0 ? strange() : std::string(usual.substr(0, comma)));
      usual.remove_prefix(std::min(comma + 1, usual.size()));
    }
    return all;
  }
  std::string strange() {
    static constexpr const char* kSpecial[] = {
        "0", "-0", "5e-324", "1.7976931348623157e308", "1e-300", "-1e300", "3.5e38", "1e-46", "1e15", "16777217"};
    if (random_() % 3 == 0) return kSpecial[random_() % std::size(kSpecial)];
    // Every second one is of a size that is often allowed.
    const double most = random_() % 2 == 0 ? 300 : 12;
    char text[32];
    std::snprintf(
        text, sizeof text, "%.17g",
        (random_() % 2 == 0 ? 1 : -1) * std::pow(10, std::uniform_real_distribution<double>(-most, most)(random_)));
    return text;
  }

  std::mt19937_64 random_;
};

/// What is wrong with the results; empty: they are numbers.
std::string wrong_results(const Simulation& simulation) {
  for (const float value : simulation.color("CAM").pixels) {
    if (std::isnan(value)) return "a pixel of CAM is no number";
  }
  for (const float value : simulation.depth("CAM").pixels) {
    if (!(value >= 0)) return "a depth of CAM is " + std::to_string(value);
  }
  for (const char* name : {"SCAN", "PLANAR"}) {
    const Scan scan = simulation.scan(name);
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      if (!(scan.range_m[i] >= 0)) return std::string("a range of ") + name + " is " + std::to_string(scan.range_m[i]);
      if (!(scan.error_bound_m[i] >= 0)) return std::string("a bound of ") + name + " is no number";
    }
  }
  return {};
}

TEST_CASE("scenes with numbers of any size are refused with their place, or measure numbers") {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  NumberedScenes scenes(static_cast<unsigned>(count_of("SIMVIS_TEST_SEED", 1)));
  SimulationDesc desc;
  desc.device.cache_dir = (folder / "cache").string();
  int measured = 0, refused = 0;
  for (int i = count_of("SIMVIS_TEST_SCENES", sanitized() ? 20 : 50); i > 0; --i) {
    const std::string text = scenes.next();
    CAPTURE(text);
    write_text(folder / "scene.xml", "<scene>" + text + "</scene>");
    try {
      Simulation simulation = Simulation::load(folder / "scene.xml", desc);
      for (int frame = 0; frame < 2; ++frame) {
        simulation.step();
        CHECK(wrong_results(simulation) == "");
      }
      ++measured;
    } catch (const InputError& error) {
      INFO(error.what());
      CHECK(std::string(error.what()).find("error: ") != std::string::npos);
      ++refused;
    } catch (const std::exception& error) {
      FAIL_CHECK(error.what());
    }
  }
  std::printf("scenes with strange numbers: %d measured, %d were refused\n", measured, refused);
  CHECK(measured > 0);
  CHECK(refused > 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
