// How MJCF models look: built-in pictures, cube textures, repeats, shine, lights and the sky.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/srgb.h"
#include "import/mjcf/mjcf_cube.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/mjcf_scene.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/python_package.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

std::string textured(const std::string& texture, const std::string& geom = "size='1'", const std::string& look = "") {
  return "<asset><texture name='t' " + texture + "/><material name='m' texture='t' " + look + "/></asset>" +
         mjcf_world("<geom material='m' " + geom + "/>");
}

// The red, green and blue of the texels, row by row.
std::vector<int> texels(MjcfScene& scene) {
  const auto& picture = scene.material(0).base_color_texture;
  REQUIRE(picture != nullptr);
  std::vector<int> read;
  for (std::size_t i = 0; i < picture->rgba.size(); ++i) {
    if (i % 4 != 3) read.push_back(picture->rgba[i]);
  }
  return read;
}

const char* const kTexelsScript = R"(
import sys, mujoco
model = mujoco.MjModel.from_xml_path(sys.argv[1])
print(*model.tex_data[:3 * model.tex_width[0] * model.tex_height[0]])
)";

constexpr float kSmooth = 0.5F;  // rounded once to float32
constexpr double kDegreesRounding = 1e-13;
constexpr double kDirection = 1e-12;  // sines and cosines of angles that a command has with 17 digits

}  // namespace

