// Materials, meshes, lights and sensors of SDF worlds.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/sdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Two triangles, each in a group of its own, with one material: 1 x 1 m at the origin and at x = 4.
constexpr const char* kTwoGroups =
    "mtllib two.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 4 0 0\nv 5 0 0\nv 4 1 0\n"
    "o near\nf 1 2 3\no far\nf 4 5 6\n";
constexpr const char* kPaint = "newmtl paint\nKd 0 0 1\n";

std::string visible_model(const std::string& content) {
  return sdf_world("<model name='m'><link name='l'>" + content + "</link></model>");
}

std::string material_xml(const std::string& content) { return "<material>" + content + "</material>"; }

glm::vec4 linear(double r, double g, double b, double a = 1) {
  return {linear_from_srgb(r), linear_from_srgb(g), linear_from_srgb(b), static_cast<float>(a)};
}

// The smallest and largest corner of what an item draws, in the world.
std::pair<glm::dvec3, glm::dvec3> box_of(SdfScene& scene, std::size_t item) {
  glm::dvec3 low(1e9), high(-1e9);
  for (const glm::vec3& position : scene.mesh(item).positions) {
    const glm::dvec3 at(scene.place(item) * glm::dvec4(position, 1));
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  return {low, high};
}

}  // namespace

TEST_CASE("<laser_retro> of a visual is the gain of a retro-reflector, whatever its shape and material") {
  const std::string retro = "<laser_retro>25</laser_retro>", mesh = "<mesh><uri>two.obj</uri></mesh>";
  const std::string red = material_xml("<diffuse>1 0 0 1</diffuse>");
  SdfScene scene(visible_model(sdf_box("1 1 1", retro) + sdf_box("1 1 1", red + retro) + sdf_visual(mesh, retro) +
                               sdf_visual(mesh, red + retro) + sdf_visual(mesh) + sdf_box("1 1 1", red)),
                 {{"two.obj", kTwoGroups}, {"two.mtl", kPaint}});
  CHECK(scene.warnings().empty());
  std::vector<float> gains;
  for (std::size_t item = 0; item < scene.list().items.size(); ++item) {
    gains.push_back(scene.material(item).retro_reflectance);
  }
  CHECK(gains == std::vector<float>{25, 25, 25, 25, 25, 25, 0, 0, 0});
  SdfScene wrong(visible_model(sdf_box("1 1 1", "<laser_retro>-1</laser_retro>") + sdf_box("1 1 1")));
  REQUIRE(wrong.warnings().size() == 1);
  CHECK(contains(wrong.warnings()[0], "element <laser_retro> is -1, expected a number from 0 to 1e+09"));
}

TEST_CASE("colours of SDF are sRGB; metal has metalness and roughness; transparency fades") {
  SdfScene plain(
      visible_model(sdf_box("1 1 1", material_xml("<ambient>1 0 0 1</ambient><diffuse>0.2 0.4 0.6 1</diffuse>"
                                                  "<emissive>0.1 0 0 1</emissive>") +
                                         "<transparency>0.25</transparency>")));
  CHECK(plain.warnings().empty());
  CHECK(plain.material(0).base_color == linear(0.2, 0.4, 0.6));
  CHECK(plain.material(0).emissive == glm::vec3(linear(0.1, 0, 0)));
  CHECK(plain.material(0).opacity == 0.75f);
  CHECK(plain.material(0).roughness == 1);

  SdfScene metal(visible_model(
      sdf_box("1 1 1", material_xml("<diffuse>1 1 1</diffuse><pbr><metal><metalness>0.75</metalness></metal></pbr>"))));
  CHECK(metal.material(0).metallic == 0.75f);
  CHECK(metal.material(0).roughness == 0.5f);  // SDF's default

  SdfScene faint(visible_model(sdf_box("1 1 1", material_xml("<diffuse>1 0 0 0.5</diffuse>"))));
  CHECK(faint.material(0).alpha_mode == AlphaMode::blend);
  CHECK(faint.material(0).base_color == linear(1, 0, 0, 0.5));

  SdfScene gone(visible_model(sdf_box("1 1 1", material_xml("<diffuse>1 0 0 0</diffuse>"))));
  CHECK(gone.material(0).base_color == linear(1, 0, 0));
  const std::string xml =
      "<model name='m'><link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box></geometry>"
      "<material><";
  CHECK(gone.warnings() == std::vector<std::string>{"4:" + std::to_string(xml.size() + 1) +
                                                    ": the colour is wholly transparent; it is read as opaque"});
}

