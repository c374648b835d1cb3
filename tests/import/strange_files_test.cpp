// Files that Coin or Assimp would refuse as a whole, or crash on, for something that other programs read over or name.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/inventor_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

const std::string kVrmlBox = "Shape { geometry Box { size 1 2 3 } }\n";

std::string vrml_error(InventorFiles& files, const std::string& nodes) {
  return error_of([&] { files.vrml(nodes); });
}

std::string place_in(const InventorFiles& files, const std::string& rest) {
  return (files.folder / "part.wrl").string() + rest;
}

std::vector<std::string> part_warnings(const TemporaryFolder& folder, const std::string& file) {
  return build_scene(parse_commands("<part file='" + file + "' name='P' insert_at='ROOT'/>", "s.xml", folder.path()))
      .scene.warnings();
}

// A COLLADA file of one triangle. `parts` stand beside its geometry, `nodes` in its scene.
std::string collada(const std::string& parts, const std::string& nodes, const std::string& offset = "") {
  return "<COLLADA version=\"1.4.1\"><asset><up_axis>Z_UP</up_axis></asset>\n"
         "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"9\">0 0 0 1 0 0 "
         "0 "
         "1 0</float_array><technique_common><accessor source=\"#a\" count=\"3\" stride=\"3\"" +
         offset +
         "><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/>"
         "</accessor></technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/>"
         "</vertices><triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p>"
         "</triangles></mesh></geometry></library_geometries>\n" +
         parts + "\n<library_visual_scenes><visual_scene id=\"s\">" + nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}
const std::string kTriangleNode = "<node><instance_geometry url=\"#g\"/></node>";

}  // namespace

TEST_CASE("a point set of VRML97 has the points of its own field") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart part =
      files.vrml("Shape { geometry PointSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 2 0 ] } } }");
  const PartMeasure seen = measure(part.list);
  CHECK(seen.points == 3);
  CHECK(seen.max == glm::dvec3(1, 2, 0));
}

TEST_CASE("unknown fields and nodes of VRML97 are left out, with the first place of each") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart fields = files.vrml(
      "Shape { appearance Appearance { material Material { gloss [ 1 2 ] diffuseColor 1 0 0\n gloss 3 } shader Fancy "
      "{ a { b \"}\" } } } # gloss\n geometry Box { size 1 2 3 } }");
  CHECK(fields.content.warnings ==
        std::vector<std::string>{
            place_in(files, ":2:53: field \"gloss\" of a node \"Material\" is unknown; it is left out (and 1 more)"),
            place_in(files, ":3:12: field \"shader\" of a node \"Appearance\" is unknown; it is left out")});
  CHECK(measure(fields.list).triangles == 12);
  CHECK(glm::vec3(material_of(fields, 0).base_color) == glm::vec3(1, 0, 0));

  const LoadedPart nodes = files.vrml("Group { children [ DEF F Fancy { a 1 b [ 1 2 ] c Shape { } }\n" + kVrmlBox +
                                      "USE F Fancy { } ] }\nDEF T TimeSensor { }\nROUTE T.time TO F.time");
  CHECK(nodes.content.warnings ==
        std::vector<std::string>{place_in(files, ":2:26: node \"Fancy\" is unknown; it is left out (and 1 more)")});
  CHECK(measure(nodes.list).triangles == 12);
  // What Coin refuses for another reason keeps Coin's message and its line.
  CHECK(contains(vrml_error(files, kVrmlBox + "Shape { geometry Box { size 1 2"), "line   4"));
}

TEST_CASE("fields of prototypes, scripts and events are no unknown ones") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart part = files.vrml(
      "PROTO Block [ field SFVec3f edges 1 1 1 exposedField SFNode look Material { } eventIn SFBool go ] {\n"
      " Group { children [ Shape { appearance Appearance { material IS look } geometry Box { size IS edges } }\n"
      " Script { field SFFloat own 1 eventIn SFBool hit url \"javascript:\" } ] } }\nBlock { edges 1 2 3 }");
  for (const std::string& warning : part.content.warnings) {
    CHECK(warning.find("is unknown") == std::string::npos);  // Coin has no interpreter for the script
  }
  CHECK(measure(part.list).max == glm::dvec3(0.5, 1, 1.5));
}

TEST_CASE("an EXTERNPROTO of a file that is not there is left out with its nodes") {
  if (!has_coin()) return;
  InventorFiles files;
  write_text(files.folder / "block.wrl",
             kVrml97Header + "PROTO Block [ field SFFloat a 1 ] { Shape { geometry Box { } } }");
  const LoadedPart found = files.vrml("EXTERNPROTO Block [ field SFFloat a ] \"block.wrl#Block\"\nBlock { a 2 }");
  CHECK(found.content.warnings.empty());
  CHECK(measure(found.list).triangles == 12);
  const LoadedPart lost = files.vrml(
      "EXTERNPROTO Block [ field SFFloat a ] [ \"urn:x\" \"none.wrl#Block\" ]\nBlock { "
      "a 2 }\n" +
      kVrmlBox);
  CHECK(lost.content.warnings == std::vector<std::string>{place_in(
                                     files,
                                     ":2:1: EXTERNPROTO \"Block\" names the file \"urn:x\", which is not there, and "
                                     "has no nodes; it is left out")});
  CHECK(measure(lost.list).triangles == 12);
}

