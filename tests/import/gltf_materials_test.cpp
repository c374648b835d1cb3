// Materials and textures of glTF parts.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "tests/support/parts/gltf_loader.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Sums of products of float32 values below 2, formed in double and rounded once.
constexpr float kFactorTolerance = 2 * 0x1p-24f;

// 2 x 1 pixels: red, and half transparent green.
ByteString red_green_png() { return png(2, 1, 8, 6, {{255, 0, 0, 255, 0, 255, 0, 128}}); }

// A triangle with a material that shows picture `bytes` through sampler 0.
void add_textured_triangle(GltfBuilder& builder, const ByteString& bytes) {
  builder.triangle()["material"] = 0;
  builder.append("images", {{"bufferView", builder.view(bytes.data(), bytes.size())}, {"mimeType", "image/png"}});
  builder.append("samplers", json::object());
  builder.append("textures", {{"source", 0}, {"sampler", 0}});
  builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
}

std::vector<std::uint8_t> pixels_of(const ByteString& picture) {
  GltfLoader loader;
  GltfBuilder builder;
  add_textured_triangle(builder, picture);
  return loader.load(builder).list.materials.at(0)->base_color_texture->rgba;
}

Material material_of(json description, const std::vector<std::string>& extensions = {}) {
  GltfLoader loader;
  GltfBuilder builder;
  if (!extensions.empty()) builder.root["extensionsUsed"] = extensions;
  add_textured_triangle(builder, red_green_png());
  builder.root["materials"][0] = std::move(description);
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.materials.size() == 1);
  return *part.list.materials[0];
}

}  // namespace

TEST_CASE("factors, alpha modes and sides") {
  const Material plain = material_of(json::object());
  CHECK(plain == Material{});

  const Material full = material_of({{"name", "PAINT"},
                                     {"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 0.75, 0.125}}}},
                                     {"emissiveFactor", {0.5, 0, 1}},
                                     {"alphaMode", "MASK"},
                                     {"alphaCutoff", 0.75},
                                     {"doubleSided", true}});
  CHECK(full.name == "PAINT");
  CHECK(full.base_color == glm::vec4(0.25f, 0.5f, 0.75f, 0.125f));
  CHECK(full.emissive == glm::vec3(0.5f, 0, 1));
  CHECK(full.alpha_mode == AlphaMode::mask);
  CHECK(full.alpha_cutoff == 0.75f);
  CHECK(full.double_sided);
  CHECK(!full.unlit);
  CHECK(material_of({{"alphaMode", "BLEND"}}).alpha_mode == AlphaMode::blend);
  CHECK(material_of({{"alphaMode", "OPAQUE"}}).alpha_mode == AlphaMode::opaque);
}

TEST_CASE("KHR_materials_unlit and KHR_materials_emissive_strength") {
  const json unlit{{"KHR_materials_unlit", json::object()}};
  CHECK(material_of({{"extensions", unlit}}, {"KHR_materials_unlit"}).unlit);
  const json strong{{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}};
  CHECK(material_of({{"emissiveFactor", {0.5, 1, 0}}, {"extensions", strong}}, {"KHR_materials_emissive_strength"})
            .emissive == glm::vec3(4, 8, 0));
}

// The extension is archived; its text says how a material is read without metalness.
TEST_CASE("KHR_materials_pbrSpecularGlossiness: the diffuse colour and picture, unless there is a fallback") {
  const std::string name = "KHR_materials_pbrSpecularGlossiness";
  const json extension{{name,
                        {{"diffuseFactor", {0.25, 0.5, 0.75, 1}},
                         {"diffuseTexture", {{"index", 0}, {"texCoord", 1}}},
                         {"glossinessFactor", 0.25}}}};
  const Material read = material_of({{"extensions", extension}}, {name});
  CHECK(read.base_color == glm::vec4(0.25f, 0.5f, 0.75f, 1));
  REQUIRE(read.base_color_texture != nullptr);
  CHECK(read.uv_set == 1);
  CHECK(read.roughness == 0.75f);
  CHECK(read.metallic == 0);
  const Material fallback =
      material_of({{"extensions", extension}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}}, {name});
  CHECK(fallback.base_color == glm::vec4(1, 0, 0, 1));
  CHECK(fallback.base_color_texture == nullptr);

  GltfLoader loader;
  GltfBuilder builder;
  add_textured_triangle(builder, red_green_png());
  builder.root["extensionsRequired"] = builder.root["extensionsUsed"] = {name};
  builder.root["materials"][0] = {{"extensions", extension}};
  const std::vector<std::string> warnings = loader.load(builder).content.warnings;
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].ends_with("part.gltf: materials with " + name + " are shown without their specular colour"));
  builder.root["materials"][0]["extensions"][name]["diffuseTexture"]["index"] = 7;
  CHECK(loader.refusal(builder.text()).find("is 7, but the file has 1 textures") != std::string::npos);
}