TEST_CASE("numbers of SDF colours above 1 are divided by 255, each for itself, as in Gazebo") {
  SdfScene scene(visible_model(sdf_box("1 1 1", material_xml("<diffuse>51 1 204 255</diffuse>"))));
  CHECK(scene.material(0).base_color == linear(0.2, 1, 0.8));
  REQUIRE(scene.warnings().size() == 1);
  CHECK(contains(scene.warnings()[0], "a colour has numbers above 1, which are divided by 255 as in Gazebo"));
}

TEST_CASE("scripts name Gazebo's colours, or materials of OGRE beside the model") {
  const auto script = [](const std::string& uri, const std::string& name) {
    return visible_model(
        sdf_box("1 1 1", material_xml("<script><uri>" + uri + "</uri><name>" + name + "</name></script>")));
  };
  SdfScene grey(script("file://media/materials/scripts/gazebo.material", "Gazebo/Grey"));
  CHECK(grey.warnings().empty());
  CHECK(grey.material(0).base_color == linear(0.7, 0.7, 0.7));

  const SdfTestFiles files = {
      {"models/x/model.config", "<model/>"},
      {"models/x/model.sdf", sdf_model("<model name='x'/>")},
      {"models/x/materials/scripts/x.material",
       "// colours\nmaterial Base\n{\n technique { pass { ambient 1 0 0\n diffuse 0 1 0 1\n } }\n}\n"
       "material Derived : Base { }\nmaterial Lost\n{\n technique\n{\n pass\n{\n diffuse 1 1 0\n"
       " texture_unit\n{\n texture lost.png\n}\n}\n}\n}\n"}};
  SdfScene derived(script("model://x/materials/scripts", "Derived"), files);
  CHECK(derived.warnings().empty());
  CHECK(derived.material(0).base_color == linear(0, 1, 0));
  SdfScene lost(script("model://x/materials/scripts/x.material", "Lost"), files);
  CHECK(lost.material(0).base_color == linear(1, 1, 0));
  REQUIRE(lost.warnings().size() == 1);
  CHECK(contains(lost.warnings()[0], "texture \"lost.png\" of material \"Lost\" is not there"));

  SdfScene unknown(script("file://nowhere", "Somebody/Paint"));
  REQUIRE(unknown.warnings().size() == 1);
  CHECK(contains(unknown.warnings()[0], "material \"Somebody/Paint\" of a script is not known"));
  CHECK(unknown.list().items.size() == 1);
}

TEST_CASE("Gazebo's own scripts are found by GAZEBO_RESOURCE_PATH, and an unknown one gives one warning") {
  const TemporaryFolder gazebo;
  std::filesystem::create_directories(gazebo / "media/materials/scripts");
  write_text(gazebo / "media/materials/scripts/gazebo.material",
             "material Gazebo/Wood\n{\n technique\n{\n pass\n{\n diffuse 0.5 0.25 0 1\n}\n}\n}\n");
  const std::string wood = material_xml(
      "<script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Wood</name></script>");
  const std::string model = visible_model(sdf_box("1 1 1", wood) + sdf_box("2 2 2", wood));
  ::unsetenv("GAZEBO_RESOURCE_PATH");
  SdfScene without(model);
  REQUIRE(without.warnings().size() == 1);
  CHECK(without.warnings()[0].ends_with("keeps its own look; this is so 2 times"));
  ::setenv("GAZEBO_RESOURCE_PATH", ("/nowhere:" + gazebo.path().string()).c_str(), 1);
  SdfScene with_gazebo(model);
  ::unsetenv("GAZEBO_RESOURCE_PATH");
  CHECK(with_gazebo.warnings().empty());
  CHECK(with_gazebo.material(0).base_color == linear(0.5, 0.25, 0));
}

