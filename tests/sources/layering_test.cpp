// The arrows between the rooms: scripts/include_graph, which holds them for this tree, finds what is wrong in trees
// that are made up here. And no folder of this tree is too large.
#include <doctest/doctest.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "tests/support/run_process.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sources");

namespace {

namespace fs = std::filesystem;
using namespace simvis;

/// A file of a tree and its text.
using File = std::pair<const char*, const char*>;

ProcessResult check(std::initializer_list<File> files) {
  const TemporaryFolder root;
  for (const auto& [name, text] : files) {
    fs::create_directories((root / name).parent_path());
    write_text(root / name, text);
  }
  return Process({std::string(SIMVIS_SOURCE_DIR) + "/scripts/include_graph", "--check", "--root", root.path().string()})
      .wait();
}

/// What is said of a tree in which this file includes that one.
std::string complaint(const char* file, const char* include) {
  const ProcessResult result = check({{file, include}});
  CAPTURE(result.err);
  CHECK(result.exit_code == (result.out.starts_with("no include against") ? 0 : 1));
  return result.out;
}

bool is_right(const char* file, const char* include) { return complaint(file, include).starts_with("no include"); }

bool is_source(const fs::path& file) {
  static const std::set<std::string> kEndings = {".h", ".cpp", ".glsl", ".vert", ".frag", ".comp"};
  return kEndings.contains(file.extension().string());
}

}  // namespace

TEST_CASE("no folder of sources has more than forty files") {
  std::map<fs::path, int> files;
  for (const char* folder : {"include", "clients", "engine", "messages", "scenegraph", "elements", "effects", "sensors",
                             "simvis", "dynamics", "live", "python", "bench", "tests"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / folder)) {
      if (entry.is_regular_file() && is_source(entry.path())) ++files[entry.path().parent_path()];
    }
  }
  for (const auto& entry : files) {
    const fs::path& folder = entry.first;
    CAPTURE(folder);
    CHECK(entry.second <= 40);
  }
}

TEST_CASE("an include against the arrows is named") {
  CHECK(complaint("sensors/psd/psd.cpp", "#include \"elements/pose.h\"\n") ==
        "sensors/psd/psd.cpp includes elements/pose.h: sensors/psd must not include elements\n");
  const std::initializer_list<File> wrong = {
      {"engine/culling/occluders.cpp", "#include \"engine/render/renderer.h\""},
      {"engine/geometry/item_index.cpp", "#include \"engine/raycast/tlas.h\""},
      {"engine/draw/mesh.cpp", "#include <simvis/scan.h>"},
      {"scenegraph/scene.cpp", "#include <simvis/step_costs.h>"},
      {"scenegraph/import/gltf/a.cpp", "#include \"scenegraph/import/urdf/b.h\""},
      {"sensors/psd/psd.cpp", "#include \"sensors/camera/camera.h\""},
      {"sensors/camera/camera.cpp", "#include <simvis/simulation_desc.h>"},
      {"simvis/clock.cpp", "#include \"simvis/report/price.h\""},
      {"simvis/parameters.cpp", "#include \"tests/support/error_of.h\""},
      {"bench/scale.cpp", "#include \"tests/support/error_of.h\""},
      {"tests/simvis/cli_test.cpp", "#include \"bench/timing.h\""},
      {"shaders/mesh_depth.vert", "#include <simvis/scan.h>"}};
  const ProcessResult result = check(wrong);
  CHECK(result.exit_code == 1);
  for (const auto& [file, include] : wrong) {
    CAPTURE(file);
    const std::size_t line = result.out.find(std::string(file) + " includes ");
    REQUIRE(line != std::string::npos);
    CHECK(result.out.substr(line, result.out.find('\n', line) - line).find("must not include") != std::string::npos);
  }
}

