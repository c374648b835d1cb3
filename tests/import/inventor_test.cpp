// Inventor and VRML parts: shapes, sharing, switches, normals, commands, included files.
#include <doctest/doctest.h>

#include <numbers>
#include <string>
#include <vector>

#include "tests/support/parts/inventor_fixture.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Positions and normals of these tests are of the order of 1 and have several float32 roundings of 6e-8 each.
constexpr double kRounding = 1e-6;

// A roof: two triangles that share the edge from (0,0,0) to (0,1,0); their normals make `angle_rad` with each other.
std::string roof(double angle_rad) {
  const double x = std::cos(angle_rad / 2), z = -std::sin(angle_rad / 2);
  const auto point = [](double a, double b, double c) {
    return std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + ", ";
  };
  return "[ " + point(0, 0, 0) + point(0, 1, 0) + point(x, 0, z) + point(-x, 0, z) + "]";
}

const std::string kRoofFaces = "coordIndex [ 0, 2, 1, -1, 0, 1, 3, -1 ]";

// Largest component of the normals at the ridge, in x: 0 when the ridge is smooth.
double ridge_normal_x(const LoadedPart& part) {
  double x = 0;
  int corners = 0;
  const Mesh& mesh = mesh_of(part, 0);
  for (const std::uint32_t index : mesh.indices) {
    if (mesh.positions[index].x != 0) continue;
    ++corners;
    x = std::max(x, std::abs(static_cast<double>(mesh.attributes[index].normal.x)));
    CHECK(std::abs(static_cast<double>(glm::length(mesh.attributes[index].normal)) - 1) < kRounding);
    CHECK(mesh.attributes[index].normal.z > 0);
  }
  CHECK(corners == 4);
  return x;
}

}  // namespace

TEST_CASE("both file endings have an importer; a build without Coin names what is missing") {
  TemporaryFolder folder;
  write_text(folder / "part.wrl", kVrml97Header);
  ContentPool pool;
  REQUIRE((find_part_importer("A.IV") != nullptr));
  REQUIRE((find_part_importer("a.wrl") != nullptr));
  if (has_coin()) {
    CHECK(flatten(import_part(folder / "part.wrl", pool)).items.empty());
    return;
  }
  const std::string error = error_of([&] { import_part(folder / "part.wrl", pool); });
  CHECK(error.starts_with((folder / "part.wrl").string() + ": error: "));
  CHECK(contains(error, "has no Coin"));
  CHECK(contains(error, "install libcoin-dev"));
}

TEST_CASE("a cube has twelve triangles that face outwards") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart part = files.iv("Translation { translation 5 0 0 } Cube { width 2 height 3 depth 4 }");
  REQUIRE(part.list.items.size() == 1);
  const PartMeasure cube = measure(part.list);
  CHECK(cube.triangles == 12);
  CHECK(cube.area == doctest::Approx(2 * (2 * 3 + 3 * 4 + 4 * 2)));
  CHECK(cube.min == glm::dvec3(4, -1.5, -2));
  CHECK(cube.max == glm::dvec3(6, 1.5, 2));
  const Mesh& mesh = mesh_of(part, 0);
  CHECK(mesh.bounds_min == glm::vec3(-1, -1.5, -2));
  CHECK(mesh.positions.size() == 24);  // three normals meet at each of 8 corners
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    const glm::vec3 facing = glm::normalize(glm::cross(b - a, c - a));
    for (std::size_t k = 0; k < 3; ++k) CHECK(mesh.attributes[mesh.indices[i + k]].normal == facing);
    CHECK(glm::dot(facing, a) > 0);
  }
}

TEST_CASE("binary Inventor is read, and up=\"y\" turns a part") {
  if (!has_coin()) return;
  const auto padded = [](const std::string& name) {
    std::string bytes{0, 0, 0, static_cast<char>(name.size())};
    bytes += name;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return bytes;
  };
  const auto number = [](unsigned char high, unsigned char next) {
    return std::string{static_cast<char>(high), static_cast<char>(next), 0, 0};
  };
  const std::string zero(4, '\0'), one{0, 0, 0, 1}, three{0, 0, 0, 3};
  std::string text = "#Inventor V2.1 binary  \n";
  text += padded("Separator") + zero + zero + one + padded("Cube") + zero + three;
  text += padded("width") + number(0x40, 0) + zero;      // 2.0f, big-endian
  text += padded("height") + number(0x40, 0x40) + zero;  // 3.0f
  text += padded("depth") + number(0x40, 0x80) + zero;   // 4.0f
  InventorFiles files;
  const PartMeasure as_it_is = measure(files.load("binary.iv", text).list);
  CHECK(as_it_is.max == glm::dvec3(1, 1.5, 2));
  const PartContent turned = find_part_importer("a.iv")({files.folder / "binary.iv", true, UpAxis::y}, files.pool);
  CHECK(measure(flatten(turned)).max == glm::dvec3(1, 2, 1.5));
  CHECK(measure(flatten(turned)).min == glm::dvec3(-1, -2, -1.5));
}

