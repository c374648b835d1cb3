// The dial of cameras, max_error_px: what it changes, and what it must not change.
#include <doctest/doctest.h>

#include <string>

#include <simvis/simulation.h>
#include "program/report/explain.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// Balls so far away that a dial of a few pixels draws them coarser, and sensors of all kinds that look at them.
constexpr std::string_view kBalls = R"(
<repeat count="6" as="i"><part shape="sphere" radius="0.6" name="BALL_${i}" insert_at="ROOT"
        pose_offset="${8 + 4 * i} ${i - 3} 0 0 0 0"/></repeat>
<sensor type="camera" name="CAM" insert_at="ROOT" width="160" height="120" outputs="color depth"/>
<sensor type="stereo_camera" name="EYES" insert_at="ROOT" width="160" height="120" outputs="color depth disparity"/>
<sensor type="laser_scanner" name="RAYS" insert_at="ROOT" samples="361" min_angle="-30" max_angle="30"/>
<sensor type="laser_scanner" name="STRIP" insert_at="ROOT" samples="361" min_angle="-30" max_angle="30"
        method="planar" resolution="1024"/>)";

struct BallScene {
  TemporaryFolder folder;

  Simulation load(const char* dial_px) const {
    write_text(folder / "scene.xml", "<scene>" + std::string(kBalls) + "</scene>");
    SimulationDesc desc;
    for (const char* type : {"camera", "stereo_camera"})
      desc.overrides.push_back({type, "max_error_px", dial_px, "test"});
    return Simulation::load(folder / "scene.xml", desc);
  }
};

}  // namespace

TEST_CASE("the dial changes colour; depth, disparity and ranges stay the same bytes") {
  const BallScene scene;
  Simulation exact = scene.load("0"), coarse = scene.load("3");
  exact.step();
  coarse.step();
  CHECK(exact.color("CAM").pixels != coarse.color("CAM").pixels);
  CHECK(exact.picture("EYES", "left").pixels != coarse.picture("EYES", "left").pixels);
  CHECK(exact.picture("EYES", "right").pixels != coarse.picture("EYES", "right").pixels);
  CHECK(exact.depth("CAM").pixels == coarse.depth("CAM").pixels);
  for (const char* picture : {"left_depth", "right_depth", "disparity"}) {
    CHECK(exact.picture("EYES", picture).pixels == coarse.picture("EYES", picture).pixels);
  }
  CHECK(exact.value("CAM", "depth_error_bound_m") == coarse.value("CAM", "depth_error_bound_m"));
  for (const char* scanner : {"RAYS", "STRIP"}) {
    CHECK(exact.scan(scanner).range_m == coarse.scan(scanner).range_m);
    CHECK(exact.scan(scanner).error_bound_m == coarse.scan(scanner).error_bound_m);
  }
  CHECK(exact.diagnostics().counters().levels_held == 0);
  CHECK(coarse.diagnostics().counters().levels_held == 0);  // a ball has levels of its own, see round_levels.h
  CHECK(coarse.diagnostics().counters().passes == exact.diagnostics().counters().passes + 2);  // depth, apart
}

TEST_CASE("--explain says which levels are drawn, and why depth has a pass of its own") {
  const BallScene scene;
  Simulation coarse = scene.load("3");
  coarse.step();
  const Diagnostics drawn = coarse.diagnostics();
  const std::string text = explain(drawn.frame_plan(), {.counters = drawn.counters()});
  CHECK(contains(text, "displaced by at most"));
  CHECK(contains(text, "apart: of every triangle"));
}

TEST_CASE("values of the dial that are not allowed name their place") {
  const TemporaryFolder folder;
  const auto error_with = [&](const std::string& attributes) {
    write_text(folder / "scene.xml",
               "<scene>\n<sensor type=\"camera\" name=\"CAM\" insert_at=\"ROOT\" " + attributes + "/></scene>");
    return error_of([&] { Simulation::load(folder / "scene.xml"); });
  };
  CHECK(contains(error_with("max_error_px=\"-1\""), "scene.xml:2:"));
  CHECK(contains(error_with("max_error_px=\"-1\""), "at least 0"));
  CHECK(contains(error_with("max_error_px=\"nan\""), "max_error_px"));
  CHECK(contains(error_with("max_error_px=\"a pixel\""), "max_error_px"));
  CHECK(contains(error_with("max_error_px=\"1\" outputs=\"depth\""), "depth is always exact"));
  CHECK(error_with("max_error_px=\"1\"") == "nothing was thrown");
}

}  // namespace simvis

TEST_SUITE_END();
