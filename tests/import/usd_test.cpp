// Parts from USD: against the same scene as glTF, and the same robot as MJCF.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "elements/label.h"
#include "import/sandbox/import_program.h"
#include "scenegraph/flattener.h"
#include "simvis/element_motion.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/python_package.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Lets the importer find usd-core for the length of a test.
class UsdPython {
 public:
  UsdPython() { ::setenv("SIMVIS_PYTHON", kToolsPython, 1); }
  ~UsdPython() { ::unsetenv("SIMVIS_PYTHON"); }
  UsdPython(const UsdPython&) = delete;
  UsdPython& operator=(const UsdPython&) = delete;
};

BuiltScene usd_scene(const TemporaryFolder& folder, const std::string& file, const std::string& more = "") {
  return build_scene(
      parse_commands("<part file='" + file + "' name='P' insert_at='ROOT'/>" + more, "s.xml", folder.path()));
}

std::string usd_error(const TemporaryFolder& folder, const std::string& text) {
  write_text(folder / "p.usda", text);
  return error_of([&] { usd_scene(folder, "p.usda"); });
}

const std::string kTranslateOrder = "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";

// Centimetres, y up: a square of 1 m with a picture on it in the plane z = 0, two instances of a box of four sides
// beside it, and a camera 4 m in front.
const std::string kUsdScene = R"(#usda 1.0
( metersPerUnit = 0.01
  upAxis = "Y" )
def Xform "World"
{
    def Mesh "Square" (prepend apiSchemas = ["MaterialBindingAPI"])
    {
        rel material:binding = </World/Looks/Paint>
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)]
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")
        uniform token subdivisionScheme = "none"
    }
    def Xform "Left" (instanceable = true
        prepend references = </Wedge>)
    {
        double3 xformOp:translate = (-100, 0, -50)
        )" + kTranslateOrder + R"(    }
    def Xform "Right" (instanceable = true
        prepend references = </Wedge>)
    {
        double3 xformOp:translate = (100, 25, 50)
        )" + kTranslateOrder + R"(    }
    def DistantLight "Sun"
    {
        bool inputs:normalize = true
        float inputs:intensity = 3
    }
    def Camera "Eye"
    {
        float focalLength = 20
        float horizontalAperture = 20
        float verticalAperture = 15
        float2 clippingRange = (10, 100000)
        double3 xformOp:translate = (0, 0, 400)
        )" + kTranslateOrder + R"(    }
    def Scope "Looks"
    {
        def Material "Paint"
        {
            token outputs:surface.connect = </World/Looks/Paint/Surface.outputs:surface>
            def Shader "Surface"
            {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor.connect = </World/Looks/Paint/Picture.outputs:rgb>
                float inputs:metallic = 0.25
                float inputs:roughness = 0.75
                token outputs:surface
            }
            def Shader "Picture"
            {
                uniform token info:id = "UsdUVTexture"
                asset inputs:file = @paint.png@
                token inputs:wrapS = "clamp"
                token inputs:wrapT = "clamp"
                float2 inputs:st.connect = </World/Looks/Paint/Uv.outputs:result>
                float3 outputs:rgb
            }
            def Shader "Uv"
            {
                uniform token info:id = "UsdPrimvarReader_float2"
                string inputs:varname = "st"
                float2 outputs:result
            }
        }
    }
}
class Xform "Wedge"
{
    def Mesh "Faces"
    {
        int[] faceVertexCounts = [3, 3]
        int[] faceVertexIndices = [0, 1, 2, 0, 3, 1]
        point3f[] points = [(0, 40, 0), (0, -40, 30), (40, 0, 0), (-40, 0, 0)]
        color3f[] primvars:displayColor = [(0.25, 0.5, 0.75)]
        uniform token subdivisionScheme = "none"
    }
}
)";

json material(const char* name, const json& metallic_roughness) {
  json made = {{"pbrMetallicRoughness", metallic_roughness}};
  if (*name != '\0') made["name"] = name;
  return made;
}

