#include "tests/support/parts/box_files.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <sstream>

#include "scenegraph/flattener.h"

namespace simvis::test {

namespace {

constexpr std::array<std::array<float, 3>, 8> kCorners{
    {{1, 2, 3}, {2, 2, 3}, {2, 4, 3}, {1, 4, 3}, {1, 2, 6}, {2, 2, 6}, {2, 4, 6}, {1, 4, 6}}};
constexpr std::array<std::array<int, 4>, 6> kSides{
    // counter-clockwise from outside
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}}};

}  // namespace

PartContent import(const std::filesystem::path& file, ContentPool& pool, bool up_given, UpAxis up) {
  const PartImporter importer = find_part_importer(file);
  REQUIRE((importer != nullptr));
  return importer({.file = file, .up_given = up_given, .up = up}, pool);
}

Loaded load(const std::filesystem::path& file, bool up_given, UpAxis up) {
  ContentPool pool;
  const PartContent content = import(file, pool, up_given, up);
  const auto root = std::make_shared<Group>();
  root->add(content.root);
  return {Flattener(root).update(), content.warnings};
}

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

void put_float(std::string& bytes, float value, bool big_endian) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> (big_endian ? 24 - 8 * i : 8 * i));
}

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

std::string stl_box(bool binary, bool with_normals) {
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

std::string dae_box(const std::string& asset, float scale, const std::string& node_matrix, const std::string& effect) {
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

}  // namespace simvis::test