TEST_CASE("a node that a file uses several times is one mesh under several transforms") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart part = files.iv(R"(
    Material { diffuseColor 1 0 0 }
    DEF BALL Sphere { radius 0.5 }
    Translation { translation 1 0 0 } USE BALL
    Translation { translation 1 0 0 } Material { diffuseColor 0 1 0 } USE BALL
    Separator { Scale { scaleFactor 2 2 2 } Sphere { radius 0.5 } })");
  CHECK(part.list.items.size() == 4);
  CHECK(part.list.meshes.size() == 1);
  CHECK(part.list.materials.size() == 2);
  CHECK(origin_of(part, 2) == glm::dvec3(2, 0, 0));
  CHECK(part.list.world_from_node[part.list.items[3].transform][0].x == 2);
  const auto& children = dynamic_cast<const Group&>(*part.content.root).children();
  CHECK(children.front()->name == "BALL");
}

TEST_CASE("a switch shows the children of its whichChild") {
  if (!has_coin()) return;
  InventorFiles files;
  const auto shown = [&](const std::string& which) {
    const LoadedPart part = files.iv("Switch { " + which + " Cube { width 1 } Cube { width 2 } Cube { width 3 } }");
    std::vector<float> widths;
    for (std::size_t i = 0; i < part.list.items.size(); ++i) widths.push_back(2 * mesh_of(part, i).bounds_max.x);
    return widths;
  };
  CHECK(shown("") == std::vector<float>{});
  CHECK(shown("whichChild -1") == std::vector<float>{});
  CHECK(shown("whichChild 1") == std::vector<float>{2});
  CHECK(shown("whichChild -3") == std::vector<float>{1, 2, 3});
  const LoadedPart vrml = files.vrml("Switch { whichChoice 0 choice [ Shape { geometry Box { } } ] }");
  CHECK(vrml.list.items.size() == 1);
}

TEST_CASE("normals are smooth up to the crease angle and flat beyond it") {
  if (!has_coin()) return;
  InventorFiles files;
  const double angle_rad = 40 * std::numbers::pi / 180;
  // The coordinates in the file have six decimals.
  const double written = 2e-6;
  const double flat = std::sin(angle_rad / 2);
  for (const bool smooth : {false, true}) {
    const std::string crease = "creaseAngle " + std::to_string(smooth ? angle_rad * 1.1 : angle_rad * 0.9);
    const double expected = smooth ? 0 : flat;
    const LoadedPart iv =
        files.iv("ShapeHints { vertexOrdering COUNTERCLOCKWISE " + crease + " } Coordinate3 { point " +
                 roof(angle_rad) + " } IndexedFaceSet { " + kRoofFaces + " }");
    CHECK(std::abs(ridge_normal_x(iv) - expected) < written + kRounding);
    const LoadedPart vrml =
        files.vrml("Shape { appearance Appearance { material Material { } } geometry IndexedFaceSet { " + crease +
                   " coord Coordinate { point " + roof(angle_rad) + " } " + kRoofFaces + " } }");
    CHECK(std::abs(ridge_normal_x(vrml) - expected) < written + kRounding);
  }
}

TEST_CASE("the order of a face's corners and its hints determine the drawn sides") {
  if (!has_coin()) return;
  InventorFiles files;
  const std::string face =
      "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] }";
  const auto facing_z = [](const LoadedPart& part) {
    const Mesh& mesh = mesh_of(part, 0);
    const auto corner = [&](std::size_t i) { return mesh.positions[mesh.indices[i]]; };
    return glm::cross(corner(1) - corner(0), corner(2) - corner(0)).z;
  };
  const auto hints = [&](const std::string& text) { return files.iv("ShapeHints { " + text + " } " + face); };
  const LoadedPart solid = hints("vertexOrdering COUNTERCLOCKWISE shapeType SOLID");
  CHECK(!material_of(solid, 0).double_sided);
  CHECK(facing_z(solid) == 1);
  const LoadedPart clockwise = hints("vertexOrdering CLOCKWISE shapeType SOLID");
  CHECK(!material_of(clockwise, 0).double_sided);
  CHECK(facing_z(clockwise) == -1);
  CHECK(mesh_of(clockwise, 0).attributes[0].normal.z == -1);
  CHECK(material_of(hints("vertexOrdering COUNTERCLOCKWISE"), 0).double_sided);
  CHECK(material_of(hints("shapeType SOLID"), 0).double_sided);
  // Where the order is unknown, the normals in the file determine the front.
  const LoadedPart turned = files.iv("Normal { vector 0 0 -1 } NormalBinding { value OVERALL } " + face);
  CHECK(facing_z(turned) == -1);
  CHECK(mesh_of(turned, 0).attributes[0].normal.z == -1);
  for (const bool is_solid : {false, true}) {
    const LoadedPart vrml =
        files.vrml("Shape { geometry IndexedFaceSet { ccw FALSE solid " + std::string(is_solid ? "TRUE" : "FALSE") +
                   " coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 -1 ] } }");
    CHECK(material_of(vrml, 0).double_sided == !is_solid);
    CHECK(facing_z(vrml) == -1);
  }
}