// The same scene in glTF's metres, without its camera.
std::string same_as_gltf() {
  GltfBuilder builder;
  const auto mesh = [&](const std::vector<float>& points, const std::vector<float>& uv,
                        const std::vector<std::uint32_t>& corners, int look) {
    json attributes = {{"POSITION", builder.accessor("VEC3", points)}};
    if (!uv.empty()) attributes["TEXCOORD_0"] = builder.accessor("VEC2", uv);
    json& primitive = builder.primitive(attributes);
    primitive["indices"] = builder.accessor("SCALAR", corners);
    primitive["material"] = look;
  };
  mesh({-0.5F, -0.5F, 0, 0.5F, -0.5F, 0, 0.5F, 0.5F, 0, -0.5F, 0.5F, 0}, {0, 1, 1, 1, 1, 0, 0, 0}, {0, 1, 2, 0, 2, 3},
       0);
  mesh({0, 0.4F, 0, 0, -0.4F, 0.3F, 0.4F, 0, 0, -0.4F, 0, 0}, {}, {0, 1, 2, 0, 3, 1}, 1);
  json& root = builder.root;
  root["nodes"][1]["translation"] = {-1, 0, -0.5};
  json right = root["nodes"][1];
  right["translation"] = {1, 0.25, 0.5};
  const int second = builder.append("nodes", right), sun = builder.append("nodes", json::object());
  root["scene"] = 0;
  root["scenes"][0]["nodes"] = {0, 1, second, sun};
  root["extensionsUsed"] = {"KHR_lights_punctual"};
  root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 3}}};
  root["nodes"][sun]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  builder.append("samplers", {{"wrapS", 33071}, {"wrapT", 33071}});
  builder.append("images", {{"uri", "paint.png"}});
  builder.append("textures", {{"source", 0}, {"sampler", 0}});
  builder.append(
      "materials",
      material("Paint", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.75}}));
  builder.append("materials", material("", {{"baseColorFactor", {0.25, 0.5, 0.75, 1}}, {"metallicFactor", 0}}));
  return builder.text();
}

// How many numbers differ, and the first that does.
template <class Numbers>
std::string different(const Numbers& seen, const Numbers& wanted) {
  if (seen.size() != wanted.size()) return "sizes";
  std::size_t count = 0;
  std::string first;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] == wanted[i]) continue;
    if (count++ == 0) {
      first = "number " + std::to_string(i) + ": " + std::to_string(seen[i]) + " for " + std::to_string(wanted[i]);
    }
  }
  return count == 0 ? "" : std::to_string(count) + " differ, " + first;
}

// An arm of 1 m and 2 kg on a hinge about y at (0, 0, 0.5), in USD and in MJCF.
const std::string kUsdArm = R"(#usda 1.0
( metersPerUnit = 1
  upAxis = "Z" )
def Xform "Arm"
{
    def Xform "base" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "SemanticsLabelsAPI:class"])
    {
        token[] semantics:labels:class = ["stand"]
        def Cube "shape" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double size = 0.25
        }
    }
    def Xform "link" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 2
        double3 xformOp:translate = (0.25, 0, 0.5)
        )" + kTranslateOrder +
                            R"(        def Cube "shape" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double size = 0.5
            double3 xformOp:translate = (0.25, 0, 0)
            float3 xformOp:scale = (2, 0.25, 0.25)
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
        }
    }
    def PhysicsFixedJoint "root"
    {
        rel physics:body1 = </Arm/base>
    }
    def PhysicsRevoluteJoint "hinge" (prepend apiSchemas = ["PhysicsDriveAPI:angular"])
    {
        uniform token physics:axis = "Y"
        rel physics:body0 = </Arm/base>
        rel physics:body1 = </Arm/link>
        point3f physics:localPos0 = (0, 0, 0.5)
        point3f physics:localPos1 = (-0.25, 0, 0)
        float physics:lowerLimit = -90
        float physics:upperLimit = 60
        float drive:angular:physics:stiffness = 0.5
        float drive:angular:physics:damping = 0.03125
        float drive:angular:physics:targetPosition = 15
    }
}
)";
const char* const kMjcfArm =
    "<mujoco><option timestep='0.001' gravity='0 0 -9.80665'/><worldbody><body name='base'>"
    "<geom type='box' size='0.125 0.125 0.125'/><body name='link' pos='0.25 0 0.5'>"
    "<joint name='hinge' axis='0 1 0' pos='-0.25 0 0' range='-90 60'/>"
    "<geom type='box' pos='0.25 0 0' size='0.5 0.0625 0.0625' mass='2'/></body></body></worldbody><actuator>"
    "<general joint='hinge' biastype='affine' gainprm='28.64788975654116' biasprm='7.5 -28.64788975654116 "
    "-1.790493109783822'/></actuator></mujoco>";

}  // namespace

