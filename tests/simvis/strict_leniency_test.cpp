// Every leniency in reading strangers' files is a warning, and an error where warnings are errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/inventor_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using test::dae_box;
using test::has_coin;
using test::kMetresZUp;
using test::obj_box;

struct Leniency {
  std::string file;                          // the part's
  std::map<std::string, std::string> files;  // with their content
  std::string warning;                       // a part of it
};

std::string robot_with(const std::string& content) {
  return "<robot name='r'><link name='a'><visual><geometry><box size='1 1 1'/></geometry></visual>" + content +
         "</robot>";
}

std::string sdf_with(const std::string& content) {
  return "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box>"
         "</geometry></visual></link>" +
         content + "</model></sdf>";
}

Leniency robot_leniency(const std::string& content, const std::string& warning) {
  return {"a.urdf", {{"a.urdf", robot_with(content)}}, warning};
}

Leniency sdf_leniency(const std::string& content, const std::string& warning) {
  return {"a.sdf", {{"a.sdf", sdf_with(content)}}, warning};
}

std::string sdf_visual(const std::string& content) {
  return "<link name='k'><visual name='w'>" + content + "</visual></link>";
}

const std::string kSdfBox = "<geometry><box><size>1 1 1</size></box></geometry>";

// A triangle whose bytes are in the file, with more members of the document and of the primitive.
Leniency gltf_leniency(const std::string& document, const std::string& primitive, const std::string& warning,
                       const std::string& node = "") {
  // The positions 0 0 0, 1 0 0, 0 1 0.
  const std::string buffer = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  return {"a.gltf",
          {{"a.gltf",
            R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + node +
                R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0})" + primitive +
                R"(}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],)"
                R"("max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
                buffer + "\"}]" + document + "}"}},
          warning};
}

std::vector<Leniency> gltf_leniencies() {
  const auto material = [](const std::string& properties, const std::string& more, const std::string& warning) {
    return gltf_leniency(R"(,"materials":[{)" + properties + "}]" + more, R"(,"material":0)", warning);
  };
  const std::string picture = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  return {
      gltf_leniency(R"(,"extensionsUsed":["EXT_odd"])", "", "extension EXT_odd is not supported and left out"),
      gltf_leniency(R"(,"extensionsUsed":["KHR_materials_sheen"],"extensionsRequired":["KHR_materials_sheen"])", "",
                    "extension KHR_materials_sheen is not supported and left out"),
      material(R"("extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[1,0,0,1]}})",
               R"(,"extensionsUsed":["KHR_materials_pbrSpecularGlossiness"])", "without their specular colour"),
      material(R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":1}})",
               R"(,"extensionsUsed":["KHR_materials_transmission"])", "are opaque in drawn images"),
      material(picture, R"(,"textures":[{"source":0}],"images":[{"uri":"no.png"}])", "picture \"no.png\" is not there"),
      material(picture, R"(,"textures":[{"source":0}],"images":[{"uri":"a.gltf"}])",
               "the material's colour replaces it"),
      material(picture, R"(,"textures":[{}])", "textures/0 has no picture"),
      material(R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":2}})", R"(,"textures":[{}])",
               "textures with texCoord above 1 are left out"),
      gltf_leniency("", R"(,"mode":1)", "incomplete triangles or lines"),
  };
}

std::vector<Leniency> inventor_leniencies() {
  const auto iv = [](const std::string& nodes, const std::string& warning) {
    return Leniency{"a.iv", {{"a.iv", "#Inventor V2.1 ascii\nSeparator { Cube { } " + nodes + " }\n"}}, warning};
  };
  return {
      iv("Text2 { string \"a\" }", "screen-aligned text (Text2) is left out"),
      iv("NurbsCurve { }", "NURBS curves and surfaces are left out"),
      iv("Texture2 { filename \"no.png\" } Cube { }", "picture \"no.png\" is not there"),
      iv("Texture2 { model BLEND image 1 1 3 0xff0000 } Cube { }", "are drawn as MODULATE"),
  };
}

