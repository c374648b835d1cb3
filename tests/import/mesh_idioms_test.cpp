// STL and PLY files that are legal or usual and that many programs misread.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

// The box with the two bytes behind each facet set, low byte first.
std::string marked_stl(char low, char high) {
  constexpr std::size_t kHeader = 84, kFacet = 50, kAttribute = 48;
  std::string stl = stl_box(true);
  for (std::size_t at = kHeader + kAttribute; at + 1 < stl.size(); at += kFacet) {
    stl[at] = low;
    stl[at + 1] = high;
  }
  return stl;
}

glm::vec4 vertex_color(const Loaded& loaded) { return loaded.list.meshes.at(0)->attributes.at(0).color; }

}  // namespace

// VisCAM and SolidView: bit 15 says that bits 0 to 14 are a colour. The format itself leaves the two bytes without a
// meaning, so a file whose every colour is 0 is taken to have none.
TEST_CASE("STL: facets that are marked as coloured without any colour have none") {
  TemporaryFolder folder;
  write_text(folder / "marked.stl", marked_stl('\0', '\x80'));
  const Loaded marked = load(folder / "marked.stl");
  check_box(marked.list);
  CHECK(vertex_color(marked) == glm::vec4(1));
  REQUIRE(marked.warnings.size() == 1);
  CHECK(contains(marked.warnings[0], "marked.stl: facets are marked as coloured, but every colour is 0"));

  write_text(folder / "red.stl", marked_stl('\0', '\xfc'));  // bits 10 to 14, which are red
  const Loaded red = load(folder / "red.stl");
  CHECK(vertex_color(red) == glm::vec4(1, 0, 0, 1));
  CHECK(red.warnings.empty());

  write_text(folder / "bare.stl", marked_stl('\x12', '\0'));
  CHECK(vertex_color(load(folder / "bare.stl")) == glm::vec4(1));
}

TEST_CASE("PLY: the header's order, empty and unknown lines") {
  TemporaryFolder folder;
  const std::string text = ply_box(PlyFormat::text);
  write_text(folder / "comment.ply", replaced(text, "ply\n", "ply\ncomment before the format\n"));
  const Loaded comment = load(folder / "comment.ply");
  check_box(comment.list);
  CHECK(comment.warnings.empty());
  write_text(folder / "odd.ply", replaced(text, "comment a box\n", "Created by a modeller\n\n"));
  const Loaded odd = load(folder / "odd.ply");
  check_box(odd.list);
  REQUIRE(odd.warnings.size() == 2);
  CHECK(contains(odd.warnings[0], "odd.ply:3: a line of the header is not understood, beginning with \"Created\""));
  CHECK(contains(odd.warnings[1], "odd.ply:4: an empty line in the header"));
}

TEST_CASE("PLY: binary data that begins with a line feed") {
  TemporaryFolder folder;
  for (const PlyFormat format : {PlyFormat::little, PlyFormat::big}) {
    std::string ply = ply_box(format);
    const std::size_t body = ply.find("end_header\n") + 11;
    ply[body] = '\n';  // the first byte of the first vertex' x: 1 + 0x0a * 2^-23 m, or 0x0a800000, about 1.2e-32 m
    write_text(folder / "box.ply", ply);
    const Loaded loaded = load(folder / "box.ply");
    const Totals totals = total(loaded.list);
    CHECK(totals.triangles == 12);
    CHECK(totals.max == glm::dvec3(2, 4, 6));
    CHECK(loaded.warnings.empty());
    for (const std::string ends : {"\r\n"}) {
      write_text(folder / "crlf.ply", replaced(ply, "end_header\n", "end_header" + ends));
      CHECK(total(load(folder / "crlf.ply").list).triangles == 12);
    }
  }
}

TEST_CASE("PLY: whole numbers as coordinates, and lines of white space") {
  TemporaryFolder folder;
  for (const char* const type : {"int", "short", "uchar"}) {
    CAPTURE(type);
    std::string head = "\n \nply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char axis : {'x', 'y', 'z'}) head += std::string("property ") + type + " " + axis + "\n";
    const std::string vertices = "end_header\n\n0 0 0\n \t\n2 0 0\n0 2 0\n";
    write_text(folder / "m.ply",
               head + "element face 1\nproperty list uchar int vertex_indices\n" + vertices + "\n3 0 1 2\n");
    const Loaded mesh = load(folder / "m.ply");
    CHECK(total(mesh.list).surface_m2 == 2);
    CHECK(mesh.warnings.empty());
    write_text(folder / "p.ply", head + vertices);
    CHECK(load(folder / "p.ply").list.meshes.at(0)->positions.size() == 3);
  }
}

