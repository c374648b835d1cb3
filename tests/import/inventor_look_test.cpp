// The look of Inventor and VRML parts: materials, colours, textures, transparency, lights.
#include <doctest/doctest.h>

#include <numbers>
#include <string>
#include <vector>

#include "tests/support/parts/inventor_fixture.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// A colour passes one power function and a rounding to float32, each with a relative error of 6e-8.
constexpr double kColorRounding = 1e-6;

void check_color(const glm::vec3& color, const glm::dvec3& srgb) {
  for (int i = 0; i < 3; ++i) CHECK(std::abs(static_cast<double>(color[i]) - linear_of_srgb(srgb[i])) < kColorRounding);
}

// Red, green / blue, white, with rows from the top.
const std::vector<ByteString> kPictureRows{{255, 0, 0, 0, 255, 0}, {0, 0, 255, 255, 255, 255}};
const std::vector<std::uint8_t> kPictureRgba{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};

const std::string kSquare =
    "Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] ";

// The uv at a corner of the unit square.
glm::vec2 uv_at(const Mesh& mesh, const glm::vec3& position) {
  for (const std::uint32_t index : mesh.indices) {
    if (mesh.positions[index] == position) return mesh.attributes[index].uv[0];
  }
  FAIL("no such corner");
  return {};
}

}  // namespace

TEST_CASE("materials become base colour, emission and opacity") {
  if (!has_coin()) return;
  InventorFiles files;
  const std::string fields = "diffuseColor 0.5 0.25 0.75 emissiveColor 0.1 0.2 0.3 transparency 0.25";
  const std::string in_vrml =
      "Shape { appearance Appearance { material Material { " + fields + " } } geometry Box { } }";
  for (const LoadedPart& part : {files.iv("Material { " + fields + " } Cube { }"), files.vrml(in_vrml)}) {
    const Material& material = material_of(part, 0);
    check_color(material.base_color, {0.5, 0.25, 0.75});
    check_color(material.emissive, {0.1, 0.2, 0.3});
    CHECK(material.base_color.a == 0.75f);
    CHECK(material.alpha_mode == AlphaMode::blend);
    CHECK(!material.unlit);
    CHECK(material.base_color_texture == nullptr);
  }
  const LoadedPart plain = files.iv("LightModel { model BASE_COLOR } Cube { }");
  CHECK(material_of(plain, 0).unlit);
  CHECK(material_of(plain, 0).alpha_mode == AlphaMode::opaque);
  check_color(material_of(plain, 0).base_color, glm::dvec3(0.8));  // Inventor's default
}

TEST_CASE("colours of faces and vertices become vertex colours") {
  if (!has_coin()) return;
  InventorFiles files;
  const std::string two_faces =
      "Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } IndexedFaceSet { coordIndex [ 0, 1, 2, -1, 0, 2, 3, -1 ] }";
  const LoadedPart per_face = files.iv(
      "Material { diffuseColor [ 0.5 0 0, 0 0.5 0 ] transparency [ 0, 0.5 ] } "
      "MaterialBinding { value PER_FACE } " +
      two_faces);
  const Mesh& mesh = mesh_of(per_face, 0);
  REQUIRE(mesh.indices.size() == 6);
  CHECK(material_of(per_face, 0).base_color == glm::vec4(1));
  CHECK(material_of(per_face, 0).alpha_mode == AlphaMode::blend);
  for (std::size_t i = 0; i < 6; ++i) {
    const glm::vec4 color = mesh.attributes[mesh.indices[i]].color;
    check_color(color, i < 3 ? glm::dvec3(0.5, 0, 0) : glm::dvec3(0, 0.5, 0));
    CHECK(color.a == (i < 3 ? 1.0f : 0.5f));
  }
  const LoadedPart packed = files.iv(
      "PackedColor { orderedRGBA [ 0xff0000ff, 0x0000ff80 ] } "
      "MaterialBinding { value PER_FACE } " +
      two_faces);
  const Mesh& packed_mesh = mesh_of(packed, 0);
  CHECK(packed_mesh.attributes[packed_mesh.indices[0]].color == glm::vec4(1, 0, 0, 1));
  CHECK(glm::vec3(packed_mesh.attributes[packed_mesh.indices[3]].color) == glm::vec3(0, 0, 1));
  CHECK(packed_mesh.attributes[packed_mesh.indices[3]].color.a == doctest::Approx(128 / 255.0));
  const LoadedPart vrml = files.vrml(R"(Shape {
    appearance Appearance { material Material { } }
    geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 -1 ]
      color Color { color [ 1 0 0, 0 1 0, 0 0 1 ] } colorPerVertex TRUE } })");
  for (const std::uint32_t index : mesh_of(vrml, 0).indices) {
    const glm::vec3 p = mesh_of(vrml, 0).positions[index];
    CHECK(glm::vec3(mesh_of(vrml, 0).attributes[index].color) == glm::vec3(1 - p.x - p.y, p.x, p.y));
  }
}

