// The scene file with the values of the running scene: what is rewritten, what stays, what cannot be said.
#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/error.h>
#include "program/cli/saved_scene.h"
#include "scenegraph/pictures/png_bytes.h"
#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

struct RunningScene {
  RunningScene(std::string text, std::string_view more = "") : xml(std::move(text)) {
    write_text(folder / "more.xml", more);
    scene.emplace(std::vector<AttributeOverride>(), parse_commands(xml, file.string(), folder.path()));
    written = scene->built.parameters.changes().size();
  }
  void set(std::string_view element, std::string_view parameter, double value) {
    Parameters& parameters = scene->built.parameters;
    parameters.set(parameters.index(element, parameter), value);
  }
  void execute(std::string_view commands) { scene->execute(parse_commands(commands, "page", folder.path())); }
  SavedScene save() const {
    const std::vector<std::string>& changes = scene->built.parameters.changes();
    return saved_scene(xml, file, scene->built.parameters, std::span(changes).subspan(written), {});
  }
  TemporaryFolder folder;
  std::filesystem::path file = folder / "scene.xml";
  std::string xml;
  std::optional<LiveScene> scene;
  std::size_t written = 0;
};

}  // namespace

TEST_CASE("values are rewritten in place, and all else stays as the user wrote it") {
  RunningScene running(R"(<scene>
  <!-- the <element x="1"/> of a comment -->
  <element type="pose" name='A' x = '0.50' insert_at="ROOT"
           y="2"/>  <!-- behind -->
  <element insert_at="ROOT" type="pose" name="B" />
</scene>
)");
  CHECK(running.save().xml == running.xml);
  running.set("A", "y", 2.25);
  running.set("B", "yaw", 90);
  const SavedScene saved = running.save();
  CHECK(saved.left.empty());
  CHECK(saved.xml == R"(<scene>
  <!-- the <element x="1"/> of a comment -->
  <element type="pose" name='A' x = '0.50' insert_at="ROOT"
           y="2.25"/>  <!-- behind -->
  <element insert_at="ROOT" type="pose" name="B" yaw="90" />
</scene>
)");
}

TEST_CASE("what was added and removed while it ran follows, with its values") {
  for (const bool enclosed : {true, false}) {
    CAPTURE(enclosed);
    const std::string body = "<element type=\"pose\" name=\"A\" insert_at=\"ROOT\"/>\n";
    RunningScene running(enclosed ? "<scene>\n" + body + "</scene>" : body);
    running.execute("<element type='pose' name='B' insert_at='ROOT' z='1'/>");
    running.execute("<remove name='A'/>");
    running.set("B", "z", 3);
    const std::string xml = running.save().xml;
    CHECK(xml.starts_with(enclosed ? "<scene>\n" + body : body));
    RunningScene again(xml);
    const Parameters& parameters = again.scene->built.parameters;
    CHECK(parameters.values()[parameters.index("B", "z")] == 3);
    CHECK_THROWS_AS(parameters.index("A", "x"), InputError);
  }
}

constexpr std::array<std::uint8_t, 4> kGrey{0, 80, 160, 240};

// A follower executes the log in another folder.
TEST_CASE("each attribute that names a file is absolute in the log, and relative again in the saved scene") {
  RunningScene running("<scene>\n</scene>");
  write_text(running.folder / "wood.png", png_bytes({.width = 2, .height = 2, .bits = 8, .channels = 1}, kGrey));
  write_text(running.folder / "beams.csv", "azimuth_deg,elevation_deg\n0,0\n10,0\n");
  running.execute("<part shape='box' size='1 1 1' texture='wood.png' name='BOX' insert_at='ROOT'/>");
  running.execute(
      "<part shape='heightmap' heights='wood.png' size='1 1' z_range='0 1' name='HILLS' insert_at='ROOT'/>");
  running.execute("<sensor type='laser_scanner' pattern='beams.csv' name='SCAN' insert_at='ROOT'/>");
  std::string log;
  for (const std::string& change : running.scene->built.parameters.changes()) log += change + "\n";
  const std::string xml = running.save().xml;
  for (const std::string file : {"texture=\"wood.png\"", "heights=\"wood.png\"", "pattern=\"beams.csv\""}) {
    CAPTURE(file);
    const std::size_t quote = file.find('"') + 1;
    CHECK(contains(log, file.substr(0, quote) + running.folder.path().string() + "/" + file.substr(quote)));
    CHECK(contains(xml, file));
  }
}

TEST_CASE("a value whose text stands for more than this value is named and left") {
  RunningScene running(R"(<scene>
  <set name="HEIGHT" value="2"/>
  <element type="pose" name="EXPRESSION" insert_at="ROOT" x="1" z="${HEIGHT}"/>
  <repeat count="2" as="I"><element type="pose" name="COPY${I}" insert_at="ROOT"/></repeat>
  <include file="more.xml" prefix="MORE_"/>
</scene>)",
                       R"(<element type="pose" name="INCLUDED" insert_at="ROOT"/>)");
  running.set("EXPRESSION", "x", 4);
  running.set("EXPRESSION", "z", 3);
  running.set("COPY1", "x", 1);
  running.set("MORE_INCLUDED", "x", 1);
  const SavedScene saved = running.save();
  CHECK(saved.xml.find(R"(x="4" z="${HEIGHT}")") != std::string::npos);
  REQUIRE(saved.left.size() == 3);
  CHECK(saved.left[0].starts_with("EXPRESSION.z: "));
  CHECK(saved.left[1].starts_with("COPY1.x: "));
  CHECK(saved.left[2].starts_with("MORE_INCLUDED.x: "));
}

TEST_CASE("a file that does not give the scene that runs is refused") {
  RunningScene running("<element type=\"pose\" name=\"A\" insert_at=\"ROOT\"/>");
  running.xml = "<element type=\"pose\" name=\"OTHER\" insert_at=\"ROOT\"/>";
  running.set("A", "x", 1);
  CHECK_THROWS_AS(running.save(), InputError);
}

}  // namespace simvis

TEST_SUITE_END();
