// URDF files that break the format in usual ways: what is loaded, and the one warning with its place.
#include <doctest/doctest.h>

#include <string>
#include <tuple>
#include <vector>

#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string visual_xml(const std::string& shape, const std::string& material = "") {
  return "<visual><geometry>" + shape + "</geometry>" + material + "</visual>";
}
constexpr const char* kCube = R"(<box size="1 1 1"/>)";

// The robot's warnings without "FILE:".
std::vector<std::string> warnings_of(const UrdfScene& scene) {
  std::vector<std::string> warnings;
  for (const std::string& warning : scene.warnings()) {
    REQUIRE(warning.starts_with(scene.file().string() + ":"));
    warnings.push_back(warning.substr(scene.file().string().size() + 1));
  }
  return warnings;
}

// Two links, "a" with a cube, and one joint between them.
std::string with_joint(const std::string& joint) { return link_xml("a", visual_xml(kCube)) + link_xml("b") + joint; }

Material material_of(UrdfScene& scene, std::size_t item) {
  return *scene.list().materials[scene.list().items.at(item).material];
}

}  // namespace

TEST_CASE("a robot that keeps the format gives no warning") {
  UrdfScene scene(R"(<material name="red"><color rgba="1 0 0 1"/></material>)" +
                  link_xml("a", visual_xml(kCube, R"(<material name="red"/>)") +
                                    visual_xml(kCube, R"(<material name=""><color rgba="1 0 0 1"/></material>)") +
                                    visual_xml(kCube, R"(<material name=""><color rgba="0 1 0 1"/></material>)")) +
                  link_xml("b") +
                  joint_xml("j", "revolute", "a", "b", R"(<limit lower="0" upper="0" effort="1" velocity="1"/>)"));
  CHECK(scene.warnings().empty());
  CHECK(scene.list().items.size() == 3);
}

TEST_CASE("visuals without a size or a known shape are left out") {
  const std::string rest = " whose size is not above 0; the visual is left out";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"(<box size="1 0 1"/>)", "has a box" + rest},
      {R"(<cylinder radius="0" length="1"/>)", "has a cylinder" + rest},
      {R"(<cylinder radius="1" length="0"/>)", "has a cylinder" + rest},
      {R"(<sphere radius="-1"/>)", "has a sphere" + rest},
      {R"(<mesh filename="m.stl" scale="1 0 1"/>)", "has a mesh" + rest},
      {R"(<mesh filename=""/>)", "has a mesh without a filename; the visual is left out"},
      {R"(<capsule radius="1" length="0"/>)", "has a capsule" + rest},
      {R"(<cone radius="1" length="1"/>)",
       "has a visual of kind \"cone\", expected box, cylinder, capsule, sphere or mesh; the visual is left out"},
      {"", "has a visual without a geometry; the visual is left out"}};
  for (const auto& [shape, warning] : cases) {
    CAPTURE(shape);
    UrdfScene scene(link_xml("a", visual_xml(kCube) + visual_xml(shape)));
    CHECK(warnings_of(scene) == std::vector<std::string>{"3:74: link \"a\" " + warning});
    CHECK(scene.list().items.size() == 1);
  }
}

TEST_CASE("capsules, text before a shape, and commas between numbers") {
  UrdfScene text(link_xml("a", visual_xml(std::string(" text ") + kCube)));
  CHECK(text.warnings().empty());
  CHECK(text.list().items.size() == 1);

  UrdfScene capsule(link_xml("a", visual_xml(kCube) + visual_xml(R"(<capsule radius="0.25" length="1"/>)")));
  CHECK(capsule.warnings().empty());
  REQUIRE(capsule.list().items.size() == 2);
  const Mesh& mesh = *capsule.list().meshes[capsule.list().items[1].mesh];
  REQUIRE(mesh.surface);
  CHECK(mesh.surface->kind == SurfaceKind::capsule);
  CHECK(mesh.surface->radius_m == 0.25);
  CHECK(mesh.surface->length_m == 1);

  UrdfScene commas(link_xml("a",
                            R"(<visual><origin xyz="1, 2,3" rpy="0,0,0"/><geometry><box size="1,1, 1"/></geometry>)"
                            "</visual>"));
  REQUIRE(commas.list().items.size() == 1);
  CHECK(glm::dvec3(commas.list().world_from_node[commas.list().items[0].transform][3]) == glm::dvec3(1, 2, 3));
  REQUIRE(commas.warnings().size() == 1);
  CHECK(
      contains(commas.warnings()[0],
               "element <origin> has commas between the numbers of xyz; they are read as spaces, here and in others"));
}

