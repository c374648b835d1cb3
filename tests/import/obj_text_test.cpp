// OBJ files and material files as other programs read them. `d` is the opacity and `Tr` is 1 - opacity (three.js'
// MTLLoader, Assimp, tinyobjloader); where both stand and contradict each other, tinyobjloader, which Gazebo uses,
// takes `d`. MeshLab writes the opacity as `Tr` (vcglib, export_obj.h: `Tr 1.000000` for opaque materials).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

TEST_CASE("MTL: opacity as exporters mean it") {
  struct Idiom {
    const char *head, *lines;
    double opacity;
    const char* warning;  // empty: none
  };
  const char* meshlab = "#\n# Wavefront material file\n# Converted by Meshlab Group\n#\n\n";
  const Idiom idioms[] = {
      {"", "Tr 1.0\n", 1, "is wholly transparent; it is read as opaque"},
      {"", "d 0\n", 1, "is wholly transparent; it is read as opaque"},
      {"", "d 0.0\nTr 1.0\n", 1, "is wholly transparent; it is read as opaque"},
      {"", "d 1.0\nTr 1.0\n", 1, "d and Tr contradict each other; d is taken"},
      {"", "d 0.25\nTr 0.25\n", 0.25, "d and Tr contradict each other; d is taken"},
      {meshlab, "Tr 1.000000\n", 1, "MeshLab writes the opacity as Tr"},
      {meshlab, "Tr 0.750000\n", 0.75, "MeshLab writes the opacity as Tr"},
      {"", "Tr 0.25\n", 0.75, ""},
      {"", "d 0.25\n", 0.25, ""},
      {"", "d 0.75\nTr 0.25\n", 0.75, ""},
      {"", "Tr 0\n", 1, ""},
      {meshlab, "d 0.5\n", 0.5, ""},
      {meshlab, "Tr 0.5\n", 0.5, ""},
  };
  TemporaryFolder folder;
  write_text(folder / "a.obj", "mtllib a.mtl\nusemtl paint\n" + obj_box());
  for (const Idiom& idiom : idioms) {
    CAPTURE(std::string(idiom.head));
    CAPTURE(std::string(idiom.lines));
    write_text(folder / "a.mtl", std::string(idiom.head) + "newmtl other\nKd 1 1 1\nnewmtl paint\nKd 1 0 0\n" +
                                     idiom.lines + "illum 2\n");
    const Loaded loaded = load(folder / "a.obj");
    check_box(loaded.list);
    const Material& material = *loaded.list.materials.at(0);
    CHECK(material.name == "paint");
    CHECK(material.base_color.r == 1);
    CHECK(material.base_color.g == 0);
    CHECK(static_cast<double>(material.base_color.a) == idiom.opacity);
    REQUIRE(loaded.warnings.size() == (*idiom.warning != '\0' ? 1 : 0));
    if (loaded.warnings.empty()) continue;
    const int line = *idiom.head != '\0' ? 10 : 5;
    CHECK(contains(loaded.warnings[0], "a.mtl:" + std::to_string(line)));
    CHECK(contains(loaded.warnings[0], std::string("material \"paint\": ") + idiom.warning));
  }
}

TEST_CASE("OBJ: a material file outside the folders of the part is not read") {
  TemporaryFolder folder;
  std::filesystem::create_directories(folder / "model/part/below");
  const std::string mtl = "newmtl m\nKd 1 0 0\n";
  write_text(folder / "outside.mtl", mtl);
  write_text(folder / "model/beside.mtl", mtl);
  write_text(folder / "model/part/below/inside.mtl", mtl);
  const auto load_with = [&](const std::string& name) {
    write_text(folder / "model/part/a.obj", "mtllib " + name + "\nusemtl m\n" + obj_box());
    return load(folder / "model/part/a.obj");
  };
  CHECK(load_with("below/inside.mtl").list.materials.at(0)->base_color.g == 0);
  CHECK(load_with("below/../below/inside.mtl").list.materials.at(0)->base_color.g == 0);
  CHECK(load_with("../beside.mtl").list.materials.at(0)->base_color.g == 0);
  for (const std::string& name : {std::string("../../outside.mtl"), std::string("below/../../../outside.mtl")}) {
    CAPTURE(name);
    const Loaded loaded = load_with(name);
    CHECK(loaded.list.materials.at(0)->base_color.g > 0);
    REQUIRE(loaded.warnings.size() >= 1);
    CHECK(contains(loaded.warnings[0], "outside the folders of the part and is not read"));
  }
  // Assimp looks for an absolute name below the folder, as it looks for every name.
  CHECK(load_with((folder / "outside.mtl").string()).list.materials.at(0)->base_color.g > 0);
}