TEST_CASE("glTF in a world keeps the axes that it is written in") {
  GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 2, 0})}});
  const ByteString glb = builder.glb();
  const SdfTestFiles files = {{"m.glb", std::string(glb.begin(), glb.end())}};
  SdfScene scene(visible_model(sdf_visual("<mesh><uri>m.glb</uri></mesh>")), files);
  CHECK(scene.warnings().empty());
  CHECK(box_of(scene, 0) == std::pair(glm::dvec3(0), glm::dvec3(1, 2, 0)));
  SdfScene turned(visible_model(sdf_visual("<mesh><uri>m.glb</uri></mesh>")), files, "", "up='y'");
  CHECK(box_of(turned, 0) == std::pair(glm::dvec3(0), glm::dvec3(1, 0, 2)));
}

TEST_CASE("a submesh of COLLADA is the node of this name, whatever its id") {
  const auto node = [](const std::string& attributes, const std::string& x, const std::string& inner) {
    return "<node " + attributes + "><translate>" + x + " 0 0</translate>" + inner + "</node>";
  };
  const std::string mesh = "<instance_geometry url='#geom'/>";
  const std::string dae =
      "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
      "<asset><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id='geom' name='Left'><mesh><source id='p'>"
      "<float_array id='pa' count='9'>0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source='#pa' "
      "count='3' "
      "stride='3'><param name='X' type='float'/><param name='Y' type='float'/><param name='Z' type='float'/></accessor>"
      "</technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles "
      "count='1'><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles></mesh></geometry>"
      "</library_geometries><library_visual_scenes><visual_scene id='s'>" +
      node("id='n1' name='Left'", "10", mesh) + node("id='n3' name='Other'", "40", mesh) +
      node("id='n2' name='Right'", "20", node("id='bare'", "5", mesh)) +
      "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
  const auto left_of = [&](const std::string& submesh) {
    SdfScene scene(
        visible_model(sdf_visual("<mesh><uri>m.dae</uri><submesh><name>" + submesh + "</name></submesh></mesh>")),
        {{"m.dae", dae}});
    CHECK(scene.list().items.size() == 1);
    return box_of(scene, 0).first.x;
  };
  CHECK(left_of("Right") == 25);  // the mesh of a node without a name belongs to the one around it
  CHECK(left_of("bare") == 25);   // and is found by its id, which Gazebo does not
  CHECK(left_of("Left") == 10);   // the node alone, not all that shows the mesh of this name
  // A node that has a name is not found by its id.
  CHECK(contains(error_of([&] { left_of("n1"); }), "names the submesh \"n1\", which the file does not have"));
}

TEST_CASE("a mesh has its scale, its submesh, and the visual's material in place of its own") {
  const SdfTestFiles files = {{"meshes/two.obj", kTwoGroups}, {"meshes/two.mtl", kPaint}};
  const auto mesh = [](const std::string& more) { return "<mesh><uri>meshes/two.obj</uri>" + more + "</mesh>"; };
  SdfScene whole(visible_model(sdf_visual(mesh("<scale>2 1 1</scale>"))), files);
  CHECK(whole.warnings().empty());
  REQUIRE(whole.list().items.size() == 2);
  CHECK(box_of(whole, 0).second == glm::dvec3(2, 1, 0));
  CHECK(box_of(whole, 1).second == glm::dvec3(10, 1, 0));
  CHECK(whole.material(0).base_color == linear(0, 0, 1));

  SdfScene far(visible_model(sdf_visual(mesh("<submesh><name>far</name></submesh>"))), files);
  REQUIRE(far.list().items.size() == 1);
  CHECK(box_of(far, 0) == std::pair(glm::dvec3(4, 0, 0), glm::dvec3(5, 1, 0)));
  SdfScene centred(visible_model(sdf_visual(mesh("<submesh><name>far</name><center>true</center></submesh>"))), files);
  CHECK(box_of(centred, 0) == std::pair(glm::dvec3(-0.5, -0.5, 0), glm::dvec3(0.5, 0.5, 0)));
  const std::string missing = sdf_visual(mesh("<submesh><name>none</name></submesh>"));
  SdfScene none(visible_model(missing + sdf_box("1 1 1")), files);
  CHECK(none.list().items.size() == 1);
  REQUIRE(none.warnings().size() == 1);
  CHECK(contains(none.warnings()[0],
                 "names the submesh \"none\", which the file does not have; a visual of link \"l\" is left out"));

  SdfScene painted(visible_model(sdf_visual(mesh(""), material_xml("<diffuse>1 0 0 1</diffuse>")) +
                                 sdf_visual(mesh(""), "<transparency>0.5</transparency>")),
                   files);
  REQUIRE(painted.list().items.size() == 4);
  CHECK(painted.material(0).base_color == linear(1, 0, 0));
  CHECK(painted.material(2).base_color == linear(0, 0, 1));
  CHECK(painted.material(2).opacity == 0.5f);
}

