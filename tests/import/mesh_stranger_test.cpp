// Mesh files as strangers have them: faces with two sides, nodes that are nowhere, values that are no numbers.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

const std::string kRedAndBlue = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";
const std::string kTwoSidedSquare = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\n";

Loaded load_obj(const TemporaryFolder& folder, const std::string& faces, const std::string& materials = kRedAndBlue) {
  write_text(folder / "a.mtl", materials);
  write_text(folder / "a.obj", kTwoSidedSquare + faces);
  return load(folder / "a.obj");
}

// How many triangles are seen from both sides, and from one.
std::array<int, 2> sides_of(const Loaded& loaded) {
  std::array<int, 2> triangles{};
  for (const DrawItem& item : loaded.list.items) {
    const bool both = loaded.list.materials[item.material]->double_sided;
    triangles[both ? 0 : 1] += static_cast<int>(loaded.list.meshes[item.mesh]->indices.size() / 3);
  }
  return triangles;
}

std::string replaced_in(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

// SketchUp: a face and its reverse, with the materials of its front and its back. Gazebo (OGRE culls back faces) and
// three.js (FrontSide, unless the file says double_sided) show the front's material in front.
TEST_CASE("two faces back to back in two materials are seen from one side each") {
  TemporaryFolder folder;
  const std::string both = "usemtl red\nf 1 2 3 4\nusemtl blue\nf 2 1 4 3\n";
  CHECK(sides_of(load_obj(folder, both)) == std::array{0, 4});
  CHECK(load_obj(folder, both).warnings.empty());
  // Faces of the same materials that have no counterpart stay as they are.
  CHECK(sides_of(load_obj(folder, both + "usemtl red\nf 1 2 5\n")) == std::array{1, 4});
  // The same side twice, the same material, other corners, another number of corners.
  CHECK(sides_of(load_obj(folder, "usemtl red\nf 1 2 3 4\nusemtl blue\nf 2 3 4 1\n")) == std::array{4, 0});
  CHECK(sides_of(load_obj(folder, "usemtl red\nf 1 2 3 4\nf 2 1 4 3\nusemtl blue\nf 1 2 5\n")) == std::array{5, 0});
  CHECK(sides_of(load_obj(folder, "usemtl red\nf 1 2 3\nusemtl blue\nf 2 1 4\n")) == std::array{2, 0});
  CHECK(sides_of(load_obj(folder, "usemtl red\nf 1 2 3 4\nusemtl blue\nf 3 2 1\n")) == std::array{3, 0});
}

TEST_CASE("a file that repeats one face very often is read in the time of any other") {
  TemporaryFolder folder;
  std::string faces = "usemtl red\n";
  for (int i = 0; i < 100'000; ++i) faces += "f 1 2 3\n";
  CHECK(sides_of(load_obj(folder, faces + "usemtl blue\nf 2 1 3\n")) == std::array{0, 100'001});
}

TEST_CASE("COLLADA: a node whose matrix is not finite is left out, with a warning") {
  TemporaryFolder folder;
  const std::string not_finite = "<matrix>INF NaN 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>";
  const auto with_node = [&](const std::string& content) {
    return replaced_in(dae_box(kMetresZUp), "</visual_scene>",
                       "<node id=\"n\">" + not_finite + content + "</node></visual_scene>");
  };
  const std::string text = dae_box(kMetresZUp);
  const std::size_t begin = text.find("<instance_geometry");
  const std::string end = "</instance_geometry>";
  const std::string instance = text.substr(begin, text.find(end) + end.size() - begin);
  write_text(folder / "box.dae", with_node("<node>" + instance + "</node>"));
  const Loaded loaded = load(folder / "box.dae");
  check_box(loaded.list);
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "node \"n\": its matrix is not finite; it is left out"));
  // SketchUp writes such a matrix for its camera.
  write_text(folder / "camera.dae", with_node(""));
  CHECK(load(folder / "camera.dae").warnings.empty());
  write_text(folder / "none.dae", replaced_in(text, "<instance_geometry", not_finite + "<instance_geometry"));
  CHECK(contains(error_of([&] { load(folder / "none.dae"); }), "holds nothing to draw"));
}

TEST_CASE("colours and texture coordinates that are no numbers are replaced, with a warning") {
  TemporaryFolder folder;
  write_text(folder / "color.obj", "v 0 0 0 1 0 0\nv 1 0 0 nan nan nan\nv 0 1 0 0 1 0\nf 1 2 3\n");
  const Loaded color = load(folder / "color.obj");
  CHECK(color.list.meshes.at(0)->attributes.at(0).color == glm::vec4(1, 0, 0, 1));
  CHECK(color.list.meshes.at(0)->attributes.at(1).color == glm::vec4(1));
  REQUIRE(color.warnings.size() == 1);
  CHECK(contains(color.warnings[0], "color.obj: vertex colours that are negative or not finite are read as white"));
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float s\nproperty float t\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  for (const float value : {0.f, 0.f, 0.f, 0.5f, 0.5f, 1.f, 0.f, 0.f, NAN, 0.f, 0.f, 1.f, 0.f, 0.5f, 0.5f}) {
    put_float(ply, value);
  }
  write_text(folder / "uv.ply", ply + std::string("\3\0\1\2", 4));
  const Loaded uv = load(folder / "uv.ply");
  CHECK(uv.list.meshes.at(0)->attributes.at(0).uv[0] == glm::vec2(0.5));
  CHECK(uv.list.meshes.at(0)->attributes.at(1).uv[0] == glm::vec2(0));
  REQUIRE(uv.warnings.size() == 1);
  CHECK(contains(uv.warnings[0], "texture coordinates that are not finite are read as 0 0"));
}

// OGRE, which RViz and Gazebo show with, multiplies the sum of emission and light by the picture. COLLADA's text adds
// the emission to it, which would hide the picture of the many files whose emission is white.
TEST_CASE("an emission is multiplied by the material's picture") {
  TemporaryFolder folder;
  write_text(folder / "red.ppm", std::string("P6\n1 1\n255\n\xff\0\0", 14));
  const auto emitting = [&](const std::string& color) {
    return load_obj(folder, "usemtl m\nf 1 2 3\n", "newmtl m\nKd 1 1 1\nmap_Kd red.ppm\nKe " + color + "\n");
  };
  const Loaded white = emitting("1 1 1");
  const Material& material = *white.list.materials.at(0);
  REQUIRE(material.base_color_texture != nullptr);
  CHECK(material.map(MapKind::emissive).texture == material.base_color_texture);
  REQUIRE(white.warnings.size() == 1);
  CHECK(contains(white.warnings[0], "material \"m\": its emission is multiplied by its picture"));
  const Loaded black = emitting("0 0 0");
  CHECK(black.list.materials.at(0)->map(MapKind::emissive).texture == nullptr);
  CHECK(black.warnings.empty());
}

TEST_SUITE_END();
