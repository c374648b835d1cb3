// The arrows between the modules: tools/include_graph, which holds them for this tree, finds what is wrong in trees
// that are made up here, and folders without a module or too large.
#include <doctest/doctest.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

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
  return Process({std::string(SIMVIS_SOURCE_DIR) + "/tools/include_graph", "--check", "--root", root.path().string()})
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

/// The modules that tools/modules lists.
std::vector<std::string> modules() {
  std::vector<std::string> found;
  std::istringstream lines(read_text(fs::path(SIMVIS_SOURCE_DIR) / "tools/modules"));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("module ")) found.push_back(line.substr(7, line.find(':') - 7));
  }
  return found;
}

/// A tree with a wrong include and two files that include each other in every module.
void write_wrong_tree(const fs::path& root) {
  for (const std::string& module : modules()) {
    fs::create_directories(root / module);
    write_text(root / module / "wrong.cpp",
               module == "tests" ? "#include \"bench/a.h\"\n" : "#include \"tests/a.h\"\n");
    write_text(root / module / "a.h", "#include \"" + module + "/b.h\"\n");
    write_text(root / module / "b.h", "#include \"" + module + "/a.h\"\n");
  }
}

ProcessResult check_tree(const fs::path& script, const fs::path& root) {
  return Process({script.string(), "--check", "--root", root.string()}).wait();
}

/// Those of the programs that read part files are left out: each program is linked by itself.
std::vector<std::string> headers_of_the_library() {
  std::vector<std::string> found;
  for (const char* top : {"include", "engine", "scenegraph", "import", "elements", "effects", "sensors", "exchange",
                          "simvis", "program", "python/core"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / top)) {
      const std::string name = entry.path().lexically_relative(SIMVIS_SOURCE_DIR).generic_string();
      if (entry.path().extension() == ".h" && !name.starts_with("import/programs/")) found.push_back(name);
    }
  }
  return found;
}

}  // namespace

TEST_CASE("a wrong include and a circle are found in every module") {
  const TemporaryFolder root;
  write_wrong_tree(root.path());
  const ProcessResult result = check_tree(fs::path(SIMVIS_SOURCE_DIR) / "tools/include_graph", root.path());
  CAPTURE(result.err);
  CHECK(result.exit_code == 1);
  CHECK(modules().size() > 40);
  for (const std::string& module : modules()) {
    CAPTURE(module);
    const std::string other = module == "tests" ? "bench" : "tests";
    CHECK(result.out.find(module + "/wrong.cpp includes " + other + "/a.h: " + module + " must not include " + other +
                          "\n") != std::string::npos);
    CHECK(result.out.find(module + "/b.h includes " + module + "/a.h: files include each other: ") !=
          std::string::npos);
  }
}

TEST_CASE("every folder of sources is named, and a large one has a reason") {
  CHECK(check({{"engine/thing/a.cpp", ""}, {"tools/a.h", ""}, {"tests/thing/a.h", ""}, {"simvis/time/a.h", ""}}).out ==
        "engine/thing: it is no module; expected a line \"module\" or \"folder\" in tools/modules\n"
        "tools: it is no module; expected a line \"module\" or \"folder\" in tools/modules\n");
  const TemporaryFolder root;
  const fs::path tools = root / "tools", script = tools / "include_graph";
  fs::create_directories(root / "engine/draw");
  fs::create_directories(tools);
  for (int i = 0; i < 41; ++i) write_text(root / "engine/draw" / (std::to_string(i) + ".h"), "");
  for (const char* name : {"include_graph", "module_list.py", "modules"}) {
    fs::copy_file(fs::path(SIMVIS_SOURCE_DIR) / "tools" / name, tools / name);
  }
  CHECK(check_tree(script, root.path()).out ==
        "engine/draw: it has 41 files; expected at most 40, or a line \"large\" with the reason in tools/modules\n");
  write_text(tools / "modules", read_text(tools / "modules") + "large engine/draw: one file for each number\n");
  CHECK(check_tree(script, root.path()).exit_code == 0);
  fs::remove(root / "engine/draw/0.h");
  CHECK(Process({script.string(), "--check"}).wait().out ==
        "engine/draw: it has 40 files; a line \"large\" in tools/modules is for more than 40\n");
}

