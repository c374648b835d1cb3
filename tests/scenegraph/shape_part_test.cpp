// Parts without a file, and files in other units.
#include "scenegraph/shape_part.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "import/model/shape_nodes.h"
#include "scenegraph/flattener.h"
#include "scenegraph/primitive_meshes.h"
#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/stub_part.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr double kRadius = 2, kLength = 3;

// Positions are float32: each coordinate is off by half a unit in the last place of at most 4.
constexpr double kPosition_m = 3 * 2.4e-7;

glm::dvec3 corner(const Mesh& mesh, std::size_t index) { return mesh.positions[mesh.indices[index]]; }

// Six times the volume between the triangles and the origin.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    sum += glm::dot(corner(mesh, i), glm::cross(corner(mesh, i + 1), corner(mesh, i + 2)));
  }
  return sum / 6;
}

// Whether each edge, between positions, is there once in each direction.
bool is_closed(const Mesh& mesh) {
  const auto key = [](const glm::vec3& p) {
    return std::array{std::lround(p.x * 1e4), std::lround(p.y * 1e4), std::lround(p.z * 1e4)};
  };
  std::map<std::pair<std::array<long, 3>, std::array<long, 3>>, int> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
    ++edges[{key(mesh.positions[mesh.indices[i]]), key(mesh.positions[mesh.indices[next]])}];
  }
  for (const auto& [edge, count] : edges) {
    if (count != 1 || edges.count({edge.second, edge.first}) != 1) return false;
  }
  return !edges.empty();
}

// The largest depth of a point of a triangle below the round surface, whose distance from the outside `outside` gives:
// negative within. Triangles are probed at 66 points each.
template <typename Outside>
std::pair<double, double> deviation(const Mesh& mesh, const Outside& outside) {
  constexpr int kSteps = 10;
  double lowest = 0, highest = -1;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const glm::dvec3 point = (double(a) * corner(mesh, i) + double(b) * corner(mesh, i + 1) +
                                  double(kSteps - a - b) * corner(mesh, i + 2)) /
                                 double(kSteps);
        lowest = std::min(lowest, outside(point));
        highest = std::max(highest, outside(point));
      }
    }
  }
  return {lowest, highest};
}

TEST_CASE("solids are closed, face outwards, and lie within the stated depth of the round surface") {
  const double half_turn_of_side = std::numbers::pi / kSidesAround;
  const double flat = kRadius * (1 - std::cos(half_turn_of_side));
  const double diagonal = kRadius * (1 - std::pow(std::cos(half_turn_of_side), 2));
  const auto capsule = [](const glm::dvec3& p) {
    const double beyond = std::max(std::abs(p.z) - kLength / 2, 0.0);
    return std::hypot(p.x, p.y, beyond) - kRadius;
  };
  const auto cylinder = [](const glm::dvec3& p) {
    return std::max(std::hypot(p.x, p.y) - kRadius, std::abs(p.z) - kLength / 2);
  };
  const auto cone = [](const glm::dvec3& p) {  // at the height of the point, across the axis
    return std::max(std::hypot(p.x, p.y) - kRadius * (0.5 - p.z / kLength), -kLength / 2 - p.z);
  };
  for (const auto& [mesh, lowest, highest] :
       {std::tuple{capsule_mesh(kRadius, kLength), deviation(capsule_mesh(kRadius, kLength), capsule), diagonal},
        std::tuple{sphere_mesh(kRadius),
                   deviation(sphere_mesh(kRadius), [](const glm::dvec3& p) { return glm::length(p) - kRadius; }),
                   diagonal},
        std::tuple{cylinder_mesh(kRadius, kLength), deviation(cylinder_mesh(kRadius, kLength), cylinder), flat},
        std::tuple{cone_mesh(kRadius, kLength), deviation(cone_mesh(kRadius, kLength), cone), flat}}) {
    CAPTURE(mesh.name);
    CHECK(is_closed(mesh));
    if (mesh.name == "cylinder" || mesh.name == "cone") {
      CHECK(lowest.second <= kPosition_m);  // the flat ends have points of any depth
    } else {
      CHECK(lowest.first >= -highest - kPosition_m);
      CHECK(lowest.first <= -0.9 * highest);  // the stated depth is reached
      CHECK(lowest.second <= kPosition_m);
    }
  }
  // A polygon of n sides has n / 2 sin(2 pi / n) r^2 of the circle's pi r^2.
  const double area = kSidesAround / 2.0 * std::sin(2 * half_turn_of_side) * kRadius * kRadius;
  CHECK(volume(cylinder_mesh(kRadius, kLength)) == doctest::Approx(area * kLength).epsilon(1e-6));
  CHECK(volume(cone_mesh(kRadius, kLength)) == doctest::Approx(area * kLength / 3).epsilon(1e-6));
  CHECK(volume(capsule_mesh(kRadius, kLength)) ==
        doctest::Approx(volume(sphere_mesh(kRadius)) + area * kLength).epsilon(1e-6));
  CHECK(volume(box_mesh({1, 2, 3})) == doctest::Approx(6).epsilon(1e-6));
  CHECK(plane_mesh({4, 2}).bounds_min == glm::vec3(-2, -1, 0));
  CHECK(plane_mesh({4, 2}).bounds_max == glm::vec3(2, 1, 0));
}