TEST_CASE("names with dots and slashes are names of insertion points and elements") {
  UrdfScene scene(link_xml("arm.0/base") + link_xml("hand.left", visual_xml(kCube)) +
                      joint_xml("fl.hx/1", "continuous", "arm.0/base", "hand.left", R"(<axis xyz="0 0 1"/>)"),
                  "<sensor type='camera' name='C' insert_at='hand.left'/>");
  CHECK(scene.warnings().empty());
  CHECK(scene.built().scene.has_insertion_point("arm.0/base"));
  CHECK(scene.built().parameters.name(scene.built().parameters.index("fl.hx/1", "value")) == "fl.hx/1.value");
  scene.set("fl.hx/1", 90);
  CHECK(scene.place(0) == matrix_from_degrees({0, 0, 0}, 0, 0, 90));
}

TEST_CASE("joints: mimic of a fixed joint, limits the wrong way round or absent") {
  UrdfScene fixed(with_joint(joint_xml("j", "fixed", "a", "b", R"(<mimic joint="x"/>)")));
  CHECK(warnings_of(fixed) ==
        std::vector<std::string>{"5:66: joint \"j\" is fixed and mimics another one; the mimic is ignored"});
  CHECK(fixed.built().parameters.elements().empty());

  UrdfScene lost(with_joint(joint_xml("j", "continuous", "a", "b", R"(<mimic joint="x"/>)")));
  CHECK(warnings_of(lost) ==
        std::vector<std::string>{"5:71: joint \"j\" mimics joint \"x\", which is not there; it moves by itself"});
  CHECK(lost.built().parameters.elements().at(0).type == "joint");

  UrdfScene turned(
      with_joint(joint_xml("j", "prismatic", "a", "b", R"(<limit lower="2" upper="1" effort="1" velocity="1"/>)")));
  CHECK(warnings_of(turned) ==
        std::vector<std::string>{"5:70: joint \"j\" has a lower limit above its upper one; it is left open"});
  CHECK(turned.built().parameters.values()[0] == 0);
  turned.set("j", -50);

  UrdfScene huge(with_joint(joint_xml("j", "revolute", "a", "b", R"(<limit lower="-1e16" upper="1e16"/>)")));
  CHECK(huge.warnings().empty());
  huge.set("j", -1e6);

  UrdfScene ball(with_joint(joint_xml("j", "spherical", "a", "b")) + link_xml("c") +
                 joint_xml("k", "spherical", "b", "c"));
  CHECK(warnings_of(ball) ==
        std::vector<std::string>{"5:2: joint \"j\" is spherical, as only Bullet's robots are; it is a ball joint, "
                                 "here and in others"});
  CHECK(ball.built().parameters.elements().at(0).type == "pose");

  UrdfScene absent(with_joint(joint_xml("j", "revolute", "a", "b")));
  CHECK(warnings_of(absent) == std::vector<std::string>{"5:2: joint \"j\" has no limits; it is left open"});
  absent.set("j", 1000);
}