TEST_CASE("an extension of materials is left out with a warning, also if it is required") {
  GltfLoader loader;
  GltfBuilder builder;
  add_textured_triangle(builder, red_green_png());
  builder.root["extensionsRequired"] = {"KHR_materials_clearcoat"};
  for (const bool is_listed : {false, true}) {
    if (is_listed) builder.root["extensionsUsed"] = {"KHR_materials_clearcoat"};
    const std::vector<std::string> warnings = loader.load(builder).content.warnings;
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].ends_with("extension KHR_materials_clearcoat is not supported and left out"));
  }
}

TEST_CASE("base colour textures, their UV set and KHR_texture_transform") {
  const auto textured = [](json info) {
    info["index"] = 0;
    return material_of({{"pbrMetallicRoughness", {{"baseColorTexture", std::move(info)}}}}, {"KHR_texture_transform"});
  };
  const Material plain = textured({{"texCoord", 1}});
  REQUIRE(plain.base_color_texture != nullptr);
  CHECK(plain.uv_set == 1);
  CHECK(plain.uv_transform == glm::mat3x2(1, 0, 0, 1, 0, 0));

  const auto transformed = [&](json transform) {
    return textured({{"texCoord", 1}, {"extensions", {{"KHR_texture_transform", std::move(transform)}}}});
  };
  CHECK(transformed({{"texCoord", 0}}).uv_set == 0);
  CHECK(transformed(json::object()).uv_set == 1);
  // Offset and scale alone: uv' = scale * uv + offset.
  CHECK(transformed({{"offset", {0.5, 0.25}}, {"scale", {2, -3}}}).uv_transform ==
        glm::mat3x2(2, 0, 0, -3, 0.5f, 0.25f));
  // A picture rotated by 22.5 degrees counter-clockwise, v down. The Khronos sample TextureTransformTest gives the
  // place on its quad where the picture's point (0.7778, 0.7778) must be visible: (0.42095, 1.01627).
  const glm::mat3x2 turn = transformed({{"rotation", 0.39269908169872414}}).uv_transform;
  const glm::vec2 seen = turn * glm::vec3(0.42095178f, 1.0162675f, 1);
  CHECK(std::abs(seen.x - 0.7778174593f) <= 8 * kFactorTolerance);
  CHECK(std::abs(seen.y - 0.7778174593f) <= 8 * kFactorTolerance);
  // All combined: first the scale, then the rotation, then the offset.
  const glm::mat3x2 all = transformed({{"offset", {0.5, 0.25}}, {"rotation", 1}, {"scale", {1.5, 0.5}}}).uv_transform;
  const double c = std::cos(1.0), s = std::sin(1.0);
  const glm::vec2 expected(c * 1.5 * 0.2 + s * 0.5 * 0.6 + 0.5, -s * 1.5 * 0.2 + c * 0.5 * 0.6 + 0.25);
  const glm::vec2 uv = all * glm::vec3(0.2f, 0.6f, 1);
  CHECK(std::abs(uv.x - expected.x) <= 4 * kFactorTolerance);
  CHECK(std::abs(uv.y - expected.y) <= 4 * kFactorTolerance);
}

TEST_CASE("pictures of every kind become RGBA8, rows from the top") {
  CHECK(pixels_of(red_green_png()) == ByteString{255, 0, 0, 255, 0, 255, 0, 128});
  CHECK(pixels_of(png(1, 2, 8, 2, {{1, 2, 3}, {4, 5, 6}})) == ByteString{1, 2, 3, 255, 4, 5, 6, 255});
  CHECK(pixels_of(png(2, 1, 8, 0, {{7, 8}})) == ByteString{7, 7, 7, 255, 8, 8, 8, 255});
  CHECK(pixels_of(png(2, 1, 1, 0, {{0x40}})) == ByteString{0, 0, 0, 255, 255, 255, 255, 255});
  CHECK(pixels_of(png(1, 1, 16, 0, {{0xAB, 0xCD}})) == ByteString{0xAB, 0xAB, 0xAB, 255});
  CHECK(pixels_of(png(1, 1, 16, 6, {{1, 0, 2, 0, 3, 0, 4, 0}})) == ByteString{1, 2, 3, 4});
}

