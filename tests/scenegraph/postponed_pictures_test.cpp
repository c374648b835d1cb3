// Pictures that only cameras show are read when the scene has a camera, and not before.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include <simvis/simulation.h>
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/sensor_bytes.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

// The box is 1 m in front of the camera, 2 m wide and 3 m high.
const std::string kPictureBox = "<part file='box.obj' name='BOX' insert_at='ROOT' pose_offset='0 -3 -4.5 0 0 0'/>";
const std::string kPictureScanner = "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='31'/>";
const std::string kPictureCamera =
    "<sensor type='camera' name='CAM' insert_at='ROOT' width='16' height='16' hfov='60'/>";

struct PictureStage {
  explicit PictureStage(const std::string& picture) {
    write_text(folder / "box.mtl", "newmtl m\nKd 1 1 1\nmap_Kd " + picture + "\n");
    write_text(folder / "box.obj", "mtllib box.mtl\nusemtl m\n" + test::obj_box());
    write_text(folder / "red.ppm", std::string("P6\n1 1\n255\n\xff\0\0", 14));
  }
  Simulation simulation(const std::string& commands, bool strict = false) const {
    SimulationDesc desc;
    desc.strict = strict;
    return Simulation::from_string(commands, desc, folder.path());
  }
  TemporaryFolder folder;
};

bool has_warning_of(const Simulation& simulation, const std::string& text) {
  return std::ranges::any_of(simulation.warnings(), [&](const std::string& each) { return contains(each, text); });
}

bool has_input(const Simulation& simulation, const std::string& name) {
  return std::ranges::any_of(simulation.diagnostics().inputs(),
                             [&](const auto& file) { return file.filename() == name; });
}

TEST_CASE("a scene that only lasers look at opens no picture, and misses none") {
  const PictureStage missing("no.png"), there("red.ppm");
  Simulation without = missing.simulation(kPictureBox + kPictureScanner, true);
  without.step();
  CHECK(without.scan("SCAN").range_m[15] == 1.0f);
  CHECK(without.warnings().empty());
  Simulation with = there.simulation(kPictureBox + kPictureScanner);
  with.step();
  CHECK_FALSE(has_input(with, "red.ppm"));
  CHECK(measured_hash(with) == measured_hash(without));
}

TEST_CASE("a camera reads the pictures, whether it is there at once or comes later") {
  const PictureStage stage("red.ppm");
  Simulation at_once = stage.simulation(kPictureBox + kPictureCamera);
  CHECK(has_input(at_once, "red.ppm"));
  at_once.step();
  Simulation later = stage.simulation(kPictureBox + kPictureScanner);
  later.step();
  later.execute(kPictureCamera);
  CHECK(has_input(later, "red.ppm"));
  later.step();
  const Image &first = at_once.color("CAM"), &second = later.color("CAM");
  CHECK(first.pixels == second.pixels);
  const std::size_t middle = std::size_t{4} * (8 * 16 + 8);
  CHECK(first.pixels[middle] > 0.1f);
  CHECK(first.pixels[middle + 1] == 0);
}

TEST_CASE("a program that shows the draw list has its pictures read without any camera") {
  const PictureStage stage("red.ppm");
  Simulation simulation = stage.simulation(kPictureBox + kPictureScanner);
  const auto texture = [&] {
    const DrawList& list = simulation.diagnostics().draw_list();
    REQUIRE(list.items.size() == 1);
    return list.materials[list.items[0].material]->base_color_texture;
  };
  const std::vector<std::uint8_t> red{255, 0, 0, 255};
  simulation.step();
  CHECK((texture() == nullptr || texture()->rgba != red));
  read_all_content(simulation);
  simulation.step();
  REQUIRE(texture() != nullptr);
  CHECK(texture()->rgba == red);
  CHECK(simulation.scan("SCAN").range_m[15] == 1.0f);
}

TEST_CASE("a missing picture is a warning as soon as there is a camera, and an error if the scene is strict") {
  const PictureStage stage("no.png");
  const Simulation lenient = stage.simulation(kPictureBox + kPictureCamera);
  CHECK(has_warning_of(lenient, "picture \"no.png\" is not there"));
  CHECK(contains(error_of([&] { stage.simulation(kPictureBox + kPictureCamera, true); }),
                 "picture \"no.png\" is not there"));
  // The scene stays as it was, and the pictures stay to be read.
  Simulation strict = stage.simulation(kPictureBox + kPictureScanner, true);
  for (int i = 0; i < 2; ++i) {
    CHECK(contains(error_of([&] { strict.execute(kPictureCamera); }), "picture \"no.png\" is not there"));
  }
  CHECK(strict.sensors().size() == 1);
}

TEST_CASE("a camera of depth alone reads no picture") {
  const PictureStage stage("no.png");
  Simulation simulation = stage.simulation(
      kPictureBox + "<sensor type='camera' name='CAM' insert_at='ROOT' width='16' height='16' outputs='depth'/>");
  simulation.step();
  CHECK(simulation.depth("CAM").pixels[8 * 16 + 8] == doctest::Approx(1));
  CHECK(simulation.warnings().empty());
}

TEST_CASE("a picture whose alpha decides where beams pass is read at once") {
  ContentPool pool;
  pool.postpone_pictures();
  int reads = 0;
  const auto read = [&](std::vector<std::string>&) {
    ++reads;
    return std::optional(Texture{"t", 1, 1, {1, 2, 3, 4}, {}});
  };
  std::vector<std::string> warnings;
  const auto alpha = pool.picture({.read = read, .use = PictureUse::alpha}, warnings);
  CHECK(reads == 1);
  CHECK(alpha->rgba == std::vector<std::uint8_t>{1, 2, 3, 4});
  const auto color = pool.picture({.read = read}, warnings);
  CHECK(reads == 1);
  CHECK(color->rgba == std::vector<std::uint8_t>{255, 255, 255, 255});
  const auto pictures = pool.read_pictures(warnings);
  CHECK(reads == 2);
  CHECK(pictures.at(color.get()) == alpha);  // equal pictures are one
}

TEST_CASE("shapes have textures") {
  const PictureStage stage("red.ppm");
  const std::string wall = "<part name='WALL' insert_at='ROOT' shape='box' size='0.1 4 4' pose_offset='2 0 0 0 0 0' ";
  Simulation simulation = stage.simulation(wall + "texture='red.ppm' color='0.5 1 1'/>" + kPictureCamera);
  simulation.step();
  const Image& red = simulation.color("CAM");
  Simulation plain = stage.simulation(wall + "color='0.5 0 0'/>" + kPictureCamera);
  plain.step();
  CHECK(red.pixels == plain.color("CAM").pixels);
  CHECK(contains(error_of([&] { stage.simulation(wall + "texture='no.png'/>"); }),
                 "attribute \"texture\": there is no picture"));
  const Simulation broken = stage.simulation(wall + "texture='box.obj'/>" + kPictureCamera);
  CHECK(has_warning_of(broken, "the colour replaces the texture"));
}

}  // namespace
}  // namespace simvis
