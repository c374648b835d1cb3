// References of COLLADA that lead nowhere: of texture coordinates, normals, vertices and instances.
#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string source_of(const std::string& id, const std::string& values, int count, const std::string& axes) {
  std::string parameters;
  for (const char axis : axes) parameters += std::string("<param name=\"") + axis + "\" type=\"float\"/>";
  const std::string stride = std::to_string(axes.size());
  return "<source id=\"" + id + "\"><float_array id=\"" + id + "a\" count=\"" +
         std::to_string(count * static_cast<int>(axes.size())) + "\">" + values +
         "</float_array><technique_common><accessor source=\"#" + id + "a\" count=\"" + std::to_string(count) +
         "\" stride=\"" + stride + "\">" + parameters + "</accessor></technique_common></source>\n";
}

// Two triangles of a square of 2 m: texture coordinates stand first, then vertices, then normals, then colours.
std::string square() {
  return std::string(
             "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
             "version=\"1.4.1\"><asset>") +
         kMetresZUp + "</asset>\n<library_geometries><geometry id=\"g\"><mesh>\n" +
         source_of("p", "0 0 0 2 0 0 2 2 0 0 2 0", 4, "XYZ") + source_of("n", "0 0.6 0.8 0 0 1", 2, "XYZ") +
         source_of("t", "0 0 1 0 1 1 0 1", 4, "ST") + source_of("c", "1 0 0 0 1 0", 2, "RGB") +
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n"
         "<triangles count=\"2\"><input semantic=\"TEXCOORD\" source=\"#t\" offset=\"0\" set=\"0\"/>"
         "<input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/><input semantic=\"NORMAL\" source=\"#n\" "
         "offset=\"2\"/>"
         "<input semantic=\"COLOR\" source=\"#c\" offset=\"3\"/>"
         "<p>0 0 0 0 1 1 0 1 2 2 0 0 0 0 0 1 2 2 0 0 3 3 1 1</p></triangles>\n"
         "</mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id=\"s\">"
         "<node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

std::string square_with(const std::string& before, const std::string& after) {
  std::string text = square();
  const std::size_t at = text.find(before);
  REQUIRE(at != std::string::npos);
  return text.replace(at, before.size(), after);
}

}  // namespace

TEST_CASE("COLLADA: what names no texture coordinates, normals or colours of the file is left out") {
  const TemporaryFolder folder;
  write_text(folder / "whole.dae", square());
  const Mesh whole = *load(folder / "whole.dae").list.meshes.at(0);
  REQUIRE(whole.indices.size() == 6);
  REQUIRE(whole.attributes[whole.indices[1]].uv[0] != glm::vec2(0));
  REQUIRE(whole.attributes[0].normal != glm::vec3(0, 0, 1));
  REQUIRE(whole.attributes[0].color != glm::vec4(1));
  struct Kind {
    const char *semantic, *id;
  };
  for (const Kind kind : {Kind{"TEXCOORD", "t"}, Kind{"NORMAL", "n"}, Kind{"COLOR", "c"}}) {
    const std::string input = std::string("semantic=\"") + kind.semantic + "\" source=\"", id = kind.id;
    const std::string array = "accessor source=\"", few = "count=\"" + std::string(id == "t" ? "4" : "2") + "\" stride";
    const std::string accessor = array + "#" + id + "a\" ";
    const std::vector<std::pair<std::string, std::string>> faults{
        {input + "#" + id, input + "#gone"},
        {input + "#" + id, input + "#v"},
        {accessor, array + "#gone\" "},
        {accessor + few, accessor + "count=\"1\" stride"},
    };
    for (const auto& fault : faults) {
      const std::string &before = fault.first, &after = fault.second;
      CAPTURE(after);
      write_text(folder / "a.dae", square_with(before, after));
      const Loaded loaded = load(folder / "a.dae");
      REQUIRE(loaded.warnings.size() == 1);
      CHECK(contains(loaded.warnings[0], "they are left out"));
      const Mesh& mesh = *loaded.list.meshes.at(0);
      REQUIRE(mesh.indices.size() == 6);
      for (std::size_t i = 0; i < 6; ++i) {
        CAPTURE(i);
        const VertexAttributes &own = mesh.attributes[mesh.indices[i]], &of_whole = whole.attributes[whole.indices[i]];
        CHECK(mesh.positions[mesh.indices[i]] == whole.positions[whole.indices[i]]);
        CHECK(own.uv[0] == (id == "t" ? VertexAttributes().uv[0] : of_whole.uv[0]));
        CHECK(own.normal == (id == "n" ? glm::vec3(0, 0, 1) : of_whole.normal));
        CHECK(own.color == (id == "c" ? glm::vec4(1) : of_whole.color));
      }
    }
    for (const auto& unmarked : {std::pair{input + "#" + id, input + id}, {accessor, array + id + "a\" "}}) {
      CAPTURE(unmarked.second);
      write_text(folder / "a.dae", square_with(unmarked.first, unmarked.second));
      const Loaded loaded = load(folder / "a.dae");
      CHECK(loaded.warnings.empty());
      CHECK(loaded.list.meshes.at(0)->attributes == whole.attributes);
    }
  }
}