TEST_CASE("built-in pictures are drawn, and a geom's own colour multiplies them") {
  MjcfScene scene(textured("type='2d' builtin='checker' width='4' height='2' rgb1='1 0 0' rgb2='0 0 0.2' mark='none'",
                           "type='plane' size='1 1 1' rgba='1 0.5 0 1'"));
  CHECK(scene.warnings().empty());
  CHECK(texels(scene) == std::vector<int>{255, 0, 0,  255, 0, 0,  0,   0, 51, 0,   0, 51,  //
                                          0,   0, 51, 0,   0, 51, 255, 0, 0,  255, 0, 0});
  CHECK(scene.material(0).base_color == glm::vec4(1, linear_from_srgb(0.5), 0, 1));
  MjcfScene random(
      textured("type='2d' builtin='flat' width='100' height='100' rgb1='0 0 0' mark='random' random='0.2' "
               "markrgb='1 1 1'"));
  int marks = 0;
  for (const int value : texels(random)) marks += value == 255 ? 1 : 0;
  // 2000 of 10,000 texels, and five times the standard deviation of their number.
  CHECK(std::abs(marks / 3 - 2000) < 5 * std::sqrt(10'000 * 0.2 * 0.8));
  MjcfScene wrong(textured("type='2d' builtin='flat' width='0' height='4'"));
  REQUIRE(wrong.warnings().size() == 1);
  CHECK(contains(wrong.warnings()[0], "has a width or height that is not allowed, expected 1 to 8192; the material's"));
  CHECK(wrong.list().items.size() == 1);
}

TEST_CASE("built-in pictures have the texels of MuJoCo") {
  if (!has_python_module("mujoco")) return;
  const TemporaryFolder folder;
  std::size_t compared = 0;
  for (const std::string type : {"2d", "cube"}) {
    for (const std::string kind : {"checker", "gradient", "flat"}) {
      for (const std::string mark : {"none", "edge", "cross"}) {
        const std::string content =
            textured("type='" + type + "' builtin='" + kind + "' mark='" + mark +
                     "' width='9' height='6' rgb1='0.1 0.5 0.9' rgb2='0.8 0.3 0.2' markrgb='1 0 0.4'");
        write_text(folder / "m.xml", "<mujoco>" + content + "</mujoco>");
        const ProcessResult mujoco = Process({kToolsPython, "-c", kTexelsScript, (folder / "m.xml").string()}).wait();
        REQUIRE_MESSAGE(mujoco.exit_code == 0, mujoco.err);
        std::vector<int> expected;
        std::istringstream numbers(mujoco.out);
        for (int value = 0; numbers >> value;) expected.push_back(value);
        CAPTURE(content);
        MjcfScene scene(content);
        CHECK(texels(scene) == expected);
        compared += expected.size();
      }
    }
  }
  CHECK(compared == 3 * 9 * (9 * 6 + 6 * 9 * 9));
}

TEST_CASE("a cube's picture lies on the sides of a box as OpenGL says, and around a mesh") {
  const std::string cube = "type='cube' builtin='flat' width='8' rgb1='1 1 1' rgb2='1 1 1'";
  MjcfScene box(textured(cube, "type='box' size='1 2 3'", "texrepeat='5 5'"));
  CHECK(box.warnings().empty());
  const Mesh& mesh = box.mesh(0);
  REQUIRE(mesh.positions.size() == 36);
  CHECK(box.material(0).uv_transform == glm::mat3x2(1, 0, 0, 1, 0, 0));
  // Of each side, what lies at u = v = 0: the corner at the left and the top (OpenGL 4.6, table 8.19).
  const std::map<std::array<float, 3>, glm::vec3> corners = {{{1, 0, 0}, {1, 2, 3}},   {{-1, 0, 0}, {-1, 2, -3}},
                                                             {{0, 1, 0}, {-1, 2, -3}}, {{0, -1, 0}, {-1, -2, 3}},
                                                             {{0, 0, 1}, {-1, 2, 3}},  {{0, 0, -1}, {1, 2, -3}}};
  int found = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec2 uv = mesh.attributes[i].uv[0];
    CHECK(((uv.x == 0 || uv.x == 1) && (uv.y == 0 || uv.y == 1)));
    if (uv != glm::vec2(0)) continue;
    const glm::vec3 n = mesh.attributes[i].normal;
    CHECK(mesh.positions[i] == corners.at({n.x, n.y, n.z}));
    ++found;
  }
  CHECK(found >= 6);

  // The box stands beside the origin and has another shape; the cube is around its middle.
  const std::string with_mesh = "<asset><mesh name='b' file='box.obj'/></asset>";
  MjcfScene around(with_mesh + textured(cube, "type='mesh' mesh='b'"), {{"box.obj", obj_box()}});
  const Mesh& shown = around.mesh(0);
  REQUIRE(shown.positions.size() == 36);
  const glm::vec3 middle(1.5F, 3, 4.5F);
  for (std::size_t i = 0; i < shown.positions.size(); ++i) {
    const glm::vec3 at = shown.positions[i] - middle, n = shown.attributes[i].normal;
    if (n != glm::vec3(0, 0, 1)) continue;
    CHECK(shown.attributes[i].uv[0].x == doctest::Approx(0.5 + 0.5 * at.x / at.z).epsilon(1e-6));
    CHECK(shown.attributes[i].uv[0].y == doctest::Approx(0.5 - 0.5 * at.y / at.z).epsilon(1e-6));
  }
  // Of an octahedron, each triangle has its corners on three sides.
  MjcfScene octahedron("<asset><mesh name='o' vertex='1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1'/></asset>" +
                       textured(cube, "type='mesh' mesh='o'"));
  REQUIRE(octahedron.mesh(0).attributes.size() == 24);
  for (const VertexAttributes& corner : octahedron.mesh(0).attributes) {
    CHECK(glm::all(glm::greaterThanEqual(corner.uv[0], glm::vec2(0))));
    CHECK(glm::all(glm::lessThanEqual(corner.uv[0], glm::vec2(1))));
  }
  // Round shapes keep the shape that rays meet.
  MjcfScene ball(textured(cube));
  CHECK(ball.mesh(0).surface == sphere_mesh(1).surface);
  MjcfScene checker(textured("type='cube' builtin='checker' width='8'"));
  REQUIRE(checker.warnings().size() == 1);
  CHECK(contains(checker.warnings()[0], "difference between the sides of a cube texture on a round or flat shape"));
}

// The texels are those that MuJoCo 4.0 has for these files.
TEST_CASE("the sides of a cube may have pictures of their own, in a grid or in files") {
  const auto side = [](std::uint8_t red) {
    const ByteString picture = png(1, 1, 8, 2, {{red, 0, 9}});
    return std::string(picture.begin(), picture.end());
  };
  MjcfScene files(textured("type='cube' fileright='a.png' fileback='b.png' rgb1='0 1 0'", "type='box' size='1 1 1'"),
                  {{"a.png", side(10)}, {"b.png", side(20)}});
  CHECK(files.warnings().empty());
  CHECK(texels(files) == std::vector<int>{10, 0, 9, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 20, 0, 9});
  int found = 0;
  for (const VertexAttributes& corner : files.mesh(0).attributes) {
    // Sides from +x to -z, one sixth of the strip each.
    const glm::vec3& n = corner.normal;
    const int number = n.x != 0 ? (n.x > 0 ? 0 : 1) : (n.y != 0 ? (n.y > 0 ? 2 : 3) : (n.z > 0 ? 4 : 5));
    CHECK(static_cast<int>(std::floor(corner.uv[0].y * 6)) == number);
    ++found;
  }
  CHECK(found == 36);
  const ByteString grid = png(2, 2, 8, 0, {{10, 20}, {30, 40}});
  MjcfScene cells(
      textured("type='cube' file='g.png' gridsize='2 2' gridlayout='.UFD' rgb1='0 0 0'", "type='box' size='1 1 1'"),
      {{"g.png", std::string(grid.begin(), grid.end())}});
  CHECK(cells.warnings().empty());
  CHECK(texels(cells) == std::vector<int>{0, 0, 0, 0, 0, 0, 20, 20, 20, 40, 40, 40, 30, 30, 30, 0, 0, 0});
  MjcfScene wrong(textured("type='cube' file='g.png' gridsize='2 2' gridlayout='U'", "type='box' size='1 1 1'"),
                  {{"g.png", std::string(grid.begin(), grid.end())}});
  REQUIRE(wrong.warnings().size() == 1);
  CHECK(contains(wrong.warnings()[0], "has a gridsize and a gridlayout that do not fit"));
  MjcfScene negative(textured("type='cube' file='g.png' gridsize='-2 -1' gridlayout='UD'", "type='box' size='1 1 1'"),
                     {{"g.png", std::string(grid.begin(), grid.end())}});
  REQUIRE(negative.warnings().size() == 1);
  CHECK(contains(negative.warnings()[0], "has a gridsize and a gridlayout that do not fit"));
  MjcfScene unequal(textured("type='cube' fileright='a.png' fileback='g.png'", "type='box' size='1 1 1'"),
                    {{"a.png", side(10)}, {"g.png", std::string(grid.begin(), grid.end())}});
  REQUIRE(unequal.warnings().size() == 1);
  CHECK(contains(unequal.warnings()[0], "has no squares of the size of the other sides"));
  MjcfScene large(textured("type='cube' builtin='checker' width='2731'", "type='box' size='1 1 1'"));
  REQUIRE(large.warnings().size() == 1);
  CHECK(contains(large.warnings()[0], "has a width that is too large for a cube, expected up to 2730"));
}

// From MuJoCo's texture coordinates, which object planes make of places on the plane.
TEST_CASE("pictures repeat over planes as in MuJoCo") {
  const auto transform = [](const std::string& geom, const std::string& look) {
    MjcfScene scene(textured("type='2d' builtin='flat' width='1' height='1'", "type='plane' " + geom, look));
    return scene.material(0).uv_transform;
  };
  CHECK(transform("size='3 4 1'", "texrepeat='5 2'") == glm::mat3x2(5, 0, 0, 2, 0, 0));
  CHECK(transform("size='3 4 1'", "texrepeat='5 2' texuniform='true'") == glm::mat3x2(15, 0, 0, 8, 0, 0));
  CHECK(transform("size='0 0 1'", "texrepeat='5 2'") == glm::mat3x2(250, 0, 0, 100, -125.5F, -50.5F));
  CHECK(transform("size='3 0 1'", "texrepeat='5 2'") == glm::mat3x2(5, 0, 0, 100, -0.5F, -50.5F));
  CHECK(transform("size='3 4 1'", "") == glm::mat3x2(1, 0, 0, 1, 0, 0));
}

// MuJoCo makes the coordinates 0.5 * repeat * x / half - 0.5 and -0.5 * repeat * y / half - 0.5 (settexture() of its
// renderer, also since version 3.12, where other shapes have coordinates of their own); with texuniform the half edge
// is 1 m.
TEST_CASE("a 2d picture on a mesh without coordinates is projected along z over its box") {
  const auto coordinates = [](const std::string& look, const std::string& vertices) {
    MjcfScene scene(
        "<asset><texture name='t' type='2d' builtin='flat' width='1' height='1'/><material name='m' "
        "texture='t' " +
        look + "/><mesh name='s' scale='2 1 1' vertex='" + vertices + "'/></asset>" +
        mjcf_world("<geom type='mesh' mesh='s' material='m'/>"));
    CHECK(scene.warnings().empty());
    std::map<std::array<float, 3>, glm::vec2> at;
    for (std::size_t i = 0; i < scene.mesh(0).positions.size(); ++i) {
      const glm::vec3 p = scene.mesh(0).positions[i];
      at[{p.x, p.y, p.z}] = scene.material(0).uv_transform * glm::vec3(scene.mesh(0).attributes[i].uv[0], 1);
    }
    return at;
  };
  const std::string tetrahedron = "1 0 0  3 0 0  1 4 0  1 0 1";  // from x = 2 to 6 by its scale, y = 0 to 4
  auto whole = coordinates("texrepeat='3 2'", tetrahedron);
  CHECK(whole[{1, 0, 0}] == glm::vec2(-2, 0.5F));
  CHECK(whole[{3, 0, 0}] == glm::vec2(1, 0.5F));
  CHECK(whole[{1, 4, 0}] == glm::vec2(-2, -1.5F));
  auto uniform = coordinates("texrepeat='3 2' texuniform='true'", tetrahedron);
  CHECK(uniform[{1, 0, 0}] == glm::vec2(-3.5F, 1.5F));
  CHECK(uniform[{3, 0, 0}] == glm::vec2(2.5F, 1.5F));
}

/// A geom with a 2d picture that repeats 3 times and twice.
MjcfScene flat_pictured(const std::string& geom, const std::string& look = "") {
  return MjcfScene(
      "<asset><texture name='t' type='2d' builtin='flat' width='1' height='1'/><material name='m' texture='t' "
      "texrepeat='3 2' " +
      look + "/><hfield name='f' nrow='2' ncol='2' size='2 0.5 1 1'/></asset>" +
      mjcf_world("<geom material='m' " + geom + "/>"));
}

// Of a position over its half edge, and of a coordinate up to 8, to float32.
constexpr double kCoordinate = 0x1p-20;

TEST_CASE("a 2d picture on a field of heights is projected along z, as over a mesh") {
  MjcfScene scene = flat_pictured("type='hfield' hfield='f'");
  CHECK(scene.warnings().empty());
  const Mesh& mesh = scene.mesh(0);
  CHECK(mesh.positions.size() >= 4);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec2 at = glm::dvec2(scene.place(0) * glm::dvec4(mesh.positions[i], 1)) / glm::dvec2(2, 0.5);
    const glm::vec2 uv = scene.material(0).uv_transform * glm::vec3(mesh.attributes[i].uv[0], 1);
    CHECK(std::abs(uv.x - (0.5 * 3 * at.x - 0.5)) < kCoordinate);
    CHECK(std::abs(uv.y - (-0.5 * 2 * at.y - 0.5)) < kCoordinate);
  }
}