TEST_CASE("pictures come from buffer views, data URIs and files") {
  const ByteString picture = red_green_png();
  for (const std::string& uri : {std::string("data:image/png;base64,") + base64(picture), std::string("my picture.png"),
                                 std::string("my%20picture.png")}) {
    CAPTURE(uri);
    GltfLoader loader;
    GltfBuilder builder;
    add_textured_triangle(builder, picture);
    write_bytes(loader.folder / "my picture.png", picture);
    builder.root["images"][0] = {{"uri", uri}};
    const auto texture = loader.load(builder).list.materials.at(0)->base_color_texture;
    CHECK(texture->width == 2);
    CHECK(texture->height == 1);
    CHECK(texture->rgba == ByteString{255, 0, 0, 255, 0, 255, 0, 128});
  }
}

TEST_CASE("pictures outside the folders of a glTF file are refused, however the URI says it") {
  const ByteString picture = red_green_png();
  const TemporaryFolder other;
  write_bytes(other / "secret.png", picture);
  const std::string absolute = (other / "secret.png").string();
  const std::string up = "../" + other.path().filename().string() + "/secret.png";
  const std::string hidden = "%2E%2e/" + other.path().filename().string() + "/secret.png";
  for (const std::string& uri : {absolute, "file://" + absolute, up, "x/../" + up, hidden, "file:%2F%2F" + absolute}) {
    CAPTURE(uri);
    GltfLoader loader;
    REQUIRE(loader.folder.path().parent_path() == other.path().parent_path());  // so that the relative names are right
    GltfBuilder builder;
    add_textured_triangle(builder, picture);
    builder.root["images"][0] = {{"uri", uri}};
    const LoadedPart part = loader.load(builder);
    CHECK(part.list.materials.at(0)->base_color_texture == nullptr);
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(contains(part.content.warnings[0], "images/0 has the URI"));
    CHECK(contains(part.content.warnings[0], "expected a relative path in the folders of the part"));
  }
}

TEST_CASE("samplers: wrap modes and filters") {
  const auto sampler_of = [](json description) {
    GltfLoader loader;
    GltfBuilder builder;
    add_textured_triangle(builder, red_green_png());
    builder.root["samplers"][0] = std::move(description);
    return loader.load(builder).list.materials.at(0)->base_color_texture->sampler;
  };
  constexpr Filter kNearest = Filter::nearest, kLinear = Filter::linear;
  CHECK(sampler_of(json::object()) == Sampler{});
  const Sampler wraps = sampler_of({{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  CHECK(wraps.wrap_u == Wrap::clamp_to_edge);
  CHECK(wraps.wrap_v == Wrap::mirrored_repeat);
  CHECK(wraps.magnify == kNearest);
  CHECK(sampler_of({{"wrapS", 10497}, {"magFilter", 9729}}) == Sampler{});
  struct Case {
    int filter;
    Filter minify, between_mips;
    bool mipmapped;
  };
  for (const Case& c :
       {Case{9728, kNearest, kLinear, false}, Case{9729, kLinear, kLinear, false}, Case{9984, kNearest, kNearest, true},
        Case{9985, kLinear, kNearest, true}, Case{9986, kNearest, kLinear, true}, Case{9987, kLinear, kLinear, true}}) {
    CAPTURE(c.filter);
    const Sampler sampler = sampler_of({{"minFilter", c.filter}});
    CHECK(sampler.minify == c.minify);
    CHECK(sampler.between_mips == c.between_mips);
    CHECK(sampler.mipmapped == c.mipmapped);
  }
}

TEST_CASE("one material node serves all primitives with the material, and does not affect those without") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle()["material"] = 0;
  json& primitives = builder.root["meshes"][0]["primitives"];
  json other = primitives[0];
  primitives.push_back(other);
  other.erase("material");
  primitives.push_back(other);
  builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}});
  const LoadedPart part = loader.load(builder);
  const auto& root = dynamic_cast<const Group&>(*part.content.root);
  const auto& children = dynamic_cast<const Group&>(*root.children().at(0)).children();
  REQUIRE(children.size() == 6);
  CHECK(children[0]->kind() == NodeKind::material);
  CHECK(children[0] == children[2]);
  CHECK(children[4] != children[0]);
  CHECK(part.list.materials.at(part.list.items.at(2).material)->base_color == glm::vec4(1));
}

TEST_CASE("lines without normals are unlit and have their own material node") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle()["material"] = 0;
  json lines = builder.root["meshes"][0]["primitives"][0];
  lines["mode"] = 3;
  builder.root["meshes"][0]["primitives"].push_back(lines);
  builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}});
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.items.size() == 2);
  const Material& surface = *part.list.materials[part.list.items[0].material];
  const Material& line = *part.list.materials[part.list.items[1].material];
  CHECK(!surface.unlit);
  CHECK(line.unlit);
  CHECK(line.base_color == surface.base_color);
}

