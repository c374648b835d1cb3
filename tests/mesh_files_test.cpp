// OBJ, PLY, STL and COLLADA parts: written here, read back, compared with the geometry that they were written from.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "engine/error.h"
#include "engine/srgb.h"
#include "scenegraph/polygon.h"
#include "tests/error_of.h"
#include "tests/gltf_fixture.h"
#include "tests/random_numbers.h"

using namespace simvis;
using namespace simvis::test;

namespace {

// A box from (1, 2, 3) to (2, 4, 6): no two axes alike, no side through the origin, every number exact in float.
constexpr std::array<std::array<float, 3>, 8> kCorners{
    {{1, 2, 3}, {2, 2, 3}, {2, 4, 3}, {1, 4, 3}, {1, 2, 6}, {2, 2, 6}, {2, 4, 6}, {1, 4, 6}}};
constexpr std::array<std::array<int, 4>, 6> kSides{
    // counter-clockwise from outside
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}}};
constexpr double kBoxSurface_m2 = 2 * (1 * 2 + 2 * 3 + 1 * 3);

PartContent import(const std::filesystem::path& file, ContentPool& pool, bool up_given = false, UpAxis up = UpAxis::z) {
  const PartImporter importer = find_part_importer(file);
  REQUIRE((importer != nullptr));
  return importer({.file = file, .up_given = up_given, .up = up}, pool);
}

// A part flattened, with its warnings.
struct Loaded {
  DrawList list;
  std::vector<std::string> warnings;
};
Loaded load(const std::filesystem::path& file, bool up_given = false, UpAxis up = UpAxis::z) {
  ContentPool pool;
  const PartContent content = import(file, pool, up_given, up);
  const auto root = std::make_shared<Group>();
  root->add(content.root);
  return {Flattener(root).update(), content.warnings};
}

std::string error(const std::filesystem::path& file) {
  return error_of([&] { load(file); });
}

struct Totals {
  int triangles = 0;
  double surface_m2 = 0;
  glm::dvec3 min{INFINITY}, max{-INFINITY};
  double largest_normal_error = 0;  // against the geometry, as a length
};
Totals total(const DrawList& list) {
  Totals totals;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const glm::dmat4& world = list.world_from_node[item.transform];
    if (mesh.topology != Topology::triangles) continue;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      std::array<glm::dvec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = glm::dvec3(world * glm::dvec4(glm::dvec3(mesh.positions[mesh.indices[i + k]]), 1));
        totals.min = glm::min(totals.min, p[k]);
        totals.max = glm::max(totals.max, p[k]);
      }
      const glm::dvec3 area = glm::cross(p[1] - p[0], p[2] - p[0]) / 2.0;
      ++totals.triangles;
      totals.surface_m2 += glm::length(area);
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 normal(world * glm::dvec4(glm::dvec3(mesh.attributes[mesh.indices[i + k]].normal), 0));
        totals.largest_normal_error =
            std::max(totals.largest_normal_error, glm::length(glm::normalize(area) - glm::normalize(normal)));
      }
    }
  }
  return totals;
}

void check_box(const DrawList& list) {
  const Totals totals = total(list);
  CHECK(totals.triangles == 12);
  CHECK(totals.min == glm::dvec3(1, 2, 3));
  CHECK(totals.max == glm::dvec3(2, 4, 6));
  CHECK(totals.surface_m2 == kBoxSurface_m2);
  CHECK(totals.largest_normal_error == 0);
  std::size_t vertices = 0;
  for (const auto& mesh : list.meshes) vertices += mesh->positions.size();
  CHECK(vertices == 24);  // four corners a side, joined where position and normal agree
}

std::string obj_box() {
  std::ostringstream text;
  for (const auto& c : kCorners) text << "v " << c[0] << ' ' << c[1] << ' ' << c[2] << '\n';
  for (const auto& s : kSides)
    text << "f " << s[0] + 1 << ' ' << s[1] + 1 << ' ' << s[2] + 1 << ' ' << s[3] + 1 << '\n';
  return text.str();
}

void put_float(std::string& bytes, float value, bool big_endian = false) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> (big_endian ? 24 - 8 * i : 8 * i));
}

