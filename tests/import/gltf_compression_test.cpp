// glTF parts whose geometry or pictures are compressed, made by the libraries' own encoders.
#include <doctest/doctest.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_loader.h"
#include "tests/support/random_numbers.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr int kSide = 9;
// The quantised positions of Draco have 14 bits for the longest side of the box, which is 8 m: the nearest of 2^14
// values is within half a step. One more step of float32 comes from each of the two conversions.
constexpr int kPositionBits = 14;
constexpr double kExtent_m = kSide - 1;
constexpr double kDracoTolerance_m = kExtent_m / ((1 << kPositionBits) - 1) / 2 + 2 * kExtent_m * 0x1p-23;
// The exponential filter keeps 15 bits with sign of the largest coordinate's exponent: the largest value is below 2^e,
// its step is 2^(e - 14), and a value that would round up to 2^e is a whole step too low; 2^e is at most twice the
// value.
constexpr int kExponentialBits = 15;
constexpr double kExponentialTolerance_m = 2 * kExtent_m * 0x1p-14;

struct Grid {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
};

// A square grid of 1 m with waves of height 0.5 m.
Grid grid() {
  Grid made;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      made.positions.emplace_back(x, y, 0.25 * std::sin(1.1 * x) + 0.25 * std::cos(0.7 * y));
  }
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t a = y * kSide + x, b = a + kSide;
      made.indices.insert(made.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
    }
  }
  return made;
}

using Triangles = std::multiset<std::vector<std::uint32_t>>;

// The triangles with the smallest corner first, which keeps their sides; each vertex stands for its number in `of`.
Triangles triangles(const std::vector<std::uint32_t>& indices, const std::vector<std::uint32_t>& of) {
  Triangles all;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    std::vector<std::uint32_t> corners{of.at(indices[i]), of.at(indices[i + 1]), of.at(indices[i + 2])};
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    all.insert(corners);
  }
  return all;
}

// Checks that the mesh is the grid, with vertices in any order.
void check_is_grid(const Mesh& mesh, double tolerance_m) {
  const Grid expected = grid();
  std::vector<std::uint32_t> itself(expected.positions.size()), number;
  for (std::uint32_t i = 0; i < itself.size(); ++i) itself[i] = i;
  for (const glm::vec3& p : mesh.positions) {
    const auto x = static_cast<std::uint32_t>(std::lround(p.x)), y = static_cast<std::uint32_t>(std::lround(p.y));
    REQUIRE(x < kSide);
    REQUIRE(y < kSide);
    number.push_back(y * kSide + x);
    for (int i = 0; i < 3; ++i) CHECK(std::abs(double(p[i]) - expected.positions[number.back()][i]) <= tolerance_m);
  }
  CHECK(triangles(mesh.indices, number) == triangles(expected.indices, itself));
}

ByteString draco_of(const Grid& source, int method) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(source.positions.size()));
  draco::GeometryAttribute positions, ids;
  positions.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int attribute = mesh.AddAttribute(positions, true, mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    mesh.attribute(attribute)->SetAttributeValue(draco::AttributeValueIndex(i), &source.positions[i]);
  }
  for (std::size_t i = 0; i < source.indices.size(); i += 3) {
    mesh.AddFace({draco::PointIndex(source.indices[i]), draco::PointIndex(source.indices[i + 1]),
                  draco::PointIndex(source.indices[i + 2])});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, kPositionBits);
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

GltfBuilder draco_file(const ByteString& compressed) {
  const Grid source = grid();
  GltfBuilder builder;
  builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const int positions =
      builder.append("accessors", {{"componentType", kFloat}, {"count", source.positions.size()}, {"type", "VEC3"}});
  const int indices =
      builder.append("accessors", {{"componentType", kUShort}, {"count", source.indices.size()}, {"type", "SCALAR"}});
  json& primitive = builder.primitive({{"POSITION", positions}});
  primitive["indices"] = indices;
  primitive["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", builder.view(compressed.data(), compressed.size())}, {"attributes", {{"POSITION", 0}}}};
  return builder;
}

ByteString meshopt_vertices(const void* vertices, std::size_t count, std::size_t size) {
  ByteString bytes(meshopt_encodeVertexBufferBound(count, size));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), vertices, count, size));
  return bytes;
}