TEST_CASE("pictures of a PBR material become its maps") {
  SdfScene lost(
      visible_model(sdf_box("1 1 1", material_xml("<diffuse>1 0 0</diffuse><pbr><metal><albedo_map>a.png"
                                                  "</albedo_map><roughness_map>r.png</roughness_map></metal></pbr>"))));
  REQUIRE(lost.warnings().size() == 2);
  CHECK(contains(lost.warnings()[0], "picture \"a.png\" is not there"));
  CHECK(contains(lost.warnings()[1], "element <roughness_map> of a material is not taken over"));
  CHECK(lost.material(0).base_color == linear(1, 0, 0));
}

TEST_CASE("lights have their place, direction and strength") {
  SdfScene scene(sdf_world(
      "<light name='sun' type='directional'><direction>-1 0 -1</direction><diffuse>1 0.5 0 1</diffuse>"
      "<cast_shadows>true</cast_shadows></light>"
      "<light name='lamp' type='point'><pose>1 2 3 0 0 0</pose><intensity>2</intensity><attenuation><range>20</range>"
      "<constant>0.5</constant><linear>0.1</linear><quadratic>0.02</quadratic></attenuation></light>"
      "<model name='m'><pose>5 0 0 0 0 0</pose><link name='l'><light name='spot' type='spot'>"
      "<pose>0 0 1 0 0 0</pose><direction>0 1 0</direction><spot><inner_angle>0.4</inner_angle>"
      "<outer_angle>0.8</outer_angle></spot></light></link></model>"));
  CHECK(scene.warnings().empty());
  const std::string spot = "m/l/spot";
  CHECK(scene.value("sun", "azimuth") == 0);
  CHECK(scene.value("sun", "elevation") == doctest::Approx(45).epsilon(1e-14));
  CHECK(scene.value("sun", "intensity") == std::numbers::pi);
  CHECK(scene.value("sun", "green") == decode_srgb(0.5));
  CHECK(scene.value("lamp", "x") == 1);
  CHECK(scene.value("lamp", "range") == 20);
  // At 3 m, SDF's light is 2 / (0.5 + 0.3 + 0.18); that of I candela is I / 3^2 / pi on a white surface.
  CHECK(scene.value("lamp", "intensity") == doctest::Approx(std::numbers::pi * 9 * 2 / 0.98).epsilon(1e-14));
  CHECK(scene.value(spot, "yaw") == 90);
  CHECK(scene.value(spot, "z") == 1);
  CHECK(scene.value(spot, "outer_cone") == doctest::Approx(0.4 * 180 / std::numbers::pi).epsilon(1e-14));
  const DrawList& list = scene.list();
  REQUIRE(list.lights.size() == 3);
  std::size_t with_shadows = 0;
  for (const LightItem& item : list.lights) with_shadows += item.light.shadow_px > 0 ? 1 : 0;
  CHECK(with_shadows == 1);
}

TEST_CASE("a scene's background and ambient light become a sky") {
  SdfScene scene(sdf_world("<scene><ambient>0.4 0.4 0.4 1</ambient><background>0.7 0.7 0.7 1</background></scene>"));
  CHECK(scene.value("sky", "red") == decode_srgb(0.7));
  CHECK(scene.value("sky", "ambient_blue") == 0.4 / std::numbers::pi);
}