TEST_CASE("a texture file covers a cube's front, its rows from the top") {
  if (!has_coin()) return;
  InventorFiles files;
  write_bytes(files.folder / "four.png", png(2, 2, 8, 2, kPictureRows));
  const LoadedPart part = files.iv(
      "Texture2 { filename \"four.png\" wrapS CLAMP } Texture2Transform { translation 0.25 0.5 scaleFactor 2 3 } "
      "Cube { }");
  CHECK(part.content.warnings.empty());
  const Material& material = material_of(part, 0);
  REQUIRE(material.base_color_texture != nullptr);
  const Texture& texture = *material.base_color_texture;
  CHECK(texture.width == 2);
  CHECK(texture.height == 2);
  CHECK(texture.rgba == kPictureRgba);
  CHECK(texture.sampler.wrap_u == Wrap::clamp_to_edge);
  CHECK(texture.sampler.wrap_v == Wrap::repeat);
  CHECK(material.alpha_mode == AlphaMode::opaque);
  const Mesh& mesh = mesh_of(part, 0);
  CHECK(mesh.indices.size() == 36);
  int corners = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.attributes[i].normal.z < 0.5f) continue;
    // s grows with x and t with y; v is measured from the top.
    const double s = mesh.positions[i].x > 0 ? 1 : 0, t = mesh.positions[i].y > 0 ? 1 : 0;
    CHECK(mesh.attributes[i].uv[0] == glm::vec2(s, 1 - t));
    const glm::vec2 moved = material.uv_transform * glm::vec3(mesh.attributes[i].uv[0], 1);
    CHECK(moved.x == doctest::Approx(2 * s + 0.25));
    CHECK(moved.y == doctest::Approx(1 - (3 * t + 0.5)));
    ++corners;
  }
  CHECK(corners == 4);
}

TEST_CASE("VRML97 textures: files, pixels, and their effect on the diffuse colour") {
  if (!has_coin()) return;
  InventorFiles files;
  write_bytes(files.folder / "four.png", png(2, 2, 8, 2, kPictureRows));
  write_bytes(files.folder / "grey.png", png(1, 1, 8, 0, {{100}}));
  const auto box = [&](const std::string& texture) {
    return files.vrml("Shape { appearance Appearance { material Material { diffuseColor 0.5 0.5 0.5 } texture " +
                      texture + " } geometry Box { } }");
  };
  const LoadedPart color = box("ImageTexture { url \"four.png\" repeatT FALSE }");
  CHECK(color.content.warnings.empty());
  REQUIRE(material_of(color, 0).base_color_texture != nullptr);
  CHECK(material_of(color, 0).base_color_texture->rgba == kPictureRgba);
  CHECK(material_of(color, 0).base_color_texture->sampler.wrap_v == Wrap::clamp_to_edge);
  CHECK(material_of(color, 0).base_color == glm::vec4(1));  // coloured pictures replace it
  const LoadedPart grey = box("ImageTexture { url \"grey.png\" }");
  REQUIRE(material_of(grey, 0).base_color_texture != nullptr);
  CHECK(material_of(grey, 0).base_color_texture->rgba == std::vector<std::uint8_t>{100, 100, 100, 255});
  check_color(material_of(grey, 0).base_color, glm::dvec3(0.5));  // grey ones multiply it
  // The first pixel is the lower left one.
  const LoadedPart pixels = box("PixelTexture { image 1 2 3 0xFF0000 0x0000FF }");
  REQUIRE(material_of(pixels, 0).base_color_texture != nullptr);
  CHECK(material_of(pixels, 0).base_color_texture->rgba == std::vector<std::uint8_t>{0, 0, 255, 255, 255, 0, 0, 255});
}

