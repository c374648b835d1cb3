// Broken glTF files: each is refused with a message that names the file, or is loaded completely. None crashes or
// hangs.
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr int kBrokenFiles = 10000;
constexpr double kLongest_s = 10;

enum class Outcome { loaded, refused };

// The guarantees of Mesh must hold for everything that is loaded.
void check_meshes(const DrawList& list) {
  for (const auto& mesh : list.meshes) {
    REQUIRE(mesh->attributes.size() == mesh->positions.size());
    for (const std::uint32_t index : mesh->indices) REQUIRE(index < mesh->positions.size());
    for (const glm::vec3& p : mesh->positions) {
      REQUIRE((std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)));
    }
  }
  for (const auto& material : list.materials) {
    const auto& texture = material->base_color_texture;
    if (texture) REQUIRE(texture->rgba.size() == std::size_t{4} * texture->width * texture->height);
  }
}

// Any other exception ends the test.
Outcome try_to_load(const std::filesystem::path& file) {
  ContentPool pool;
  try {
    check_meshes(load_unturned(file, pool).list);
    return Outcome::loaded;
  } catch (const InputError& e) {
    REQUIRE(std::string(e.what()).starts_with(file.string() + ": error: "));
    return Outcome::refused;
  }
}

struct Seed {
  const char* name;
  ByteString bytes;
};

ByteString bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

GltfBuilder textured_seed() {
  GltfBuilder builder;
  json& primitive = builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                                       {"TEXCOORD_0", builder.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1})}});
  primitive["indices"] = builder.accessor<std::uint16_t>("SCALAR", {0, 1, 2});
  primitive["material"] = 0;
  std::vector<ByteString> rows;
  for (std::uint8_t y = 0; y < 8; ++y) rows.emplace_back(32, static_cast<std::uint8_t>(y * 30));
  const ByteString picture = png(8, 8, 8, 6, rows);
  builder.append("images", {{"bufferView", builder.view(picture.data(), picture.size())}, {"mimeType", "image/png"}});
  builder.append("samplers", {{"wrapS", 33071}});
  builder.append("textures", {{"source", 0}, {"sampler", 0}});
  builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return builder;
}

GltfBuilder deformed_seed() {
  GltfBuilder builder;
  json& primitive = builder.triangle();
  primitive["attributes"]["JOINTS_0"] = builder.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  primitive["attributes"]["WEIGHTS_0"] = builder.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0});
  primitive["targets"] = {{{"POSITION", builder.accessor<float>("VEC3", {1, 0, 0, 0, 0, 0, 0, 0, 0})}}};
  builder.root["meshes"][0]["weights"] = {0.5};
  const std::vector<std::uint16_t> indices{0, 2};
  const std::vector<float> values{5, 6, 7, 8, 9, 10};
  builder.root["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", builder.view(indices.data(), 4)}, {"componentType", kUShort}}},
      {"values", {{"bufferView", builder.view(values.data(), 24)}}}};
  builder.root["nodes"][0]["skin"] = 0;
  builder.append("nodes", {{"children", {2}}, {"rotation", {0, 0, 0, 1}}});
  builder.append("nodes", {{"translation", {0, 0, 2}}, {"extras", {{"simvis", "<element/>"}}}});
  builder.append("skins", {{"joints", {1, 2}}});
  builder.root["scenes"] = {{{"nodes", {0, 1}}}};
  builder.root["scene"] = 0;
  return builder;
}

GltfBuilder lit_seed() {
  GltfBuilder builder;
  builder.root["extensionsUsed"] = {"KHR_lights_punctual", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}}}, {"range", 5}}};
  builder.primitive({{"POSITION", builder.accessor<std::int16_t>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1})},
                     {"COLOR_0", builder.accessor<std::uint8_t>("VEC4", ByteString(16, 99), true)}})["mode"] = 5;
  const json attributes{{"TRANSLATION", builder.accessor<float>("VEC3", {1, 2, 3, 4, 5, 6})}};
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  builder.append("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return builder;
}

ByteString broken(const Seed& seed, Random& random) {
  ByteString bytes = seed.bytes;
  if (random.below(4) == 0) {
    bytes.resize(random.below(bytes.size()));
    return bytes;
  }
  const std::uint64_t flips = 1 + random.below(8);
  for (std::uint64_t i = 0; i < flips; ++i) {
    bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
  }
  return bytes;
}

}  // namespace

TEST_CASE("ten thousand truncated and bit-flipped files are loaded or refused") {
  const Seed seeds[] = {{"textured.glb", textured_seed().glb()},
                        {"textured.gltf", bytes_of(textured_seed().text())},
                        {"deformed.gltf", bytes_of(deformed_seed().text())},
                        {"deformed.glb", deformed_seed().glb()},
                        {"lit.gltf", bytes_of(lit_seed().text())}};
  TemporaryFolder folder;
  for (const Seed& seed : seeds) {
    write_bytes(folder / seed.name, seed.bytes);
    CAPTURE(seed.name);
    REQUIRE(try_to_load(folder / seed.name) == Outcome::loaded);
  }
  Random random;
  int loaded = 0;
  for (int i = 0; i < kBrokenFiles; ++i) {
    CAPTURE(i);
    const Seed& seed = seeds[static_cast<std::size_t>(i) % std::size(seeds)];
    // A new file each time: some file systems write an overwritten file to the disk at once.
    std::filesystem::remove(folder / seed.name);
    write_bytes(folder / seed.name, broken(seed, random));
    if (try_to_load(folder / seed.name) == Outcome::loaded) ++loaded;
  }
  // Flips of vertex and colour data change values, not validity. Flips of structure are detected.
  CHECK(loaded > kBrokenFiles / 100);
  CHECK(loaded < kBrokenFiles / 2);
}

TEST_CASE("test data: broken files of other projects are loaded or refused, each in time") {
  const auto index_file = test::test_data("malformed/INDEX.csv");
  if (!index_file) return;
  const std::filesystem::path folder = index_file->parent_path();
  std::ifstream index(*index_file);
  TemporaryFolder scratch;
  int files = 0;
  std::string line;
  while (std::getline(index, line)) {
    const std::string name = line.substr(0, line.find(','));
    CAPTURE(name);
    const std::filesystem::path file = folder / name;
    const auto start = std::chrono::steady_clock::now();
    if (find_part_importer(file) != nullptr) {
      try_to_load(file);
    } else if (file.extension() == ".png") {
      GltfBuilder builder = textured_seed();
      const std::string picture = read_text(file);
      builder.root["images"][0]["bufferView"] = builder.view(picture.data(), picture.size());
      write_bytes(scratch / "part.glb", builder.glb());
      try_to_load(scratch / "part.glb");
    } else {
      continue;
    }
    ++files;
    CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < kLongest_s);
  }
  CHECK(files > 500);
}

TEST_SUITE_END();