TEST_CASE("normals of round shapes stand on the surface") {
  const Mesh cone = cone_mesh(kRadius, kLength);
  for (int i = 0; i <= 2 * kSidesAround + 1; ++i) {
    const glm::vec3& position = cone.positions[static_cast<std::size_t>(i)];
    const glm::vec3& normal = cone.attributes[static_cast<std::size_t>(i)].normal;
    const glm::dvec3 down_the_side = glm::dvec3(0, 0, kLength / 2) - glm::dvec3(position);
    CHECK(glm::length(normal) == doctest::Approx(1).epsilon(1e-6));
    CHECK(std::abs(glm::dot(glm::dvec3(normal), down_the_side)) < 1e-6);
  }
}

struct ShapeStage {
  ShapeStage() {
    write_text(folder / "a.stub", "triangle 2");
    write_text(folder / "carrier.stub", "point P");
  }
  BuiltScene build(const std::string& xml) const { return build_scene(parse_commands(xml, "s.xml", folder.path())); }
  std::string error(const std::string& xml) const {
    return error_of([&] { build(xml); });
  }
  DrawList list(const std::string& xml) const { return Flattener(build(xml).scene.root()).update(); }
  TemporaryFolder folder;
};

TEST_CASE("a shape is a part: it is inserted, placed, painted and moved like one") {
  const ShapeStage stage;
  const DrawList list = stage.list(R"(
    <part name="BOX" insert_at="ROOT" shape="box" size="4 0.1 2.5" color="0.8 0.7 0.5" pose_offset="1 2 3 0 0 90"/>
    <element type="pose" name="MOVE" insert_at="BOX" x="5"/>
    <part name="SAME" insert_at="BOX" shape="box" size=" 4 0.1  2.50" color="0.8 0.7 0.5"/>
    <part name="BALL" insert_at="SAME" shape="sphere" radius="1"/>)");
  REQUIRE(list.items.size() == 3);
  CHECK(list.meshes.size() == 2);     // equal boxes are one
  CHECK(list.materials.size() == 2);  // and so is their material
  bool painted = false, white = false;
  for (const auto& material : list.materials) {
    painted |= material->base_color == glm::vec4(0.8f, 0.7f, 0.5f, 1);
    white |= material->base_color == glm::vec4(1);
    CHECK(material->double_sided);
  }
  CHECK(painted);
  CHECK(white);
  for (const DrawItem& item : list.items) {
    const glm::dvec3 place(list.world_from_node[item.transform][3]);
    CHECK(glm::length(place - glm::dvec3(1, 7, 3)) < 1e-12);  // 5 m along x, which points along the world's y
  }
}

