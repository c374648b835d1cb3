// The arrows between the folders: engine < scenegraph < {elements, effects < sensors} < simvis < {tests, bench}, and
// shaders/interop.h a leaf. Reads every #include of the tree and says which one points the wrong way.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

TEST_SUITE_BEGIN("simvis");

namespace {

namespace fs = std::filesystem;

/// What the files of each folder may include, besides those of their own folder.
const std::map<std::string, std::set<std::string>, std::less<>> kAllowed = {
    {"shaders", {}},
    {"engine", {"shaders"}},
    {"scenegraph", {"engine", "shaders"}},
    {"elements", {"scenegraph", "engine", "shaders"}},
    {"effects", {"scenegraph", "engine", "shaders"}},
    {"sensors", {"effects", "scenegraph", "engine", "shaders"}},
    {"simvis", {"elements", "effects", "sensors", "scenegraph", "engine", "shaders"}},
    {"bench", {"simvis", "elements", "effects", "sensors", "scenegraph", "engine", "shaders"}},
    {"tests", {"simvis", "elements", "effects", "sensors", "scenegraph", "engine", "shaders"}},
};

constexpr std::string_view kLeaf = "shaders/interop.h";

struct Include {
  std::string file;    ///< who includes, from the root of the tree
  std::string target;  ///< what stands between the quotes or brackets
  bool quoted = true;
};

std::string_view folder_of(std::string_view file) {
  const std::size_t slash = file.find('/');
  return slash == std::string_view::npos ? std::string_view() : file.substr(0, slash);
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

/// Reads `#include "x"` and `#include <x>`, spaces or not. False when the line is no such thing.
bool parse_include(std::string_view line, Include& include) {
  line = trimmed(line);
  if (!line.starts_with('#')) return false;
  line = trimmed(line.substr(1));
  constexpr std::string_view kWord = "include";
  if (!line.starts_with(kWord)) return false;
  line = trimmed(line.substr(kWord.size()));
  if (line.empty() || (line[0] != '"' && line[0] != '<')) return false;
  include.quoted = line[0] == '"';
  const std::size_t end = line.find(include.quoted ? '"' : '>', 1);
  if (end == std::string_view::npos) return false;
  include.target = line.substr(1, end - 1);
  return true;
}

/// What is wrong with an include; empty when it is right.
std::string complaint(const Include& include) {
  const std::string said = include.file + " includes " + include.target;
  const std::string_view from = folder_of(include.file), to = folder_of(include.target);
  if (include.quoted && !kAllowed.contains(to)) return said + ": quotes are for our own files, written from the root";
  if (!kAllowed.contains(to)) return {};
  if (include.file == kLeaf) return said + ": it is a leaf and includes nothing of ours";
  if (from == to) return {};
  const std::set<std::string>& allowed = kAllowed.find(from)->second;
  if (allowed.contains(std::string(to))) return {};
  return said + ": " + std::string(from) + " must not know " + std::string(to);
}

std::vector<std::string> complaints(const std::vector<Include>& includes) {
  std::vector<std::string> all;
  for (const Include& include : includes) {
    if (std::string text = complaint(include); !text.empty()) all.push_back(std::move(text));
  }
  return all;
}

bool is_source(const fs::path& file) {
  static const std::set<std::string> kEndings = {".h", ".cpp", ".glsl", ".vert", ".frag", ".comp"};
  return kEndings.contains(file.extension().string());
}

std::vector<Include> includes_of_tree(const fs::path& root) {
  std::vector<Include> includes;
  for (const auto& [folder, allowed] : kAllowed) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      std::ifstream in(entry.path());
      Include include{.file = entry.path().lexically_relative(root).generic_string(), .target = {}};
      for (std::string line; std::getline(in, line);) {
        if (parse_include(line, include)) includes.push_back(include);
      }
    }
  }
  return includes;
}

}  // namespace

