// SDF files that are wrong, incomplete or hostile: what is loaded, what is said, and what is refused with its place.
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/sdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string model_with(const std::string& content) {
  return sdf_world("<model name='m'><link name='l'>" + sdf_box("1 1 1") + content + "</link></model>");
}

std::string error_in(const std::string& text, const SdfTestFiles& files = {}) {
  return error_of([&] { SdfScene scene(text, files); });
}

}  // namespace

TEST_CASE("each kind of unsupported content gives one warning, with its count and first place") {
  SdfScene scene(
      sdf_world("<physics type='ode'/>\n<gui/>\n<plugin name='a' filename='a'/>\n"
                "<model name='m'><link name='l'><inertial><mass>1</mass></inertial>\n"
                "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>\n"
                "<sensor name='s' type='logical_camera'/></link>\n<plugin name='b' filename='b'/></model>\n"
                "<actor name='x'/>\n"));
  CHECK(scene.warnings() ==
        std::vector<std::string>{"11:2: element <actor> is not taken over", "5:2: element <gui> is not taken over",
                                 "6:2: element <plugin> is not taken over, 2 in all, the first one here",
                                 "9:2: sensor of type \"logical_camera\" is not taken over"});
}

TEST_CASE("visuals that cannot be shown are left out, each with a warning") {
  const std::string rest = "; a visual of link \"l\" is left out";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {sdf_box("1 0 1"), "element <box> has a <size> of 0, expected more than 0 and at most 1e+15 m"},
      {sdf_box("1 1e300 1"), "element <box> has a <size> of 1e+300, expected more than 0 and at most 1e+15 m"},
      {sdf_box("1 nan 1"), "element <size> has \"nan\", expected finite numbers"},
      {sdf_box("1 1"), "element <size> has no 3 numbers: \"1 1\""},
      {sdf_visual("<sphere><radius>-1</radius></sphere>"), "element <sphere> has a <radius> of -1, expected more"},
      {sdf_visual("<sphere><radius>inf</radius></sphere>"), "element <sphere> has a <radius> of inf, expected more"},
      {sdf_visual("<heightmap/>"), "element <heightmap> has no <uri>"},
      {sdf_visual("<polyline/>"), "element <polyline> has 0 points"},
      {sdf_box("1 1 1", "<pose>0 0 nan 0 0 0</pose>"), "element <pose> has no six finite numbers"},
      {sdf_box("1 1 1", "<pose relative_to='x'>0 0 0 0 0 0</pose>"), "element <pose> refers to \"x\""},
      {sdf_visual("<mesh><uri>model://none/a.dae</uri></mesh>"), "\"model://none/a.dae\" is not there; tried "},
      {sdf_visual("<mesh><uri>http://x/a.dae</uri></mesh>"), "is on the network, where no files are looked for"},
      {sdf_visual("<mesh><uri>a.xyz</uri></mesh>"), "which is of an unknown kind"},
      {sdf_visual("<mesh><uri>broken.stl</uri></mesh>"), "broken.stl"}};
  for (const auto& [visual, warning] : cases) {
    CAPTURE(visual);
    SdfScene scene(model_with(visual), {{"a.xyz", "x"}, {"broken.stl", "x"}});
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], warning));
    CHECK(contains(scene.warnings()[0], rest));
    CHECK(scene.list().items.size() == 1);
  }
}

TEST_CASE("a visual without a geometry is left out, and an empty one is nothing") {
  SdfScene scene(model_with("\n<visual name='v'/>" + sdf_visual("<empty/>")));
  CHECK(scene.warnings() == std::vector<std::string>{"5:2: the visual has no geometry and is left out"});
}

TEST_CASE("a file of which nothing can be shown is refused, as is one that is no SDF") {
  CHECK(contains(error_in(sdf_world("<model name='m'><link name='l'>" + sdf_box("0 0 0") + "</link></model>")),
                 "none of its visuals can be shown: "));
  CHECK(contains(error_in("<robot name='r'/>"), "w.sdf:1:2: element <robot> is the root, expected <sdf>"));
  CHECK(contains(error_in("<sdf version='1.0'/>"), "has the version 1.0, expected 1.2 or newer"));
  CHECK(contains(error_in("<sdf version='1.6'><world>"), "malformed XML"));
  CHECK(contains(error_in("<sdf version='1.6'><world name='a'><model/></world></sdf>"),
                 "w.sdf:1:37: element <model> has no name"));
}