TEST_CASE("what is not read may be wrong: mass, collision, damping, effort") {
  UrdfScene scene(link_xml("a", visual_xml(kCube) + "<inertial><mass/></inertial><collision><geometry/></collision>"
                                                    R"(<collision><geometry><box size="x"/></geometry></collision>)") +
                  link_xml("b") +
                  joint_xml("j", "revolute", "a", "b",
                            R"(<limit lower="0" upper="1" effort="none"/><dynamics/><safety_controller/>)"));
  CHECK(scene.warnings().empty());
  CHECK(scene.list().items.size() == 1);
}

TEST_CASE("materials that are defined nowhere, twice, later or without a name") {
  UrdfScene nowhere(
      link_xml("a", visual_xml(kCube, R"(<material name="m"/>)") + visual_xml(kCube, R"(<material name="m"/>)")));
  CHECK(warnings_of(nowhere) ==
        std::vector<std::string>{"3:65: link \"a\" has the material \"m\", which is not defined; it is shown grey"});
  const float grey = linear_from_srgb(0.5);
  CHECK(material_of(nowhere, 1).base_color == glm::vec4(grey, grey, grey, 1));

  const std::string red = R"(<material name="m"><color rgba="1 0 0 1"/></material>)";
  const std::string blue = R"(<material name="m"><color rgba="0 0 1 1"/></material>)";
  UrdfScene twice(red + "\n" + blue + link_xml("a", visual_xml(kCube, R"(<material name="m"/>)")));
  CHECK(warnings_of(twice) ==
        std::vector<std::string>{"4:2: material \"m\" is defined again in another way; the first definition counts"});
  CHECK(material_of(twice, 0).base_color == glm::vec4(1, 0, 0, 1));

  UrdfScene same(red + red + link_xml("a", visual_xml(kCube, red) + visual_xml(kCube, red)));
  CHECK(same.warnings().empty());
  UrdfScene of_visuals(link_xml("a", visual_xml(kCube, red) + visual_xml(kCube, blue)));
  CHECK(of_visuals.warnings().size() == 1);
  CHECK(material_of(of_visuals, 1).base_color == glm::vec4(1, 0, 0, 1));

  UrdfScene later(link_xml("a", visual_xml(kCube, R"(<material name="m"/>)")) + link_xml("b", visual_xml(kCube, blue)) +
                  joint_xml("j", "fixed", "a", "b"));
  CHECK(later.warnings().empty());
  CHECK(material_of(later, 0).base_color == glm::vec4(0, 0, 1, 1));

  UrdfScene unnamed(link_xml("a", visual_xml(kCube, R"(<material><color rgba="0 1 0 1"/></material>)")));
  CHECK(unnamed.warnings().empty());
  CHECK(material_of(unnamed, 0).base_color == glm::vec4(0, 1, 0, 1));
}

TEST_CASE("colours of three numbers are opaque, and wrong ones grey") {
  const float grey = linear_from_srgb(0.5);
  const std::vector<std::tuple<std::string, std::string, glm::vec4>> cases = {
      {"0 1 0", "opaque", {0, 1, 0, 1}},
      {"0.15 0.15 0.15 0 1", "shown grey", {grey, grey, grey, 1}},
      {"2 0 0 1", "shown grey", {grey, grey, grey, 1}},
      {"0 0 -1 1", "shown grey", {grey, grey, grey, 1}},
      {"1 0", "shown grey", {grey, grey, grey, 1}},
      {"0 nan 0 1", "shown grey", {grey, grey, grey, 1}}};
  for (const auto& [rgba, instead, color] : cases) {
    CAPTURE(rgba);
    UrdfScene scene(link_xml("a", visual_xml(kCube, "<material name=\"m\"><color rgba=\"" + rgba + "\"/></material>")));
    CHECK(warnings_of(scene) == std::vector<std::string>{"3:84: material \"m\" has rgba \"" + rgba +
                                                         "\", expected four numbers from 0 to 1; it is " + instead});
    CHECK(material_of(scene, 0).base_color == color);
  }
}