Leniency obj_with(const std::string& material, const std::string& warning) {
  return {"a.obj",
          {{"a.obj", "mtllib a.mtl\nusemtl m\n" + obj_box()}, {"a.mtl", "newmtl m\nKd 1 0 0\n" + material + "\n"}},
          warning};
}

std::string effect_with(const std::string& rest) { return "<diffuse><color>1 0 0 1</color></diffuse>" + rest; }

std::string utf16(const std::string& text) {
  std::string bytes = "\xff\xfe";
  for (const char c : text) bytes += {c, '\0'};
  return bytes;
}

std::string black_stl() {
  std::string bytes = test::stl_box(true);
  for (std::size_t facet = 0; facet < 12; ++facet) bytes[84 + 50 * facet + 49] = '\x80';
  return bytes;
}

std::vector<Leniency> sdf_leniencies() {
  const std::string link_joint = "<joint name='j' type='revolute'><parent>l</parent><child>l</child>";
  return {
      sdf_leniency("<plugin name='p' filename='p'/>", "element <plugin> is not taken over"),
      sdf_leniency("<link name='k'><sensor name='s' type='logical_camera'/></link>",
                   "sensor of type \"logical_camera\" is not taken over"),
      sdf_leniency("<joint name='j' type='revolute'><parent>l</parent><child>x</child></joint>", "is left out"),
      sdf_leniency(link_joint + "</joint>", "is left out"),
      sdf_leniency("<include><uri>model://none</uri></include>", "the <include> is left out"),
      sdf_leniency("<link name='l'/>", "is there already"),
      sdf_leniency(sdf_visual("<geometry><mesh><uri>no.dae</uri></mesh></geometry>"), "is left out"),
      sdf_leniency(sdf_visual("<geometry><box><size>0 1 1</size></box></geometry>"), "is left out"),
      sdf_leniency(sdf_visual("<cast_shadows>0</cast_shadows>" + kSdfBox), "<cast_shadows> 0 of a visual"),
      sdf_leniency(sdf_visual(kSdfBox + "<material><diffuse>1 0 0 0</diffuse></material>"), "is read as opaque"),
      sdf_leniency(sdf_visual(kSdfBox + "<material><script><name>None/Such</name></script></material>"),
                   "of a script is not known"),
      sdf_leniency("<link name='k'><sensor name='s' type='camera'><camera><image><width>0</width></image></camera>"
                   "</sensor></link>",
                   "the sensor is left out"),
      sdf_leniency("<link name='k'><light name='i' type='odd'/></link>", "the light is left out"),
  };
}

std::vector<Leniency> robot_leniencies() {
  const std::string limits = "<axis xyz='0 0 1'/><limit lower='1' upper='-1' effort='1' velocity='1'/></joint>",
                    ends = "<parent link='a'/><child link='b'/>";
  return {
      robot_leniency("<visual><geometry><mesh filename='no.stl'/></geometry></visual></link>", "a visual is left out"),
      robot_leniency("<visual><geometry><box size='0 1 1'/></geometry></visual></link>", "whose size is not above 0"),
      robot_leniency("<visual><geometry><ball/></geometry></visual></link>", "has a visual of kind \"ball\""),
      robot_leniency("<visual><geometry><box size='1 1 1'/></geometry><material name='x'/></visual></link>",
                     "which is not defined"),
      robot_leniency("</link><link name='b'/><joint name='j' type='revolute'>" + ends + limits, "it is left open"),
      robot_leniency("</link><link name='b'/><joint name='j' type='fixed'><mimic joint='k'/>" + ends + "</joint>",
                     "is fixed and mimics another one"),
      robot_leniency("</link><link name='b'/><joint name='j' type='continuous'><mimic joint='k'/>" + ends + "</joint>",
                     "mimic"),
      robot_leniency("</link><material name='m'><color rgba='1 0 0 1'/></material><material name='m'><color rgba="
                     "'0 1 0 1'/></material>",
                     "is defined again in another way"),
  };
}