TEST_CASE("lights, scanners and cameras that are wrong are left out") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"<light name='x' type='laser'/>", "has the type \"laser\", expected point, spot or directional; the light"},
      {"<light name='x' type='spot'><direction>0 0 0</direction></light>", "has a <direction> without length"},
      {"<sensor name='s' type='camera'/>", "has no <camera>; the sensor is left out"},
      {"<sensor name='s' type='camera'><camera><horizontal_fov>3.2</horizontal_fov></camera></sensor>",
       "that is not between 0 and pi"},
      {"<sensor name='s' type='camera'><camera><image><width>1e9</width></image></camera></sensor>",
       "expected a whole number from 1 to 16384"},
      {"<sensor name='s' type='ray'/>", "has no <ray> or <lidar>"},
      {"<sensor name='s' type='ray'><ray><scan><horizontal><samples>99999999999</samples></horizontal></scan></ray>"
       "</sensor>",
       "expected a whole number from 1 to 1000000"},
      {"<sensor name='s' type='ray'><ray><scan><horizontal><samples>1000000</samples></horizontal><vertical>"
       "<samples>100000</samples></vertical></scan></ray></sensor>",
       "has more than 50000000 beams"},
      {"<sensor name='s' type='ray'><ray><scan><horizontal><samples>4</samples><min_angle>0</min_angle>"
       "<max_angle>7</max_angle></horizontal></scan></ray></sensor>",
       "expected <max_angle> from <min_angle> to 360"},
      {"<sensor name='s' type='ray'><ray><range><min>2</min><max>1</max></range></ray></sensor>", "has a <range>"}};
  for (const auto& [content, warning] : cases) {
    CAPTURE(content);
    SdfScene scene(model_with(content));
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], warning));
    CHECK(scene.built().sensors.empty());
    CHECK(scene.list().lights.empty());
  }
}

TEST_CASE("a lens that folds within the picture is left out, one that does not is kept") {
  // r (1 + k1 r^2) grows up to r = 1 / sqrt(-3 k1) and reaches 2/3 of that. The corner of 320 x 240 pixels at 90
  // degrees is at 1.25, which needs k1 above -4 / (27 * 1.25^2) = -0.0948.
  const auto camera = [](const std::string& k1) {
    return model_with(
        "<sensor name='s' type='camera'><camera><horizontal_fov>1.5707963</horizontal_fov><distortion>"
        "<k1>" +
        k1 + "</k1></distortion></camera></sensor>");
  };
  SdfScene folds(camera("-0.1"));
  REQUIRE(folds.warnings().size() == 1);
  CHECK(contains(folds.warnings()[0], "a lens distortion that folds within the picture is not taken over"));
  CHECK(folds.sensor("m/l/s", "distortion") == "");
  SdfScene fills(camera("-0.08"));
  CHECK(fills.warnings().empty());
  CHECK(fills.sensor("m/l/s", "k1") == "-0.08");
}

TEST_CASE("a turn that is rounded up is a full turn") {
  SdfScene scene(
      model_with("<sensor name='s' type='ray'><ray><scan><horizontal><samples>4</samples>"
                 "<min_angle>-3.14160</min_angle><max_angle>3.14160</max_angle></horizontal></scan></ray>"
                 "</sensor>"));
  CHECK(scene.warnings().empty());
  CHECK(std::stod(scene.sensor("m/l/s", "max_angle")) - std::stod(scene.sensor("m/l/s", "min_angle")) <= 360);
}

TEST_CASE("joints that cannot be followed are left out, and open limits stay open") {
  const auto joints = [](const std::string& content) {
    return sdf_world("<model name='m'><link name='a'/><link name='b'/><link name='c'/>" + content + "</model>");
  };
  const auto joint = [](const std::string& name, const std::string& type, const std::string& parent,
                        const std::string& child, const std::string& axis = "") {
    return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child +
           "</child><axis>" + axis + "</axis></joint>";
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {joint("j", "revolute", "a", "b") + joint("k", "revolute", "c", "b"),
       "joint \"k\" is left out: joint \"j\" moves its child already"},
      {joint("j", "revolute", "a", "b") + joint("k", "revolute", "b", "a"),
       "joint \"k\" is left out: it closes a circle of joints"},
      {joint("j", "revolute", "none", "b"), "refers to \"none\""},
      {joint("j", "ball", "a", "b"), "motion of a joint of type \"ball\" is not taken over"},
      {joint("j", "gearbox", "a", "b"), "joint of type gearbox is not taken over"},
      {joint("j", "revolute", "a", "b", "<limit><lower>1</lower><upper>-1</upper></limit>"),
       "the lower limit 1 is above the upper limit -1; the joint has no limits"}};
  for (const auto& [content, warning] : cases) {
    CAPTURE(content);
    SdfScene scene(joints(content));
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], warning));
  }
  SdfScene open(joints(joint("j", "revolute", "world", "b", "<limit><lower>-1e16</lower><upper>1e16</upper></limit>")));
  CHECK(open.warnings().empty());
  open.set("m/j", 1e6);
  CHECK(contains(error_in(joints(joint("j", "revolute", "a", "b", "<xyz>0 0 0</xyz>"))), "<axis> is 0 0 0"));
}

TEST_CASE("a second item of a name gets another name") {
  SdfScene scene(sdf_world("<model name='m'><link name='l'/></model>\n<model name='m'><link name='l'/></model>\n"));
  CHECK(scene.warnings() == std::vector<std::string>{"5:2: model \"m\" is there already; this one is called \"m_2\""});
  CHECK(scene.built().scene.has_insertion_point("m_2/l"));
}