TEST_CASE("a missing, broken or foreign mesh leaves its visual out; a robot without any visual is refused") {
  const auto mesh = [](const std::string& name) { return visual_xml("<mesh filename=\"" + name + "\"/>"); };
  UrdfScene missing(link_xml("a", visual_xml(kCube) + mesh("package://pkg/m.stl")));
  REQUIRE(missing.warnings().size() == 1);
  CHECK(contains(warnings_of(missing)[0],
                 "3:2: link \"a\": a visual is left out, mesh file \"package://pkg/m.stl\" is not there; tried "
                 "ROS_PACKAGE_PATH"));
  CHECK(missing.list().items.size() == 1);

  UrdfScene foreign(link_xml("a", visual_xml(kCube) + mesh("r.urdf")));
  REQUIRE(foreign.warnings().size() == 1);
  CHECK(contains(foreign.warnings()[0],
                 "\"r.urdf\" is of an unknown kind, expected .dae, .zae, .obj, .ply, .stl, .gltf or .glb"));

  CHECK(contains(error_of([&] { UrdfScene scene(link_xml("a", mesh("m.stl"))); }),
                 "r.urdf: none of its visuals can be shown: mesh file \"m.stl\" is not there; tried /"));
}

TEST_CASE("a mesh whose scale is one number") {
  const std::map<std::string, std::string> files = {{"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}};
  const auto mesh = [&](const std::string& scale) {
    return link_xml("a", visual_xml("<mesh filename=\"m.obj\" scale=\"" + scale + "\"/>"));
  };
  UrdfScene one(mesh(" .5"), files);
  REQUIRE(one.warnings().size() == 1);
  CHECK(contains(warnings_of(one)[0], "link \"a\" has a mesh whose scale is the one number 0.5; it is taken for all"));
  UrdfScene three(mesh("0.5 0.5 0.5"), files);
  CHECK(three.warnings().empty());
  CHECK(one.list().world_from_node == three.list().world_from_node);
  CHECK(contains(error_of([&] { UrdfScene scene(mesh("1 2"), files); }), "scale"));
}

TEST_CASE("glTF is a mesh of a robot too, with the axes that it is written in, as an OBJ has") {
  GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 2, 0})}});
  const ByteString glb = builder.glb();
  const std::map<std::string, std::string> files = {{"m.GLB", std::string(glb.begin(), glb.end())}};
  UrdfScene scene(link_xml("a", visual_xml("<mesh filename=\"m.GLB\"/>")), files);
  CHECK(scene.warnings().empty());
  REQUIRE(scene.list().items.size() == 1);
  CHECK(scene.place(0) * glm::dvec4(0, 2, 0, 1) == glm::dvec4(0, 2, 0, 1));
  const std::map<std::string, std::string> obj = {{"m.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"}};
  UrdfScene plain(link_xml("a", visual_xml("<mesh filename=\"m.obj\"/>")), obj);
  CHECK(plain.list().world_from_node[plain.list().items[0].transform] * glm::dvec4(0, 2, 0, 1) ==
        scene.place(0) * glm::dvec4(0, 2, 0, 1));
}

TEST_CASE("zero bytes behind the robot are left out") {
  TemporaryFolder folder;
  const std::string text = robot(link_xml("a", visual_xml(kCube)));
  write_text(folder / "r.urdf", text + std::string(3, '\0'));
  ContentPool pool;
  const PartContent content = import_part(folder / "r.urdf", pool);
  CHECK(test::flatten(content).items.size() == 1);
  REQUIRE(content.warnings.size() == 1);
  CHECK(contains(content.warnings[0], "r.urdf: 3 zero bytes at its end are left out"));
  write_text(folder / "r.urdf", std::string(2, '\0') + text);
  CHECK(contains(error_of([&] { import_part(folder / "r.urdf", pool); }), "r.urdf:1:1"));
}

