// Progress reports to a program, and the terminal output, while a scene is opened.
#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <simvis/simulation.h>
#include "program/cli/loading_bar.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;

namespace {

constexpr const char* kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 -1 -1\n0 1 -1\n0 0 1\n3 0 1 2\n";
constexpr const char* kScene = R"(
  <part file="triangle.ply" name="A" insert_at="ROOT"/>
  <element type="light" name="SUN" insert_at="ROOT"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" pose_offset="-5 0 0 0 0 0" width="8" height="8"/>)";

std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("loading reports its progress, and a step the meshes that it prepares") {
  const TemporaryFolder folder;
  write_text(folder / "triangle.ply", kTriangle);
  std::vector<Progress> told;
  SimulationDesc desc;
  desc.progress = [&](const Progress& progress) { told.push_back(progress); };
  Simulation simulation = Simulation::from_string(kScene, desc, folder.path());
  REQUIRE(told.size() == 4);
  for (std::size_t i = 0; i < told.size(); ++i) {
    CHECK(told[i].work == "reading the scene");
    CHECK(told[i].done == i);
    CHECK(told[i].total == 3);
  }
  told.clear();
  simulation.step();
  REQUIRE(told.size() == 1);
  CHECK(told[0].work == "preparing meshes");
  CHECK(told[0].done == 0);
  CHECK(told[0].total == 3);
  told.clear();
  simulation.step();
  CHECK(told.empty());
}

TEST_CASE("the receiver of the progress can end the loading") {
  const TemporaryFolder folder;
  write_text(folder / "triangle.ply", kTriangle);
  SimulationDesc desc;
  desc.progress = [](const Progress& progress) {
    if (progress.done == 2) throw std::runtime_error("enough");
  };
  CHECK_THROWS_WITH_AS(Simulation::from_string(kScene, desc, folder.path()), "enough", std::runtime_error);
}

TEST_CASE("the loading bar draws itself, and clears its line before other output and at its end") {
  using namespace std::chrono_literals;
  const TemporaryFolder folder;
  std::ofstream terminal(folder / "terminal"), silent(folder / "silent");
  {
    LoadingBar bar(terminal, true, 0ms), off(silent, false, 0ms);
    for (LoadingBar* each : {&bar, &off}) each->update({"reading the scene", 1, 4});
    while (read(folder / "terminal").find("[##########                              ] reading the scene") ==
           std::string::npos) {
      std::this_thread::sleep_for(5ms);
    }
    bar.clear_line();
    CHECK(read(folder / "terminal").find("scene\r\033[K") != std::string::npos);
    for (LoadingBar* each : {&bar, &off}) each->update({"preparing meshes", 4, 4});
    while (read(folder / "terminal").find("preparing meshes") == std::string::npos) std::this_thread::sleep_for(5ms);
  }
  CHECK(read(folder / "terminal").ends_with("\r\033[K"));
  CHECK(read(folder / "silent").empty());
}

TEST_CASE("a bar for short work writes nothing") {
  const TemporaryFolder folder;
  std::ofstream terminal(folder / "terminal");
  {
    LoadingBar bar(terminal, true, std::chrono::hours(1));
    bar.update({"reading the scene", 1, 4});
  }
  CHECK(read(folder / "terminal").empty());
}

TEST_SUITE_END();
