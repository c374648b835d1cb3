// <simvis/test_run.h>: runs that are checked, and the evidence that a failing one leaves.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/reading_sensor.h>
#include <simvis/testing.h>
#include <zlib.h>
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis::test_kit {
namespace {

// A scanner that a test moves towards a wall. At x it measures kWall_m - x.
constexpr double kWall_m = 4;
constexpr std::string_view kScene = R"(<simvis>
  <part shape="box" size="1 4 2" name="WALL" insert_at="ROOT" pose_offset="4.5 0 0 0 0 0"/>
  <part name="ROBOT" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="1" min_angle="0" max_angle="0"/>
</simvis>)";

/// A scene file and the folder of evidence.
struct Tested {
  Tested() { write_text(folder / "wall.xml", kScene); }
  RunDesc desc(double limit_s) const {
    return {.limit_s = limit_s,
            .simulation = {.rate_hz = 8, .device = {}, .overrides = {}},
            .evidence = folder / "evidence",
            .name = "a test"};
  }
  TemporaryFolder folder;
};

bool says(const Verdict& verdict, std::string_view text) { return verdict.text.find(text) != std::string::npos; }

/// The bytes that base64 stands for.
std::string decoded(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size() && text[i] != '='; ++i) {
    bits = bits << 6 | static_cast<std::uint32_t>(kDigits.find(text[i]));
    if (i % 4 != 0) bytes += static_cast<char>(bits >> (6 - i % 4 * 2));
  }
  return bytes;
}

/// The messages of a frame of a page; empty: it has no such frame.
std::string frame_of(const std::string& page, std::size_t frame) {
  const std::string begin = "id=\"frame-" + std::to_string(frame) + "\">";
  const std::size_t start = page.find(begin);
  if (start == page.npos) return {};
  const std::size_t first = start + begin.size();
  const std::string compressed = decoded(std::string_view(page).substr(first, page.find('<', first) - first));
  std::string bytes(1 << 20, 0);  // more than any frame of these scenes
  uLongf size = bytes.size();
  REQUIRE(::uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(compressed.data()),
                       compressed.size()) == Z_OK);
  bytes.resize(size);
  return bytes;
}

// Types of this test's program: an element with one parameter, and a sensor that measures how often any of its kind has
// measured.
constexpr AttributeSpec kTargetAttributes[] = {
    {.name = "reach", .default_value = "2", .unit = "m", .text = "how far a made-up arm reaches", .live = true}};

struct Target : Element {
  void update(ParameterView) override {}
};

const ElementRegistration kTarget({
    .name = "test_run_target",
    .summary = "an element of a test",
    .attributes = kTargetAttributes,
    .create = [](const ElementContext&) -> std::unique_ptr<Element> { return std::make_unique<Target>(); },
});

const TableColumn kCounterColumns[] = {
    {.name = "count_of_test", .format = "%.9g", .unit = "1", .meaning = "measurements", .in_message = true}};
double counted = 0;

class Counter : public ReadingSensor {
 public:
  Counter() : ReadingSensor({std::begin(kCounterColumns), std::end(kCounterColumns)}) {}
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override {
    set_reading(time, {++counted});
  }
  std::string method() const override { return "counts"; }
};

const SensorRegistration kCounter({
    .name = "test_run_counter",
    .summary = "a sensor of a test",
    .create = [](const SensorContext&) -> std::unique_ptr<Sensor> { return std::make_unique<Counter>(); },
    .outputs = [](const SensorContext&) { return column_outputs(kCounterColumns, OutputKind::scalar); },
});

TEST_CASE("a run ends at its limit, and a passing one leaves nothing") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(1));
  run.always([](const Simulation& sim) { return clear_of(sim.scan("SCAN"), 1); });
  int frames = 0;
  while (run.step()) ++frames;
  CHECK(frames == 9);  // at 0, 1/8, ... 1 s
  CHECK(run.result());
  CHECK(run.check(range_near(run.sim().scan("SCAN"), 0, kWall_m)));
  CHECK_FALSE(std::filesystem::exists(tested.folder / "evidence"));
}