TEST_CASE("COLLADA: a skew, and the images of COLLADA 1.5") {
  TemporaryFolder folder;
  const std::string box = dae_box(kMetresZUp);
  const std::string instance = box.substr(box.find("<instance_geometry"));
  // Points move along x by tan(45 degrees) of their y.
  write_text(folder / "skew.dae", replaced(box, instance, "<skew>45 0 1 0 1 0 0</skew>" + instance));
  const Loaded skewed = load(folder / "skew.dae");
  const Loaded plain = [&] {
    write_text(folder / "plain.dae", box);
    return load(folder / "plain.dae");
  }();
  const glm::dvec3 low = total(plain.list).min, high = total(plain.list).max;
  CHECK(glm::length(total(skewed.list).min - (low + glm::dvec3(low.y, 0, 0))) < 1e-6);
  CHECK(glm::length(total(skewed.list).max - (high + glm::dvec3(high.y, 0, 0))) < 1e-6);
  write_text(folder / "far.dae", replaced(box, instance, "<skew>90 0 1 0 1 0 0</skew>" + instance));
  CHECK(contains(error_of([&] { load(folder / "far.dae"); }), "skew turns an axis by 90 degrees"));
  write_text(folder / "red.ppm", std::string("P6\n1 1\n255\n\xff\0\0", 14));
  std::string newer = dae_box(kMetresZUp, 1, "", "<diffuse><texture texture=\"s\" texcoord=\"UV\"/></diffuse>");
  newer = replaced(newer, "<library_effects>",
                   "<library_images><image id=\"i\"><init_from><ref>red.ppm</ref></init_from></image>"
                   "</library_images><library_effects>");
  newer = replaced(newer, "<profile_COMMON>",
                   "<profile_COMMON><newparam sid=\"s\"><sampler2D><instance_image url=\"#i\"/>"
                   "</sampler2D></newparam>");
  newer = replaced(newer, "version=\"1.4.1\"", "version=\"1.5.0\"");
  write_text(folder / "newer.dae", newer);
  const Loaded pictured = load(folder / "newer.dae");
  CHECK(pictured.list.materials.at(0)->base_color_texture != nullptr);
  CHECK(pictured.warnings.empty());
}

TEST_CASE("PLY: nothing uses the number of a property that is none") {
  TemporaryFolder folder;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string tail = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  write_text(folder / "q.ply",
             head + "property float quality\n" + tail + "0 0 0 nan\n1 0 0 -nan\n0 1 0 inf\n3 0 1 2\n");
  const Loaded loaded = load(folder / "q.ply");
  CHECK(total(loaded.list).surface_m2 == 0.5);
  CHECK(loaded.warnings.empty());
  write_text(folder / "x.ply", head + tail + "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  CHECK(
      contains(error_of([&] { load(folder / "x.ply"); }), "x.ply:10: error: element vertex 0 has a value that is no"));
}

TEST_CASE("COLLADA: a file without a scene says so") {
  TemporaryFolder folder;
  const std::string box = dae_box(kMetresZUp);
  write_text(folder / "none.dae", replaced(box, "<scene><instance_visual_scene url=\"#vs\"/></scene>", ""));
  CHECK(contains(error_of([&] { load(folder / "none.dae"); }), "none.dae:1:23: error: has no <scene>"));
  write_text(folder / "other.dae", replaced(box, "url=\"#vs\"", "url=\"#other\""));
  CHECK(contains(error_of([&] { load(folder / "other.dae"); }), "there is no visual scene \"#other\""));
}

