// A draw list as a GLB: read again it is the same list, equal items share a mesh, and other readers agree.
#include "program/live/glb_file.h"

#include <doctest/doctest.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/live/exported_scene.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

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

TEST_CASE("what is read again is the same list") {
  const Scenery things(kThings);
  check_round_trip(things, things.glb());
  const Scenery parts(
      "<part file=\"robot.glb\" name=\"R\" insert_at=\"ROOT\" pose_offset=\"1 2 0 0 0 30\"/>"
      "<part file=\"plant.glb\" name=\"P\" insert_at=\"R\"/>"
      "<part file=\"poster.glb\" name=\"Q\" insert_at=\"R\"/>",
      SIMVIS_SOURCE_DIR "/scenes/marvin");
  check_round_trip(parts, parts.glb());
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

}  // namespace
}  // namespace simvis::live
