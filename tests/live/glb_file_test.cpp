// A draw list as a GLB: read again it is the same list, equal items share a mesh, and other readers agree.
#include "live/glb_file.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "live/glb_matrix.h"
#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

// A matrix is a product of two in double, and of four where it shears: some dozens of roundings of 1e-16, and the turns
// stop when columns are square within 1e-9.
constexpr double kMatrix = 1e-12, kSheared = 1e-8;
// Factors are float32 and are divided and multiplied once: 6e-8 each, on numbers up to 1.
constexpr float kFactor = 2e-7f;

/// A scene without a device, and its draw list.
struct Scenery {
  explicit Scenery(const std::string& xml, const std::filesystem::path& folder = "")
      : scene({}, parse_commands(xml, "s.xml", folder)),
        flattener(scene.built.scene.root()),
        list(flattener.update()) {}
  std::string glb() const { return glb_bytes(list, draw_owners(scene.built).items); }
  LiveScene scene;
  Flattener flattener;
  const DrawList& list;
};

const std::string kThings = R"(
  <part name="BOX" insert_at="ROOT" shape="box" size="2 1 0.5" color="1 0.5 0.25" pose_offset="1 2 3 10 20 30"/>
  <part name="BALL" insert_at="BOX" shape="sphere" radius="0.5"/>
  <element type="scale" name="FLAT" insert_at="BALL" x="1" y="2" z="0.5"/>
  <part name="ROD" insert_at="BALL" shape="cylinder" radius="0.1" length="1" pose_offset="0 0 0 40 50 0"/>
  <part name="TWIN" insert_at="ROOT" shape="box" size="2 1 0.5" color="1 0.5 0.25"/>
  <element type="light" name="LAMP" insert_at="BOX" kind="spot"/>)";

nlohmann::json json_in(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  return nlohmann::json::parse(glb.substr(20, length));
}

double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(a[i][k] - b[i][k]));
  }
  return largest;
}

void check_same(const Material& now, const Material& before) {
  for (int i = 0; i < 4; ++i) CHECK(std::abs(now.base_color[i] - before.base_color[i]) <= kFactor);
  for (int i = 0; i < 3; ++i)
    CHECK(std::abs(now.emissive[i] - before.emissive[i]) <= kFactor * (1 + before.emissive[i]));
  CHECK(now.name == before.name);
  CHECK(now.alpha_mode == before.alpha_mode);
  CHECK(now.roughness == before.roughness);
  CHECK(now.metallic == before.metallic);
  CHECK(now.double_sided == before.double_sided);
  CHECK(now.unlit == before.unlit);
  REQUIRE((now.base_color_texture == nullptr) == (before.base_color_texture == nullptr));
  if (now.base_color_texture == nullptr) return;
  CHECK(now.base_color_texture->rgba == before.base_color_texture->rgba);
  CHECK(now.base_color_texture->sampler == before.base_color_texture->sampler);
}

/// The list, written and read again.
void check_round_trip(const Scenery& before) {
  const TemporaryFolder folder;
  write_text(folder / "again.glb", before.glb());
  const Scenery again("<part file=\"again.glb\" name=\"AGAIN\" insert_at=\"ROOT\"/>", folder.path());
  CHECK(again.scene.built.scene.warnings().empty());
  REQUIRE(again.list.items.size() == before.list.items.size());
  for (std::size_t i = 0; i < again.list.items.size(); ++i) {
    const DrawItem &a = again.list.items[i], &b = before.list.items[i];
    const Mesh &now = *again.list.meshes[a.mesh], &then = *before.list.meshes[b.mesh];
    CHECK(now.positions == then.positions);
    CHECK(now.indices == then.indices);
    const glm::dmat4& world = before.list.world_from_node[b.transform];
    const double tolerance = gltf_nodes_of(world).size() == 1 ? kMatrix : kSheared;
    CHECK(difference(again.list.world_from_node[a.transform], world) < tolerance * (1 + glm::length(world[3])));
    check_same(*again.list.materials[a.material], *before.list.materials[b.material]);
  }
  REQUIRE(again.list.lights.size() == before.list.lights.size());
  for (std::size_t i = 0; i < again.list.lights.size(); ++i) {
    const LightItem &a = again.list.lights[i], &b = before.list.lights[i];
    const glm::dmat4 &now = again.list.world_from_node[a.transform], &then = before.list.world_from_node[b.transform];
    CHECK(a.light.kind == b.light.kind);
    CHECK(a.light.intensity == b.light.intensity);
    CHECK(glm::length(now[3] - then[3]) < kMatrix * (1 + glm::length(then[3])));
    if (b.light.kind == LightKind::point) continue;
    const glm::dvec4 from(a.light.direction, 0), to(b.light.direction, 0);
    CHECK(glm::length(glm::normalize(now * from) - glm::normalize(then * to)) < kMatrix);
  }
}

