// The list of what light costs: errors against converged pictures, rows, and the program.
#include "program/report/light_costs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/philox.h>
#include "program/report/scene_lights.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis {
namespace {

// A box on a floor below a ball that shines, in ambient light: matte, so that light of one bounce is all that is drawn.
constexpr std::string_view kLitBox = R"(<scene>
<part shape="plane" size="20 20" name="FLOOR" insert_at="ROOT" color="0.6 0.6 0.6"/>
<part shape="box" size="0.6 0.6 0.8" name="BOX" insert_at="ROOT" color="0.7 0.5 0.3" pose_offset="3 0 0.4 0 0 20"/>
<element type="sky" name="AIR" insert_at="ROOT" ambient_red="0.2" ambient_green="0.2" ambient_blue="0.2"
  red="0" green="0" blue="0"/>
<element type="light" name="LAMP" insert_at="ROOT" kind="point" x="2" y="1.5" z="2" radius="0.3" intensity="12"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="64" height="48" pose_offset="0 0 1.2 0 15 0" exposure="0.5"
  light="path" bounces="1" samples="2"/>
<sensor type="camera" name="DEPTH" insert_at="ROOT" width="8" height="8" outputs="depth"/></scene>)";

struct LitBox {
  LitBox() { write_text(folder / "scene.xml", kLitBox); }
  std::string scene() const { return (folder / "scene.xml").string(); }

  TemporaryFolder folder;
};

Image noisy_image(double value, double deviation, std::uint32_t seed) {
  constexpr std::uint32_t kSize = 64;
  Image image{.width = kSize, .height = kSize, .channels = 4, .pixels = {}};
  const SensorRandom random(seed, "image");
  std::vector<float>& pixels = image.pixels.overwrite();
  for (std::uint32_t i = 0; i < 4 * kSize * kSize; ++i) {
    pixels.push_back(static_cast<float>(value + deviation * random.gaussian(0, i, 0)));
  }
  return image;
}

// The error of paths is their noise: half of it with four times as many, within that of the estimates.
void check_noise_of_paths(const std::vector<LightVariantCosts>& rows) {
  const std::size_t count = std::size(kCostedSamples);
  REQUIRE(rows.size() > count);
  for (std::size_t i = rows.size() - count; i + 1 < rows.size(); ++i) {
    const double expected = rows[i].error.rms / 2, off = rows[i + 1].error.rms - expected;
    CHECK(std::abs(off) < 0.15 * expected + 5 * (rows[i].error.uncertainty + rows[i + 1].error.uncertainty));
  }
}

}  // namespace

TEST_CASE("the error of a picture does not have the noise of those that it is compared with") {
  constexpr double kNoise = 0.5, kNumbers = 3 * 64 * 64;
  std::vector<Image> references;
  for (std::uint32_t i = 0; i < 4; ++i) references.push_back(noisy_image(1, kNoise, i));
  // A product of two differences d + e, with e of the deviation s, has the variance 2 d^2 s^2 + s^4; there are 6 pairs,
  // which share the term of the mean noise.
  const auto deviation = [&](double off) {
    const double square = kNoise * kNoise;
    return std::sqrt((off * off * square + square * square / 6) / kNumbers);
  };
  for (const double off : {0.0, 0.1, 1.0}) {
    CAPTURE(off);
    const LightError error = light_error(noisy_image(1 + off, 0, 9), references);
    CHECK(std::abs(error.rms * error.rms - off * off) <= 5 * deviation(off));
    CHECK(error.uncertainty > 0);
    if (off == 1) CHECK(error.uncertainty < 3 * deviation(off) / 2);
  }
  // The noise of the picture itself is part of its error.
  const LightError own = light_error(noisy_image(1, 0.2, 9), references);
  CHECK(std::abs(own.rms * own.rms - 0.04) <= 5 * (deviation(0.2) + 0.04 * std::sqrt(2 / kNumbers)));
}