TEST_CASE("offsets of a USD camera's aperture move its principal point") {
  const UsdPython python;
  const TemporaryFolder folder;
  const auto scene = [&](const std::string& offsets) {
    write_text(folder / "c.usda",
               "#usda 1.0\n( upAxis = \"Z\" )\ndef Xform \"Robot\" {\n def Camera \"Eye\" {\n"
               "float focalLength = 20\nfloat horizontalAperture = 20\n"
               "float verticalAperture = 15.01\n" +
                   offsets + " }\n def Cube \"Body\" {}\n}\n");
    return usd_scene(folder, "c.usda");
  };
  const BuiltScene moved = scene("float horizontalApertureOffset = 2\nfloat verticalApertureOffset = 1\n");
  REQUIRE(moved.sensors.size() == 1);
  // 640 pixels on 20 units: 32 for each, and rows for 15.01 units, which are 480.32. The window is moved to the right
  // and upwards, and so the axis in the image to the left and down. Centres of pixels stand at whole numbers.
  const auto number = [&](const char* name) { return std::stod(moved.sensors[0].command.require(name).value); };
  constexpr double kRounding_px = 1e-9;
  CHECK(number("height") == 480);
  CHECK(std::abs(number("fx") - 640) <= kRounding_px);
  CHECK(moved.sensors[0].command.find("fy") == nullptr);
  CHECK(moved.sensors[0].command.find("distortion") == nullptr);
  CHECK(std::abs(number("cx") - (320 - 2 * 32 - 0.5)) <= kRounding_px);
  CHECK(std::abs(number("cy") - (240 + 1 * 32 - 0.5)) <= kRounding_px);
  const BuiltScene wrong = scene("float horizontalApertureOffset = nan\n");
  CHECK(wrong.sensors.empty());
  REQUIRE(wrong.scene.warnings().size() == 1);
  CHECK(contains(wrong.scene.warnings()[0], "has an offset of its aperture that is not finite"));
}