TEST_CASE("cameras and scanners of links become sensors named after the link") {
  SdfScene scene(sdf_world(
      "<model name='m'><link name='l.1'>"
      "<sensor name='eye' type='camera'><pose>1 0 0 0 0 0</pose><update_rate>15</update_rate><camera>"
      "<horizontal_fov>1.5707963267948966</horizontal_fov><image><width>32</width><height>24</height></image>"
      "<clip><near>0.02</near><far>9</far></clip><distortion><k1>0.1</k1></distortion></camera></sensor>"
      "<sensor name='d' type='depth_camera'><camera/></sensor><sensor name='rgbd' type='rgbd_camera'><camera/></sensor>"
      "<sensor name='a/b' type='gpu_lidar'><update_rate>10</update_rate><lidar><scan><horizontal><samples>5</samples>"
      "<min_angle>-1.5707963267948966</min_angle><max_angle>1.5707963267948966</max_angle></horizontal>"
      "<vertical><samples>3</samples><resolution>1</resolution><min_angle>-0.1</min_angle><max_angle>0.1</max_angle></"
      "vertical></scan>"
      "<range><min>0.1</min><max>inf</max></range><noise><type>gaussian</type><stddev>0.01</stddev></noise></lidar>"
      "</sensor></link></model>"));
  CHECK(scene.warnings().empty());
  const std::string eye = "m/l_1/eye", lidar = "m/l_1/a_b";
  CHECK(scene.sensor(eye, "width") == "32");
  CHECK(scene.sensor(eye, "hfov") == "90");
  CHECK(scene.sensor(eye, "near") == "0.02");
  CHECK(scene.sensor(eye, "rate") == "15");
  CHECK(scene.sensor(eye, "k1") == "0.1");
  CHECK(scene.sensor(eye, "outputs") == "color");
  CHECK(scene.sensor(eye, "pose_offset") == "1 0 0");
  CHECK(scene.sensor("m/l_1/d", "outputs") == "depth");
  CHECK(scene.sensor("m/l_1/rgbd", "outputs") == "color depth");
  CHECK(scene.sensor(lidar, "samples") == "5");
  CHECK(scene.sensor(lidar, "vertical_samples") == "3");
  CHECK(scene.sensor(lidar, "min_angle") == "-90");
  CHECK(scene.sensor(lidar, "range_noise") == "0.01");
  CHECK(scene.sensor(lidar, "range_max") == "1000000");
}

TEST_CASE("a lidar on a joint measures the walls of the world") {
  const TemporaryFolder folder;
  // Walls at x = 3 and at y = 2, seen from a lidar that a joint turns by 90 degrees.
  write_text(folder / "w.world",
             sdf_world("<model name='walls'><link name='l'>" + sdf_box("1 20 2", "<pose>3.5 0 0 0 0 0</pose>") +
                       sdf_box("20 1 2", "<pose>0 2.5 0 0 0 0</pose>") +
                       "</link></model><model name='robot'><link name='base'/><link name='head'/>"
                       "<joint name='neck' type='continuous'><parent>base</parent><child>head</child><axis>"
                       "<xyz>0 0 1</xyz></axis></joint></model>"));
  std::string text = read_text(folder / "w.world");
  const std::string sensor =
      "<link name='head'><sensor name='scan' type='ray'><ray><scan><horizontal><samples>3</samples>"
      "<min_angle>-0.5</min_angle><max_angle>0.5</max_angle></horizontal></scan><range><min>0.1</min><max>10</max>"
      "</range></ray></sensor></link>";
  const std::string link = "<link name='head'/>";
  write_text(folder / "w.world", text.replace(text.find(link), link.size(), sensor));
  Simulation simulation =
      Simulation::from_string("<part file='w.world' name='W' insert_at='ROOT'/>", SimulationDesc{}, folder.path());
  const auto check_ranges = [&](double distance_m) {
    simulation.step();
    const Scan& scan = simulation.scan("robot/head/scan");
    REQUIRE(scan.range_m.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected_m = distance_m / std::cos(scan.azimuth_rad[i]);
      // The bound, and the rounding of the printed range to float32.
      CHECK(std::abs(scan.range_m[i] - expected_m) <= scan.error_bound_m[i] + 1e-6);
    }
  };
  check_ranges(3);
  simulation.set("robot/neck", "value", 90);
  check_ranges(2);
}
