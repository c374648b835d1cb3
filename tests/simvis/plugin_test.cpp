// An element and a sensor in a plug-in library work like those of SimVis.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// The distance of the probe is near / d of one float32 depth. It has at most 8 roundings of relative 2^-24: two of the
// vertex, four of the setup and evaluation of the plane, one of the projection, one of the storage of depth.
constexpr double kDistanceTolerance = 8 * 0x1p-24;

const std::string kPlugin = tested_build() + "/lib/libsimvis_example_plugin.so";

constexpr std::string_view kPluginScene = R"(<scene>
  <element type="plate" name="PLATE" insert_at="ROOT" x="2.5"/>
  <sensor type="distance_probe" name="PROBE" insert_at="ROOT" pose_offset="-1 0 0 0 0 0"/>
</scene>
)";

/// The cells of the last column of a table, its heading first.
std::vector<std::string> last_column(const std::string& csv) {
  std::vector<std::string> cells;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) cells.push_back(line.substr(line.rfind(',') + 1));
  return cells;
}

}  // namespace

TEST_CASE("--describe lists the types of a plug-in") {
  const ProcessResult plate = Process({simvis_run(), "--plugin", kPlugin, "--describe", "plate"}).wait();
  CHECK(plate.exit_code == 0);
  CHECK(plate.out.find("a square plate across the x axis") != std::string::npos);
  CHECK(plate.out.find("length of its edges") != std::string::npos);
  const ProcessResult probe = Process({simvis_run(), "--plugin", kPlugin, "--describe", "distance_probe"}).wait();
  CHECK(probe.exit_code == 0);
  CHECK(probe.out.find("what is nearer is not seen") != std::string::npos);
  CHECK(probe.out.find("\ngives:\ndistance_m  scalar of f64 (m), frame sensor, nothing: inf\n"
                       "            along x\n") != std::string::npos);
}

TEST_CASE("a scene with types of a plug-in is run") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml", kPluginScene);
  write_text(folder / "move.csv", "time_s,PLATE.x\n0,2.5\n1,-5\n");
  const ProcessResult run =
      Process({simvis_run(), "--plugin", kPlugin, "--frames", "2", "--rate", "1", "--trajectory",
               (folder / "move.csv").string(), "--out", (folder / "out").string(), (folder / "scene.xml").string()})
          .wait();
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const std::vector<std::string> distances = last_column(read_text(folder / "out/PROBE.csv"));
  REQUIRE(distances.size() == 3);
  CHECK(distances[0] == "distance_m");
  CHECK(std::abs(std::stod(distances[1]) - 3.5) <= 3.5 * kDistanceTolerance);
  // In the second frame the plate is behind the probe.
  CHECK(distances[2] == "inf");
}

TEST_CASE("the door of the tutorial opens") {
  const TemporaryFolder folder;
  // The probe is in front of the hinge and does not move; the plate 2 m ahead turns with the door.
  write_text(folder / "scene.xml", R"(<scene>
    <sensor type="distance_probe" name="PROBE" insert_at="ROOT"/>
    <element type="door" name="DOOR" insert_at="ROOT"/>
    <element type="plate" name="PLATE" insert_at="ROOT" x="2" size="5"/>
  </scene>)");
  write_text(folder / "move.csv", "time_s,DOOR.open\n0,0\n1,50\n2,100\n");
  const ProcessResult run =
      Process({simvis_run(), "--plugin", kPlugin, "--frames", "3", "--rate", "1", "--trajectory",
               (folder / "move.csv").string(), "--out", (folder / "out").string(), (folder / "scene.xml").string()})
          .wait();
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const std::vector<std::string> distances = last_column(read_text(folder / "out/PROBE.csv"));
  REQUIRE(distances.size() == 4);
  CHECK(std::abs(std::stod(distances[1]) - 2) <= 2 * kDistanceTolerance);
  // Half open, 45 degrees: the plane of the plate crosses the x axis at 2 / cos(45 degrees), 2 m from the centre of the
  // plate.
  const double half_open = 2 * std::sqrt(2.0);
  // The slant doubles the effect of a vertex rounding.
  CHECK(std::abs(std::stod(distances[2]) - half_open) <= 2 * half_open * kDistanceTolerance);
  CHECK(distances[3] == "inf");  // a quarter turn
}

TEST_CASE("a scene is refused without its plug-in") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml", kPluginScene);
  const ProcessResult run = Process({simvis_run(), (folder / "scene.xml").string()}).wait();
  CHECK(run.exit_code == 2);
  CHECK(run.err.find("plate") != std::string::npos);
}

}  // namespace simvis

TEST_SUITE_END();