// Georgia Tech's archive of large models has such files; Assimp 5.2 keeps one triangle of each strip.
TEST_CASE("PLY: triangle strips are faces, in each encoding") {
  TemporaryFolder folder;
  const std::string vertices = "element vertex 6\nproperty float x\nproperty float y\nproperty float z\n";
  const std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 1, 1, 2, 1};
  // Each second triangle turned round; 3 3 4 connects; -1 begins another strip.
  write_text(folder / "faces.ply",
             "ply\nformat ascii 1.0\n" + vertices +
                 "element face 5\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 "
                 "1\n1 2 1\n3 0 1 2\n3 2 1 3\n3 3 4 5\n3 0 2 4\n3 1 0 3\n");
  const std::vector<std::vector<int>> strips{{0, 1, 2, 3, 3, 4, 5, -1, 0, 2, 4}, {1, 0, 3}};
  const Loaded faces = load(folder / "faces.ply");
  REQUIRE(total(faces.list).triangles == 5);
  for (const PlyFormat format : {PlyFormat::text, PlyFormat::little, PlyFormat::big}) {
    const bool big = format == PlyFormat::big;
    const std::string name = format == PlyFormat::text ? "ascii" : big ? "binary_big_endian" : "binary_little_endian";
    std::string ply = "ply\nformat " + name + " 1.0\n" + vertices +
                      "element tristrips 2\nproperty list int int vertex_indices\nend_header\n";
    const auto put = [&](int number) {
      for (unsigned i = 0; i < 4; ++i) ply += static_cast<char>(static_cast<unsigned>(number) >> 8 * (big ? 3 - i : i));
    };
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (format == PlyFormat::text) {
        ply += std::to_string(static_cast<int>(numbers[i])) + (i % 3 == 2 ? "\n" : " ");
      } else {
        put_float(ply, numbers[i], big);
      }
    }
    for (const std::vector<int>& strip : strips) {
      if (format == PlyFormat::text) ply += std::to_string(strip.size());
      if (format != PlyFormat::text) put(static_cast<int>(strip.size()));
      for (const int vertex : strip) {
        if (format == PlyFormat::text) ply += " " + std::to_string(vertex);
        if (format != PlyFormat::text) put(vertex);
      }
      if (format == PlyFormat::text) ply += "\n";
    }
    write_text(folder / "strips.ply", ply);
    const Loaded loaded = load(folder / "strips.ply");
    CHECK(loaded.warnings.empty());
    CHECK(loaded.list.meshes.at(0)->positions == faces.list.meshes.at(0)->positions);
    CHECK(loaded.list.meshes.at(0)->indices == faces.list.meshes.at(0)->indices);
  }
  const std::string one = "ply\nformat ascii 1.0\n" + vertices +
                          "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
                          "0\n1 1 0\n0 2 1\n1 2 1\n3 0 1 ";
  write_text(folder / "x.ply", one + "6\n");
  CHECK(contains(error_of([&] { load(folder / "x.ply"); }), "x.ply:16: error: element tristrips 0 has the vertex 6"));
  write_text(folder / "y.ply", replaced(one + "2\n3 0 1 2\n", "end_header",
                                        "element face 1\nproperty list int int vertex_indices\nend_header"));
  CHECK(contains(error_of([&] { load(folder / "y.ply"); }), "the file has faces and tristrips"));
}

TEST_CASE("PLY: elements of other kinds are read over, wherever they stand and with lists") {
  TemporaryFolder folder;
  for (const PlyFormat format : {PlyFormat::text, PlyFormat::little, PlyFormat::big}) {
    const std::string plain = ply_box(format);
    const std::string other = "element 2mass 2\nproperty uchar m\nproperty list uchar char q\n";
    const std::string instances = format == PlyFormat::text ? "7 2 -3 -4\n5 0\n" : std::string("\7\2\xfd\xfc\5\0", 6);
    const std::size_t end = plain.find("end_header\n") + 11;
    const std::size_t face = format == PlyFormat::text ? plain.find("4 0 3 2 1") : end + 8 * 3 * sizeof(float);
    const auto load_with = [&](const std::string& before, std::size_t at) {
      write_text(folder / "a.ply",
                 replaced(plain.substr(0, at) + instances + plain.substr(at), before, other + before));
      const Loaded loaded = load(folder / "a.ply");
      CHECK(loaded.warnings.empty());
      return total(loaded.list).triangles;
    };
    CHECK(load_with("element face", face) == 12);
    CHECK(load_with("element vertex", end) == 12);
    CHECK(load_with("end_header", plain.size()) == 12);
  }
  write_text(folder / "none.ply", "ply\nformat ascii 1.0\nelement mass 1\nproperty float m\nend_header\n1\n");
  CHECK(contains(error_of([&] { load(folder / "none.ply"); }), "none.ply:5: error: the header has no element vertex"));
}