TEST_CASE("includes that are not there, on the network or broken are left out") {
  const SdfTestFiles files = {{"broken.sdf", "<sdf"}, {"empty.sdf", sdf_model("")}};
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"model://none", "the <include> is left out, model \"model://none\" is not there; tried "},
      {"https://fuel.gazebosim.org/1.0/x/models/y", "is on the network, where no files are looked for"},
      {"", "the <include> is left out, it names no file"},
      {"broken.sdf", "malformed XML"},
      {"empty.sdf", "has no <model>"}};
  for (const auto& [uri, warning] : cases) {
    CAPTURE(uri);
    SdfScene scene(sdf_world("<include><uri>" + uri + "</uri></include>\n<model name='m'><link name='l'/></model>\n"),
                   files);
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], warning));
    CHECK(scene.built().scene.has_insertion_point("m/l"));
  }
}

TEST_CASE("an include that is missing several times gives one warning, with the number") {
  const std::string include = "<include><uri>https://fuel.gazebosim.org/1.0/x/models/y</uri></include>\n";
  SdfScene scene(sdf_world(include + include + include + "<model name='m'><link name='l'/></model>\n"));
  REQUIRE(scene.warnings().size() == 1);
  CHECK(contains(scene.warnings()[0], "the <include> is left out, \"https://fuel.gazebosim.org/1.0/x/models/y\""));
  CHECK(scene.warnings()[0].ends_with("; this is so 3 times"));
}

TEST_CASE("--strict refuses what is not taken over, and a refused file leaves nothing") {
  const TemporaryFolder folder;
  write_text(folder / "w.sdf", model_with("<plugin name='p' filename='p'/>"));
  BuiltScene built;
  built.scene.make_strict();
  SceneBuilder builder(built, {});
  const auto commands = parse_commands("<part file='w.sdf' name='W' insert_at='ROOT'/>", "s.xml", folder.path());
  CHECK(contains(error_of([&] { builder.execute(commands); }), "element <plugin> is not taken over (a warning"));
  CHECK(!built.scene.has_insertion_point("m/l"));
  CHECK(built.scene.root()->children().size() == 1);  // ROOT's point
}

TEST_CASE("hostile files are refused with a place") {
  CHECK(contains(error_in(sdf_world("<model name='m'><pose>0 0 nan 0 0 0</pose></model>")),
                 "w.sdf:4:18: element <pose> has no six finite numbers: \"0 0 nan 0 0 0\""));
  CHECK(contains(error_in(sdf_world("<model name='m'><link name='l'><pose>0 0 1e300 0 0 0</pose></link></model>")),
                 "has a coordinate that is not allowed"));
  CHECK(contains(error_in(sdf_world("<include><uri>w.sdf</uri></include>")), "include itself"));
  const SdfTestFiles circle = {{"a.sdf", sdf_model("<model name='a'><include><uri>b.sdf</uri></include></model>")},
                               {"b.sdf", sdf_model("<model name='b'><include><uri>a.sdf</uri></include></model>")}};
  CHECK(contains(error_in(sdf_world("<include><uri>a.sdf</uri></include>"), circle), "include itself"));
  CHECK(contains(error_in(sdf_world("<model name='m'><link name='a'><pose relative_to='b'/></link>"
                                    "<link name='b'><pose relative_to='a'/></link></model>")),
                 "depends on itself: frames form a circle"));
  std::string chain;
  constexpr int kFrames = 5000;
  for (int i = 0; i < kFrames; ++i) {
    chain += "<frame name='f" + std::to_string(i) + "'><pose relative_to='f" + std::to_string(i + 1) + "'/></frame>";
  }
  CHECK(contains(error_in(sdf_world("<model name='m'><link name='l'><pose relative_to='f0'/></link>" + chain +
                                    "<frame name='f" + std::to_string(kFrames) + "'/></model>")),
                 "stands in a chain of more than 1000 frames"));
  std::string nested;
  constexpr int kDepth = 100;
  for (int i = 0; i < kDepth; ++i) nested += "<model name='m'>";
  for (int i = 0; i < kDepth; ++i) nested += "</model>";
  CHECK(contains(error_in(sdf_world(nested)), "is nested deeper than 64 models"));
}

TEST_CASE("includes that double at each level are refused before they fill the memory") {
  SdfTestFiles files;
  constexpr int kLevels = 30;  // 2^30 models
  for (int i = 0; i < kLevels; ++i) {
    const std::string uri = "<uri>m" + std::to_string(i + 1) + ".sdf</uri>";
    files["m" + std::to_string(i) + ".sdf"] = sdf_model("<model name='m'><include>" + uri + "<name>a</name></include>" +
                                                        "<include>" + uri + "<name>b</name></include></model>");
  }
  files["m" + std::to_string(kLevels) + ".sdf"] = sdf_model("<model name='m'><link name='l'/></model>");
  CHECK(
      contains(error_in(sdf_world("<include><uri>m0.sdf</uri></include>"), files), "is one of more than 20000 models"));
}