ByteString meshopt_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  ByteString bytes(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

ByteString meshopt_sequence(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  ByteString bytes(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

// A view of buffer 1, which has no bytes, that is compressed into buffer 0.
int compressed_view(GltfBuilder& builder, const ByteString& compressed, std::size_t count, std::size_t stride,
                    const char* mode, const char* filter) {
  const int source = builder.view(compressed.data(), compressed.size());
  json extension = builder.root["bufferViews"][static_cast<std::size_t>(source)];
  extension.update({{"byteStride", stride}, {"count", count}, {"mode", mode}, {"filter", filter}});
  json view{{"buffer", 1}, {"byteLength", count * stride}};
  if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
  view["extensions"]["EXT_meshopt_compression"] = extension;
  return builder.append("bufferViews", view);
}

GltfBuilder meshopt_file(const ByteString& vertices, const char* filter, const ByteString& indices, const char* mode) {
  const Grid source = grid();
  GltfBuilder builder;
  builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  const int vertex_view = compressed_view(builder, vertices, source.positions.size(), 12, "ATTRIBUTES", filter);
  const int index_view = compressed_view(builder, indices, source.indices.size(), 4, mode, "NONE");
  json& primitive = builder.primitive({{"POSITION", builder.append("accessors", {{"bufferView", vertex_view},
                                                                                 {"componentType", kFloat},
                                                                                 {"count", source.positions.size()},
                                                                                 {"type", "VEC3"}})}});
  primitive["indices"] = builder.append(
      "accessors",
      {{"bufferView", index_view}, {"componentType", kUInt}, {"count", source.indices.size()}, {"type", "SCALAR"}});
  builder.root["buffers"] = {
      {{"byteLength", builder.bytes.size()}, {"uri", "data:;base64," + base64(builder.bytes)}},
      {{"byteLength", 100000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  return builder;
}

ByteString flipped(ByteString bytes, Random& random) {
  if (random.below(4) == 0) bytes.resize(1 + random.below(bytes.size() - 1));
  for (std::uint64_t flips = 1 + random.below(4); flips > 0; --flips) {
    bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
  }
  return bytes;
}

}  // namespace

TEST_CASE("KHR_draco_mesh_compression: positions within the quantisation, the same triangles") {
  GltfLoader loader;
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    CAPTURE(method);
    const LoadedPart part = loader.load(draco_file(draco_of(grid(), method)));
    CHECK(part.content.warnings.empty());
    check_is_grid(only_mesh(part), kDracoTolerance_m);
  }
}

TEST_CASE("Draco data that does not fit the file") {
  GltfLoader loader;
  const ByteString compressed = draco_of(grid(), draco::MESH_EDGEBREAKER_ENCODING);
  GltfBuilder other = draco_file(compressed);
  other.root["accessors"][0]["count"] = 80;
  const LoadedPart part = loader.load(other);
  check_is_grid(only_mesh(part), kDracoTolerance_m);
  REQUIRE(part.content.warnings.size() == 1);
  CHECK(contains(part.content.warnings[0],
                 "part.gltf: meshes/0/primitives/0 has 81 elements where an accessor gives 80"));

  const auto refusal = [&](const auto& spoil) {
    GltfBuilder builder = draco_file(compressed);
    spoil(builder.root, builder.root["meshes"][0]["primitives"][0]);
    const std::string text = loader.refusal(builder.text());
    CHECK(contains(text, "part.gltf: error: meshes/0/primitives/0"));
    return text;
  };
  CHECK(contains(refusal([](json&, json& p) { p["mode"] = 0; }), "mode that Draco does not compress"));
  CHECK(contains(
      refusal([](json&, json& p) { p["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 7; }),
      "lacks attribute 7"));
  CHECK(contains(refusal([](json& r, json&) { r["accessors"][0]["type"] = "VEC2"; }), "3 components in attribute 0"));
  CHECK(contains(refusal([](json& r, json&) { r["bufferViews"][0]["byteLength"] = 20; }), "broken Draco data"));
}

TEST_CASE("EXT_meshopt_compression: the same bytes, or within the filter") {
  GltfLoader loader;
  const Grid source = grid();
  const ByteString vertices = meshopt_vertices(source.positions.data(), source.positions.size(), 12);
  const ByteString list = meshopt_triangles(source.indices, source.positions.size());
  check_is_grid(only_mesh(loader.load(meshopt_file(vertices, "NONE", list, "TRIANGLES"))), 0);

  const ByteString sequence = meshopt_sequence(source.indices, source.positions.size());
  check_is_grid(only_mesh(loader.load(meshopt_file(vertices, "NONE", sequence, "INDICES"))), 0);

  std::vector<std::uint32_t> filtered(source.positions.size() * 3);
  meshopt_encodeFilterExp(filtered.data(), source.positions.size(), 12, kExponentialBits, &source.positions[0].x);
  const ByteString exponential = meshopt_vertices(filtered.data(), source.positions.size(), 12);
  check_is_grid(only_mesh(loader.load(meshopt_file(exponential, "EXPONENTIAL", sequence, "INDICES"))),
                kExponentialTolerance_m);
}

TEST_CASE("meshopt data that does not fit the file") {
  GltfLoader loader;
  const Grid source = grid();
  const ByteString vertices = meshopt_vertices(source.positions.data(), source.positions.size(), 12);
  const ByteString list = meshopt_triangles(source.indices, source.positions.size());
  const auto refusal = [&](const char* name, const json& value) {
    GltfBuilder builder = meshopt_file(vertices, "NONE", list, "TRIANGLES");
    builder.root["bufferViews"][1]["extensions"]["EXT_meshopt_compression"][name] = value;
    return loader.refusal(builder.text());
  };
  const std::string place = "part.gltf: error: bufferViews/1/extensions/EXT_meshopt_compression ";
  CHECK(contains(refusal("mode", "POINTS"), place + "has an unknown mode"));
  CHECK(contains(refusal("byteStride", 6), place + "has a byteStride that does not fit"));
  CHECK(contains(refusal("filter", "OCTAHEDRAL"), place + "has a filter that is unknown or does not fit"));
  CHECK(contains(refusal("byteLength", 30), place + "holds broken data"));
  CHECK(contains(refusal("byteOffset", 1 << 20), place + "does not lie within its buffer"));
  // Memory is not taken: 2^31 - 1 elements of 12 bytes.
  CHECK(contains(refusal("count", 0x7fffffff), place + "gives 2147483647 elements, more than its"));
}

TEST_CASE("compressed data with flipped bits is read or refused, and read content is sound") {
  const int tries = 60;
  GltfLoader loader;
  Random random;
  const Grid source = grid();
  const ByteString compressed = draco_of(source, draco::MESH_EDGEBREAKER_ENCODING);
  const ByteString vertices = meshopt_vertices(source.positions.data(), source.positions.size(), 12);
  const ByteString list = meshopt_triangles(source.indices, source.positions.size());
  int read = 0;
  for (int i = 0; i < tries; ++i) {
    for (const GltfBuilder& builder :
         {draco_file(flipped(compressed, random)),
          meshopt_file(flipped(vertices, random), "NONE", flipped(list, random), "TRIANGLES")}) {
      try {
        const LoadedPart part = loader.load(builder);
        for (const auto& mesh : part.list.meshes) {
          for (const std::uint32_t index : mesh->indices) REQUIRE(index < mesh->positions.size());
        }
        ++read;
      } catch (const InputError&) {
      }
    }
  }
  CHECK(read > 0);
  CHECK(read < 2 * tries);
}

TEST_CASE("glTF pictures: WebP is read, Basis and missing ones are replaced by the colour") {
  GltfLoader loader;
  const ByteString pixels{255, 0, 0, 255};
  std::uint8_t* encoded = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(pixels.data(), 1, 1, 4, &encoded);
  const ByteString webp(encoded, encoded + size);
  WebPFree(encoded);
  const ByteString blue = png(1, 1, 8, 6, {{0, 0, 255, 255}});
  const std::string ktx = "\xABKTX 20\xBB\r\n\x1A\n";
  const auto with = [&](const json& texture) {
    GltfBuilder builder;
    builder.triangle()["material"] = 0;
    builder.append("images", {{"bufferView", builder.view(webp.data(), webp.size())}});
    builder.append("images", {{"bufferView", builder.view(blue.data(), blue.size())}});
    builder.append("images", {{"bufferView", builder.view(ktx.data(), ktx.size())}});
    builder.append("images", {{"uri", "no%20ne.png"}});
    builder.append("textures", texture);
    builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    return loader.load(builder);
  };
  const auto texture_of = [](const LoadedPart& part) { return part.list.materials.at(0)->base_color_texture; };
  const LoadedPart of_webp = with({{"source", 1}, {"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
  REQUIRE(texture_of(of_webp) != nullptr);
  CHECK(texture_of(of_webp)->rgba == pixels);
  CHECK(of_webp.content.warnings.empty());

  const json basis = {{"KHR_texture_basisu", {{"source", 2}}}};
  const LoadedPart fallback = with({{"source", 1}, {"extensions", basis}});
  REQUIRE(texture_of(fallback) != nullptr);
  CHECK(texture_of(fallback)->rgba == ByteString{0, 0, 255, 255});
  CHECK(fallback.content.warnings.empty());

  const LoadedPart alone = with({{"extensions", basis}});
  CHECK(texture_of(alone) == nullptr);
  REQUIRE(alone.content.warnings.size() == 1);
  CHECK(
      contains(alone.content.warnings[0], "part.gltf: images/2 is a picture of the kind KTX 2, which cannot be read"));

  const LoadedPart missing = with({{"source", 3}});
  CHECK(texture_of(missing) == nullptr);
  REQUIRE(missing.content.warnings.size() == 1);
  CHECK(contains(missing.content.warnings[0], "part.gltf: picture \"no ne.png\" is not there"));

  const LoadedPart empty = with(json::object());
  REQUIRE(empty.content.warnings.size() == 1);
  CHECK(contains(empty.content.warnings[0], "textures/0 has no picture"));
}

TEST_CASE("transmission: cameras show it opaque, and a warning says so") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle()["material"] = 0;
  builder.append("materials", {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}}}}});
  const LoadedPart part = loader.load(builder);
  CHECK(part.list.materials.at(0)->transmission == 0.5f);
  CHECK(part.list.materials.at(0)->alpha_mode == AlphaMode::opaque);
  REQUIRE(part.content.warnings.size() == 1);
  CHECK(contains(part.content.warnings[0], "KHR_materials_transmission are opaque in drawn images"));
  builder.root["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 0;
  CHECK(loader.load(builder).content.warnings.empty());
}

TEST_SUITE_END();