// The lists of MuJoCo's renderer: the coordinates of each side go from 0 to 1 along x or else y, and from 1 to 0 along
// z or else y.
TEST_CASE("a 2d picture is whole on each side of a box") {
  const glm::dvec3 half_m(2, 0.5, 3);
  for (const bool uniform : {false, true}) {
    MjcfScene scene = flat_pictured("type='box' size='2 0.5 3'", uniform ? "texuniform='true'" : "");
    CHECK(scene.warnings().empty());
    const Mesh& mesh = scene.mesh(0);
    CHECK(mesh.positions.size() == 24);
    const glm::dvec2 repeats = uniform ? glm::dvec2(3 * half_m.x, 2 * half_m.y) : glm::dvec2(3, 2);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::dvec3 at = glm::dvec3(scene.place(0) * glm::dvec4(mesh.positions[i], 1)) / half_m;
      const glm::vec3& normal = mesh.attributes[i].normal;
      const double along = normal.x != 0 ? at.y : at.x, up = normal.z != 0 ? at.y : at.z;
      const glm::vec2 uv = scene.material(0).uv_transform * glm::vec3(mesh.attributes[i].uv[0], 1);
      CHECK(std::abs(uv.x - repeats.x * (along + 1) / 2) < kCoordinate);
      CHECK(std::abs(uv.y - repeats.y * (1 - up) / 2) < kCoordinate);
    }
  }
}