TEST_CASE("a circle in a VRML file is named") {
  if (!has_coin()) return;
  InventorFiles files;
  CHECK(contains(vrml_error(files, "Shape { }\nDEF A Group { children [ USE A ] }"),
                 "part.wrl:3:26: error: node \"A\" is used within itself: a circle of DEF and USE"));
  CHECK(contains(vrml_error(files, "PROTO P [ ] { Group { children P { } } }\nP { }"),
                 "part.wrl:2:32: error: PROTO \"P\" uses itself: a circle of prototypes"));
  write_text(files.folder / "other.wrl", kVrml97Header + "Inline { url \"part.wrl\" }");
  const std::string error = vrml_error(files, "Inline { url \"other.wrl\" }");
  CHECK(contains(error, "files include each other in a circle: "));
  CHECK(error.find("Coin") == std::string::npos);
  CHECK(contains(error, "part.wrl, " + (files.folder / "other.wrl").string() + ", "));
  // One file twice is no circle.
  write_text(files.folder / "box.wrl", kVrml97Header + kVrmlBox);
  CHECK(measure(files.vrml("Inline { url \"box.wrl\" }\nInline { url \"box.wrl\" }").list).triangles == 24);
}

TEST_CASE("a part that holds nothing says so, whatever its format") {
  const TemporaryFolder folder;
  write_text(folder / "a.iv", kInventorHeader + "Separator { Material { } }");
  write_text(folder / "a.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{}]})");
  write_text(folder / "a.xml", "<mujoco><worldbody/></mujoco>");
  write_text(folder / "a.sdf", "<sdf version='1.6'><world name='w'/></sdf>");
  for (const std::string file : {"a.gltf", "a.iv", "a.xml", "a.sdf"}) {
    if (file == "a.iv" && !has_coin()) continue;
    CAPTURE(file);
    CHECK(part_warnings(folder, file) ==
          std::vector<std::string>{(folder / file).string() + ": holds nothing to show"});
  }
  write_text(folder / "a.dae", collada("", "<node/>"));
  CHECK(contains(error_of([&] { part_warnings(folder, "a.dae"); }), "a.dae: holds nothing to draw"));
  write_text(folder / "a.obj", "# nothing");
  CHECK(contains(error_of([&] { part_warnings(folder, "a.obj"); }), "a.obj: holds nothing to draw"));
  write_text(folder / "a.urdf", "<robot name='r'><link name='frame'/></robot>");
  CHECK(part_warnings(folder, "a.urdf").empty());  // its link is an insertion point
}

TEST_CASE("COLLADA may have an empty offset, and skins that nothing shows") {
  const TemporaryFolder folder;
  const std::string broken_skin =
      "<library_controllers><controller id=\"c\"><skin source=\"#g\"><source id=\"w\"><technique_common><accessor "
      "source=\"#none\" count=\"-7\"/></technique_common></source></skin></controller></library_controllers>";
  for (const std::string& text : {collada("", kTriangleNode, " offset=\"\""), collada(broken_skin, kTriangleNode)}) {
    write_text(folder / "a.dae", text);
    const Loaded loaded = load(folder / "a.dae");
    CHECK(loaded.warnings.empty());
    REQUIRE(loaded.list.items.size() == 1);
    CHECK(loaded.list.meshes[0]->positions.size() == 3);
  }
}

TEST_CASE("COLLADA nodes in a circle are named") {
  const TemporaryFolder folder;
  write_text(folder / "a.dae", collada("<library_nodes><node id=\"a\"><node><instance_node url=\"#b\"/></node></node>\n"
                                       "<node id=\"b\"><instance_node url=\"#a\"/></node></library_nodes>",
                                       "<node><instance_node url=\"#a\"/></node>"));
  const std::string error = error_of([&] { load(folder / "a.dae"); });
  CHECK(contains(error, "a.dae:4:"));
  CHECK(contains(error, "node \"a\" is within itself: a circle"));
  // A node that several others contain is no circle.
  write_text(folder / "a.dae", collada("<library_nodes><node id=\"a\"><instance_geometry url=\"#g\"/></node><node "
                                       "id=\"b\"><instance_node url=\"#a\"/><instance_node url=\"#a\"/></node>"
                                       "</library_nodes>",
                                       "<node><instance_node url=\"#b\"/><instance_node url=\"#a\"/></node>"));
  CHECK(load(folder / "a.dae").list.items.size() == 3);
}