TEST_CASE("f-theta lenses of Omniverse are taken over, and other lenses are a warning") {
  const UsdPython python;
  const TemporaryFolder folder;
  const auto scene = [&](const std::string& model, const std::string& k0, const std::string& k4) {
    const auto line = [](const std::string& name, const std::string& value) {
      return "custom float omni:lensdistortion:ftheta:" + name + " = " + value + "\n";
    };
    write_text(folder / "c.usda",
               "#usda 1.0\n( upAxis = \"Z\" )\ndef Xform \"Robot\" {\n def Camera \"Eye\" {\n"
               "custom token omni:lensdistortion:model = \"" +
                   model + "\"\n" + line("nominalWidth", "64") + line("nominalHeight", "48") + line("k0", k0) +
                   line("k1", "0.03125") + line("k2", "0") + line("k3", "0.0000152587890625") + line("k4", k4) +
                   "custom float2 omni:lensdistortion:ftheta:opticalCenter = (31, 22.5)\n"
                   " }\n def Cube \"Body\" {}\n}\n");
    return usd_scene(folder, "c.usda");
  };
  const BuiltScene taken = scene("ftheta", "0", "0");
  REQUIRE(taken.sensors.size() == 1);
  CHECK(taken.scene.warnings().empty());
  const auto text = [&](const char* name) { return taken.sensors[0].command.require(name).value; };
  CHECK(text("width") == "64");
  CHECK(text("height") == "48");
  CHECK(text("distortion") == "ftheta_backward");
  double polynomial[5];
  REQUIRE(parse_numbers(text("polynomial"), polynomial));
  CHECK(std::vector<double>(polynomial, polynomial + 5) == std::vector<double>{0, 0x1p-5, 0, 0x1p-16, 0});
  CHECK(std::stod(text("cx")) == 31);
  CHECK(std::stod(text("cy")) == 22.5);
  CHECK(taken.sensors[0].command.find("hfov") == nullptr);
  using ModelAndEnds = std::array<const char*, 3>;  // model, k0 and k4
  for (const ModelAndEnds& wrong : {ModelAndEnds{"ftheta", "0.1", "0"},
                                    {"ftheta", "0", "-0.0001"},
                                    {"ftheta", "0", "nan"},
                                    {"kannalaBrandtK3", "0", "0"}}) {
    CAPTURE(wrong[0]);
    CAPTURE(wrong[2]);
    const BuiltScene left_out = scene(wrong[0], wrong[1], wrong[2]);
    REQUIRE(left_out.sensors.size() == 1);
    CHECK(left_out.sensors[0].command.find("distortion") == nullptr);
    REQUIRE(left_out.scene.warnings().size() == 1);
    CHECK(contains(left_out.scene.warnings()[0], "has a lens that is not taken over; it is a pinhole"));
  }
}

TEST_CASE("rays and pictures of a USD stage are those of the same scene as glTF") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  write_text(folder / "a.usda", kUsdScene);
  write_text(folder / "b.gltf", same_as_gltf());
  write_bytes(folder / "paint.png", png(2, 2, 8, 2, {{255, 0, 0, 0, 255, 0}, {0, 0, 255, 255, 255, 0}}));
  const std::string scanner =
      "<sensor name='S' insert_at='ROOT' type='laser_scanner' pose_offset='0.1 -3 0.05 0 0 90' min_angle='-40' "
      "max_angle='40' samples='321'/>";
  // The camera of the file stands at 4 m along z, which is -y here, and looks along -z.
  Simulation usd = Simulation::from_string("<part file='a.usda' name='P' insert_at='ROOT'/>" + scanner,
                                           SimulationDesc{}, folder.path());
  Simulation gltf = Simulation::from_string(
      "<part file='b.gltf' name='P' insert_at='ROOT'/><sensor name='Eye' type='camera' insert_at='ROOT' "
      "pose_offset='0 -4 0 0 0 90' hfov='53.13010235415598' near='0.1'/>" +
          scanner,
      SimulationDesc{}, folder.path());
  CHECK(usd.warnings().empty());
  usd.step();
  gltf.step();
  const auto& seen = usd.scan("S").range_m;
  const auto& wanted = gltf.scan("S").range_m;
  CHECK(different(seen, wanted) == "");
  CHECK(std::ranges::count_if(seen, [](float range) { return std::isfinite(range) && range > 0; }) > 100);
  const Image picture = usd.color("Eye"), same = gltf.color("Eye");
  REQUIRE(picture.pixels.size() == std::size_t{640} * 480 * 4);
  CHECK(different(picture.pixels, same.pixels) == "");
  // The picture's corners: red, green, blue and yellow from the upper left one on.
  const auto pixel = [&](std::size_t x, std::size_t y) { return &picture.pixels[(y * 640 + x) * 4]; };
  CHECK(pixel(270, 190)[0] > pixel(270, 190)[1]);
  CHECK(pixel(370, 190)[1] > pixel(370, 190)[0]);
  CHECK(pixel(270, 290)[2] > pixel(270, 290)[0]);
}