TEST_CASE("a failing run stops, and leaves a page and a recording that have measured the same") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(10));
  run.always([](const Simulation& sim) { return clear_of(sim.scan("SCAN"), 2); }, "keeps 2 m away");
  int frames = 0;
  for (double x = 0; run.step(); x += 0.3) {  // 0.3 is no sum of a few powers of two: all digits must come back
    ++frames;
    run.sim().set("MOVE", "x", x + 0.3);
  }
  // At frame k the robot is at 0.3 k, so that 4 - 0.3 k < 2 first at k = 7.
  CHECK(frames == 7);
  const Verdict& failed = run.result();
  CHECK_FALSE(failed);
  CHECK(says(failed, "at 0.875 s: keeps 2 m away: beam 0 measures 1."));
  const std::filesystem::path evidence = tested.folder / "evidence/a_test";
  CHECK(says(failed, (evidence / "failure.html").string() + "#frame=7&select=beam:SCAN:0\nrecording: "));
  CHECK(std::filesystem::file_size(evidence / "failure.mcap") > 0);
  // Frame 7 is the last one, and has the failure as a warning.
  const std::string page = read_text(evidence / "failure.html");
  CHECK(contains(frame_of(page, 7), "at 0.875 s: keeps 2 m away: beam 0 measures 1."));
  CHECK(frame_of(page, 6).find("keeps 2 m away") == std::string::npos);
  CHECK(frame_of(page, 8).empty());
  CHECK_FALSE(says(failed, "the repeated run measured something else"));
  CHECK_FALSE(run.step());  // it stays ended
}

TEST_CASE("a check that fails by itself leaves evidence once") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(1));
  REQUIRE(run.step());
  const Verdict first = run.check(range_near(run.sim().scan("SCAN"), 0, 5));
  CHECK_FALSE(first);
  CHECK(says(first, "failure.html"));
  const Verdict second = run.check({false, "another"});
  CHECK(second.text == "another");
  CHECK(run.result().text == first.text);
}

TEST_CASE("each failure has a folder of its own") {
  const Tested tested;
  for (const char* const folder : {"a_test", "a_test-2", "a_test-3"}) {
    Run run(tested.folder / "wall.xml", tested.desc(1));
    REQUIRE(run.step());
    CHECK(says(run.check({false, "it is wrong"}), (tested.folder / "evidence" / folder / "failure.html").string()));
    CHECK(std::filesystem::exists(tested.folder / "evidence" / folder / "failure.html"));
  }
}

TEST_CASE("the run is repeated with the settings of the test") {
  const Tested tested;
  std::string scene(kScene);
  scene.insert(scene.find("samples="), "range_noise='0.1' ");
  write_text(tested.folder / "wall.xml", scene);
  RunDesc desc = tested.desc(1);
  desc.simulation.seed = 7;
  desc.simulation.strict = true;
  desc.simulation.overrides = {{"laser_scanner", "samples", "3", ""}, {"laser_scanner", "max_angle", "10", ""}};
  Run run(tested.folder / "wall.xml", desc);
  REQUIRE(run.step());
  REQUIRE(run.sim().scan("SCAN").beams == 3);
  const Verdict noisy = run.check(range_near(run.sim().scan("SCAN"), 0, kWall_m));
  CHECK_FALSE(noisy);
  CHECK(says(noisy, "#frame=0&select=beam:SCAN:0\nrecording: "));
  CHECK_FALSE(says(noisy, "something else"));
}

TEST_CASE("types of the test's own program are on the page and in the recording") {
  const Tested tested;
  write_text(tested.folder / "own.xml",
             "<simvis><element type='test_run_target' name='TARGET' insert_at='ROOT'/>"
             "<sensor type='test_run_counter' name='COUNTER' insert_at='ROOT'/></simvis>");
  Run run(tested.folder / "own.xml", tested.desc(1));
  REQUIRE(run.step());
  run.sim().set("TARGET", "reach", 2.375);
  REQUIRE(run.step());
  counted = 0;  // so that the repeated run measures the same
  const Verdict failed = run.check({false, "it is wrong"});
  CHECK_FALSE(says(failed, "something else"));
  const std::filesystem::path evidence = tested.folder / "evidence/a_test";
  const std::string page = read_text(evidence / "failure.html"), first = frame_of(page, 0), last = frame_of(page, 1);
  for (const char* const name :
       {"TARGET", "test_run_target", "reach", "COUNTER", "test_run_counter", "count_of_test"}) {
    CAPTURE(name);
    CHECK(contains(first, name));
  }
  CHECK(first.find("2.375") == std::string::npos);
  CHECK(contains(last, "2.375"));
  CHECK(contains(read_text(evidence / "failure.mcap"), "COUNTER"));
}

TEST_CASE("a repeated run that measures something else says so") {
  const Tested tested;
  write_text(tested.folder / "own.xml",
             "<simvis><sensor type='test_run_counter' name='COUNTER' insert_at='ROOT'/></simvis>");
  Run run(tested.folder / "own.xml", tested.desc(1));
  REQUIRE(run.step());
  CHECK(says(run.check({false, "it is wrong"}),
             "\nthe repeated run measured something else: COUNTER.count_of_test\npage: "));
}

TEST_CASE("names that leave the folder of evidence, and no name of a scene, are refused") {
  const Tested tested;
  for (const char* const name : {".", ".."}) {
    RunDesc desc = tested.desc(1);
    desc.name = name;
    CHECK(contains(error_of([&] { Run run(tested.folder / "wall.xml", desc); }), "the name of the test is "));
  }
  CHECK(contains(error_of([] { Run run(""); }), "the name of the scene file is empty"));
}