// The same lists: a turn about z from x goes from 0 to 1, and so does the way from the upper pole or end to the lower.
TEST_CASE("a 2d picture lies once around a round shape, times its repeats") {
  struct Case {
    const char* geom;
    glm::vec2 half_m;
  };
  for (const Case& each :
       {Case{"type='sphere' size='0.25'", {0.25F, 0.25F}}, Case{"type='capsule' size='0.25 2'", {0.25F, 0.25F}},
        Case{"type='cylinder' size='0.25 2'", {0.25F, 0.25F}}, Case{"type='ellipsoid' size='2 0.5 3'", {2, 0.5F}}}) {
    CAPTURE(each.geom);
    const auto transform = [&](const char* look) { return flat_pictured(each.geom, look).material(0).uv_transform; };
    CHECK(transform("") == glm::mat3x2(3, 0, 0, 2, 0, 0));
    CHECK(transform("texuniform='true'") == glm::mat3x2(3 * each.half_m.x, 0, 0, 2 * each.half_m.y, 0, 0));
  }
  MjcfScene ball = flat_pictured("type='ellipsoid' size='2 0.5 3'"), tube = flat_pictured("type='cylinder' size='1 2'");
  std::size_t checked = 0;
  for (MjcfScene* const scene : {&ball, &tube}) {
    const Mesh& mesh = scene->mesh(0);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::dvec3 p(mesh.positions[i]);
      const glm::vec2 uv = mesh.attributes[i].uv[0];
      if (scene == &tube && mesh.attributes[i].normal.z != 0) continue;  // the discs have pictures of their own
      const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi);
      const double height = scene == &ball ? std::atan2(p.z, std::hypot(p.x, p.y)) / std::numbers::pi : p.z / 4;
      CHECK(std::abs(uv.y - (0.5 - height)) < kCoordinate);
      if (std::hypot(p.x, p.y) < 0.01 || std::abs(p.y) < 1e-6) continue;  // a pole, or where both ends of the turn meet
      CHECK(std::abs(uv.x - (turn < 0 ? turn + 1 : turn)) < kCoordinate);
      ++checked;
    }
  }
  CHECK(checked > 1000);
}