TEST_CASE("a robot of USD moves by its joints, and in physics as the same one of MJCF") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  write_text(folder / "arm.usda", kUsdArm);
  write_text(folder / "arm.xml", kMjcfArm);
  BuiltScene shown = usd_scene(folder, "arm.usda");
  CHECK(shown.scene.warnings().empty());
  const auto& rows = shown.parameters.elements();
  const auto hinge = std::ranges::find(rows, std::string("hinge"), &ElementDescriptor::name);
  REQUIRE(hinge != rows.end());
  CHECK(hinge->parameters[0].min == -90);
  CHECK(hinge->parameters[0].max == 60);
  CHECK(std::ranges::count(rows, std::string("label"), &ElementDescriptor::type) == 1);  // of the base
  const auto moved = [&](const std::string& file) {
    BuiltScene scene = usd_scene(folder, file,
                                 "<element type='physics' name='W' insert_at='ROOT'/>"
                                 "<element type='models' name='B' insert_at='P'/>");
    std::vector<glm::dmat4> places;
    for (const double t : {0.0, 0.2, 0.5, 1.0}) {
      advance_elements(scene, {.time_ns = std::llround(t * 1e9)});
      places.push_back(scene.scene.world_from_point("link").value());
    }
    return places;
  };
  // The same engine with the same numbers, of which USD's have 24 bits.
  const std::vector<glm::dmat4> usd = moved("arm.usda"), mjcf = moved("arm.xml");
  constexpr double kFloat = 1e-5;
  for (std::size_t i = 0; i < usd.size(); ++i) {
    for (int column = 0; column < 4; ++column) CHECK(glm::length(usd[i][column] - mjcf[i][column]) < kFloat);
  }
  CHECK(glm::length(usd[0][3] - usd[2][3]) > 0.05);
}

TEST_CASE("a joint of USD whose limits leave out the pose of the file starts at the nearest limit") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  std::string text = kUsdArm;
  const std::string lower = "physics:lowerLimit = -90";
  text.replace(text.find(lower), lower.size(), "physics:lowerLimit = 10");
  write_text(folder / "arm.usda", text);
  BuiltScene shown = usd_scene(folder, "arm.usda");
  CHECK(shown.parameters.values()[shown.parameters.index("hinge", "value")] == 10);
}

TEST_CASE("shapes of USD that do not say their sides are seen from both, as in usdview") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  for (const std::string sides : {"", "uniform bool doubleSided = true", "uniform bool doubleSided = false"}) {
    CAPTURE(sides);
    write_text(folder / "q.usda", "#usda 1.0\ndef Mesh \"m\"\n{\n" + sides +
                                      "\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
                                      "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n}\n");
    BuiltScene scene = usd_scene(folder, "q.usda");
    Flattener flattener(scene.scene.root());
    const DrawList& list = flattener.update();
    REQUIRE(list.items.size() == 1);
    CHECK(list.materials[list.items[0].material]->double_sided == (sides.find("false") == sides.npos));
  }
}

TEST_CASE("a USD file that cannot be read says why, and reads no file outside its folders") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder, outside;
  CHECK(contains(usd_error(folder, "#usda 1.0\ndef Xform \"a\" {"), "p.usda:2:"));
  CHECK(contains(usd_error(folder, "nothing"), "p.usda"));
  CHECK(contains(usd_error(folder,
                           "#usda 1.0\ndef Mesh \"m\"\n{\nint[] faceVertexCounts = [3]\nint[] "
                           "faceVertexIndices = [0, 1, 9]\npoint3f[] points = [(0, 0, 0)]\n}\n"),
                 "prim /m: faceVertexIndices beyond the points"));
  write_text(outside / "secret.usda", "#usda 1.0\n(\n  defaultPrim = \"s\"\n)\ndef Sphere \"s\" { }\n");
  write_text(folder / "p.usda",
             "#usda 1.0\ndef Xform \"a\" (prepend references = @" + (outside / "secret.usda").string() + "@)\n{\n}\n");
  std::string said;
  try {
    const BuiltScene built = usd_scene(folder, "p.usda");
    for (const std::string& warning : built.scene.warnings()) said += warning + "\n";
  } catch (const InputError& error) {
    said = error.what();
  }
  CHECK(contains(said, "secret.usda"));
}