TEST_CASE("an empty SIMVIS_EVIDENCE names no folder") {
  const Tested tested;
  ::setenv("SIMVIS_EVIDENCE", "", 1);
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(tested.folder.path());
  RunDesc desc = tested.desc(1);
  desc.evidence.clear();
  Run run("wall.xml", desc);
  REQUIRE(run.step());
  CHECK(says(run.check({false, "it is wrong"}), "simvis-evidence/a_test/failure.html"));
  std::filesystem::current_path(before);
  ::unsetenv("SIMVIS_EVIDENCE");
}

TEST_CASE("a step that fails is no frame of the evidence") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(10));
  REQUIRE(run.step());
  // Half a unit in the last place of a range above 64 m is 4e-6 m.
  run.sim().execute(R"(<sensor type="laser_scanner" name="FINE" insert_at="ROBOT" samples="2" min_angle="-1"
                               max_angle="1" range_max="500" method="hybrid" max_error_m="1e-6"/>)");
  run.sim().set("MOVE", "x", -100);
  for (int i = 0; i < 2; ++i) CHECK(contains(error_of([&] { run.step(); }), "cannot be kept by any method"));
  run.sim().set("MOVE", "x", 0);
  REQUIRE(run.step());
  run.check({false, "it is wrong"});
  const std::string page = read_text(tested.folder / "evidence/a_test/failure.html");
  CHECK_FALSE(frame_of(page, 1).empty());
  CHECK(frame_of(page, 2).empty());
}

TEST_CASE("what prevents evidence is said beside the failure") {
  const Tested tested;
  const std::filesystem::path scene = tested.folder / "wall.xml";
  RunDesc desc = tested.desc(1);
  desc.evidence = scene;  // which is no folder
  const auto text_of = [&](const auto& before_check) {
    Run run(scene, desc);
    REQUIRE(run.step());
    before_check();
    return run.check({false, "it is wrong"}).text;
  };
  CHECK(text_of([] {}).starts_with("at 0 s: it is wrong\nno evidence: filesystem error: "));
  desc.evidence = tested.folder / "evidence";
  CHECK(text_of([&] { std::filesystem::remove(scene); }) ==
        "at 0 s: it is wrong\nno evidence: " + scene.string() + ": error: cannot be read: No such file or directory");
  CHECK(std::filesystem::is_empty(tested.folder / "evidence"));
}

TEST_CASE("a run whose steps have another length is not repeated as it was, and the message says so") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(1));
  REQUIRE(run.step());
  run.sim().step(std::chrono::milliseconds(7));
  REQUIRE(run.step());
  CHECK(says(run.check({false, "it is wrong"}), "\nthe repeated run measured something else: its last frame is at "));
}

TEST_CASE("a folder whose name is no part of a link is written as one") {
  const Tested tested;
  RunDesc desc = tested.desc(1);
  desc.evidence = tested.folder / "what failed #1";
  Run run(tested.folder / "wall.xml", desc);
  REQUIRE(run.step());
  CHECK(says(run.check({false, "it is wrong"}), "/what%20failed%20%231/a_test/failure.html#frame=0\n"));
}

TEST_CASE("the page selects the beam that failed, of the scanner that has it") {
  const Tested tested;
  std::string scene(kScene);
  scene.insert(scene.find("</simvis>"),
               "<sensor type='laser_scanner' name='REAR SIDE' insert_at='ROBOT' samples='3' vertical_samples='2' "
               "vertical_min_angle='-30' vertical_max_angle='0' min_angle='-90' max_angle='90'/>");
  write_text(tested.folder / "wall.xml", scene);
  const auto link = [&](const auto& check) {
    Run run(tested.folder / "wall.xml", tested.desc(1));
    REQUIRE(run.step());
    const std::string text = run.check(check(run.sim())).text;
    const std::size_t begin = text.find("#frame=");
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  CHECK(link([](const Simulation& sim) { return clear_of(sim.scan("SCAN"), 9); }) == "#frame=0&select=beam:SCAN:0");
  // Beam 1 of the upper ring, the sixth, looks straight ahead; the others meet nothing or the wall farther away.
  CHECK(link([](const Simulation& sim) { return clear_of(sim.scan("REAR SIDE"), 9); }) ==
        "#frame=0&select=beam:REAR%20SIDE:4");
  CHECK(link([](const Simulation& sim) { return scans_near(sim.scan("SCAN"), Scan(1, 1)); }) == "#frame=0");
  CHECK(link([](const Simulation&) { return Verdict{false, "of no beam"}; }) == "#frame=0");
}

}  // namespace
}  // namespace simvis::test_kit

TEST_SUITE_END();
