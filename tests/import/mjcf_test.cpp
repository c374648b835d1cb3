// MJCF models: shapes, frames, classes of defaults, joints, and what is left out.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/srgb.h"
#include "import/model/unique_names.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/mjcf_scene.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string world(const std::string& content) { return mjcf_world(content); }

}  // namespace

TEST_CASE("MJCF gives half sizes, and a capsule's length between its ends") {
  const std::vector<std::pair<std::string, Mesh>> cases = {
      {"size='0.5'", sphere_mesh(0.5)},
      {"type='box' size='1 2 3'", box_mesh({2, 4, 6})},
      {"type='cylinder' size='0.5 2'", cylinder_mesh(0.5, 4)},
      {"type='capsule' size='0.5 2'", capsule_mesh(0.5, 4)},
      {"type='plane' size='3 4 0.1'", plane_mesh({6, 8})},
      {"type='plane' size='0 4 0.1'", endless_plane_mesh({INFINITY, 4})},
      {"type='ellipsoid' size='1 2 3'", sphere_mesh(1)}};
  for (const auto& [geom, mesh] : cases) {
    CAPTURE(geom);
    MjcfScene scene(world("<geom " + geom + "/>"));
    CHECK(scene.warnings().empty());
    REQUIRE(scene.list().items.size() == 1);
    CHECK(scene.mesh(0).positions == mesh.positions);
    CHECK(scene.mesh(0).surface == mesh.surface);
  }
  MjcfScene between(world("<geom type='capsule' size='0.1' fromto='1 0 0 1 4 0'/>"));
  CHECK(between.mesh(0).positions == capsule_mesh(0.1, 4).positions);
  CHECK(glm::length(glm::dvec3(between.place(0)[2]) - glm::dvec3(0, 1, 0)) < kMjcfPlace);
  CHECK(glm::length(glm::dvec3(between.place(0)[3]) - glm::dvec3(1, 2, 0)) < kMjcfPlace);
}