TEST_CASE("layers and pictures of USD that are missing or lie outside: the rule and the warnings of robots") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  const std::string box = "#usda 1.0\n(\n  defaultPrim = \"s\"\n)\ndef Cube \"s\" { }\n";
  for (const char* const place : {"a/b/p", "out/one", "out/two"}) {
    std::filesystem::create_directories(folder / place);
    write_text(folder / place / "box.usda", box);
    write_bytes(folder / place / "red.png", png(1, 1, 8, 2, {{255, 0, 0}}));
  }
  const auto load = [&](const std::string& body, const std::string& attributes) {
    write_text(folder / "a/b/p/p.usda", "#usda 1.0\n" + body);
    return build_scene(parse_commands("<part file='p.usda' name='P' insert_at='ROOT' " + attributes + "/>", "s.xml",
                                      folder / "a/b/p"))
        .scene.warnings();
  };
  const auto references = [](const std::vector<std::string>& files) {
    std::string body;
    for (const std::string& file : files) {
      body += "def \"x" + std::to_string(body.size()) + "\" (prepend references = @" + file + "@)\n{\n}\n";
    }
    return body;
  };
  const std::string in = "box.usda", one = "../../../out/one/box.usda", two = "../../../out/two/box.usda";
  CHECK(load(references({in, in}), "").empty());
  const std::vector<std::string> outside = load(references({in, in, one, two}), "");
  REQUIRE(outside.size() == 1);
  CHECK(contains(outside[0],
                 "p.usda: 2 visuals are left out: their files lie outside the folders of the part; "
                 "--package NAME=" +
                     (folder / "out").string() + " adds the folder"));
  for (const std::string& missing : {one, std::string("gone.usda")}) {
    CAPTURE(missing);
    CHECK(load(references({in, missing}), "").size() == 1);
    CHECK(contains(error_of([&] {
                     load(references({in, "gone2.usda", missing}), "");
                   }),
                   "only 1 of its 3 visuals can be shown: "));
    CHECK(contains(error_of([&] { load(references({missing}), ""); }), "none of its visuals can be shown: "));
    CHECK(load(references({missing}), "missing_visuals='any'").size() == 2);  // and that nothing is shown
  }
  CHECK(load(references({in, "paint.mtlx", "colour.mtlx"}), "").size() == 2);  // no visuals
  const auto gone = [](const std::string& name) {
    return "def Material \"" + name + "\" (prepend references = @gone.usda@</" + name + ">)\n{\n}\n";
  };
  CHECK(load("def Cube \"c\"\n{\n}\n" + gone("Red") + gone("Blue"), "").size() == 2);

  std::string painted;
  for (const std::string file : {"../../../out/one/red.png", "../../../out/two/red.png", "red.png"}) {
    const std::string name = "m" + std::to_string(painted.size());
    painted += "def Cube \"c" + name + "\" (prepend apiSchemas = [\"MaterialBindingAPI\"])\n{\n" +
               "rel material:binding = </" + name + ">\n}\ndef Material \"" + name + "\"\n{\n" +
               "token outputs:surface.connect = </" + name + "/S.outputs:surface>\n" +
               "def Shader \"S\"\n{\nuniform token info:id = \"UsdPreviewSurface\"\n" +
               "color3f inputs:diffuseColor.connect = </" + name + "/T.outputs:rgb>\ntoken outputs:surface\n}\n" +
               "def Shader \"T\"\n{\nuniform token info:id = \"UsdUVTexture\"\nasset inputs:file = @" + file +
               "@\nfloat3 outputs:rgb\n}\n}\n";
  }
  const std::vector<std::string> pictures = load(painted, "");
  REQUIRE(pictures.size() == 1);
  CHECK(contains(pictures[0],
                 "p.usda: 2 pictures are left out: their files lie outside the folders of the part; "
                 "--package NAME=" +
                     (folder / "out").string() + " adds the folder"));
}