TEST_CASE("OBJ: faces that name texture coordinates which the file does not have") {
  TemporaryFolder folder;
  write_text(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1//1 2//1 3//1\n");
  const Loaded loaded = load(folder / "a.obj");
  const Totals totals = total(loaded.list);
  CHECK(totals.triangles == 2);
  CHECK(totals.surface_m2 == 1);
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "a.obj:5: faces name texture coordinates, but the file has none"));
  write_text(folder / "b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/3\n");
  CHECK(total(load(folder / "b.obj").list).triangles == 1);
}

TEST_CASE("OBJ and MTL with a byte order mark or in UTF-16") {
  TemporaryFolder folder;
  const std::string obj = "mtllib box.mtl\nusemtl m\n" + obj_box(), mtl = "newmtl m\nKd 1 0 0\n";
  const auto in_utf16 = [](const std::string& text, bool big_endian, bool with_mark) {
    std::string bytes;
    const auto add = [&](int code) {
      const char low = static_cast<char>(code & 255), high = static_cast<char>(code >> 8);
      bytes += {big_endian ? high : low, big_endian ? low : high};
    };
    if (with_mark) add(0xfeff);
    for (const char c : text) add(c);
    return bytes;
  };
  const auto read = [&](const std::string& obj_bytes, const std::string& mtl_bytes) {
    write_text(folder / "box.obj", obj_bytes);
    write_text(folder / "box.mtl", mtl_bytes);
    Loaded loaded = load(folder / "box.obj");
    check_box(loaded.list);
    CHECK(loaded.list.materials.at(0)->base_color == glm::vec4(1, 0, 0, 1));
    return loaded.warnings;
  };
  const std::string mark = "\xef\xbb\xbf";
  CHECK(read(mark + obj, mark + mtl).empty());
  for (const bool big_endian : {false, true}) {
    for (const bool with_mark : {false, true}) {
      const std::vector<std::string> warnings =
          read(in_utf16(obj, big_endian, with_mark), in_utf16(mtl, big_endian, with_mark));
      REQUIRE(warnings.size() == 2);
      CHECK(contains(warnings[0], "box.obj: is text in UTF-16"));
      CHECK(contains(warnings[1], "box.mtl: is text in UTF-16"));
    }
  }
}

