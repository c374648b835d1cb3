// A sensor of a plug-in that gives something else than its type lists is refused where its measurement enters the
// simulation, whoever reads it. python/tests/test_mistakes.py has sensors that are written in Python.
#include <doctest/doctest.h>

#include <string>

#include <simvis/simulation.h>
#include "simvis/message_tap.h"
#include "tests/plugin/refused/wrong_output.cpp"  // NOLINT(bugprone-suspicious-include): its type, which it registers
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

std::string wrong_xml(const std::string& fault) {
  return "<simvis>\n<sensor type='wrong_output' name='S' insert_at='ROOT' fault='" + fault + "'/>\n</simvis>";
}

Simulation wrong_scene(const std::string& fault) { return Simulation::from_string(wrong_xml(fault), {}, ".", "w.xml"); }

/// What reading the measurement of a frame says.
std::string refusal(const std::string& fault) {
  Simulation simulation = wrong_scene(fault);
  return error_of([&] {
    simulation.step();
    simulation.measurement("S");
  });
}

/// Wants every message and takes none.
struct NoOutlet : ros::MessageOutlet {
  bool wants(const ros::Topic&, ros::TopicForm) override { return true; }
  bool add(ros::MessageJob) override {
    ++jobs;
    return true;
  }
  int jobs = 0;
};

}  // namespace

TEST_CASE("a measurement that is not what its type lists is refused, with sensor, output, what is given and the list") {
  CHECK(refusal("none") == "nothing was thrown");
  const std::string height = "w.xml:2:2: error: sensor \"S\": output \"height_m\": ",
                    depth = "w.xml:2:2: error: sensor \"S\": output \"depth\": ";
  CHECK(refusal("kind") == height + "scan column, expected image");
  CHECK(refusal("unit") == height + "unit \"mm\", expected \"m\"");
  CHECK(refusal("type") == height + "numbers of f32, expected f64");
  CHECK(refusal("held") == height + "numbers of f32, expected f64");
  CHECK(refusal("shape") == height + "shape 3 x 2, expected 2 x 3");
  const std::string places = " in an array of 6 numbers, expected first 0, stride 1 and 6 numbers";
  CHECK(refusal("first") == height + "shape 2 x 3 with first 1 and stride 1" + places);
  CHECK(refusal("stride") == height + "shape 2 x 3 with first 0 and stride 2" + places);
  CHECK(refusal("empty") == depth + "an image without pixels");
  CHECK(refusal("content") == depth + "another content of the image than its type lists");
  CHECK(refusal("name") ==
        "w.xml:2:2: error: sensor \"S\": output \"hight_m\": it is not among those that its type lists");
  CHECK(refusal("places") ==
        "w.xml:2:2: error: sensor \"S\": output \"score\": shape 2 with first 3 and "
        "stride 2 in an array of 4 numbers, expected places in the array");
}

TEST_CASE("arrays of a measurement that do not belong together are refused") {
  const std::string sensor = "w.xml:2:2: error: sensor \"S\": ";
  CHECK(refusal("columns").starts_with(sensor + "its columns have different lengths"));
  CHECK(refusal("views") == sensor +
                                "outputs \"shown\" and \"depth\" of one view: shapes 2 x 3 x 4 and 1, "
                                "expected equal rows and columns");
  CHECK(refusal("disparity") ==
        sensor + "output \"parallax\": a disparity, expected a calibration of a view \"right\"");
}

TEST_CASE("a refused measurement reaches no consumer, and its frame is not made") {
  Simulation simulation = wrong_scene("shape");
  NoOutlet outlet;
  send_messages(simulation, &outlet);
  for (int i = 0; i < 2; ++i) {
    CHECK(contains(error_of([&] { simulation.step(); }), "shape 3 x 2, expected 2 x 3"));
    CHECK(simulation.measured().empty());
    CHECK(simulation.next_frame().index == 0);
  }
  CHECK(outlet.jobs == 0);
  send_messages(simulation, nullptr);
  CHECK(contains(error_of([&] { simulation.depth("S"); }), "expected 2 x 3"));
  CHECK(contains(error_of([&] { simulation.value("S", "score"); }), "expected 2 x 3"));
}

TEST_CASE("the program ends with status 2 at a measurement that is not what its type lists") {
  const TemporaryFolder folder;
  write_text(folder / "w.xml", wrong_xml("type"));
  const ProcessResult run = Process({simvis_run(), "--plugin", tested_build() + "/lib/libsimvis_plugin_wrong_output.so",
                                     "--out", (folder / "out").string(), (folder / "w.xml").string()})
                                .wait();
  CHECK(run.exit_code == 2);
  CHECK(contains(run.err, "sensor \"S\": output \"height_m\": numbers of f32, expected f64"));
}

}  // namespace simvis

TEST_SUITE_END();