TEST_CASE("the list of light has rows for what the scene offers, and paths whose error falls with their number") {
  const LitBox box;
  CHECK(costed_lights(Simulation::load(box.scene())) == Strings{"CAM"});
  const std::vector<LightCosts> all =
      light_costs(Simulation::load(box.scene()), {.frames = 2, .warm_up = 0, .on_frame = {}});
  REQUIRE(all.size() == 1);
  CHECK(all[0].refused.empty());
  CHECK(all[0].mean_radiance > 0);
  CHECK(all[0].width_px == 64);
  CHECK(all[0].height_px == 48);
  CHECK(all[0].bounces == 1);
  const std::vector<LightVariantCosts>& rows = all[0].variants;
  REQUIRE(rows.size() == 9);
  const auto named = [&](std::size_t i, const std::string& name) {
    CHECK(rows[i].light == name);
    CHECK(rows[i].median_ms > 0);
    CHECK(rows[i].error.uncertainty > 0);
  };
  named(0, "drawn");
  named(1, "with shadows");
  named(2, "with area lights");
  named(3, "with sky and occlusion");
  named(4, "and msaa 4");
  for (std::size_t i = 0; i < 4; ++i) {
    named(5 + i, "paths " + std::to_string(kCostedSamples[i]));
  }
  // Shadows and occlusion bring the picture nearer to that of paths, and its edges are what remains.
  CHECK(rows[1].error.rms < rows[0].error.rms);
  CHECK(rows[3].error.rms < rows[2].error.rms);
  CHECK(rows[4].error.rms < rows[3].error.rms);
  check_noise_of_paths(rows);
}

TEST_CASE("all pictures of the list of light show one moment, while bodies move by themselves") {
  std::string moving(kLitBox);
  moving.insert(moving.find("</scene>"),
                "<element type=\"physics\" name=\"PHYSICS\" insert_at=\"ROOT\" gravity=\"0 0 0\"/>"
                "<element type=\"body\" name=\"BODY\" insert_at=\"BOX\" mass=\"1\" velocity=\"0 3 0\"/>");
  Simulation simulation = Simulation::from_string(moving);
  simulation.step();
  simulation.step();
  CHECK(simulation.get("BODY", "y") > 0.1);  // 0.2 m in a frame
  const std::vector<LightCosts> all =
      light_costs(Simulation::from_string(moving), {.frames = 2, .warm_up = 0, .on_frame = {}});
  REQUIRE(all.size() == 1);
  REQUIRE(all[0].variants.size() == 9);
  check_noise_of_paths(all[0].variants);
}

// The numbers of an attribute of a camera with these attributes, as the list has it.
std::vector<double> listed(const std::string& attributes, const char* name) {
  const Simulation simulation = Simulation::from_string(
      "<scene><sensor type=\"camera\" name=\"C\" insert_at=\"ROOT\" light=\"path\" " + attributes + "/></scene>");
  const Command command = listed_camera(simulation.diagnostics().command("C"));
  std::vector<double> numbers;
  std::istringstream words(command.require(name).value);
  for (double number = 0; words >> number;) numbers.push_back(number);
  return numbers;
}

TEST_CASE("the list takes large cameras in a small image of the same view") {
  // A quarter of it is 120 x 67.5.
  const std::string focal = "width=\"480\" height=\"270\" ", lens = focal + "hfov=\"70\" ";
  CHECK(listed(lens, "width") == std::vector<double>{120});
  CHECK(listed(lens, "height") == std::vector<double>{68});
  CHECK(listed(lens, "hfov") == std::vector<double>{70});
  const std::string pinhole = focal + "fx=\"250\" fy=\"248\" cx=\"239.5\" cy=\"132.5\" ";
  CHECK(listed(pinhole, "fx") == std::vector<double>{62.5});
  CHECK(listed(pinhole, "fy") == std::vector<double>{62});
  CHECK(listed(pinhole, "cx") == std::vector<double>{59.5});
  CHECK(listed(pinhole, "cy") == std::vector<double>{32.75});
  const auto polynomial = [&](const std::string& lens_and_numbers) {
    return listed(focal + "distortion=" + lens_and_numbers, "polynomial");
  };
  CHECK(polynomial("\"ftheta\" polynomial=\"0 250 -8 4\"") == std::vector<double>{0, 62.5, -2, 1});
  // The same angles of a quarter of the distances; 2^-26 becomes 2^-20.
  CHECK(polynomial("\"ftheta_backward\" polynomial=\"0 0.0078125 0 1.4901161193847656e-8\"") ==
        std::vector<double>{0, 0.03125, 0, 0x1p-20});
  // Small images stay. Drawn ones may have more pixels than paths through an image of their size.
  CHECK(listed("width=\"100\" height=\"50\"", "width") == std::vector<double>{100});
  const Simulation drawn = Simulation::from_string(
      "<scene><sensor type=\"camera\" name=\"C\" insert_at=\"ROOT\" width=\"2048\" height=\"2049\"/></scene>");
  CHECK(listed_camera(drawn.diagnostics().command("C")).require("width").value == "90");
}