TEST_CASE("PLY: colours of each type, and texture coordinates of faces") {
  TemporaryFolder folder;
  const auto load_with = [&](const std::string& type, const std::string& red) {
    write_text(
        folder / "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty " +
            type + " red\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float " +
            "texcoord\nend_header\n0 0 0 " + red + "\n1 0 0 " + red + "\n0 1 0 " + red +
            "\n3 0 1 2 6 0 0 0.5 0.25 0 1\n");
    return load(folder / "a.ply");
  };
  const std::pair<const char*, const char*> full[] = {{"uchar", "255"},  {"ushort", "65535"}, {"int", "65535"},
                                                      {"uint", "65535"}, {"float", "1"},      {"double", "1"}};
  for (const auto& [type, red] : full) {
    CAPTURE(std::string(type));
    const Loaded loaded = load_with(type, red);
    CHECK(vertex_color(loaded) == glm::vec4(1, 0, 0, 1));
    CHECK(loaded.list.meshes.at(0)->attributes.at(1).uv[0] == glm::vec2(0.5, 0.75));
  }
}

TEST_CASE("STL text: solids with names of several words, facets without a normal, and the nearest float of a number") {
  TemporaryFolder folder;
  const std::string facet =
      "facet\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 16777217.0 0\nendloop\nendfacet\n";
  write_text(folder / "a.stl",
             "solid a normal vertex\n" + facet + "endsolid a normal vertex\nsolid b\n" + facet + "endsolid b\n");
  const Loaded loaded = load(folder / "a.stl");
  CHECK(loaded.warnings.empty());
  const Mesh& mesh = *loaded.list.meshes.at(0);
  CHECK(loaded.list.items.size() == 2);
  CHECK(mesh.attributes[0].normal == glm::vec3(0, 0, 1));
  CHECK(mesh.positions[1].x == 0.1f);
  CHECK(mesh.positions[2].y == 16777216.0f);
}

TEST_CASE("PLY: text with more values than the header says") {
  TemporaryFolder folder;
  const std::string text = ply_box(PlyFormat::text);
  write_text(folder / "more.ply", replaced(replaced(text, "4 0 3 2 1", "4 0 3 2 1 9 1"), "1 2 3\n", "1 2 3 7\n"));
  const Loaded more = load(folder / "more.ply");
  check_box(more.list);
  REQUIRE(more.warnings.size() == 1);
  CHECK(contains(more.warnings[0], "has more values than the header says; they are left out, here and in others"));
  write_text(folder / "rest.ply", text + "1 2 3\n1 2 3\n");
  const Loaded rest = load(folder / "rest.ply");
  check_box(rest.list);
  REQUIRE(rest.warnings.size() == 1);
  CHECK(contains(rest.warnings[0], "text after the last element is left out"));
}

TEST_CASE("PLY: the picture that a comment names, as VCGLIB writes it, and a file without vertices") {
  TemporaryFolder folder;
  write_text(folder / "a red.ppm", std::string("P6\n1 1\n255\n\xff\0\0", 14));
  const auto with_comment = [&](const std::string& comment) {
    write_text(folder / "a.ply", "ply\nformat ascii 1.0\n" + comment +
                                     "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                     "property float s\nproperty float t\nelement face 1\nproperty list uchar int "
                                     "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
    return load(folder / "a.ply");
  };
  const Loaded pictured = with_comment("comment TextureFile a red.ppm\n");
  const Material& material = *pictured.list.materials.at(0);
  REQUIRE(material.base_color_texture != nullptr);
  CHECK(material.base_color_texture->rgba == std::vector<std::uint8_t>{255, 0, 0, 255});
  CHECK(material.base_color == glm::vec4(1));
  CHECK(pictured.warnings.empty());
  CHECK(contains(with_comment("comment TextureFile b.ppm\n").warnings.at(0), "picture \"b.ppm\" is not there"));
  CHECK(with_comment("").list.materials.at(0)->base_color_texture == nullptr);
  write_text(folder / "none.ply",
             "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
             "property float z\nend_header\n");
  CHECK(contains(error_of([&] { load(folder / "none.ply"); }), "none.ply: error: holds nothing to draw"));
}

TEST_SUITE_END();