TEST_CASE("what is read again is the same list") {
  check_round_trip(Scenery(kThings));
  check_round_trip(
      Scenery("<part file=\"robot.glb\" name=\"R\" insert_at=\"ROOT\" pose_offset=\"1 2 0 0 0 30\"/>"
              "<part file=\"plant.glb\" name=\"P\" insert_at=\"R\"/>"
              "<part file=\"poster.glb\" name=\"Q\" insert_at=\"R\"/>",
              SIMVIS_SOURCE_DIR "/scenes/marvin"));
}

TEST_CASE("equal items are nodes of one mesh, and nodes say what they show") {
  const Scenery things(kThings);
  const nlohmann::json gltf = json_in(things.glb());
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const DrawItem& item : things.list.items) pairs.emplace(item.mesh, item.material);
  CHECK(gltf["meshes"].size() == pairs.size());
  CHECK(pairs.size() == things.list.items.size() - 1);  // BOX and TWIN
  std::set<std::string> parts;
  for (const nlohmann::json& node : gltf["nodes"]) {
    if (!node.contains("mesh")) continue;
    const DrawItem& item = things.list.items[node["extras"]["item"].get<std::size_t>()];
    CHECK(node["extras"]["transform"] == item.transform);
    parts.insert(node["extras"]["part"]);
  }
  CHECK(parts == std::set<std::string>{"BALL", "BOX", "ROD", "TWIN"});
}

TEST_CASE("a matrix that shears becomes two nodes, and one of no size none") {
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 0.7, glm::dvec3(1, 2, 3));
  const glm::dmat4 flat = glm::scale(glm::dmat4(1), glm::dvec3(1, 3, 0.2));
  CHECK(gltf_nodes_of(turn * flat).size() == 1);
  const std::vector<glm::dmat4> chain = gltf_nodes_of(flat * turn);
  REQUIRE(chain.size() == 2);
  CHECK(difference(chain[0] * chain[1], flat * turn) < kMatrix);
  for (const glm::dmat4& each : chain) CHECK(gltf_nodes_of(each).size() == 1);
  CHECK(gltf_nodes_of(glm::scale(glm::dmat4(1), glm::dvec3(1, 0, 1))).empty());
}

TEST_CASE("Khronos' validator finds no error, and trimesh the same box and triangles") {
  const TemporaryFolder folder;
  const Scenery things(kThings);
  write_text(folder / "things.glb", things.glb());
  glm::dvec3 low(1e9), high(-1e9);
  std::size_t triangles = 0;
  for (const DrawItem& item : things.list.items) {
    const Mesh& mesh = *things.list.meshes[item.mesh];
    triangles += mesh.indices.size() / 3;
    for (const glm::vec3& position : mesh.positions) {
      const glm::dvec3 world(things.list.world_from_node[item.transform] * glm::dvec4(position, 1));
      low = glm::min(low, world);
      high = glm::max(high, world);
    }
  }
  nlohmann::json expected = {
      {"triangles", triangles}, {"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}};
  const ProcessResult result = Process({"python3", SIMVIS_SOURCE_DIR "/tests/live/read_glb.py",
                                        (folder / "things.glb").string(), expected.dump(), folder.path().string()})
                                   .wait();
  INFO(result.out << result.err);
  if (result.exit_code == test::kSkippedExitCode) return test::skip(result.out);
  CHECK(result.exit_code == 0);
}

}  // namespace
}  // namespace simvis::live