TEST_CASE("two parts with the same content share meshes, textures and materials") {
  GltfLoader loader;
  GltfBuilder builder;
  add_textured_triangle(builder, red_green_png());
  const LoadedPart first = loader.load(builder);
  builder.root["materials"][0]["name"] = "other name";
  write_bytes(loader.folder / "part.glb", builder.glb());
  const LoadedPart second = load_unturned(loader.folder / "part.glb", loader.pool);
  CHECK(first.content.root != second.content.root);
  CHECK(first.list.meshes[0] == second.list.meshes[0]);
  CHECK(first.list.materials[0] == second.list.materials[0]);
}

TEST_CASE("metallic and roughness: missing values have the defaults of glTF if the file mentions any of them") {
  const auto surface = [](json pbr) {
    const Material material = material_of({{"pbrMetallicRoughness", std::move(pbr)}});
    return std::pair(material.metallic, material.roughness);
  };
  CHECK(surface({{"baseColorFactor", {1, 0, 0, 1}}}) == std::pair(0.0f, 1.0f));
  CHECK(surface({{"metallicFactor", 0.25}, {"roughnessFactor", 0.5}}) == std::pair(0.25f, 0.5f));
  CHECK(surface({{"metallicFactor", 0}}) == std::pair(0.0f, 1.0f));
  CHECK(surface({{"roughnessFactor", 0.5}}) == std::pair(1.0f, 0.5f));
  CHECK(surface({{"metallicRoughnessTexture", {{"index", 0}}}}) == std::pair(1.0f, 1.0f));
}

TEST_CASE("maps of the surface: textures, UV sets, transforms, scale and strength") {
  const json moved{{"index", 0},
                   {"texCoord", 1},
                   {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0.25}}, {"scale", {2, 3}}}}}}};
  json normal = moved, occlusion{{"index", 0}, {"strength", 0.25}};
  normal["scale"] = -2;
  const Material full = material_of({{"pbrMetallicRoughness", {{"metallicRoughnessTexture", moved}}},
                                     {"normalTexture", normal},
                                     {"occlusionTexture", occlusion},
                                     {"emissiveTexture", moved},
                                     {"emissiveFactor", {1, 0.5, 0}}},
                                    {"KHR_texture_transform"});
  for (const MapKind kind : {MapKind::normal, MapKind::metallic_roughness, MapKind::emissive}) {
    const SurfaceMap& map = full.map(kind);
    CHECK(map.texture != nullptr);
    CHECK(map.uv_set == 1);
    CHECK(map.uv_transform == glm::mat3x2(2, 0, 0, 3, 0.5f, 0.25f));
  }
  CHECK(full.map(MapKind::occlusion).texture == full.map(MapKind::normal).texture);
  CHECK(full.map(MapKind::occlusion).uv_set == 0);
  CHECK(full.normal_scale == -2);
  CHECK(full.occlusion_strength == 0.25f);
  CHECK(full.emissive == glm::vec3(1, 0.5f, 0));
  CHECK(full.base_color_texture == nullptr);
  // An unlit material has no surface.
  const Material unlit = material_of({{"pbrMetallicRoughness", {{"metallicRoughnessTexture", moved}}},
                                      {"normalTexture", normal},
                                      {"extensions", {{"KHR_materials_unlit", json::object()}}}},
                                     {"KHR_texture_transform", "KHR_materials_unlit"});
  Material plain;
  plain.unlit = true;
  CHECK(unlit == plain);
}

TEST_CASE("unsupported content is reported: pictures of other formats, further UV sets") {
  GltfLoader loader;
  GltfBuilder builder;
  add_textured_triangle(builder, red_green_png());
  const auto warned = [&](const char* what) {
    const LoadedPart part = loader.load(builder);
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(part.content.warnings[0].find(what) != std::string::npos);
    return *part.list.materials.at(0);
  };
  builder.root["materials"][0] = {{"normalTexture", {{"index", 0}, {"texCoord", 2}}}};
  CHECK(warned("texCoord above 1") == Material{});
  builder.root["materials"][0] = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 2}}}}}};
  CHECK(warned("texCoord above 1").base_color_texture == nullptr);
  builder.root["materials"][0] = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
  builder.root["textures"][0].erase("source");
  CHECK(warned("textures/0 has no picture").base_color_texture == nullptr);
}

TEST_SUITE_END();
