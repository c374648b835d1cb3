// The scenes that come with SimVis as GLB: read again they are the same, and other readers agree.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/live/exported_scene.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

/// What another reader should find in it: triangles, and the corners of the box around them.
nlohmann::json expected_of(const DrawList& list) {
  glm::dvec3 low(1e9), high(-1e9);
  std::size_t triangles = 0;
  for (const DrawItem& item : exported_items(list)) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (mesh.topology != Topology::triangles) continue;
    triangles += mesh.indices.size() / 3;
    const glm::dmat4& world = list.world_from_node[item.transform];
    for (const glm::vec3& position : mesh.positions) {
      const glm::dvec3 point(world * glm::dvec4(position, 1));
      low = glm::min(low, point);
      high = glm::max(high, point);
    }
  }
  return {{"triangles", triangles}, {"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}};
}

/// All scenes but those that are executed in another one.
std::vector<std::filesystem::path> scenes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SIMVIS_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() == ".xml" && entry.path().filename() != "view.xml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

TEST_CASE(
    "each scene read again is the same; Khronos' validator finds no error, and trimesh the same box and triangles") {
  const TemporaryFolder folder;
  nlohmann::json expected = nlohmann::json::array();
  for (const std::filesystem::path& file : scenes()) {
    CAPTURE(file);
    const Scenery scenery(file);
    const std::string bytes = scenery.glb();
    check_round_trip(scenery, bytes);
    const std::filesystem::path glb = folder / (file.stem().string() + ".glb");
    write_text(glb, bytes);
    expected.push_back(expected_of(scenery.list));
    expected.back()["file"] = glb.string();
  }
  CHECK(expected.size() >= 6);
  write_text(folder / "expected.json", expected.dump());
  const ProcessResult result = Process({"python3", SIMVIS_SOURCE_DIR "/tests/live/read_glb.py",
                                        (folder / "expected.json").string(), tested_build() + "/glb_readers"})
                                   .wait();
  INFO(result.out << result.err);
  if (result.exit_code == test::kSkippedExitCode) return test::skip(result.out);
  CHECK(result.exit_code == 0);
}

}  // namespace simvis::live

TEST_SUITE_END();