TEST_CASE("a missing or broken picture gives way to the colour") {
  const std::string material = R"(<material name="m"><color rgba="1 0 0 1"/><texture filename="m.png"/></material>)";
  UrdfScene missing(link_xml("a", visual_xml(kCube, material) + visual_xml(kCube, material)));
  REQUIRE(missing.warnings().size() == 1);
  CHECK(contains(warnings_of(missing)[0],
                 "link \"a\": the material's colour replaces its texture, picture \"m.png\" is not there; tried /"));
  CHECK(material_of(missing, 1).base_color == glm::vec4(1, 0, 0, 1));

  UrdfScene broken(link_xml("a", visual_xml(kCube, R"(<material name="m"><texture filename="r.urdf"/></material>)")));
  REQUIRE(broken.warnings().size() == 1);
  CHECK(contains(broken.warnings()[0], "r.urdf: the picture is of no known kind"));
}

TEST_CASE("a joint's limit is accepted as people round it, and no more") {
  const std::string turn = R"(<limit lower="-3.14159" upper="3.14159" effort="1" velocity="1"/>)";
  UrdfScene scene(with_joint(joint_xml("j", "revolute", "a", "b", turn)));
  const double limit_deg = scene.built().parameters.spec(0).max;
  CHECK(limit_deg == doctest::Approx(179.99985).epsilon(1e-7));  // the digits that are written here
  scene.set("j", 180);
  CHECK(scene.built().parameters.values()[0] == limit_deg);
  scene.set("j", -180);
  CHECK(scene.built().parameters.values()[0] == -limit_deg);
  CHECK(contains(error_of([&] { scene.set("j", 180.001); }), "j.value: 180.001 is not allowed"));
  UrdfScene slide(with_joint(
      joint_xml("j", "prismatic", "a", "b", R"(<limit lower="0" upper="0.0399996" effort="1" velocity="1"/>)")));
  slide.set("j", 0.04);
  CHECK(slide.built().parameters.values()[0] == 0.0399996);
  CHECK(contains(error_of([&] { slide.set("j", 0.0401); }), "is not allowed"));
}

TEST_CASE("axes of mesh files: as written, or as the part says") {
  const TemporaryFolder folder;
  write_text(folder / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_text(folder / "r.urdf", robot(link_xml("a", visual_xml(R"(<mesh filename="m.obj"/>)"))));
  const auto world_from_mesh = [&](const std::string& up) {
    BuiltScene built = build_scene(
        parse_commands("<part file='r.urdf' name='R' insert_at='ROOT' " + up + "/>", "s.xml", folder.path()));
    Flattener flattener(built.scene.root());
    const DrawList& list = flattener.update();
    return list.world_from_node[list.items.at(0).transform];
  };
  CHECK(world_from_mesh("") == glm::dmat4(1));
  CHECK(world_from_mesh("up='z'") == glm::dmat4(1));
  CHECK(world_from_mesh("up='y'") * glm::dvec4(0, 1, 0, 1) == glm::dvec4(0, 0, 1, 1));
}

TEST_CASE("copies of a robot have names of the same kind, whatever their order") {
  const std::string content =
      link_xml("base") + link_xml("hand") + joint_xml("j", "continuous", "base", "hand", R"(<axis xyz="0 0 1"/>)");
  UrdfScene one(content);
  CHECK(one.built().parameters.elements().at(0).name == "j");
  UrdfScene two(content, "<part file='./r.urdf' name='B' insert_at='ROBOT/hand'/>");
  REQUIRE(two.built().parameters.elements().size() == 2);
  CHECK(two.built().parameters.elements()[0].name == "ROBOT/j");
  CHECK(two.built().parameters.elements()[1].name == "B/j");
  CHECK(two.built().scene.has_insertion_point("ROBOT/hand"));
  CHECK(!two.built().scene.has_insertion_point("hand"));
  CHECK(contains(error_of([&] { two.set("j", 1); }), "there is no element \"j\", did you mean \"ROBOT/j\"?"));
}

TEST_SUITE_END();
