// Identical content is stored once and drawn by instancing, for any files and any order.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/parts/gltf_fixture.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr int kTables = 200, kColumns = 20;

// A square of `size` m that faces -x, with a texture of 2 x 2 texels of the given grey.
std::string square(float size, std::uint8_t grey) {
  test::GltfBuilder gltf;
  const int positions =
      gltf.accessor<float>("VEC3", {0, 0, 0, 0, 0, size, 0, size, size, 0, size, 0});  // glTF is y-up: y is our z
  const int uv = gltf.accessor<float>("VEC2", {0, 0, 1, 0, 1, 1, 0, 1});
  test::json& primitive = gltf.primitive({{"POSITION", positions}, {"TEXCOORD_0", uv}});
  primitive["indices"] = gltf.accessor<std::uint16_t>("SCALAR", {0, 1, 2, 0, 2, 3});
  primitive["material"] = gltf.append(
      "materials", {{"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.append("textures", {{"source", 0}});
  const test::ByteString row(6, grey);
  gltf.append("images", {{"uri", "data:image/png;base64," + test::base64(test::png(2, 2, 8, 2, {row, row}))}});
  return gltf.text();
}

// One part command per place of a grid that is completely visible to the camera.
std::string part(const std::string& file, int place) {
  const double y = (place % kColumns - kColumns / 2) * 0.5, z = (place / kColumns - kTables / kColumns / 2) * 0.5;
  return "<part file='" + file + "' name='P" + std::to_string(place) + "' insert_at='ROOT' pose_offset='10 " +
         std::to_string(y) + " " + std::to_string(z) + " 0 0 0'/>";
}

const std::string kCamera =
    "<sensor type='camera' name='CAM' insert_at='ROOT' hfov='90' outputs='color depth' width='64' height='48'/>";

struct Seen {
  FrameCounters counters;
  std::size_t meshes, materials;
  std::vector<float> depth;
};

Seen look(const std::filesystem::path& folder, const std::vector<std::string>& commands) {
  std::string xml;
  for (const std::string& command : commands) xml += command;
  Simulation simulation = Simulation::from_string(xml + kCamera, {}, folder);
  simulation.step();
  return {simulation.diagnostics().counters(), simulation.diagnostics().draw_list().meshes.size(),
          simulation.diagnostics().draw_list().materials.size(), simulation.depth("CAM").pixels};
}

// The cost of one square: flat shading gives each triangle its own corners, so six vertices of position and of
// attributes (normal, two uv sets, colour) as packed on the device, and six indices; 2 x 2 texels and the one of the
// smaller level.
constexpr std::uint64_t kSquareBytes = 6 * (12 + 32) + 6 * 4, kTextureBytes = (4 + 1) * 4;

}  // namespace

TEST_CASE("two hundred identical tables cost one mesh, one texture, one material and one draw") {
  const TemporaryFolder folder;
  write_text(folder / "table.gltf", square(0.4f, 200));
  std::vector<std::string> commands;
  for (int i = 0; i < kTables; ++i) commands.push_back(part("table.gltf", i));
  const Seen seen = look(folder.path(), commands);
  CHECK(seen.meshes == 1);
  CHECK(seen.materials == 1);
  CHECK(seen.counters.meshes_held == 1);
  CHECK(seen.counters.mesh_bytes == kSquareBytes);
  CHECK(seen.counters.textures_held == 1);
  CHECK(seen.counters.texture_bytes == kTextureBytes);
  CHECK(seen.counters.items_culled == 0);
  CHECK(seen.counters.draws == 1);
  CHECK(seen.counters.triangles == 2 * kTables);
}

TEST_CASE("copies of a file cost no more than the file itself") {
  const TemporaryFolder folder;
  std::vector<std::string> commands;
  for (int i = 0; i < kTables; ++i) {
    const std::string file = "table" + std::to_string(i) + ".gltf";
    write_text(folder / file, square(0.4f, 200));
    commands.push_back(part(file, i));
  }
  const Seen seen = look(folder.path(), commands);
  CHECK(seen.counters.meshes_held == 1);
  CHECK(seen.counters.textures_held == 1);
  CHECK(seen.counters.mesh_bytes == kSquareBytes);
  CHECK(seen.counters.texture_bytes == kTextureBytes);
  CHECK(seen.counters.draws == 1);
}

TEST_CASE("the order of commands changes neither cost nor picture") {
  const TemporaryFolder folder;
  write_text(folder / "table.gltf", square(0.4f, 200));
  write_text(folder / "chair.gltf", square(0.2f, 100));
  std::vector<std::string> commands;
  for (int i = 0; i < kTables; ++i) commands.push_back(part(i % 2 == 0 ? "table.gltf" : "chair.gltf", i));
  const Seen first = look(folder.path(), commands);
  CHECK(first.counters.draws == 2);
  CHECK(first.counters.meshes_held == 2);
  std::mt19937 random(1);
  for (int round = 0; round < 5; ++round) {
    std::ranges::shuffle(commands, random);
    const Seen other = look(folder.path(), commands);
    CHECK(other.counters == first.counters);
    CHECK(other.depth == first.depth);
  }
}

}  // namespace simvis

TEST_SUITE_END();
