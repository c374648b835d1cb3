// OBJ, PLY, STL and COLLADA parts that are written here, read back and compared with their geometry.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "engine/base/srgb.h"
#include "import/programs/polygon.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

TEST_CASE("the same box in every format: triangles, bounds, surface, and normals from its geometry") {
  TemporaryFolder folder;
  const std::pair<const char*, std::string> files[] = {
      {"box.obj", obj_box()},
      {"text.ply", ply_box(PlyFormat::text)},
      {"little.ply", ply_box(PlyFormat::little)},
      {"big.PLY", ply_box(PlyFormat::big)},
      {"text.stl", stl_box(false)},
      {"binary.STL", stl_box(true)},
      {"bare.stl", stl_box(true, false)},
      {"box.dae", dae_box(kMetresZUp)},
  };
  for (const auto& file : files) {
    const char* name = file.first;
    CAPTURE(std::string(name));
    write_text(folder / name, file.second);
    const Loaded loaded = load(folder / name);
    check_box(loaded.list);
    REQUIRE(loaded.list.materials.size() == 1);
    CHECK(loaded.list.materials[0]->double_sided);
    CHECK(loaded.warnings.empty());
  }
}

TEST_CASE("the up axis") {
  TemporaryFolder folder;
  write_text(folder / "box.stl", stl_box(true));
  // (x, y, z) -> (x, -z, y)
  const Totals turned = total(load(folder / "box.stl", true, UpAxis::y).list);
  CHECK(turned.min == glm::dvec3(1, -6, 2));
  CHECK(turned.max == glm::dvec3(2, -3, 4));
  check_box(load(folder / "box.stl", true, UpAxis::z).list);
  write_text(folder / "y_up.dae", dae_box(R"(<unit meter="1"/><up_axis>Y_UP</up_axis>)"));
  CHECK(total(load(folder / "y_up.dae").list).min == glm::dvec3(1, -6, 2));
  write_text(folder / "none.dae", dae_box(""));
  CHECK(total(load(folder / "none.dae").list).min == glm::dvec3(1, -6, 2));  // COLLADA is Y-up by default
  check_box(load(folder / "y_up.dae", true, UpAxis::z).list);
  write_text(folder / "z_up.dae", dae_box(kMetresZUp));
  CHECK(total(load(folder / "z_up.dae", true, UpAxis::y).list).min == glm::dvec3(1, -6, 2));
}

TEST_CASE("COLLADA: units and the matrices of nodes") {
  TemporaryFolder folder;
  write_text(folder / "half.dae", dae_box(R"(<unit meter="0.5"/><up_axis>Z_UP</up_axis>)", 0.5f));
  check_box(load(folder / "half.dae").list);
  write_text(folder / "moved.dae", dae_box(kMetresZUp, 1, "<matrix>0 -1 0 10 1 0 0 20 0 0 1 30 0 0 0 1</matrix>"));
  const Totals moved = total(load(folder / "moved.dae").list);
  CHECK(moved.min == glm::dvec3(10 - 4, 20 + 1, 33));
  CHECK(moved.max == glm::dvec3(10 - 2, 20 + 2, 36));
}

TEST_CASE("COLLADA: a skinned mesh has its rest pose; animations, lights and cameras are ignored") {
  TemporaryFolder folder;
  std::string text = dae_box(kMetresZUp);
  const auto replace = [&text](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
  };
  replace("<instance_geometry url=\"#g\">", "<instance_controller url=\"#c\"><skeleton>#none</skeleton>");
  replace("</instance_geometry>", "</instance_controller><instance_light url=\"#none\"/>");
  replace("<library_visual_scenes>",
          "<library_controllers><controller id=\"c\"><skin source=\"#d\"/></controller><controller id=\"d\"><morph "
          "source=\"#g\"/></controller></library_controllers><library_animations><animation><channel "
          "source=\"#none\"/></animation></library_animations><library_visual_scenes>");
  write_text(folder / "skin.dae", text);
  const Loaded loaded = load(folder / "skin.dae");
  check_box(loaded.list);
  CHECK(loaded.list.lights.empty());
  REQUIRE(loaded.warnings.size() == 2);
  CHECK(contains(loaded.warnings[0], "animations are not played"));
  CHECK(contains(loaded.warnings[1], "rest pose"));
}