enum class PlyFormat { text, little, big };
std::string ply_box(PlyFormat format) {
  const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string bytes = "ply\nformat " + std::string(names[static_cast<int>(format)]) +
                      " 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 6\nproperty list uchar int vertex_indices\nend_header\n";
  std::ostringstream text;
  for (const auto& c : kCorners) {
    for (const float v : c) put_float(bytes, v, format == PlyFormat::big);
    text << c[0] << ' ' << c[1] << ' ' << c[2] << '\n';
  }
  if (format == PlyFormat::text) bytes.resize(bytes.find("end_header\n") + 11);
  for (const auto& s : kSides) {
    text << 4;
    if (format != PlyFormat::text) bytes += '\4';
    for (const int i : s) {
      text << ' ' << i;
      if (format == PlyFormat::little) bytes += std::string{static_cast<char>(i), 0, 0, 0};
      if (format == PlyFormat::big) bytes += std::string{0, 0, 0, static_cast<char>(i)};
    }
    text << '\n';
  }
  return format == PlyFormat::text ? bytes + text.str() : bytes;
}

// `with_normals`: false leaves them 0 0 0, as many programs write them.
std::string stl_box(bool binary, bool with_normals = true) {
  std::string bytes(80, ' ');
  bytes += std::string{12, 0, 0, 0};
  std::ostringstream text;
  text << "solid box\n";
  for (const auto& s : kSides) {
    for (const std::array<int, 3>& face : {std::array{s[0], s[1], s[2]}, std::array{s[0], s[2], s[3]}}) {
      std::array<glm::vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& c = kCorners[static_cast<std::size_t>(face[k])];
        p[k] = {c[0], c[1], c[2]};
      }
      const glm::vec3 n = with_normals ? glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])) : glm::vec3(0);
      for (const glm::vec3& v : {n, p[0], p[1], p[2]}) {
        for (int i = 0; i < 3; ++i) put_float(bytes, v[i]);
      }
      bytes += std::string(2, '\0');
      text << "facet normal " << n.x << ' ' << n.y << ' ' << n.z << "\nouter loop\n";
      for (const glm::vec3& v : p) text << "vertex " << v.x << ' ' << v.y << ' ' << v.z << '\n';
      text << "endloop\nendfacet\n";
    }
  }
  text << "endsolid box\n";
  return binary ? bytes : text.str();
}

// `scale`: what the numbers are divided by, for units.
std::string dae_box(const std::string& asset, float scale = 1, const std::string& node_matrix = "",
                    const std::string& effect = "<diffuse><color>1 0.5 0 1</color></diffuse>") {
  std::ostringstream text;
  text
      << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)"
      << asset << R"(</asset><library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>)" << effect
      << R"(</lambert></technique></profile_COMMON></effect></library_effects><library_materials><material id="m" name="paint"><instance_effect url="#e"/></material></library_materials><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="24">)";
  for (const auto& c : kCorners) text << c[0] / scale << ' ' << c[1] / scale << ' ' << c[2] / scale << ' ';
  text
      << R"(</float_array><technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><polylist count="6" material="s"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4 4 4 4 4</vcount><p>)";
  for (const auto& s : kSides) {
    for (const int i : s) text << i << ' ';
  }
  text
      << R"(</p></polylist></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="vs"><node id="n">)"
      << node_matrix
      << R"(<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene></COLLADA>)";
  return text.str();
}
constexpr const char* kMetresZUp = R"(<unit name="meter" meter="1"/><up_axis>Z_UP</up_axis>)";

}  // namespace

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
  for (const auto& [name, bytes] : files) {
    CAPTURE(std::string(name));
    write_text(folder / name, bytes);
    const Loaded loaded = load(folder / name);
    check_box(loaded.list);
    REQUIRE(loaded.list.materials.size() == 1);
    CHECK(loaded.list.materials[0]->double_sided);
    CHECK(loaded.warnings.size() == (std::string(name) == "bare.stl" ? 1 : 0));
  }
}