// The lists SPHERETOP, CYLINDEROPEN and SPHEREBOTTOM of MuJoCo's renderer: on each of them the way down goes from 0
// to 1. Whole numbers more make no difference, because the picture repeats.
TEST_CASE("a 2d picture lies three times on a capsule: on its upper end, its side and its lower end") {
  MjcfScene scene = flat_pictured("type='capsule' size='0.25 2'", "emission='1'");
  CHECK(scene.material(0).uv_set == 1);
  CHECK(scene.material(0).map(MapKind::emissive).uv_set == 1);
  const Mesh& mesh = scene.mesh(0);
  int rims = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3 p(mesh.positions[i]);
    const double beyond = std::abs(p.z) - 2, v = mesh.attributes[i].uv[1].y;
    const double latitude = std::atan2(std::max(beyond, 0.0), std::hypot(p.x, p.y)) / (std::numbers::pi / 2);
    CHECK(std::abs(v - (p.z > 0 ? -latitude : 1 + latitude)) < kCoordinate);
    CHECK(mesh.attributes[i].uv[1].x == mesh.attributes[i].uv[0].x);
    rims += beyond == 0;
  }
  CHECK(rims == 2 * (kSidesAround + 1));
}

// DISKTOP and DISKBOTTOM: both have u = 0.5 + 0.5 x and v = 0.5 + 0.5 y.
TEST_CASE("a 2d picture on the discs of a cylinder lies along x and y, so that the upper one shows it mirrored") {
  MjcfScene scene = flat_pictured("type='cylinder' size='1 2'");
  CHECK(scene.material(0).uv_set == 1);
  const Mesh& mesh = scene.mesh(0);
  int checked = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.attributes[i].normal.z == 0) continue;
    CHECK(glm::distance(mesh.attributes[i].uv[1], 0.5F + 0.5F * glm::vec2(mesh.positions[i])) < kCoordinate);
    ++checked;
  }
  CHECK(checked == 2 * (kSidesAround + 1));
}