TEST_CASE("COLLADA: colours are sRGB, emission and opacity") {
  TemporaryFolder folder;
  write_text(folder / "box.dae", dae_box(kMetresZUp, 1, "",
                                         "<emission><color>0.25 0 0 1</color></emission><diffuse><color>1 0.5 0 1"
                                         "</color></diffuse><transparent opaque=\"A_ONE\"><color>1 1 1 1</color>"
                                         "</transparent><transparency><float>0.5</float></transparency>"));
  const Loaded loaded = load(folder / "box.dae");
  const Material& material = *loaded.list.materials.at(0);
  CHECK(material.base_color == glm::vec4(1, linear_from_srgb(0.5), 0, 0.5));
  CHECK(material.emissive == glm::vec3(linear_from_srgb(0.25), 0, 0));
  CHECK(material.alpha_mode == AlphaMode::blend);
  // IEC 61966-2-1: half of full scale is 21.4 % of the light.
  CHECK(linear_from_srgb(0.5) == doctest::Approx(0.2140).epsilon(0.001));
}

TEST_CASE("OBJ: materials, pictures, texture coordinates, normals, objects") {
  TemporaryFolder folder;
  write_bytes(folder / "dots.png", png(2, 1, 8, 6, {{255, 0, 0, 255, 0, 255, 0, 0}}));
  write_text(folder / "a.mtl",
             "newmtl red\nKd 1 0 0\nKe 0.5 0 0\nd 0.25\n"
             "newmtl leaf\nKd 1 1 1\nmap_Kd dots.png\nmap_d dots.png\n"
             "newmtl plain\nKd 0.5 1 1\nmap_Kd -clamp on dots.png\n");
  write_text(folder / "a.obj",
             "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0.25 0.75\nvn 0 0 2\nvn 0 1 0\n"
             "o first\nusemtl red\nf 1/1/1 2/2/1 3/3/2\no second\nusemtl leaf\nf 1/1 2/2 3/3\n"
             "o third\nusemtl plain\nf 3/3 2/2 1/1\n");
  const Loaded loaded = load(folder / "a.obj");
  CHECK(loaded.warnings.empty());
  REQUIRE(loaded.list.items.size() == 3);
  const auto material = [&](std::size_t i) { return *loaded.list.materials.at(loaded.list.items[i].material); };
  const auto mesh = [&](std::size_t i) { return *loaded.list.meshes.at(loaded.list.items[i].mesh); };
  CHECK(material(0).base_color == glm::vec4(1, 0, 0, 0.25));
  CHECK(material(0).emissive == glm::vec3(linear_from_srgb(0.5), 0, 0));
  CHECK(material(0).alpha_mode == AlphaMode::blend);
  CHECK(mesh(0).attributes[0].normal == glm::vec3(0, 0, 1));
  CHECK(mesh(0).attributes[2].normal == glm::vec3(0, 1, 0));
  CHECK(mesh(0).attributes[2].uv[0] == glm::vec2(0.25, 0.25));  // v is down
  CHECK(mesh(0).attributes[0].uv[0] == glm::vec2(0, 1));

  CHECK(material(1).alpha_mode == AlphaMode::mask);
  REQUIRE(material(1).base_color_texture != nullptr);
  CHECK(material(1).base_color_texture->width == 2);
  CHECK(material(1).base_color_texture->rgba == ByteString{255, 0, 0, 255, 0, 255, 0, 0});
  CHECK(material(1).base_color_texture->sampler.wrap_u == Wrap::repeat);
  CHECK(mesh(1).attributes[0].normal == glm::vec3(0, 0, 1));
  CHECK(mesh(2).attributes[0].normal == glm::vec3(0, 0, -1));
  CHECK(material(2).alpha_mode == AlphaMode::opaque);
  CHECK(material(2).base_color == glm::vec4(linear_from_srgb(0.5), 1, 1, 1));
  CHECK(material(2).base_color_texture->sampler.wrap_u == Wrap::clamp_to_edge);
}

TEST_CASE("non-convex polygons are cut into triangles that fill exactly their area") {
  TemporaryFolder folder;
  // An L of 3 squares with sides of 1.
  write_text(folder / "l.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n");
  const Totals totals = total(load(folder / "l.obj").list);
  CHECK(totals.triangles == 4);
  CHECK(totals.surface_m2 == 3);
  CHECK(totals.largest_normal_error == 0);
}

