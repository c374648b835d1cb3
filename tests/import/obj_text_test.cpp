// OBJ files and material files as other programs read them. `d` is the opacity and `Tr` is 1 - opacity (three.js'
// MTLLoader, Assimp, tinyobjloader); where both stand and contradict each other, tinyobjloader, which Gazebo uses,
// takes `d`. MeshLab writes the opacity as `Tr` (vcglib, export_obj.h: `Tr 1.000000` for opaque materials).
#include <doctest/doctest.h>

#include <cmath>
#include <string>

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