TEST_CASE("what is drawn without less of the light is as the scene has it afterwards") {
  const LitBox box;
  Simulation simulation = Simulation::load(box.scene());
  simulation.step();
  const DrawList before = simulation.diagnostics().draw_list();
  SceneLights lights(simulation);
  const auto check = [&](DrawnLight light, std::size_t count, std::size_t with_shadows) {
    CAPTURE(static_cast<int>(light));
    lights.show(light);
    simulation.step();
    const std::vector<LightItem>& shown = simulation.diagnostics().draw_list().lights;
    CHECK(shown.size() == count);
    const auto is_blocked = [](const LightItem& item) { return item.light.shadow_px > 0; };
    CHECK(static_cast<std::size_t>(std::ranges::count_if(shown, is_blocked)) == with_shadows);
  };
  check(DrawnLight::plain, 1, 0);
  check(DrawnLight::shadows, 1, 1);
  check(DrawnLight::sizes, 16, 16);
  check(DrawnLight::sky, 64, 64);
  CHECK(simulation.diagnostics().draw_list().environment.ambient == glm::vec3(0));
  lights.restore();
  simulation.step();
  const DrawList& after = simulation.diagnostics().draw_list();
  CHECK(after.lights == before.lights);
  CHECK(after.environment == before.environment);
}

TEST_CASE("the lights of a file that is inserted several times count as often") {
  const std::string lamp = SIMVIS_SOURCE_DIR "/scenes/marvin/lamp.glb";
  Simulation simulation = Simulation::from_string(
      "<scene><repeat count=\"6\" as=\"i\"><part name=\"LAMP_${i}\" insert_at=\"ROOT\" file=\"" + lamp +
      "\" pose_offset=\"${i} 0 0 0 0 0\"/></repeat>"
      "<sensor type=\"camera\" name=\"C\" insert_at=\"ROOT\" width=\"8\" height=\"8\"/></scene>");
  simulation.step();
  REQUIRE(simulation.diagnostics().draw_list().lights.size() == 6);
  SceneLights lights(simulation);
  lights.show(DrawnLight::sky);
  simulation.step();
  CHECK(simulation.diagnostics().draw_list().lights.size() == 64);
  const auto is_blocked = [](const LightItem& item) { return item.light.shadow_px > 0; };
  CHECK(std::ranges::all_of(simulation.diagnostics().draw_list().lights, is_blocked));
}

TEST_CASE("simvis-run --price prints the list of light, writes light_price.csv, and says why a camera has none") {
  const LitBox box;
  const std::string out = (box.folder / "out").string();
  const ProcessResult printed =
      Process({simvis_run(), box.scene(), "--price", "--frames", "1", "--sensor", "CAM", "--out", out}).wait();
  INFO(printed.err);
  REQUIRE(printed.exit_code == 0);
  CHECK(contains(printed.out, "CAM: light, 64 x 48 pixels, up to 1 bounces, load "));
  CHECK(contains(printed.out, "\npaths 64 "));
  CHECK(contains(printed.out, light_cost_legend()));
  CHECK(contains(printed.out, "wrote " + out + "/light_price.csv\n"));
  std::istringstream csv(read_text(box.folder / "out/light_price.csv"));
  std::size_t lines = 0;
  for (std::string line; std::getline(csv, line); ++lines) CHECK(std::ranges::count(line, ',') >= 14);
  CHECK(lines == 10);

  write_text(box.folder / "dots.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
             "end_header\n1 0 0\n");
  write_text(box.folder / "dots.xml",
             "<scene><part file=\"dots.ply\" name=\"DOTS\" insert_at=\"ROOT\"/>"
             "<sensor type=\"camera\" name=\"CAM\" insert_at=\"ROOT\" width=\"8\" height=\"8\"/></scene>");
  const ProcessResult dots =
      Process({simvis_run(), (box.folder / "dots.xml").string(), "--price", "--frames", "1"}).wait();
  CHECK(dots.exit_code == 0);
  CHECK(contains(dots.out, "CAM: light: no paths, "));
}

}  // namespace simvis

TEST_SUITE_END();