TEST_CASE("a package of USD may hold another one") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  write_text(folder / "box.usda", "#usda 1.0\n(\n  defaultPrim = \"s\"\n)\ndef Cube \"s\" { }\n");
  write_text(folder / "root.usda", "#usda 1.0\ndef \"x\" (prepend references = @inner.usdz@)\n{\n}\n");
  const std::string pack =
      "import os, sys\nfrom pxr import Sdf\nos.chdir(sys.argv[1])\n"
      "for name, files in (('inner.usdz', ['box.usda']), ('outer.usdz', ['root.usda', 'inner.usdz'])):\n"
      "    writer = Sdf.ZipFileWriter.CreateNew(name)\n    for file in files:\n        writer.AddFile(file, file)\n"
      "    writer.Save()\n";
  REQUIRE(Process({kToolsPython, "-c", pack, folder.path().string()}, {}).wait().exit_code == 0);
  std::filesystem::remove(folder / "inner.usdz");
  const BuiltScene built = usd_scene(folder, "outer.usdz");
  CHECK(built.scene.warnings().empty());
}

// What the sandbox tests of the other readers do by a library, Python tries itself.
TEST_CASE("the process that reads USD writes no file, starts no program and opens no connection") {
  if (!has_python_module("ctypes")) return;
  const TemporaryFolder folder;
  write_text(folder / "own.txt", "own");
  const std::string script = R"(
import ctypes, os, socket, sys
library = ctypes.CDLL(sys.argv[1])
reason = ctypes.create_string_buffer(1000)
folders = (ctypes.c_char_p * 1)(os.fsencode(sys.argv[2]))
size = ctypes.c_size_t(1000)
print(library.simvis_limit_process(b"usd", ctypes.c_size_t(1 << 30), folders, 1, reason, size), reason.value)
def attempt(name, act):
    try:
        act()
        print(name, "works")
    except OSError:
        print(name, "is refused")
attempt("reading", lambda: open(sys.argv[2] + "/own.txt").read())
attempt("writing", lambda: open(sys.argv[2] + "/new.txt", "w"))
attempt("connecting", lambda: socket.socket())
attempt("starting", lambda: os.posix_spawn("/bin/true", ["true"], {}))
)";
  const ProcessResult tried =
      Process({kToolsPython, "-c", script, import_program("simvis-python-limits.so").string(), folder.path().string()})
          .wait();
  CHECK(tried.out == "0 b''\nreading works\nwriting is refused\nconnecting is refused\nstarting is refused\n");
  CHECK_FALSE(std::filesystem::exists(folder / "new.txt"));
}

TEST_CASE("two parts of one USD file have the same classes") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  write_text(folder / "arm.usda", kUsdArm);
  const BuiltScene built =
      usd_scene(folder, "arm.usda", "<part file='arm.usda' name='Q' insert_at='ROOT' pose_offset='2 0 0 0 0 0'/>");
  std::set<std::string> labelled;
  for (const Label* const label : labels_of(built.scene)) {
    CHECK(label->class_name == "stand");
    for (const auto& [point, object] : label->shapes.points) labelled.insert(point);
  }
  CHECK(labelled == std::set<std::string>{"P/base", "Q/base"});
}