TEST_CASE("OBJ: each way to write the same two triangles") {
  TemporaryFolder folder;
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::pair<const char*, std::string> ways[] = {
      {"a polygon", v + "f 1 2 3 4\n"},
      {"triangles", v + "f 1 2 3\nf 1 3 4\n"},
      {"negative numbers", v + "f -4 -3 -2 -1\n"},
      {"faces before vertices", "f 1 2 3 4\n" + v},
      {"lines that go on", v + "f 1 2 \\\n3\\\r\n 4\n"},
      {"CR LF", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3 4\r\n"},
      {"CR", "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3 4"},
      {"no end of the last line", v + "f 1 2 3 4"},
      {"a comment that ends with a backslash", "# C:\\out\\\n" + v + "f 1 2 3 4\n"},
      {"comments", "# 1\n" + v + "f 1 2 3 4 # 1\n"},
      {"tabs and spaces", "  v\t0 0 0 \nv 1  0\t0\nv 1 1 0\nv 0 1 0\n f\t1 2  3 4 \n"},
      {"signs and exponents", "v +0 -0 0e0\nv 1e0 0 1e-60\nv +1.0E+0 1. 0\nv 0 1 0\nf 1 2 3 4\n"},
      {"homogeneous coordinates", "v 0 0 0 1\nv 2 0 0 2\nv 1 1 0 1\nv 0 0.5 0 0.5\nf 1 2 3 4\n"},
      {"three texture coordinates", v + "vt 0 0 0\nvt 0.5\nf 1/1 2/2 3/1 4/2\n"},
      {"words that are ignored", v + "s 1\nlod 2\nvp 0 0\nf 1 2 3 4\n"},
      {"the old word for faces", v + "fo 1 2 3 4\n"}};
  for (const auto& way : ways) {
    CAPTURE(std::string(way.first));
    write_text(folder / "a.obj", way.second);
    const Loaded loaded = load(folder / "a.obj");
    const Totals totals = total(loaded.list);
    CHECK(totals.triangles == 2);
    CHECK(totals.surface_m2 == 1);
    CHECK(totals.max == glm::dvec3(1, 1, 0));
    CHECK(loaded.list.meshes.at(0)->attributes.at(0).normal == glm::vec3(0, 0, 1));
    CHECK(loaded.warnings.empty());
  }
}

TEST_CASE("OBJ: objects, groups and materials divide the faces") {
  TemporaryFolder folder;
  write_text(folder / "a b.mtl", "newmtl my red\nKd 1 0 0\nnewmtl grey\nKd 0.5\n");
  std::string vertices;
  for (int i = 0; i < 10; ++i) vertices += "v " + std::to_string(i) + " " + std::to_string(i * i) + " 0\n";
  write_text(folder / "a.obj", "mtllib a b.mtl\n" + vertices +
                                   "f 1 2 3\nusemtl my red\nf 2 3 4\nf 3 4 5\nusemtl my red\nf 4 5 6\no one\nf 5 6 7\n"
                                   "g two\nusemtl grey\nf 6 7 8\ng two\nf 7 8 9\nusemtl unknown\nf 8 9 10\n");
  const Loaded loaded = load(folder / "a.obj");
  CHECK(loaded.warnings.empty());
  struct Run {
    std::string mesh, material;
    std::size_t triangles;
    bool operator==(const Run&) const = default;
  };
  std::vector<Run> runs;
  for (const DrawItem& item : loaded.list.items) {
    const Mesh& mesh = *loaded.list.meshes[item.mesh];
    runs.push_back({mesh.name, loaded.list.materials[item.material]->name, mesh.indices.size() / 3});
  }
  CHECK(runs.size() == 5);
  CHECK(runs == std::vector<Run>{{"defaultobject", "", 1},
                                 {"my red", "my red", 3},
                                 {"one", "my red", 1},
                                 {"two", "grey", 2},
                                 {"two", "unknown", 1}});
}

TEST_CASE("errors of OBJ and MTL have their line") {
  TemporaryFolder folder;
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  const std::pair<std::string, std::string> cases[] = {
      {v + "f 1 2 9\n", "a.obj:6: error: a face has the vertex 9, which is out of range: the file has 3"},
      {v + "f 1/2 2/1 3/1\n",
       "a.obj:6: error: a face has the texture coordinate 2, which is out of range: the file has 1"},
      {v + "f 1//1 2//1 3//4\n", "a.obj:6: error: a face has the normal 4, which is out of range: the file has 1"},
      {v + "\nf 1 2 -4\n", "a.obj:7: error: a face has the vertex -4, but 3 come before it"},
      {v + "f 1 2 0\n", "a.obj:6: error: a face has the corner \"0\", expected V, V/VT, V//VN or V/VT/VN"},
      {v + "f 1 2 3x\n", "a.obj:6: error: a face has the corner \"3x\""},
      {v + "f 1 2 3/1/1/1\n", "a.obj:6: error: a face has the corner \"3/1/1/1\""},
      {v + "f 1 2 99999999999999999999\n", "a.obj:6: error: a face has the corner \"99999999999999999999\""},
      {"v 0 0 zero\n", "a.obj:1: error: a vertex has \"zero\" in place of a number"},
      {"v 0 \\\n0 \\\nx\n", "a.obj:1: error: a vertex has \"x\" in place of a number"},
      {"v 0\n", "a.obj:1: error: a vertex has 1 numbers, expected 3, 4, or 6 with a colour"},
      {"v 0 0 0 0 0 0 0 0\n", "a.obj:1: error: a vertex has too many numbers"},
      {"v 0 0 1e39\n" + v + "f 1 2 3\n", "a.obj:1: error: vertex 1 is not finite"},
      {v + "v 0 0 1 0\nf 1 2 4\n", "a.obj:6: error: vertex 4 is not finite"},
      {"vn 0 0\n", "a.obj:1: error: a normal has 2 numbers, expected 3"},
      {"vt 0 0 0 0\n", "a.obj:1: error: a texture coordinate has 4 numbers, expected 1, 2 or 3"},
      {"mtllib a.mtl\nusemtl m\n" + v + "f 1 2 3\n", "a.mtl:2: error: material \"m\" has \"x\" in place of a number"}};
  write_text(folder / "a.mtl", "newmtl m\nKd 1 x 1\n");
  for (const auto& each : cases) {
    CAPTURE(each.first);
    write_text(folder / "a.obj", each.first);
    CHECK(contains(error_of([&] { load(folder / "a.obj"); }), each.second));
  }
  // What nothing shows may be wrong: a vertex, and the normals of a file without any.
  write_text(folder / "b.obj", "v nan 0 0\n" + v + "f 2 3 4\n");
  CHECK(total(load(folder / "b.obj").list).triangles == 1);
  write_text(folder / "c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n");
  CHECK(contains(load(folder / "c.obj").warnings.at(0), "c.obj:4: faces name normals, but the file has none"));
}

TEST_CASE("OBJ: the material file of the same name stands in for one that is not there") {
  TemporaryFolder folder;
  write_text(folder / "a.mtl", "newmtl m\nKd 1 0 0\n");
  write_text(folder / "a.obj", "mtllib lost.mtl\nusemtl m\n" + obj_box());
  const Loaded loaded = load(folder / "a.obj");
  CHECK(loaded.list.materials.at(0)->base_color == glm::vec4(1, 0, 0, 1));
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], ": is not there"));
}