TEST_CASE("random stars are cut into triangles with the same winding and the same total area") {
  Random random(3);
  for (int star = 0; star < 300; ++star) {
    CAPTURE(star);
    const std::size_t count = 3 + random.below(60);
    const int up = static_cast<int>(random.below(3)), side = star % 2 == 0 ? 1 : 2;  // either way round
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
      const double radius = 1 + static_cast<double>(random.below(1000)) / 100;
      glm::vec3 corner{7};
      corner[(up + side) % 3] = static_cast<float>(radius * std::cos(angle));
      corner[(up + 3 - side) % 3] = static_cast<float>(radius * std::sin(angle));
      corners.push_back(corner);
    }
    const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
      const glm::dvec3 p(corners[a]), q(corners[b]), r(corners[c]);
      return glm::cross(q - p, r - p)[up] / (side == 1 ? 2 : -2);
    };
    double whole = 0, parts = 0;
    for (std::size_t i = 1; i + 1 < count; ++i) whole += area(0, i, i + 1);
    const auto triangles = triangles_of_polygon(corners);
    CHECK(triangles.size() == count - 2);
    for (const auto& [a, b, c] : triangles) {
      CHECK(area(a, b, c) >= 0);
      parts += area(a, b, c);
    }
    // Sums of up to 60 terms, each at most half the square of 11 m with an error of several half-ulps.
    const double roundings_m2 = 2 * 60 * 4 * 0x1p-53 * (11 * 11 / 2.0) * 60;
    CHECK(std::abs(parts - whole) <= roundings_m2);
  }
}

TEST_CASE("PLY: vertex colours, texture coordinates, points") {
  TemporaryFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  write_text(folder / "c.ply",
             header +
                 "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
                 "property float s\nproperty float t\nelement face 1\n"
                 "property list uchar uint vertex_index\nend_header\n"
                 "0 0 0 255 0 0 255 0 0\n1 0 0 0 51 0 255 1 0\n0 1 0 0 0 255 0 0 1\n3 0 1 2\n");
  const Loaded colored = load(folder / "c.ply");
  const Mesh& mesh = *colored.list.meshes.at(0);
  REQUIRE(mesh.attributes.size() == 3);
  CHECK(mesh.attributes[0].color == glm::vec4(1, 0, 0, 1));
  CHECK(mesh.attributes[1].color == glm::vec4(0, linear_from_srgb(51 / 255.0f), 0, 1));
  CHECK(mesh.attributes[2].color == glm::vec4(0, 0, 1, 0));
  CHECK(mesh.attributes[2].uv[0] == glm::vec2(0, 0));
  CHECK(mesh.attributes[0].uv[0] == glm::vec2(0, 1));
  CHECK(colored.list.materials.at(0)->base_color == glm::vec4(1));

  write_text(folder / "p.ply", header + "end_header\n1 2 3\n4 5 6\n7 8 9\n");
  const Loaded points = load(folder / "p.ply");
  REQUIRE(points.list.meshes.size() == 1);
  CHECK(points.list.meshes[0]->topology == Topology::points);
  CHECK(points.list.meshes[0]->positions == std::vector<glm::vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  CHECK(points.list.meshes[0]->indices.size() == 3);
  CHECK(points.list.materials.at(0)->unlit);
}

TEST_CASE("OBJ: lines and points") {
  TemporaryFolder folder;
  write_text(folder / "l.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\np 1\n");
  const Loaded loaded = load(folder / "l.obj");
  std::size_t lines = 0, points = 0;
  for (const auto& mesh : loaded.list.meshes) {
    if (mesh->topology == Topology::lines) lines += mesh->indices.size() / 2;
    if (mesh->topology == Topology::points) points += mesh->indices.size();
  }
  CHECK(lines == 2);
  CHECK(points == 1);
  write_text(folder / "p.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");  // no faces at all: a cloud of points
  CHECK(load(folder / "p.obj").list.meshes.at(0)->indices.size() == 3);
}

TEST_CASE("identical meshes, textures and materials of two files are one") {
  TemporaryFolder folder;
  write_text(folder / "a.stl", stl_box(true));
  write_text(folder / "b.stl", stl_box(true));
  ContentPool pool;
  const auto root = std::make_shared<Group>();
  for (const char* name : {"a.stl", "b.stl"}) root->add(import(folder / name, pool).root);
  Flattener flattener(root);
  const DrawList& list = flattener.update();
  CHECK(list.items.size() == 2);
  CHECK(list.meshes.size() == 1);
  CHECK(list.materials.size() == 1);
}

TEST_CASE("test data: OBJ files of other projects") {
  const auto folder = test::test_data("peer_refs/drake/meshes");
  if (!folder) return;
  for (const char* name : {"box.obj", "rainbow_box.obj"}) {
    const Totals totals = total(load(*folder / name).list);
    MESSAGE(std::string(name) << ": " << totals.triangles << " triangles");
    CHECK(totals.triangles >= 12);
  }
}

TEST_SUITE_END();