TEST_CASE("prims of USD are labelled by their names") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  write_text(folder / "stove.usda",
             "#usda 1.0\ndef Xform \"Stove\"\n{\n  def Sphere \"knob_1\"\n  {\n  }\n  def Xform \"knob_2\"\n  {\n"
             "    def Cube \"Body\"\n    {\n    }\n  }\n  def Sphere \"Plain\"\n  {\n  }\n}\n");
  const BuiltScene built = usd_scene(folder, "stove.usda",
                                     "<element type='label' name='L' insert_at='ROOT' part='P' shapes='knob_*' "
                                     "class='knob' class_id='4'/>");
  REQUIRE(labels_of(built.scene).size() == 1);
  CHECK(labels_of(built.scene)[0]->shapes.names == SelectedNames{"knob_1", "knob_2"});
}

TEST_CASE("the current folder brings no modules to the programs in Python") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const TemporaryFolder folder;
  write_text(folder / "sitecustomize.py", "open('ran', 'w')\n");
  write_text(folder / "p.usda", "#usda 1.0\n(\n  defaultPrim = \"s\"\n)\ndef Sphere \"s\" { }\n");
  write_text(folder / "p.xml", "<simvis><part file=\"p.usda\" name=\"P\" insert_at=\"ROOT\"/></simvis>");
  const ProcessResult run =
      Process({"sh", "-c", "cd \"$1\" && exec \"$2\" --list p.xml", "sh", folder.path().string(), simvis_run()},
              {"PYTHONPATH=:relative:", std::string("SIMVIS_PYTHON=") + kToolsPython})
          .wait();
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(folder / "ran"));
}

TEST_CASE("an answer of the program that reads USD may not be nested without end") {
  const TemporaryFolder folder;
  write_text(folder / "p.usda", "#usda 1.0\n");
  write_text(folder / "python", R"(#!/usr/bin/python3
import os, struct
def write(data):
    data = memoryview(data)
    while data:
        data = data[os.write(3, data):]
levels = 1000000
text = b'{"gltf":' + b'[' * levels + b']' * levels + b',"model":null}'
scene = struct.pack('<Q', len(text)) + text
write(b"simvis-import-5\n")
write(struct.pack('<cQ', b'S', len(scene)))
write(scene)
os._exit(0)
)");
  std::filesystem::permissions(folder / "python", std::filesystem::perms::owner_all);
  ::setenv("SIMVIS_PYTHON", (folder / "python").c_str(), 1);
  const std::string error = error_of([&] { usd_scene(folder, "p.usda"); });
  ::unsetenv("SIMVIS_PYTHON");
  CHECK(contains(error, "returned a malformed answer"));
}

TEST_CASE("instances of a prototype that is not there are left out with a warning") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  const UsdPython python;
  const TemporaryFolder folder;
  for (const char* const lines :
       {"rel prototypes = </none>\nint[] protoIndices = [0]", "rel prototypes = </i/s>\nint[] protoIndices = [0, 5]"}) {
    CAPTURE(lines);
    write_text(folder / "p.usda", std::string("#usda 1.0\ndef Sphere \"shown\" { }\ndef PointInstancer \"i\"\n{\n") +
                                      lines +
                                      "\npoint3f[] positions = [(0, 0, 0), (1, 0, 0)]\ndef Sphere \"s\" { }\n}\n");
    std::string said;
    const BuiltScene built = usd_scene(folder, "p.usda");
    for (const std::string& warning : built.scene.warnings()) said += warning + "\n";
    CHECK(contains(said, "has instances of a prototype that is not there"));
  }
}

TEST_CASE("without usd-core, a USD file says what to install") {
  const TemporaryFolder folder;
  write_text(folder / "p.usda", "#usda 1.0\n");
  ::setenv("SIMVIS_PYTHON", "/usr/bin/python3", 1);
  const std::string error = error_of([&] { usd_scene(folder, "p.usda"); });
  ::unsetenv("SIMVIS_PYTHON");
  if (error.empty()) return skip("the system has usd-core");
  CHECK(contains(error, "pip install usd-core numpy"));
}

TEST_SUITE_END();