TEST_CASE("which axis is up") {
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

TEST_CASE("COLLADA: a skinned mesh comes in its rest pose; animations, lights and cameras are not read at all") {
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

TEST_CASE("polygons that are not convex are cut into triangles that fill them and nothing else") {
  TemporaryFolder folder;
  // An L of 3 squares with sides of 1.
  write_text(folder / "l.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n");
  const Totals totals = total(load(folder / "l.obj").list);
  CHECK(totals.triangles == 4);
  CHECK(totals.surface_m2 == 3);
  CHECK(totals.largest_normal_error == 0);
}

TEST_CASE("random stars are cut into triangles that all wind their way and have their area together") {
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
    // Sums of up to 60 terms, each at most half the square of 11 m and off by a few half-ulps.
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

TEST_CASE("mistakes in mesh files are said, with their file") {
  TemporaryFolder folder;
  const auto error_in = [&](const char* name, const std::string& bytes) {
    write_text(folder / name, bytes);
    const std::string message = error(folder / name);
    CHECK(message.starts_with((folder / name).string()));
    CHECK(contains(message, "error: "));
    return message;
  };
  const std::string ply = ply_box(PlyFormat::text);
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  CHECK(contains(error_in("a.ply", with(ply, "vertex 8", "vertex 99999999999")), ".ply:4: error: element \"vertex\""));
  CHECK(contains(error_in("b.ply", with(ply, "4 0 3 2 1", "4 0 3 2 8")), "has the vertex 8, but there are 8"));
  CHECK(contains(error_in("c.ply", with(ply, "1 2 3\n", "1 nan 3\n")), "no finite number"));
  CHECK(contains(error_in("d.ply", with(ply, "1 2 3\n", "1 3\n")), "too few values"));
  CHECK(contains(error_in("e.ply", with(ply, "element face", "element vertex")), "declared twice"));
  CHECK(contains(error_in("f.ply", ""), "ends too early"));
  std::string little = ply_box(PlyFormat::little);
  little.pop_back();
  CHECK(contains(error_in("g.ply", little), "ends too early"));
  std::string not_finite = ply_box(PlyFormat::big);
  not_finite.replace(not_finite.find("end_header\n") + 11, 4, std::string("\x7f\xc0\0\0", 4));
  CHECK(contains(error_in("h.ply", not_finite), "is not finite"));

  std::string stl = stl_box(true);
  stl.pop_back();
  CHECK(contains(error_in("a.stl", stl), "claims 12 facets"));
  std::string text_stl = stl_box(false);
  text_stl.resize(text_stl.size() / 2);
  CHECK(contains(error_in("b.stl", text_stl), "does not end with \"endsolid\""));
  error_in("c.stl", "");

  CHECK(contains(error_in("a.obj", with(obj_box(), "f 1 4 3 2", "f 1 4 3 9")), "out of range"));
  error_in("b.obj", "");
  error_in("c.obj", "# nothing is in here\n");
  write_text(folder / "e.mtl", "Kd 1 0 0\nnewmtl m\n");
  CHECK(contains(error_in("e.obj", "mtllib e.mtl\n" + obj_box()), "begins with \"Kd\", expected \"newmtl\""));
  write_text(folder / "e.txt", "Kd 1 0 0\n");
  error_in("g.obj", "mtllib e.txt\n" + obj_box());
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (std::size_t i = 0; i <= kMaxPolygonCorners; ++i) many += " " + std::to_string(1 + i % 3);
  CHECK(contains(error_in("f.obj", many + "\n"), "has 1001 corners, expected at most 1000"));
  CHECK(contains(error_in("d.obj", "mtllib d.mtl\nv nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite"));

  CHECK(contains(error_in("a.dae", "<COLLADA>\n<asset>"), "malformed XML"));
  std::string deep = "<COLLADA>";
  for (int i = 0; i < 300; ++i) deep += "<node>";
  for (int i = 0; i < 300; ++i) deep += "</node>";
  CHECK(contains(error_in("b.dae", deep + "</COLLADA>"), "nested deeper"));
  const std::string dae = dae_box(kMetresZUp);
  CHECK(contains(error_in("c.dae", with(dae, "#pa", "#none")), "accessor of \"#none\""));
  CHECK(contains(error_in("d.dae", with(dae, "count=\"8\"", "count=\"9\"")), "beyond its array of 24 values"));
  CHECK(contains(error_in("e.dae", with(dae, "\"VERTEX\"", "\"VORTEX\"")), "0 inputs of the semantic VERTEX"));
  CHECK(contains(error_in("f.dae", with(dae, "offset=\"0\"", "offset=\"-1\"")), "whole number from 0 to 63"));
  CHECK(contains(error_in("g.dae", with(dae, "<p>0 3", "<p>0 .")), "p holds \".\", expected whole numbers"));
}

TEST_CASE("missing pictures are errors, missing material files a warning") {
  TemporaryFolder folder;
  write_text(folder / "a.obj", "mtllib none.mtl\n" + obj_box());
  const Loaded loaded = load(folder / "a.obj");
  check_box(loaded.list);
  REQUIRE_FALSE(loaded.warnings.empty());
  CHECK(contains(loaded.warnings[0], "none.mtl"));
  write_text(folder / "b.mtl", "newmtl m\nmap_Kd none.png\n");
  write_text(folder / "b.obj", "mtllib b.mtl\nusemtl m\n" + obj_box());
  CHECK(contains(error(folder / "b.obj"), "none.png"));
}

TEST_CASE("files cut off or with flipped bits are loaded or refused, and what loads is sound") {
  const int files = 400;
  TemporaryFolder folder;
  write_bytes(folder / "dots.png", png(2, 1, 8, 6, {{255, 0, 0, 255, 0, 255, 0, 0}}));
  const std::string mtl = "newmtl m\nKd 1 0.5 0\nKe 0 0 0\nd 0.25\nmap_Kd dots.png\n";
  const std::pair<const char*, std::string> seeds[] = {
      {"s.obj", "mtllib s.mtl\nusemtl m\n" + obj_box()},
      {"rich.obj",
       "# all that OBJ has\nmtllib s.mtl\no a\nv 0 0 0 1 0.5 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nvt 0 1\nvt 1 0 0\n"
       "vn 0 0 1\ng b c\ns 1\nusemtl m\nf 1/1/1 2/2/1 3/1/1\nf -1//-1 -2//-1 -3//-1\ns off\nl 1 2 3\np 1 2\n"
       "f 1/1 2/2 \\\n 3/1 1/1\n"},
      {"text.ply", ply_box(PlyFormat::text)},
      {"little.ply", ply_box(PlyFormat::little)},
      {"text.stl", stl_box(false)},
      {"binary.stl", stl_box(true)},
      {"s.dae", dae_box(kMetresZUp)},
      {"s.mtl", mtl}};
  Random random;
  for (const auto& [name, bytes] : seeds) {
    int loaded = 0;
    for (int i = 0; i < files; ++i) {
      CAPTURE(std::string(name));
      CAPTURE(i);
      std::string broken = bytes;
      if (random.below(4) == 0) {
        broken.resize(random.below(broken.size()));
      } else {
        // Half of them by any bit, half from one digit to another, which keeps the file's form.
        const bool digits_only = random.below(2) == 0;
        for (std::uint64_t flips = 1 + random.below(8); flips > 0; --flips) {
          char& byte = broken[random.below(broken.size())];
          if (!digits_only) byte = static_cast<char>(byte ^ (1 << random.below(8)));
          if (digits_only && byte >= '0' && byte <= '9') byte = "0123456789-.e"[random.below(13)];
        }
      }
      const bool is_mtl = std::string_view(name) == "s.mtl";
      write_text(folder / "s.mtl", is_mtl ? broken : mtl);
      const std::filesystem::path file = folder / (is_mtl ? "s.obj" : name);
      std::filesystem::remove(file);
      write_text(file, is_mtl ? seeds[0].second : broken);
      try {
        for (const auto& mesh : load(file).list.meshes) {
          REQUIRE(mesh->attributes.size() == mesh->positions.size());
          for (const std::uint32_t index : mesh->indices) REQUIRE(index < mesh->positions.size());
          for (const glm::vec3& p : mesh->positions) REQUIRE(std::isfinite(p.x + p.y + p.z));
        }
        ++loaded;
      } catch (const InputError& refused) {
        REQUIRE(std::string(refused.what()).starts_with(folder.path().string()));
      }
    }
    MESSAGE(std::string(name) << ": " << loaded << " of " << files << " loaded");
    CHECK(loaded < files);
  }
}

TEST_CASE("other people's OBJ files") {
  const std::filesystem::path folder = std::filesystem::path(SIMVIS_SHARED_DATA) / "peer_refs/drake/meshes";
  if (!std::filesystem::exists(folder)) {
    std::cout << "skipped: no mesh files in " << folder << "\n";
    return;
  }
  for (const char* name : {"box.obj", "rainbow_box.obj"}) {
    const Totals totals = total(load(folder / name).list);
    MESSAGE(std::string(name) << ": " << totals.triangles << " triangles");
    CHECK(totals.triangles >= 12);
  }
}