TEST_CASE("shininess makes a surface smooth, unless it has a roughness, or no specular part") {
  const auto roughness = [](const std::string& look) {
    MjcfScene scene("<asset><material name='m' " + look + "/></asset>" + mjcf_world("<geom size='1' material='m'/>"));
    CHECK(scene.warnings().empty());
    return scene.material(0).roughness;
  };
  CHECK(roughness("") == 1);
  CHECK(roughness("specular='0' shininess='0.9'") == 1);
  CHECK(roughness("specular='1' shininess='0.234375'") == kSmooth);  // an exponent of 30: alpha^2 = 2 / 32
  CHECK(roughness("shininess='0.234375' roughness='0.25'") == 0.25F);
  MjcfScene glowing("<asset><material name='m' rgba='1 0 0 1' emission='0.5'/></asset>" +
                    mjcf_world("<geom size='1' material='m' rgba='0 1 0 1'/>"));
  CHECK(glowing.material(0).emissive == glm::vec3(0, 0.5F, 0));
}

TEST_CASE("lights of MJCF have their places, directions and strengths") {
  MjcfScene scene(mjcf_world(
      "<geom size='1'/><light name='sun' type='directional' dir='-1 0 -1' diffuse='1 0.5 0' castshadow='true'/>"
      "<light name='old' directional='true'/><light name='off' active='false'/>"
      "<body name='b' pos='5 0 0' euler='0 0 90'><geom size='1'/><frame euler='90 0 0'><light name='lamp' pos='0 4 3' "
      "dir='0 0 -1' attenuation='0.5 0.1 0' cutoff='30'/></frame></body>"
      "<light name='aimed' pos='5 0 3' mode='targetbody' target='b' diffuse='1 1 1'/>"
      "<light name='bulb' type='point' pos='0 0 2' ambient='0.1 0 0'/>"
      "<body name='c' euler='0 0 90'><freejoint name='free'/><geom size='1'/><light name='noon' mode='trackcom' "
      "directional='true' dir='-1 0 -1'/></body>"));
  CHECK(scene.value("sun", "azimuth") == 0);
  CHECK(scene.value("sun", "elevation") == doctest::Approx(45).epsilon(kDegreesRounding));
  CHECK(scene.value("sun", "intensity") == std::numbers::pi);
  CHECK(scene.value("sun", "green") == decode_srgb(0.5));
  CHECK(scene.value("old", "elevation") == 90);
  CHECK(scene.value("old", "red") == decode_srgb(0.7));
  // In the frame, y is the body's z and z its -y; from 5 m, MuJoCo divides by 0.5 + 0.5.
  CHECK(scene.value("lamp", "y") == doctest::Approx(-3));
  CHECK(scene.value("lamp", "z") == doctest::Approx(4));
  CHECK(scene.value("lamp", "yaw") == doctest::Approx(90));
  CHECK(scene.value("lamp", "outer_cone") == doctest::Approx(30));
  CHECK(scene.value("lamp", "intensity") == doctest::Approx(std::numbers::pi * 25));
  CHECK(scene.value("aimed", "pitch") == 90);
  CHECK(scene.value("aimed", "intensity") == doctest::Approx(std::numbers::pi * 9));
  CHECK(scene.value("bulb", "intensity") == doctest::Approx(std::numbers::pi * 4));
  const DrawList& list = scene.list();
  REQUIRE(list.lights.size() == 6);
  std::size_t with_shadows = 0;
  for (const LightItem& item : list.lights) with_shadows += item.light.shadow_px > 0 ? 1 : 0;
  CHECK(with_shadows == 1);
  // It comes from the body's x, which is the world's y, and stays there when the body turns.
  CHECK(scene.value("noon", "azimuth") == doctest::Approx(90).epsilon(kDegreesRounding));
  scene.set("free", 45, "yaw");
  CHECK(std::ranges::count_if(scene.list().lights, [&](const LightItem& item) {
          const glm::dvec3 seen =
              glm::dmat3(scene.list().world_from_node[item.transform]) * glm::dvec3(item.light.direction);
          return glm::length(seen - glm::dvec3(0, -1, -1) / std::sqrt(2.0)) < kDirection;
        }) == 1);
  // The headlight's ambient part, 2/3 of its diffuse one, and the bulb's.
  CHECK(scene.value("sky", "ambient_blue") == decode_srgb(0.1 + 2.0 / 3 * 0.4));
  CHECK(scene.value("sky", "ambient_red") == doctest::Approx(decode_srgb(0.2 + 2.0 / 3 * 0.4)));
  const std::vector<std::string> warnings = scene.warnings();
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "a light that is aimed at a body is aimed at its first place here"));
}