TEST_CASE("the faces of a box are where its size says, within rounding in double") {
  const ShapeStage stage;
  const glm::dvec3 half_m(0.1, 0.35, 1e3 / 3);
  const auto check = [&](const DrawList& list) {
    REQUIRE(list.items.size() == 1);
    const glm::dmat4& world_from_mesh = list.world_from_node[list.items[0].transform];
    for (const glm::vec3& position : list.meshes[list.items[0].mesh]->positions) {
      const glm::dvec3 corner(world_from_mesh * glm::dvec4(position, 1));
      for (int i = 0; i < 3; ++i) {
        constexpr double kTwoRoundings = 0x1p-52;  // of the scale and of its product
        CHECK(std::abs(std::abs(corner[i]) - half_m[i]) <= kTwoRoundings * half_m[i]);
      }
    }
  };
  check(stage.list("<part name='B' insert_at='ROOT' shape='box' size='0.2 0.7 " + format_number(2 * half_m.z) + "'/>"));
  const auto group = std::make_shared<Separator>();
  ContentPool pool;
  ShapeMeshes meshes(pool);
  add_shape_nodes({.kind = ModelShape::Kind::box, .size = 2.0 * half_m}, meshes, *group);
  check(Flattener(group).update());
  // Nothing is scaled where nothing was rounded.
  CHECK(exact_box_scale({0.5, 4, 2}) == glm::dmat4(1));
  CHECK(exact_box_scale({1e-60, 1e60, 2}) == glm::dmat4(1));  // beyond float32
}

TEST_CASE("a picture stands upright on each side of a box, and is not mirrored") {
  const Mesh mesh = box_mesh({2, 3, 4});
  REQUIRE(mesh.indices.size() == 6 * 6);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
    const auto uv = [&](std::size_t k) { return glm::dvec2(mesh.attributes[mesh.indices[i + k]].uv[0]); };
    const glm::dvec3 normal(mesh.attributes[mesh.indices[i]].normal);
    // Places along the picture: position = origin + u right + v down.
    const glm::dmat2 along(uv(1) - uv(0), uv(2) - uv(0));
    const glm::dmat2x3 sides(corner(1) - corner(0), corner(2) - corner(0));
    const glm::dmat2x3 axes = sides * glm::inverse(along);
    const glm::dvec3 right = glm::normalize(axes[0]), up = -glm::normalize(axes[1]);
    CAPTURE(normal.x);
    CAPTURE(normal.y);
    CAPTURE(normal.z);
    CHECK(glm::cross(right, up) == normal);
    if (normal.z == 0) CHECK(up == glm::dvec3(0, 0, 1));
    if (normal.z == 1) CHECK(up == glm::dvec3(0, 1, 0));
  }
}

TEST_CASE("equal shapes of robots are computed once, and all ellipsoids are one sphere") {
  using Kind = ModelShape::Kind;
  ContentPool pool;
  ShapeMeshes meshes(pool);
  const auto group = std::make_shared<Separator>();
  for (int i = 0; i < 3; ++i) {
    add_shape_nodes({.kind = Kind::cylinder, .size = {0.5, 0, 2}}, meshes, *group);
    add_shape_nodes({.kind = Kind::capsule, .size = {0.5, 0, 2}}, meshes, *group);
    add_shape_nodes({.kind = Kind::ellipsoid, .size = {1.0 + i, 2, 3}}, meshes, *group);
  }
  CHECK(meshes.computed() == 3);
  CHECK(meshes.mesh({.kind = Kind::cylinder, .size = {0.5, 0, 2}})->surface == cylinder_mesh(0.5, 2).surface);
}

TEST_CASE("a part without file and shape is an empty frame") {
  const ShapeStage stage;
  const BuiltScene built = stage.build(R"(
    <part name="FRAME" insert_at="ROOT" pose_offset="1 0 0 0 0 0"/>
    <part name="A" file="a.stub" insert_at="FRAME"/>)");
  const DrawList list = Flattener(built.scene.root()).update();
  REQUIRE(list.items.size() == 1);
  CHECK(list.world_from_node[list.items[0].transform][3] == glm::dvec4(1, 0, 0, 1));
}