TEST_CASE("every include of the tree points along the arrows") {
  const std::vector<Include> includes = includes_of_tree(SIMVIS_SOURCE_DIR);
  for (const auto& [folder, allowed] : kAllowed) {
    CAPTURE(folder);
    CHECK(std::any_of(includes.begin(), includes.end(),
                      [&](const Include& include) { return folder_of(include.file) == folder; }));
  }
  for (const std::string& text : complaints(includes)) FAIL_CHECK(text);
}

TEST_CASE("an include against the arrows is named") {
  const auto wrong = [](const char* file, const char* target) { return !complaint({file, target}).empty(); };
  CHECK(complaint({"sensors/laser.cpp", "elements/pose.h"}) ==
        "sensors/laser.cpp includes elements/pose.h: sensors must not know elements");
  CHECK(wrong("elements/pose.cpp", "sensors/sensor.h"));
  CHECK(wrong("engine/mesh.cpp", "scenegraph/node.h"));
  CHECK(wrong("scenegraph/scene.cpp", "elements/element.h"));
  CHECK(wrong("sensors/camera.cpp", "simvis/simulation.h"));
  CHECK(wrong("simvis/clock.cpp", "tests/wall.h"));
  CHECK(wrong("bench/speed.cpp", "tests/wall.h"));
  CHECK(wrong("tests/speed_test.cpp", "bench/speed.h"));
  CHECK(wrong("shaders/mesh.vert", "engine/mesh.h"));
  // The angle brackets of the installed headers are no way around.
  CHECK_FALSE(complaint({"engine/mesh.cpp", "simvis/simulation.h", false}).empty());
}

TEST_CASE("an include along the arrows is right") {
  const std::vector<Include> right = {
      {"engine/mesh.cpp", "engine/mesh.h"},          {"engine/renderer.cpp", "shaders/interop.h"},
      {"scenegraph/scene.cpp", "engine/mesh.h"},     {"scenegraph/gltf/skin.cpp", "scenegraph/node.h"},
      {"elements/pose.cpp", "scenegraph/node.h"},    {"sensors/camera.cpp", "engine/renderer.h"},
      {"simvis/simulation.cpp", "sensors/sensor.h"}, {"simvis/simulation.cpp", "elements/element.h"},
      {"tests/plugin/plate.cpp", "tests/wall.h"},    {"bench/speed.cpp", "simvis/simulation.h"},
      {"shaders/mesh.vert", "shaders/interop.h"},    {"engine/mesh.cpp", "vector", false},
      {"engine/mesh.h", "glm/glm.hpp", false},       {"tests/a_test.cpp", "doctest/doctest.h", false},
  };
  CHECK(complaints(right) == std::vector<std::string>());
}

TEST_CASE("the leaf includes nothing of ours, and quotes are for our own files") {
  CHECK(complaint({"shaders/interop.h", "shaders/color.glsl"}) ==
        "shaders/interop.h includes shaders/color.glsl: it is a leaf and includes nothing of ours");
  CHECK(complaint({"shaders/interop.h", "glm/glm.hpp", false}).empty());
  CHECK_FALSE(complaint({"engine/mesh.cpp", "mesh.h"}).empty());
  CHECK_FALSE(complaint({"engine/mesh.cpp", "../scenegraph/node.h"}).empty());
}

TEST_CASE("include lines are read however they are spaced") {
  Include include;
  CHECK(parse_include("#include \"engine/mesh.h\"  // why", include));
  CHECK(include.target == "engine/mesh.h");
  CHECK(include.quoted);
  CHECK(parse_include("  #  include<vector>", include));
  CHECK(include.target == "vector");
  CHECK_FALSE(include.quoted);
  CHECK_FALSE(parse_include("// #include \"engine/mesh.h\"", include));
  CHECK_FALSE(parse_include("#define include", include));
  CHECK_FALSE(parse_include("#include SOME_MACRO", include));
  CHECK_FALSE(parse_include("", include));
}

TEST_SUITE_END();