TEST_CASE("inline pictures of one to four components, and the use of their alpha") {
  if (!has_coin()) return;
  InventorFiles files;
  const auto texture = [&](const std::string& image) {
    const LoadedPart part = files.iv("Texture2 { image " + image + " } Cube { }");
    REQUIRE(material_of(part, 0).base_color_texture != nullptr);
    return std::pair(material_of(part, 0).base_color_texture->rgba, material_of(part, 0).alpha_mode);
  };
  using Pixels = std::vector<std::uint8_t>;
  CHECK(texture("1 1 1 0x40") == std::pair(Pixels{64, 64, 64, 255}, AlphaMode::opaque));
  CHECK(texture("1 1 2 0x4080") == std::pair(Pixels{64, 64, 64, 128}, AlphaMode::blend));
  CHECK(texture("1 1 3 0x102030") == std::pair(Pixels{16, 32, 48, 255}, AlphaMode::opaque));
  CHECK(texture("2 1 4 0x102030FF 0x40506000") == std::pair(Pixels{16, 32, 48, 255, 64, 80, 96, 0}, AlphaMode::mask));
}

TEST_CASE("texture coordinates come from the file, or from the shape's extent if it has none") {
  if (!has_coin()) return;
  InventorFiles files;
  const std::string image = "Texture2 { image 1 1 1 0x40 } ";
  const LoadedPart given = files.iv(image + "TextureCoordinate2 { point [ 0 0, 4 0, 4 2, 0 2 ] } " + kSquare +
                                    "textureCoordIndex [ 0, 1, 2, 3, -1 ] }");
  CHECK(uv_at(mesh_of(given, 0), {1, 1, 0}) == glm::vec2(4, 1 - 2));
  CHECK(uv_at(mesh_of(given, 0), {0, 0, 0}) == glm::vec2(0, 1));
  // The longest side of the box around it is s, the next one t, both from 0 to 1.
  const LoadedPart generated = files.iv(image +
                                        "Coordinate3 { point [ 0 0 0, 2 0 0, 2 1 0, 0 1 0 ] } "
                                        "IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] }");
  CHECK(uv_at(mesh_of(generated, 0), {2, 1, 0}) == glm::vec2(1, 0));
  CHECK(uv_at(mesh_of(generated, 0), {0, 0, 0}) == glm::vec2(0, 1));
  // They are unused without a texture, and meshes that differ only in them are one mesh.
  const LoadedPart both = files.iv("TextureCoordinate2 { point [ 0 0, 4 0, 4 2, 0 2 ] } " + kSquare + "}" + kSquare +
                                   "textureCoordIndex [ 0, 1, 2, 3, -1 ] }");
  CHECK(both.list.meshes.size() == 1);
}

TEST_CASE("lights have Inventor's brightness in lux and candela") {
  if (!has_coin()) return;
  InventorFiles files;
  const LoadedPart iv = files.iv(R"(
    Translation { translation 1 2 3 }
    DirectionalLight { direction 0 0 -2 intensity 0.5 color 0.5 1 1 }
    PointLight { location 0 0 4 }
    SpotLight { location 1 0 0 direction 1 0 0 cutOffAngle 0.4 dropOffRate 0.25 }
    PointLight { on FALSE })");
  REQUIRE(iv.list.lights.size() == 3);
  const Light& sun = iv.list.lights[0].light;
  CHECK(sun.kind == LightKind::directional);
  CHECK(sun.direction == glm::dvec3(0, 0, -1));
  // A white surface reflects irradiance / pi.
  CHECK(sun.intensity / std::numbers::pi == doctest::Approx(0.5));
  check_color(sun.color, {0.5, 1, 1});
  const LightItem& lamp = iv.list.lights[1];
  CHECK(lamp.light.kind == LightKind::point);
  CHECK(lamp.light.intensity / std::numbers::pi == doctest::Approx(1));
  CHECK(glm::dvec3(iv.list.world_from_node[lamp.transform][3]) == glm::dvec3(1, 2, 7));
  const LightItem& spot = iv.list.lights[2];
  CHECK(spot.light.kind == LightKind::spot);
  CHECK(spot.light.outer_cone_rad == doctest::Approx(0.4));
  CHECK(spot.light.inner_cone_rad == doctest::Approx(0.3));
  CHECK(glm::dvec3(iv.list.world_from_node[spot.transform][3]) == glm::dvec3(2, 2, 3));
  const LoadedPart vrml = files.vrml(R"(
    DirectionalLight { direction 1 0 0 }
    PointLight { location 1 0 0 radius 7 }
    SpotLight { beamWidth 0.2 cutOffAngle 0.5 })");
  REQUIRE(vrml.list.lights.size() == 3);
  CHECK(vrml.list.lights[0].light.direction == glm::dvec3(1, 0, 0));
  CHECK(vrml.list.lights[1].light.range_m == 7);
  CHECK(vrml.list.lights[2].light.inner_cone_rad == doctest::Approx(0.2));
  CHECK(vrml.list.lights[2].light.outer_cone_rad == doctest::Approx(0.5));
}

TEST_SUITE_END();