TEST_CASE("OBJ vertices with two coordinates lie at 0, and PLY vertices may have lists") {
  const TemporaryFolder folder;
  write_text(folder / "a.obj", "v 0 0 5\nv 1 0\nv 0 1 # two\nf 1 2 3\n");
  write_text(folder / "b.obj", "v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n");
  const Loaded flat = load(folder / "b.obj");
  CHECK(flat.warnings == std::vector<std::string>{(folder / "b.obj").string() +
                                                  ":1: vertices have two coordinates; the third is taken as 0"});
  CHECK(flat.list.meshes[0]->positions[1] == glm::vec3(1, 0, 0));

  const std::string header =
      "element vertex 3\nproperty float x\nproperty list uchar short own\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  write_text(folder / "a.ply", "ply\nformat ascii 1.0\n" + header + "0 2 7 8 0 0\n1 0 0 0\n0 1 9 2 0\n3 0 1 2\n");
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
  const auto add = [&](const auto& value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const float places[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  for (const auto& place : places) {
    add(place[0]);
    add(static_cast<unsigned char>(&place - places));  // 0, 1 and 2 numbers
    for (int i = 0; i < &place - places; ++i) add(static_cast<short>(i));
    add(place[1]);
    add(place[2]);
  }
  add(static_cast<unsigned char>(3));
  for (const int corner : {0, 1, 2}) add(corner);
  write_text(folder / "b.ply", binary);
  for (const char* const file : {"a.ply", "b.ply"}) {
    CAPTURE(file);
    const Loaded loaded = load(folder / file);
    CHECK(loaded.warnings.empty());
    CHECK(loaded.list.meshes[0]->positions[2] == glm::vec3(0, 2, 0));
  }
  write_text(folder / "c.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
             "property float z\nproperty list uchar float nx\nend_header\n0 0 0 0\n");
  CHECK(contains(error_of([&] { load(folder / "c.ply"); }), "element vertex has the list \"nx\""));
}

TEST_CASE("VRML 1: unknown nodes and fields are left out") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart part =
      files.load("part.wrl",
                 "#VRML V1.0 ascii\nSeparator { NavigationInfo { type \"WALK\" } ShapeHints { vertexOrdering CLOCKWISE "
                 "shapeType SOLID }\n"
                 "DEF M Material { diffuseColor 0 1 0 mirror 0.5 ambientColor [ 1 1 1 ] reflSpecular [ 1 1 1 ] }\n"
                 "Cube { width 1 } Translation { translation 3 0 0 } Cylinder { parts (SIDES | TOP) radius 1 } }\n");
  CHECK(part.list.items.size() == 2);
  CHECK(material_of(part, 0).base_color == glm::vec4(0, 1, 0, 1));
  REQUIRE(part.content.warnings.size() == 3);
  CHECK(contains(part.content.warnings[0], "part.wrl:3:"));
  for (const char* const what :
       {"node \"NavigationInfo\" is unknown", "field \"mirror\" of a node \"Material\" is unknown",
        "field \"reflSpecular\" of a node \"Material\" is unknown"}) {
    CHECK(std::ranges::any_of(part.content.warnings,
                              [&](const std::string& warning) { return warning.find(what) != warning.npos; }));
  }
}

TEST_CASE("errors of STL text have their line, and not the rest of the file") {
  const TemporaryFolder folder;
  const auto stl = [&](const std::string& corner, const std::string& more) {
    write_text(folder / "a.stl", "solid s\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex " + corner + "\n" +
                                     more + " endloop\nendfacet\n" + "endsolid s\n");
    return error_of([&] { load(folder / "a.stl"); });
  };
  CHECK(contains(stl("1 0 zero", "  vertex 0 1 0\n"), "a.stl:5: error: a vertex has \"zero\" in place of a number"));
  CHECK(stl("1 0 " + std::string(1000, 'x'), "  vertex 0 1 0\n").size() < 200);
  CHECK(contains(stl("1 0 0", ""), "a.stl:2: error: a facet has 2 vertices, expected 3"));
  CHECK(contains(stl("1 0 0x7", "  vertex 0 1 0\n"), "a.stl:5: error: a vertex has \"0x7\" in place of a number"));
  CHECK(contains(stl("1 0 0", "  vertex 0 1 0\n  vertex 0 1 1\n"), "a.stl:7: error: a facet has more than 3 vertices"));
  for (const char* const broken : {"faet", "vertx", "endlop", "1"}) {
    CAPTURE(broken);
    CHECK(contains(stl("1 0 0", std::string("  vertex 0 1 0\n") + broken + "\n"),
                   std::string("a.stl:7: error: has \"") + broken + "\", expected one of facet, normal, outer"));
  }
  write_text(folder / "upper.stl",
             "SOLID a b c\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\n"
             "ENDLOOP\nENDFACET\nendsolid a b c\n");
  CHECK(contains(error_of([&] { load(folder / "upper.stl"); }), "or text that begins with \"solid\""));
  CHECK(stl("+1e0 -.5 nan", "  vertex 0 1 0\n").find("in place of a number") == std::string::npos);
}

TEST_SUITE_END();