TEST_CASE("folders at the top of the tree include each other in one direction") {
  const TemporaryFolder root;
  const fs::path tools = root / "tools";
  fs::create_directories(tools);
  for (const char* name : {"include_graph", "module_list.py", "modules"}) {
    fs::copy_file(fs::path(SIMVIS_SOURCE_DIR) / "tools" / name, tools / name);
  }
  CHECK(check_tree(tools / "include_graph", root.path()).exit_code == 0);
  write_text(tools / "modules", read_text(tools / "modules") + "module scenegraph/odd: elements\n  holds a circle\n");
  const ProcessResult result = check_tree(tools / "include_graph", root.path());
  CHECK(result.exit_code == 1);
  CHECK(result.out.starts_with("tools/modules: folders at the top of the tree include each other: "));
}

// The linker takes one of two types of one name for both, without a word.
TEST_CASE("no two headers of the library define a type of the same name in the same namespace") {
  const std::regex type("^(struct|class) (SIMVIS_[A-Z_]+ )?([A-Z][A-Za-z0-9]*) (final )?(: .*)?\\{.*");
  std::map<std::string, std::string> header_of;
  for (const std::string& name : headers_of_the_library()) {
    std::istringstream lines(read_text(fs::path(SIMVIS_SOURCE_DIR) / name));
    std::string within;
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("namespace ")) within = line;
      if (!std::regex_match(line, match, type)) continue;
      const auto [at, is_new] = header_of.emplace(within + match[3].str(), name);
      CHECK_MESSAGE(is_new, name << " and " << at->second << " define " << match[3].str());
    }
  }
  CHECK(header_of.size() > 500);
}

TEST_CASE("an include against the arrows is named") {
  CHECK(complaint("sensors/psd/psd.cpp", "#include \"elements/pose.h\"\n") ==
        "sensors/psd/psd.cpp includes elements/pose.h: sensors/psd must not include elements\n");
  const std::initializer_list<File> wrong = {{"engine/culling/occluders.cpp", "#include \"engine/render/renderer.h\""},
                                             {"engine/geometry/item_index.cpp", "#include \"engine/raycast/tlas.h\""},
                                             {"engine/draw/mesh.cpp", "#include <simvis/image.h>"},
                                             {"scenegraph/scene.cpp", "#include <simvis/step_costs.h>"},
                                             {"import/gltf/a.cpp", "#include \"import/urdf/b.h\""},
                                             {"sensors/psd/psd.cpp", "#include \"sensors/event_camera/edge_touch.h\""},
                                             {"sensors/camera/camera.cpp", "#include <simvis/simulation_desc.h>"},
                                             {"simvis/clock.cpp", "#include \"program/report/scanner_costs.h\""},
                                             {"simvis/parameters.cpp", "#include \"tests/support/error_of.h\""},
                                             {"bench/scale.cpp", "#include \"tests/support/error_of.h\""},
                                             {"tests/simvis/cli_test.cpp", "#include \"bench/timing.h\""},
                                             {"shaders/mesh_depth.vert", "#include <simvis/image.h>"}};
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
                                      {"program/cli/simvis_run.cpp", "#include \"program/report/scanner_costs.h\""},
                                      {"tests/plugin/plate.cpp", "#include <simvis/image.h>"},
                                      {"bench/scale.cpp", "#include <simvis/image.h>"},
                                      {"shaders/mesh_depth.vert", "#include \"shaders/interop.h\""},
                                      {"engine/draw/cube.cpp", "#include <vector>"},
                                      {"include/simvis/image.h", "#include <glm/glm.hpp>"},
                                      {"sensors/psd/psd.cpp", "// #include \"elements/pose.h\""}});
  CAPTURE(result.err);
  CHECK(result.out.starts_with("no include against"));
  CHECK(result.exit_code == 0);
}

TEST_CASE("the leaf includes nothing of ours, and quotes are for our private files") {
  CHECK(complaint("shaders/interop.h", "#include \"shaders/fog.glsl\"") ==
        "shaders/interop.h includes shaders/fog.glsl: it is a leaf and includes nothing of ours\n");
  CHECK(is_right("shaders/interop.h", "#include <glm/glm.hpp>"));
  CHECK(complaint("include/simvis/image.h", "#include \"engine/vulkan/buffer.h\"").find("a public header includes") !=
        std::string::npos);
  for (const char* include : {"#include \"mesh.h\"", "#include \"../scenegraph/node.h\"",
                              "#include <engine/draw/mesh.h>", "#include <simvis/clock.h>"}) {
    CAPTURE(include);
    CHECK_FALSE(is_right("engine/draw/mesh.cpp", include));
  }
}

TEST_CASE("a public header belongs to the module of its source, or to the one that is said") {
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