TEST_CASE("an include along the arrows is right, however its line is spaced") {
  const ProcessResult result = check({{"engine/draw/mesh.cpp", "#include <simvis/frame_plan.h>"},
                                      {"engine/render/renderer.cpp", "#include \"shaders/interop.h\""},
                                      {"scenegraph/scene.cpp", "  #  include <simvis/frame_plan.h>  // why"},
                                      {"elements/visualization/trail.cpp", "#include \"elements/pose.h\""},
                                      {"sensors/camera/camera.cpp", "#include<simvis/frame_results.h>"},
                                      {"simvis/cli/simvis_run.cpp", "#include \"simvis/report/price.h\""},
                                      {"tests/plugin/plate.cpp", "#include <simvis/scan.h>"},
                                      {"bench/scale.cpp", "#include <simvis/scan.h>"},
                                      {"shaders/mesh_depth.vert", "#include \"shaders/interop.h\""},
                                      {"engine/draw/cube.cpp", "#include <vector>"},
                                      {"include/simvis/scan.h", "#include <glm/glm.hpp>"},
                                      {"sensors/psd/psd.cpp", "// #include \"elements/pose.h\""}});
  CAPTURE(result.err);
  CHECK(result.out.starts_with("no include against"));
  CHECK(result.exit_code == 0);
}

TEST_CASE("the leaf includes nothing of ours, and quotes are for our private files") {
  CHECK(complaint("shaders/interop.h", "#include \"shaders/color.glsl\"") ==
        "shaders/interop.h includes shaders/color.glsl: it is a leaf and includes nothing of ours\n");
  CHECK(is_right("shaders/interop.h", "#include <glm/glm.hpp>"));
  CHECK(complaint("include/simvis/scan.h", "#include \"engine/vulkan/buffer.h\"").find("a public header includes") !=
        std::string::npos);
  for (const char* include : {"#include \"mesh.h\"", "#include \"../scenegraph/node.h\"",
                              "#include <engine/draw/mesh.h>", "#include <simvis/clock.h>"}) {
    CAPTURE(include);
    CHECK_FALSE(is_right("engine/draw/mesh.cpp", include));
  }
}

TEST_CASE("a public header belongs to the room of its source, or to the one that is said") {
  const char* const uses = "#include <simvis/thing.h>\n";
  CHECK(check({{"include/simvis/thing.h", ""}, {"sensors/thing.cpp", uses}, {"simvis/clock.cpp", uses}}).exit_code ==
        0);
  CHECK(check({{"include/simvis/thing.h", ""}, {"sensors/thing.cpp", uses}, {"engine/draw/mesh.cpp", uses}}).out ==
        "engine/draw/mesh.cpp includes simvis/thing.h: engine/draw must not include sensors\n");
  const ProcessResult unknown = check({{"include/simvis/thing.h", ""}});
  CHECK(unknown.exit_code == 1);
  CHECK(unknown.err.find("include/simvis/thing.h has no source file") != std::string::npos);
}

TEST_CASE("files that include each other are named, headers and sources together") {
  const ProcessResult circle = check({{"engine/draw/a.h", "#include \"engine/draw/b.h\"\n"},
                                      {"engine/draw/a.cpp", "#include \"engine/draw/a.h\"\n"},
                                      {"engine/draw/b.h", "#include \"engine/draw/c.h\"\n"},
                                      {"engine/draw/c.cpp", "#include \"engine/draw/a.h\"\n"},
                                      {"engine/draw/c.h", ""}});
  CHECK(circle.exit_code == 1);
  CHECK(circle.out ==
        "engine/draw/c.cpp includes engine/draw/a.h: files include each other: engine/draw/a > engine/draw/b > "
        "engine/draw/c > engine/draw/a\n");
  const ProcessResult pair = check({{"include/simvis/thing.h", "#include <simvis/scan.h>\n"},
                                    {"scenegraph/thing.cpp", "#include <simvis/thing.h>\n"},
                                    {"include/simvis/scan.h", ""},
                                    {"scenegraph/scan.cpp", "#include <simvis/scan.h>\n#include <simvis/thing.h>\n"}});
  CHECK(pair.exit_code == 1);
  CHECK(pair.out.find("scenegraph/scan > scenegraph/thing > scenegraph/scan\n") != std::string::npos);
  CHECK(check({{"engine/draw/a.h", "#include \"engine/draw/b.h\"\n"},
               {"engine/draw/c.h", "#include \"engine/draw/a.h\"\n#include \"engine/draw/b.h\"\n"},
               {"engine/draw/b.h", ""}})
            .exit_code == 0);
}

TEST_SUITE_END();
