// Meshes that an animation deforms: pages get their new shapes, and not the scene again.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "program/live/view_hub.h"
#include "tests/support/parts/animated_part.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

/// The strip's upper edge, vertices 4 and 5, stands at x = 3 + sin, z = 1 + cos of an angle that is 45 degrees times
/// the time in s.
struct StripScene {
  StripScene() { write_text(folder / "strip.gltf", test::bending_strip().text()); }
  std::string xml() const {
    return "<simvis><part name='STRIP' insert_at='ROOT' up='z' file='" + (folder / "strip.gltf").string() +
           "'/><element type='animation' name='WALK' insert_at='ROOT' part='STRIP' repeat='once'/>"
           "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='3'/></simvis>";
  }
  TemporaryFolder folder;
};

struct StripView {
  ViewFrame at(double time_s) {
    simulation.parameters().set(simulation.parameters().index("WALK", "time"), time_s);
    const FrameTime time = simulation.next_frame();
    simulation.step();
    return copier.copy(simulation, time, 0, {});
  }
  StripScene scene;
  Simulation simulation = Simulation::from_string(scene.xml());
  ViewCopier copier;
};

template <typename T>
T at(const std::string& bytes, std::size_t place) {
  T value{};
  REQUIRE(place + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

constexpr std::size_t kVertices = 6, kSize = 8 + 8 + 2 * kVertices * sizeof(glm::vec3);

glm::dvec3 upper_edge(const std::string& message) { return at<glm::vec3>(message, 16 + 4 * sizeof(glm::vec3)); }
glm::dvec3 its_normal(const std::string& message) {
  return at<glm::vec3>(message, 16 + (kVertices + 4) * sizeof(glm::vec3));
}

// Coordinates up to 4, rounded to float32 once: half a step of 2^-22.
constexpr double kFloat_m = 0x1p-23;

TEST_CASE("a mesh that is deformed leaves the scene as it is, and its message has its positions and normals") {
  StripView view;
  const ViewFrame still = view.at(0), bent = view.at(1), flat = view.at(2), again = view.at(0);
  CHECK(bent.scene == still.scene);
  CHECK(flat.scene == still.scene);
  CHECK(shapes_message(nullptr, still).empty());  // as in the GLB
  for (const ViewFrame* before : {static_cast<const ViewFrame*>(nullptr), &still, &flat}) {
    const std::string message = shapes_message(before, bent);
    REQUIRE(message.size() == kSize);
    CHECK(at<std::uint32_t>(message, 0) == 5);
    CHECK(at<std::uint32_t>(message, 4) == 1);
    CHECK(at<std::uint32_t>(message, 8) == still.scene->list.items[0].mesh);
    CHECK(at<std::uint32_t>(message, 12) == kVertices);
    const double half = std::sqrt(0.5);
    CHECK(glm::length(upper_edge(message) - glm::dvec3(3 + half, -2, 1 + half)) < 2 * kFloat_m);
    CHECK(glm::length(its_normal(message) - glm::dvec3(-half, 0, half)) < 2 * kFloat_m);
  }
  CHECK(shapes_message(&bent, bent).empty());
  const std::string back = shapes_message(&bent, again);
  REQUIRE(back.size() >= 8);
  CHECK(at<std::uint32_t>(back, 0) == 5);
  // The same shape may be another mesh of the same numbers.
  if (back.size() > 8) CHECK(upper_edge(back) == glm::dvec3(3, -2, 2));
}

TEST_CASE("a page that is open gets new shapes without a scene, and one that opens later both") {
  StripView view;
  ControlQueue controls;
  ViewHub hub{controls, [](ViewWants) {}};
  const auto kinds = [](Peer& peer) {
    std::string kinds;
    while (const std::optional<WireMessage> message = peer.next()) {
      if (message->binary && message->head.starts_with('\x05')) kinds += "shapes ";
      if (message->head.starts_with(R"({"op":"scene")")) kinds += "scene ";
    }
    peer.receive(R"({"op": "shown"})", false);
    return kinds;
  };
  const std::unique_ptr<Peer> first = hub.connect(1);
  hub.publish(view.at(0), {});
  CHECK(kinds(*first) == "scene ");
  for (const double time_s : {1, 2}) {
    hub.publish(view.at(time_s), {});
    CHECK(kinds(*first) == "shapes ");
  }
  const std::unique_ptr<Peer> second = hub.connect(2);
  CHECK(kinds(*second) == "scene shapes ");
}

/// Runs browse_deformed.py; skips the test where there is no browser.
void check_in_browser(const std::vector<std::string>& arguments) {
  // Debian's Python has Debian's packages.
  std::vector<std::string> command{"/usr/bin/python3", SIMVIS_SOURCE_DIR "/tests/live/browse_deformed.py"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ProcessResult browser = Process(command).wait(std::chrono::seconds(250));
  INFO(browser.out << browser.err);
  if (browser.exit_code == test::kSkippedExitCode) return test::skip(browser.out);
  CHECK(browser.exit_code == 0);
}

TEST_CASE("a page shows a deformed mesh as it was in each frame of the last minute, while the simulation goes on") {
  const StripScene scene;
  const auto path = [&](const char* name) { return (scene.folder / name).string(); };
  write_text(scene.folder / "s.xml", scene.xml());
  write_text(scene.folder / "t.csv", "time_s,WALK.time\n0,0\n128,2\n");
  check_in_browser({simvis_run(), path("s.xml"), path("t.csv"), std::to_string(2.0 / 128)});
}

TEST_CASE("a recorded page has one scene for all frames of an animation, and shows each shape forwards and backwards") {
  const StripScene scene;
  const auto path = [&](const char* name) { return (scene.folder / name).string(); };
  write_text(scene.folder / "s.xml", scene.xml());
  write_text(scene.folder / "t.csv", "time_s,WALK.time\n0,0\n2,2\n");
  const ProcessResult run = run_simvis({path("s.xml"), "--trajectory", path("t.csv"), "--rate", "1", "--frames", "3",
                                        "--out", path("out"), "--page", path("s.html")});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const std::string page = read_text(scene.folder / "s.html");
  CHECK(page.find("id=\"glb-1\"") != std::string::npos);
  CHECK(page.find("id=\"glb-2\"") == std::string::npos);
  check_in_browser({path("s.html")});
}

}  // namespace
}  // namespace simvis::live

TEST_SUITE_END();