std::vector<Leniency> mesh_leniencies() {
  const std::string ply = test::ply_box(test::PlyFormat::text);
  return {
      obj_with("d 0", "is wholly transparent"),
      obj_with("d 0.5\nTr 0.9", "d and Tr contradict each other"),
      obj_with("map_Kd no.png", "picture \"no.png\" is not there"),
      obj_with("map_Kd a.obj", "the material's colour replaces it"),
      {"a.obj", {{"a.obj", "mtllib no.mtl\n" + obj_box()}}, "no.mtl\": is not there"},
      {"a.obj", {{"a.obj", utf16(obj_box())}}, "is text in UTF-16"},
      {"a.stl", {{"a.stl", black_stl()}}, "every colour is 0"},
      {"a.ply",
       {{"a.ply",
         "ply\n" + ply.substr(4, ply.find("end_header") - 4) + "nonsense 1\n" + ply.substr(ply.find("end_header"))}},
       "it is left out"},
      {"a.dae", {{"a.dae", dae_box(kMetresZUp) + std::string(3, '\0')}}, "bytes behind </COLLADA>"},
      {"a.dae",
       {{"a.dae", dae_box(kMetresZUp, 1, "",
                          effect_with("<transparent><color>0 0 0 1</color></transparent><transparency><float>0</float>"
                                      "</transparency>"))}},
       "is wholly transparent"},
      {"a.ply", {{"a.ply", ply + "1 2 3\n"}}, "text after the last element is left out"},
      {"a.dae",
       {{"a.dae", dae_box(kMetresZUp, 1, "", effect_with("<!-- \xe9 -->"))}},
       "are no characters of UTF-8 text; they are read as Windows-1252"},
      {"a.obj", {{"a.obj", "v 0 0 0 1 1 1\nv 1 0 0 nan 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n"}}, "are read as white"},
      {"a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/3\n"}}, "the file has none"},
      obj_with("map_Kd a.obj\nKe 1 1 1", "its emission is multiplied by its picture"),
      {"a.xml",
       {{"a.xml", "<mujoco><worldbody><composite/><geom size='1'/></worldbody></mujoco>"}},
       "<composite> is not taken over"},
      {"a.xml",
       {{"a.xml", "<mujoco><worldbody><geom size='1'/><geom type='box' size='1'/></worldbody></mujoco>"}},
       "the geom is left out"},
  };
}

std::vector<Leniency> leniencies() {
  std::vector<Leniency> all = mesh_leniencies();
  for (const auto& some : {gltf_leniencies(), robot_leniencies(), sdf_leniencies(),
                           has_coin() ? inventor_leniencies() : std::vector<Leniency>()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::vector<std::string> warnings_of(const Leniency& each, bool strict) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : each.files) write_text(folder / name, content);
  const LiveScene scene({},
                        parse_commands("<part file='" + each.file +
                                           "' name='P' insert_at='ROOT'/><sensor type='camera' "
                                           "name='CAM' insert_at='ROOT'/>",
                                       "s.xml", folder.path()),
                        0, {}, {}, strict);
  return scene.built.scene.warnings();
}

TEST_CASE("each leniency is a warning, and an error if the scene is strict") {
  for (const Leniency& each : leniencies()) {
    CAPTURE(each.file);
    CAPTURE(each.warning);
    const std::vector<std::string> warnings = warnings_of(each, false);
    CHECK(std::ranges::any_of(warnings, [&](const std::string& text) { return contains(text, each.warning); }));
    const std::string error = error_of([&] { warnings_of(each, true); });
    CHECK(contains(error, each.warning));
    CHECK(contains(error, "a warning, which is an error here"));
  }
}

}  // namespace
}  // namespace simvis