TEST_CASE("OBJ: many faults of one kind are one warning, and take time that grows with the file alone") {
  TemporaryFolder folder;
  std::string lines, materials;
  constexpr int kMany = 50000;
  for (int i = 0; i < kMany; ++i) {
    const std::string number = std::to_string(i);
    lines += "mtllib lost" + number + ".mtl\no object" + number + "\ng group" + number + "\n";
    materials += "newmtl m" + number + "\nKd spectral a\nKe 1 1 1\nmap_Kd -s 2 2 2 red.png\nmap_d alpha.png\n";
  }
  write_text(folder / "a.mtl", materials);
  write_text(folder / "a.obj", lines + "usemtl m1\n" + obj_box() + "usemtl m2\nf 1 2 3\n");
  const Loaded loaded = load(folder / "a.obj");
  for (const char* const warning : {"material file \"", "a colour that is not in RGB is left out",
                                    "the transformation of its picture is left out"}) {
    CAPTURE(warning);
    CHECK(std::ranges::count_if(loaded.warnings, [&](const auto& each) { return each.find(warning) != each.npos; }) ==
          1);
  }
  CHECK(contains(loaded.warnings.at(0), "(and "));
  CHECK(loaded.warnings.size() < 10);
  CHECK(loaded.list.items.size() == 2);  // nothing stands for a name without faces
}

TEST_CASE("MTL: options of pictures, colours of one number, and lines without a picture") {
  TemporaryFolder folder;
  write_text(folder / "my red.ppm", std::string("P6\n1 1\n255\n\xff\0\0", 14));
  write_text(folder / "a.obj", "mtllib a.mtl\nusemtl m\n" + obj_box());
  const std::pair<const char*, std::size_t> lines[] = {
      {"map_Kd my red.ppm", 0},          {"map_Kd -mm 0 1 my red.ppm", 0},
      {"map_Kd -t 1 1 1 my red.ppm", 0}, {"map_Kd -blendu on my red.ppm", 0},
      {"map_Kd -s 2 2 1 my red.ppm", 1}, {"map_Kd -o 0.5 my red.ppm", 1}};
  for (const auto& each : lines) {
    CAPTURE(std::string(each.first));
    write_text(folder / "a.mtl", std::string("newmtl m\nKd 1\n") + each.first + "\n");
    const Loaded loaded = load(folder / "a.obj");
    CHECK(loaded.warnings.size() == each.second);
    CHECK(loaded.list.materials.at(0)->base_color == glm::vec4(1));
    REQUIRE(loaded.list.materials.at(0)->base_color_texture != nullptr);
  }
  write_text(folder / "a.mtl", "newmtl m\nKd 0.5\nmap_Kd\nmap_Kd \n");
  const Loaded none = load(folder / "a.obj");
  CHECK(none.warnings.empty());
  CHECK(none.list.materials.at(0)->base_color_texture == nullptr);
}

TEST_CASE("missing normals are a warning only where the file has normals and a face needs one") {
  TemporaryFolder folder;
  const auto warnings = [&](const std::string& text) {
    write_text(folder / "a.obj", text);
    return load(folder / "a.obj").warnings;
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\n";
  const std::vector<std::string> some = warnings(corners + "f 1//1 2//1 3//1\nf 1//2 3//2 2//2\nf 1//2 2//2 3//2\n");
  REQUIRE(some.size() == 1);
  CHECK(contains(some[0], "a.obj: normals that are zero or not finite are replaced by their face's"));
  CHECK(warnings(corners + "f 1//2 2//2 3//2\n").empty());
  CHECK(warnings(corners + "f 1//1 2//1 3//1\nf 1//2 2//2 2//2\n").empty());
}

TEST_SUITE_END();