TEST_CASE("COLLADA: positions that are not there are an error at the place that names them") {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& before, const std::string& after) {
    write_text(folder / "a.dae", square_with(before, after));
    return error_of([&] { load(folder / "a.dae"); });
  };
  CHECK(contains(error("source=\"#v\"", "source=\"#gone\""), "a.dae:9:"));
  CHECK(contains(error("source=\"#v\"", "source=\"#gone\""), "\"#gone\" is not in the file"));
  CHECK(contains(error("source=\"#v\"", "source=\"#p\""), "\"#p\" is a source, expected the id of vertices"));
  CHECK(contains(error("source=\"#p\"", "source=\"#gone\""), "a.dae:8:"));
  CHECK(contains(error("<input semantic=\"POSITION\" source=\"#p\"/>", ""), "no input of the semantic POSITION"));
  CHECK(contains(error("accessor source=\"#pa\"", "accessor source=\"#gone\""), "accessor of \"#gone\""));
  CHECK(contains(error("<p>0 0 0 0", "<p>0 4 0 0"), "a.dae:9:2: error: triangles names the vertex 4, but there are 4"));
  for (const auto& unmarked : {std::pair{"source=\"#v\"", "source=\"v\""},
                               {"source=\"#p\"", "source=\"p\""},
                               {"source=\"#pa\"", "source=\"pa\""},
                               {"url=\"#g\"", "url=\"g\""}}) {
    CAPTURE(std::string(unmarked.second));
    CHECK(error(unmarked.first, unmarked.second) == "nothing was thrown");
  }
}

TEST_CASE("COLLADA: instances of nodes and geometries that are not there are left out with a warning") {
  const TemporaryFolder folder;
  const std::string instance = "<instance_geometry url=\"#g\"/>";
  write_text(folder / "a.dae",
             square_with(instance, instance + "<instance_geometry url=\"#h\"/><instance_node url=\"#n\"/>"));
  const Loaded loaded = load(folder / "a.dae");
  CHECK(loaded.list.items.size() == 1);
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "reference \"#h\" (and 1 more): names no node or geometry of the file"));
}

TEST_CASE("COLLADA: elements that lead nowhere and contain others are left out with them") {
  const TemporaryFolder folder;
  const std::string instance = "<instance_geometry url=\"#g\"/>", normals = "source=\"#n\" offset=\"2\"";
  const std::string input = "<input semantic=\"NORMAL\" source=\"#gone\" offset=\"2\"";
  struct Case {
    std::string before, after, warning;
  };
  const std::vector<Case> cases{
      {instance, instance + "<instance_node url=\"#x\"><instance_node url=\"#y\"/></instance_node>",
       "reference \"#x\" (and 1 more): names no node or geometry"},
      {instance, instance + "<instance_geometry url=\"#x\"><input/><accessor/></instance_geometry>",
       "reference \"#x\": names no node or geometry"},
      {"<input semantic=\"NORMAL\" " + normals + "/>", input + ">" + input + "/></input>",
       "reference \"#gone\": names no values"}};
  for (const Case& each : cases) {
    CAPTURE(each.after);
    write_text(folder / "a.dae", square_with(each.before, each.after));
    const Loaded loaded = load(folder / "a.dae");
    CHECK(loaded.list.items.size() == 1);
    REQUIRE(loaded.warnings.size() == 1);
    CHECK(contains(loaded.warnings[0], each.warning));
  }
}