TEST_CASE("contradictions in shapes are reported where they stand") {
  const ShapeStage stage;
  const auto refused = [&](const std::string& attributes) {
    return stage.error("<part name='A' insert_at='ROOT' " + attributes + "/>");
  };
  CHECK(refused("file='a.stub' shape='box' size='1 1 1'") ==
        "s.xml:1:47: error: attribute \"shape\": the part has a file already, expected a file or a shape, not both");
  CHECK(refused("shape='sphere' size='1 1 1'") ==
        "s.xml:1:48: error: attribute \"size\": a sphere has none, expected radius");
  CHECK(contains(refused("shape='box' size='1 1 1' radius='1'"), "\"radius\": a box has none, expected size"));
  CHECK(contains(refused("shape='sphere' radius='1' length='1'"), "\"length\": a sphere has none"));
  CHECK(refused("shape='cone' radius='1'") ==
        "s.xml:1:2: error: a cone without attribute \"length\", expected radius and length");
  CHECK(contains(refused("shape='box'"), "a box without attribute \"size\""));
  CHECK(contains(refused("shape='box' size='1 1'"), "expected three numbers x y z from 1e-06 to 1000000 (m)"));
  CHECK(
      contains(refused("shape='box' size='1 0 1'"), "s.xml:1:45: error: attribute \"size\": \"1 0 1\" is not allowed"));
  CHECK(contains(refused("shape='plane' size='1 1 1'"), "expected two numbers x y"));
  CHECK(contains(refused("shape='plane' size='1 nan'"), "expected two numbers x y"));
  CHECK(contains(refused("shape='sphere' radius='-1'"), "expected a number from 1e-06 to 1000000 (m)"));
  CHECK(contains(refused("shape='ball' radius='1'"), "expected one of: box, sphere, cylinder, cone, capsule, plane"));
  CHECK(contains(refused("size='1 1 1'"), "\"size\": it describes a shape, and the part has no attribute \"shape\""));
  CHECK(contains(refused("color='1 1 1'"), "\"color\": it describes a shape"));
  CHECK(contains(refused("file='a.stub' color='1 1 1'"), "\"color\": it describes a shape"));
  CHECK(contains(refused("shape='sphere' radius='1' color='1 2 1'"), "expected three numbers from 0 to 1"));
  for (const char* attribute : {"up='z'", "scale='2'", "unit='mm'"}) {
    CHECK(contains(refused(std::string("shape='sphere' radius='1' ") + attribute),
                   "it says how a file is read, and the part has no attribute \"file\""));
  }
}

TEST_CASE("a file in another unit is scaled, and what is inserted there is not") {
  const ShapeStage stage;
  const auto widths = [&](const std::string& attributes) {
    const DrawList list = stage.list("<part file='a.stub' name='A' insert_at='ROOT' pose_offset='1 0 0 0 0 0' " +
                                     attributes + "/><part file='a.stub' name='B' insert_at='A'/>");
    REQUIRE(list.items.size() == 2);
    glm::dvec2 lengths;
    for (int i = 0; i < 2; ++i) {
      const glm::dmat4& world = list.world_from_node[list.items[static_cast<std::size_t>(i)].transform];
      lengths[i] = glm::length(glm::dvec3(world[0]));
      CHECK(world[3] == glm::dvec4(1, 0, 0, 1));
    }
    return lengths;  // B stands before the shapes of A
  };
  CHECK(widths("") == glm::dvec2(1, 1));
  CHECK(widths("scale='0.001'") == glm::dvec2(1, 0.001));
  CHECK(widths("unit='mm'") == glm::dvec2(1, 0.001));
  CHECK(widths("unit='cm'") == glm::dvec2(1, 0.01));
  CHECK(widths("unit='m'") == glm::dvec2(1, 1));
  CHECK(widths("unit='inch'") == glm::dvec2(1, 0.0254));
  CHECK(widths("unit='cm' scale='3'") == glm::dvec2(1, 0.03));
}

TEST_CASE("mistakes in scale and unit") {
  const ShapeStage stage;
  write_text(stage.folder / "a.dae", "");
  CHECK(contains(stage.error("<part file='a.stub' name='A' insert_at='ROOT' scale='0'/>"),
                 "s.xml:1:47: error: attribute \"scale\": 0 is not allowed"));
  CHECK(contains(stage.error("<part file='a.stub' name='A' insert_at='ROOT' unit='ft'/>"),
                 "expected one of: mm, cm, m, inch"));
  CHECK(contains(stage.error("<part file='a.dae' name='A' insert_at='ROOT' unit='mm'/>"),
                 "a COLLADA file says its unit itself, expected \"scale\""));
  CHECK(contains(stage.error("<part file='carrier.stub' name='A' insert_at='ROOT' unit='mm'/>"),
                 "the file carries commands or insertion points, whose lengths are metres"));
}

}  // namespace
}  // namespace simvis