// With a search from 2 on for each name, the second part would take hours.
TEST_CASE("equal names get numbers, however many there are") {
  UniqueNames names;
  CHECK(names.add("body") == "body");
  CHECK(names.add("body_3") == "body_3");
  CHECK(names.add("body") == "body_2");
  CHECK(names.add("body") == "body_4");
  CHECK(names.add("body_2") == "body_2_2");
  for (int i = 5; i < 200'000; ++i) names.add("body");
  CHECK(names.add("body") == "body_200000");
}

TEST_CASE("every way to write an orientation, in degrees unless the compiler says radians") {
  // Each turns x to y.
  for (const std::string turn : {"quat='1 0 0 1'", "axisangle='0 0 2 90'", "euler='0 0 90'", "xyaxes='0 1 0 -1 1 0'"}) {
    CAPTURE(turn);
    MjcfScene scene(world("<body name='b' pos='1 2 3' " + turn + "><geom size='1'/></body>"));
    check_place(scene.point("b"), {0, 1, 0}, {-1, 0, 0}, {1, 2, 3});
  }
  MjcfScene zaxis(world("<body name='b' zaxis='1 0 0'><geom size='1'/></body>"));
  CHECK(glm::length(glm::dvec3(zaxis.point("b")[2]) - glm::dvec3(1, 0, 0)) < kMjcfPlace);
  MjcfScene radian("<compiler angle='radian'/>" +
                   world("<body name='b' euler='0 0 1.5707963267948966'><geom size='1'/></body>"));
  check_place(radian.point("b"), {0, 1, 0}, {-1, 0, 0}, {0, 0, 0});
  // First about x, then about the turned z: y goes to z and stays there; x goes to the turned y, which is z.
  MjcfScene moving(world("<body name='b' euler='90 0 90'><geom size='1'/></body>"));
  check_place(moving.point("b"), {0, 0, 1}, {-1, 0, 0}, {0, 0, 0});
  // About fixed axes: x goes to y, y to -x and then to -x, z to -y.
  MjcfScene fixed("<compiler eulerseq='XYZ'/>" + world("<body name='b' euler='90 0 90'><geom size='1'/></body>"));
  check_place(fixed.point("b"), {0, 1, 0}, {0, 0, 1}, {0, 0, 0});
}

TEST_CASE("defaults come from the class, the classes around it, and the child class of the bodies") {
  MjcfScene scene(
      "<default><geom size='0.5' rgba='1 0 0 1'/><default class='big'><geom size='2'/><default class='box'>"
      "<geom type='box' size='1 1 1'/></default></default></default>" +
      world("<geom/><body childclass='big'><geom/><body><geom class='box'/><geom rgba='0 1 0 1'/></body></body>"));
  CHECK(scene.warnings().empty());
  REQUIRE(scene.list().items.size() == 4);
  CHECK(scene.mesh(0).positions == sphere_mesh(0.5).positions);
  CHECK(scene.mesh(1).positions == sphere_mesh(2).positions);
  CHECK(scene.mesh(2).positions == box_mesh({2, 2, 2}).positions);
  CHECK(scene.material(2).base_color == glm::vec4(1, 0, 0, 1));
  CHECK(scene.material(3).base_color == glm::vec4(0, 1, 0, 1));
}

TEST_CASE("joints turn and slide bodies about their anchors, one after the other") {
  MjcfScene scene(
      world("<body name='b' pos='1 0 0'><joint name='turn' axis='0 0 1' pos='1 0 0' range='-90 90'/>"
            "<joint name='slide' type='slide' axis='1 0 0'/><geom size='1'/><site name='tip' pos='2 0 0'/></body>"));
  CHECK(scene.warnings().empty());
  scene.set("turn", 90);
  scene.set("slide", 0.5);
  // The anchor stays at x = 2; b stood at -1 from it along x, and slides along what is now y.
  check_place(scene.point("b"), {0, 1, 0}, {-1, 0, 0}, {2, -0.5, 0});
  check_place(scene.point("tip"), {0, 1, 0}, {-1, 0, 0}, {2, 1.5, 0});
  CHECK_THROWS_AS(scene.set("turn", 91), InputError);
}

TEST_CASE("an equality of two joints makes one follow the other") {
  MjcfScene scene("<compiler angle='radian'/>" +
                  world("<body name='b'><joint name='left' type='slide' axis='1 0 0'/><geom size='1'/></body>"
                        "<body name='c'><joint name='right' axis='0 0 1'/></body>") +
                  "<equality><joint joint1='left' joint2='right' polycoef='0.25 0.5'/></equality>");
  CHECK(scene.warnings().empty());
  scene.set("right", 180 / 3.14159265358979323846);  // 1 rad
  CHECK(scene.point("b")[3].x == doctest::Approx(0.75));
}

TEST_CASE("files that an included file names stand beside the model, else beside the included file") {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", large = "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n";
  const std::string arm =
      "<mujoco><asset><mesh name='t' file='t.obj'/></asset><worldbody><geom type='mesh' mesh='t'/>"
      "</worldbody></mujoco>";
  const auto width = [&](const std::string& compiler, std::map<std::string, std::string> files) {
    files["arm/arm.xml"] = arm;
    MjcfScene scene(compiler + "<include file='arm/arm.xml'/>", files);
    return scene.list().items.size() == 1 ? scene.mesh(0).bounds_max.x : 0;
  };
  const std::string folder = "<compiler meshdir='meshes'/>";
  CHECK(width("", {{"arm/t.obj", triangle}}) == 1);
  CHECK(width("", {{"t.obj", large}, {"arm/t.obj", triangle}}) == 9);
  CHECK(width(folder, {{"meshes/arm/t.obj", triangle}}) == 1);
  CHECK(width(folder, {{"arm/meshes/t.obj", triangle}}) == 1);
  CHECK(width(folder, {{"arm/t.obj", triangle}}) == 1);
  CHECK(width(folder, {{"meshes/t.obj", large}, {"arm/meshes/t.obj", triangle}}) == 9);
}

TEST_CASE("backslashes separate folders in the names of files, as in MuJoCo") {
  const std::string arm =
      "<mujoco><asset><mesh name='t' file='meshes\\t.obj'/></asset><worldbody>"
      "<geom type='mesh' mesh='t'/></worldbody></mujoco>";
  MjcfScene scene("<include file='arm\\arm.xml'/>",
                  {{"arm/arm.xml", arm}, {"arm/meshes/t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}});
  CHECK(scene.list().items.size() == 1);
}

TEST_CASE("meshes are scaled and shown in the look of the geom, and files are included") {
  MjcfScene scene("<include file='assets.inc'/>" +
                      world("<geom type='mesh' mesh='box' material='paint'/><geom type='mesh' mesh='moved'/>"),
                  {{"box.obj", obj_box()},
                   {"assets.inc",
                    "<mujocoinclude><asset><mesh file='box.obj' scale='2 1 1'/><mesh name='moved' file='box.obj' "
                    "scale='2 3 4' refpos='1 0 0' refquat='1 0 0 1'/><material name='paint' rgba='0.5 0 1 1'/></asset>"
                    "</mujocoinclude>"}});
  CHECK(scene.warnings().empty());
  REQUIRE(scene.list().items.size() == 2);
  check_place(scene.place(0), {2, 0, 0}, {0, 1, 0}, {0, 0, 0});
  const float half = linear_from_srgb(0.5);
  CHECK(scene.material(0).base_color == glm::vec4(half, 0, 1, 1));
  // As MuJoCo 3 places the vertex at the origin: moved to (-1, 0, 0), turned to (0, 1, 0), scaled to (0, 3, 0).
  CHECK(glm::length(glm::dvec3(scene.place(1)[3]) - glm::dvec3(0, 3, 0)) < kMjcfPlace);
}

TEST_CASE("free bodies move within their parents, and balls turn about their anchors") {
  MjcfScene scene(
      world("<body name='crate' pos='0 0 2'><freejoint name='crate_free'/><geom size='1'/></body>"
            "<body pos='4 0 0'><joint name='neck' type='ball' pos='0 0 1'/><geom pos='1 0 1' size='1'/>"
            "</body>"));
  CHECK(scene.warnings().empty());
  scene.set("crate_free", 3, "x");
  scene.set("crate_free", 1, "z");
  CHECK(glm::length(glm::dvec3(scene.place(0)[3]) - glm::dvec3(3, 0, 3)) < kMjcfPlace);
  scene.set("neck", 90, "yaw");
  CHECK(glm::length(glm::dvec3(scene.place(1)[3]) - glm::dvec3(4, 1, 1)) < kMjcfPlace);
}

TEST_CASE("collision shapes and what is wholly transparent are not drawn") {
  MjcfScene scene(world("<geom size='1' group='3'/><geom size='1' rgba='1 1 1 0'/><geom size='1' group='2'/>"));
  CHECK(scene.warnings().empty());
  CHECK(scene.list().items.size() == 1);
}

TEST_CASE("what is not taken over is listed, and what is wrong is left out with its place") {
  MjcfScene scene(world("<freejoint/><composite/><geom size='1'/><geom size='1'/><geom size='1'/><geom type='box' "
                        "size='1 1'/><geom type='hfield'/>"
                        "<geom type='mesh' mesh='none'/><body><freejoint/></body>") +
                  "<tendon/><asset><skin name='h'/></asset>");
  const std::vector<std::string> warnings = scene.warnings();
  const auto has = [&](const std::string& text) {
    return std::ranges::any_of(warnings, [&](const std::string& each) { return contains(each, text); });
  };
  CHECK(has("element <geom> has 2 sizes, expected 3; the geom is left out"));
  CHECK(has("shows the field of heights \"\", which is not there"));
  CHECK(has("there is no mesh \"none\""));
  CHECK(has("element <composite> is not taken over"));
  CHECK(has("element <tendon> is not taken over"));
  CHECK(has("asset <skin> is not taken over"));
  CHECK(scene.list().items.size() == 3);
}

// The places and names are those that MuJoCo 4.0 gives this model.
TEST_CASE("replicates are moved on one from the other, with numbers behind their names") {
  MjcfScene scene(
      world("<body name='hub'><replicate count='3' offset='0.5 0 0' euler='0 0 90'>"
            "<geom size='0.1' pos='1 0 0'/><body name='b' pos='0 0 1'><joint name='j'/><geom size='0.1'/>"
            "<site name='s' pos='1 0 0'/></body></replicate></body>"
            "<replicate count='2' offset='0 2 0' sep='_'><replicate count='10' offset='1 0 0' sep='-'>"
            "<site name='n'/></replicate></replicate>"));
  CHECK(scene.warnings().empty());
  CHECK(scene.list().items.size() == 6);
  check_place(scene.point("b0"), {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  check_place(scene.point("b1"), {0, 1, 0}, {-1, 0, 0}, {0.5, 0, 1});
  check_place(scene.point("b2"), {-1, 0, 0}, {0, -1, 0}, {0.5, 0.5, 1});
  check_place(scene.point("s2"), {-1, 0, 0}, {0, -1, 0}, {-0.5, 0.5, 1});
  check_place(scene.point("n-09_1"), {1, 0, 0}, {0, 1, 0}, {9, 2, 0});
  scene.set("j1", 90);
  check_place(scene.point("s1"), {-1, 0, 0}, {0, -1, 0}, {-0.5, 0, 1});
  CHECK(contains(mjcf_error(world("<replicate count='0'><geom size='1'/></replicate>")), "has the count 0"));
  CHECK(contains(mjcf_error(world("<replicate count='1000'><replicate count='1000'><geom size='1'/></replicate>"
                                  "</replicate>")),
                 "makes more than 100000 copies"));
}

// Of the numbers 0 1 2 in the row at +y and 3 4 6 below; MuJoCo 4.0 casts rays on the same heights.
TEST_CASE("a field of heights has its lowest value at 0 and its highest at its height") {
  MjcfScene scene("<asset><hfield name='h' nrow='2' ncol='3' size='3 2 0.5 0.1' elevation='0 1 2 3 4 6'/></asset>" +
                  world("<geom type='hfield' hfield='h' pos='0 0 1'/>"));
  CHECK(scene.warnings().empty());
  std::vector<glm::dvec3> seen;
  for (const glm::vec3& p : scene.mesh(0).positions) seen.emplace_back(scene.place(0) * glm::dvec4(p, 1));
  for (const glm::dvec3& corner : {glm::dvec3(-3, 2, 1), glm::dvec3(3, -2, 1.5), glm::dvec3(-3, -2, 1.25)}) {
    CHECK(std::ranges::count(seen, corner) > 0);
  }
  CHECK(contains(mjcf_error("<asset><hfield name='h' nrow='2' ncol='3' size='3 2 0.5 0.1' elevation='0 1'/></asset>" +
                            world("<geom type='hfield' hfield='h'/>")),
                 "expected 6 finite numbers"));
}

// Each value is rounded once, by half a unit of the last place of a float32 below 2, where the highest is from 1 to 2.
TEST_CASE("heights of a field are rounded once") {
  const std::vector<double> values = {1000, 1000.1, 1000.3, 1000.7, 1001.1, 1000.2};
  std::string elevation;
  for (const double value : values) elevation += format_number(value) + " ";
  MjcfScene scene("<asset><hfield name='h' nrow='2' ncol='3' size='3 2 0.7 0.1' elevation='" + elevation +
                  "'/></asset>" + world("<geom type='hfield' hfield='h'/>"));
  const double height_m = 0.7, bound_m = height_m * std::exp2(-24) + 1e-15;
  double most_m = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const glm::dvec4 at = scene.place(0) * glm::dvec4(scene.mesh(0).positions[i], 1);
    most_m = std::max(most_m, std::abs(at.z - (values[i] - 1000) / (1001.1 - 1000) * height_m));
  }
  CHECK(most_m <= bound_m);
}

TEST_CASE("strippath takes the folders from the names of all assets") {
  const ByteString picture = png(2, 2, 8, 0, {{0, 255}, {255, 0}});
  const std::string heights(picture.begin(), picture.end());
  const std::string shown = world("<geom type='hfield' hfield='h'/><geom type='mesh' mesh='box'/>");
  const std::string asset =
      "<asset><hfield name='h' size='1 1 1 1' file='far/away/h.png'/><mesh file='far/box.obj'/></asset>";
  MjcfScene scene("<compiler strippath='true'/>" + asset + shown, {{"h.png", heights}, {"box.obj", obj_box()}});
  CHECK(scene.warnings().empty());
  CHECK(scene.list().items.size() == 2);
  CHECK(contains(mjcf_error(asset + shown), "far/away/h.png"));
}

TEST_CASE("meshes of an MJCF model may stand in it, or in MuJoCo's own files") {
  const std::string shown = world("<geom type='mesh' mesh='m'/>");
  MjcfScene own("<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 2' face='0 1 3 0 2 1'/></asset>" + shown);
  CHECK(own.warnings().empty());
  CHECK(own.mesh(0).indices.size() == 6);
  CHECK(own.mesh(0).attributes[0].normal == glm::vec3(0, -1, 0));
  CHECK(own.mesh(0).attributes[3].normal == glm::vec3(0, 0, -1));
  CHECK(contains(mjcf_error("<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0' face='0 1 3'/></asset>" + shown),
                 "has a face of a vertex that is not there"));

  const std::int32_t counts[] = {3, 0, 0, 1}, corners[] = {0, 1, 2};
  const float places[] = {0, 0, 0, 2, 0, 0, 0, 3, 0};
  const auto bytes = [](const auto& values) {
    return std::string(reinterpret_cast<const char*>(values), sizeof(values));
  };
  const std::string msh = bytes(counts) + bytes(places) + bytes(corners),
                    asset = "<asset><mesh name='m' file='m.msh'/></asset>" + shown;
  MjcfScene file(asset, {{"m.msh", msh}});
  CHECK(file.warnings().empty());
  CHECK(file.mesh(0).positions[2] == glm::vec3(0, 3, 0));
  CHECK(file.mesh(0).attributes[0].normal == glm::vec3(0, 0, 1));
  CHECK(contains(mjcf_error(asset, {{"m.msh", msh.substr(0, msh.size() - 1)}}), "has another size than its header"));
  const std::int32_t textured[] = {3, 0, 3, 1};
  const float on_picture[] = {0, 0, 0.25F, 0, 0, 0.75F};
  MjcfScene picture(asset, {{"m.msh", bytes(textured) + bytes(places) + bytes(on_picture) + bytes(corners)}});
  CHECK(picture.mesh(0).attributes[0].normal == glm::vec3(0, 0, 1));
  CHECK(picture.mesh(0).attributes[1].uv[0] == glm::vec2(0.25F, 0));
  CHECK(picture.mesh(0).attributes[2].uv[0] == glm::vec2(0, 0.75F));
  CHECK(contains(mjcf_error(asset, {{"m.msh", "x"}}), "ends within its header"));
}

TEST_CASE("a geom without sizes names the class that no default defines") {
  CHECK(contains(mjcf_error(world("<geom class='visual' type='box'/>")),
                 "has no sizes, and the class \"visual\", which no <default> defines"));
}

TEST_CASE("models that cannot be read are refused with their place") {
  CHECK(contains(mjcf_error(world("<geom size='0'/>")), "none of its visuals can be shown"));
  CHECK(
      contains(mjcf_error("<include file='no.xml'/>"), "m.xml:1:20: element <include> names a file that is not there"));
  CHECK(contains(mjcf_error("<include file='a.xml'/>", {{"a.xml", "<mujoco><include file='a.xml'/></mujoco>"}}),
                 "includes \"a.xml\" a second time"));
  CHECK(contains(mjcf_error(world("<body pos='1 2'><geom size='1'/></body>")),
                 "element <body> has the attribute pos=\"1 2\", expected 3 finite numbers"));
  CHECK(contains(mjcf_error(world("<body quat='0 0 0 0'><geom size='1'/></body>")), "has a quaternion without length"));
  CHECK(contains(mjcf_error(world("<body><joint type='x'/><geom size='1'/></body>")), "has the type \"x\""));
  CHECK(contains(mjcf_error("<worldbody>"), "malformed XML"));
  std::string deep = "<geom size='1'/>";
  for (int i = 0; i < 150; ++i) deep = "<body>" + deep + "</body>";
  CHECK(contains(mjcf_error("<worldbody>" + deep.substr(0, 150 * 6) + "<include file='a.xml'/>" +
                                deep.substr(deep.size() - 150 * 7) + "</worldbody>",
                            {{"a.xml", "<m>" + deep + "</m>"}}),
                 "is nested too deeply"));
  const TemporaryFolder folder;
  write_text(folder / "s.xml", "<simvis/>");
  CHECK(contains(error_of([&] {
                   build_scene(
                       parse_commands("<part file='s.xml' name='M' insert_at='ROOT'/>", "t.xml", folder.path()));
                 }),
                 "is the root, expected <mujoco>"));
}