TEST_CASE("commands are in Info and WorldInfo nodes and begin with '<'") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart iv = files.iv(R"(
    Info { }
    Info { string "made by hand" }
    DEF FIRST Info { string "  <element type='pose' name='A'/>" }
    Separator { Info { string "<element type='pose' name='B'/>" } USE FIRST }
    Switch { Info { string "<element type='pose' name='OFF'/>" } })");
  CHECK(iv.content.commands ==
        std::vector<std::string>{"  <element type='pose' name='A'/>", "<element type='pose' name='B'/>"});
  const LoadedPart vrml = files.vrml("WorldInfo { title \"<no/>\" info [ \"a robot\" \"<part/>\" \"<sensor/>\" ] }");
  CHECK(vrml.content.commands == std::vector<std::string>{"<part/>", "<sensor/>"});
  const LoadedPart vrml1 = files.load("one.wrl", "#VRML V1.0 ascii\nInfo { string \"<part/>\" }\n");
  CHECK(vrml1.content.commands == std::vector<std::string>{"<part/>"});
}

TEST_CASE("lines and points keep their kind and are not lit") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart iv = files.iv(R"(
    BaseColor { rgb 1 0 0 }
    Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0 ] }
    LineSet { numVertices 3 }
    PointSet { })");
  REQUIRE(iv.list.items.size() == 2);
  CHECK(mesh_of(iv, 0).topology == Topology::lines);
  CHECK(mesh_of(iv, 0).indices.size() == 4);
  CHECK(mesh_of(iv, 1).topology == Topology::points);
  CHECK(mesh_of(iv, 1).indices.size() == 3);
  CHECK(material_of(iv, 0).unlit);
  CHECK(material_of(iv, 0).base_color == glm::vec4(1, 0, 0, 1));
  // VRML97 draws lines without colours of their own in the emissive colour.
  const LoadedPart vrml = files.vrml(R"(Shape {
    appearance Appearance { material Material { diffuseColor 1 1 1 emissiveColor 0 1 0 } }
    geometry IndexedLineSet { coord Coordinate { point [ 0 0 0, 1 0 0 ] } coordIndex [ 0 1 -1 ] } })");
  CHECK(material_of(vrml, 0).unlit);
  CHECK(material_of(vrml, 0).base_color == glm::vec4(0, 1, 0, 1));
  const LoadedPart styled = files.iv("DrawStyle { style LINES } Cube { } DrawStyle { style INVISIBLE } Sphere { }");
  CHECK(measure(styled.list).lines == 36);  // twelve triangles' edges
  CHECK(measure(styled.list).triangles == 0);
}

TEST_CASE("paths of included files and textures are relative to the file that names them") {
  if (!has_coin()) return;
  InventorFiles files;
  std::filesystem::create_directories(files.folder / "sub/deep");
  write_bytes(files.folder / "sub/red.png", png(1, 1, 8, 2, {{255, 0, 0}}));
  write_text(files.folder / "sub/deep/leaf.iv", kInventorHeader + "Cube { }\n");
  write_text(files.folder / "sub/inner.iv",
             kInventorHeader + "Texture2 { filename \"red.png\" } File { name \"deep/leaf.iv\" }\n");
  const auto check_cube = [](const LoadedPart& part) {
    CHECK(part.content.warnings.empty());
    REQUIRE(part.list.items.size() == 1);
    CHECK(mesh_of(part, 0).indices.size() == 36);
    REQUIRE(material_of(part, 0).base_color_texture != nullptr);
    CHECK(material_of(part, 0).base_color_texture->rgba == std::vector<std::uint8_t>{255, 0, 0, 255});
  };
  check_cube(files.iv("File { name \"sub/inner.iv\" }"));
  check_cube(files.vrml("Inline { url \"sub/inner.iv\" }"));
  check_cube(files.load("one.wrl", "#VRML V1.0 ascii\nWWWInline { name \"sub/inner.iv\" }\n"));
}

TEST_CASE("a texture that cannot be read is skipped with a warning") {
  if (!has_coin()) return;
  InventorFiles files;
  const auto warning_of = [](const LoadedPart& part) {
    return part.content.warnings.empty() ? "no warning" : part.content.warnings.front();
  };
  write_text(files.folder / "bad.png", "no picture");
  for (const std::string name : {"none.png", "bad.png"}) {
    const LoadedPart iv = files.iv("Texture2 { filename \"" + name + "\" } Cube { }");
    CHECK(iv.list.items.size() == 1);
    CHECK(warning_of(iv).starts_with((files.folder / "part.iv").string() + ": "));
    CHECK(contains(warning_of(iv), name));
    const LoadedPart vrml = files.vrml("Shape { appearance Appearance { texture ImageTexture { url \"" + name +
                                       "\" } } geometry Box { } }");
    CHECK(vrml.list.items.size() == 1);
    CHECK(contains(warning_of(vrml), name));
  }
}

TEST_SUITE_END();