TEST_CASE("a light of an unknown type or without a direction is left out") {
  MjcfScene scene(
      mjcf_world("<geom size='1'/><light name='a' type='image'/><light name='b' dir='0 0 0'/><light name='c'/>"));
  const std::vector<std::string> warnings = scene.warnings();
  REQUIRE(warnings.size() == 2);
  CHECK(contains(warnings[0], "expected spot, directional or point; the light is left out"));
  CHECK(contains(warnings[1], "has a direction without length; the light is left out"));
  CHECK(scene.list().lights.size() == 1);
}

TEST_CASE("a sky box colours the background, and a model without lights leaves the scene its own") {
  MjcfScene scene(
      "<visual><headlight ambient='0.3 0.3 0.3' diffuse='0 0 0'/></visual><asset><texture type='skybox' "
      "builtin='gradient' rgb1='0.2 0.4 0.6' rgb2='0 0 0' width='8' height='8'/></asset>" +
      mjcf_world("<geom size='1'/>"));
  CHECK(scene.warnings().empty());
  CHECK(scene.value("sky", "green") == decode_srgb(0.2));
  CHECK(scene.value("sky", "ambient_red") == decode_srgb(0.3));
  CHECK_THROWS(MjcfScene(mjcf_world("<geom size='1'/>")).value("sky", "red"));
}

}  // namespace simvis::test

TEST_SUITE_END();
