// The arrows between the rooms. Reads every #include of the tree and says which one points the wrong way.
//
//   base, shaders < draw, vulkan, language < geometry, scenegraph < effects, culling, raycast, import < render,
//   effects/scanner < sensors < simvis < simvis/report < simvis/cli < tests, bench
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

/// What the files of each room may include, besides those of their own room. A file belongs to the room with the
/// longest folder name that its path begins with.
const std::map<std::string, std::set<std::string>, std::less<>> kAllowed = [] {
  using Rooms = std::set<std::string>;
  const auto joined = [](Rooms all, const Rooms& more) {
    all.insert(more.begin(), more.end());
    return all;
  };
  std::map<std::string, Rooms, std::less<>> allowed;
  allowed["shaders"] = {};
  allowed["engine/base"] = {};
  allowed["engine/draw"] = {"engine/base", "shaders"};
  allowed["engine/vulkan"] = {"engine/base", "engine/draw", "shaders"};
  allowed["scenegraph/language"] = {"engine/base"};
  allowed["engine/geometry"] = {"engine/base", "engine/draw", "shaders"};
  allowed["engine/culling"] = joined(allowed["engine/geometry"], {"engine/geometry"});
  allowed["engine/raycast"] = {"engine/base", "engine/draw", "engine/vulkan", "engine/geometry", "shaders"};
  allowed["engine/render"] = joined(allowed["engine/raycast"], {"engine/culling"});
  allowed["scenegraph"] = {"engine/base", "engine/draw", "scenegraph/language"};
  allowed["scenegraph/import/sandbox"] = joined(allowed["scenegraph"], {"scenegraph"});
  allowed["scenegraph/import/mesh"] = joined(allowed["scenegraph/import/sandbox"], {"scenegraph/import/sandbox"});
  // The last are the programs that read part files with other projects' libraries.
  for (const char* room : {"gltf", "inventor", "urdf", "helper"}) {
    allowed["scenegraph/import/" + std::string(room)] =
        joined(allowed["scenegraph/import/mesh"], {"scenegraph/import/mesh"});
  }
  allowed["elements"] = joined(allowed["scenegraph"], {"scenegraph", "shaders"});
  allowed["elements/visualization"] = joined(allowed["elements"], {"elements"});
  allowed["effects"] = {"engine/base", "engine/draw", "scenegraph/language"};
  allowed["effects/camera"] = {"engine/base", "engine/draw", "scenegraph/language", "scenegraph", "effects"};
  allowed["effects/scene"] = joined(allowed["effects/camera"], {"engine/geometry"});
  allowed["effects/scanner"] = joined(allowed["effects/camera"], {"engine/raycast"});
  allowed["sensors"] = joined(allowed["effects/scanner"], {"effects"});
  allowed["sensors/raster_depth"] = joined(allowed["sensors"], {"engine/geometry"});
  allowed["sensors/psd"] = joined(allowed["sensors"], {"sensors"});
  allowed["sensors/camera"] =
      joined(allowed["sensors/raster_depth"], {"effects/camera", "sensors", "sensors/raster_depth"});
  // The scanner measures what each of its methods costs on a device, so it draws and casts by itself for once.
  allowed["sensors/laser_scanner"] =
      joined(allowed["sensors/camera"], {"effects/scanner", "engine/render", "engine/vulkan"});
  Rooms engine_and_scene;
  for (const auto& [room, rooms] : allowed) {
    if (room.find('/') == std::string::npos || room.starts_with("engine/") || room == "scenegraph/language") {
      engine_and_scene.insert(room);
    }
  }
  allowed["simvis"] = engine_and_scene;
  allowed["simvis/output"] = {"engine/base", "scenegraph", "sensors"};
  // Reports speak of what a scanner and a camera do, in their own terms.
  allowed["simvis/report"] = joined(
      engine_and_scene, {"simvis", "simvis/output", "sensors/camera", "sensors/laser_scanner", "sensors/raster_depth"});
  allowed["simvis/cli"] = joined(allowed["simvis/report"], {"simvis/report"});
  Rooms all;
  for (const auto& [room, rooms] : allowed) all.insert(room);
  allowed["scenes"] = {};  // data that tests and benchmarks share
  all.insert("scenes");
  allowed["bench"] = all;
  allowed["tests"] = all;
  return allowed;
}();

/// The room that implements each public header, include/simvis/NAME.h: its arrows are those of this room.
const std::map<std::string, std::string, std::less<>> kPublic = [] {
  std::map<std::string, std::string, std::less<>> rooms;
  const auto add = [&](const char* room, std::initializer_list<const char*> names) {
    for (const char* name : names) rooms[name] = room;
  };
  add("engine/base", {"error", "export", "philox", "progress", "version"});
  add("engine/draw", {"draw_list", "draw_list_delta", "frame_costs", "frame_plan", "frame_results", "mesh"});
  add("engine/vulkan", {"device"});
  add("engine/raycast", {"cost_model", "ray_caster", "surface_point"});
  add("scenegraph/language", {"attributes", "command", "location", "pose"});
  add("scenegraph", {"camera_layout", "content_pool", "frame_time", "image", "node", "part_importer", "scan", "scene"});
  add("elements", {"element"});
  add("effects", {"effect"});
  add("effects/camera", {"camera_effect"});
  add("effects/scanner", {"scan_effect"});
  add("sensors", {"sensor"});
  add("simvis", {"diagnostics", "parameters", "plugin", "step_costs", "sensor_info", "simulation", "simulation_desc",
                 "trajectory"});
  return rooms;
}();

constexpr std::string_view kLeaf = "shaders/interop.h";

struct Include {
  std::string file;    ///< who includes, from the root of the tree
  std::string target;  ///< what stands between the quotes or brackets
  bool quoted = true;
};

constexpr std::string_view kPublicFolder = "include/simvis/";

/// The room of a file, or of what an #include names; empty when it is none of ours.
std::string room_of(std::string_view file) {
  if (file.starts_with(kPublicFolder)) {
    const std::string_view name = file.substr(kPublicFolder.size());
    const auto found = kPublic.find(name.substr(0, name.rfind('.')));
    return found == kPublic.end() ? std::string() : found->second;
  }
  for (std::size_t end = file.rfind('/'); end != std::string_view::npos && end > 0; end = file.rfind('/', end - 1)) {
    if (kAllowed.contains(file.substr(0, end))) return std::string(file.substr(0, end));
  }
  return {};
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

/// What is wrong with an include; empty when it is right. Public headers are included as <simvis/NAME.h>, all other
/// files of ours in quotes, from the root.
std::string complaint(const Include& include) {
  const std::string said = include.file + " includes " + include.target;
  if (!include.quoted && !include.target.starts_with("simvis/")) {
    const bool ours = !room_of(include.target).empty();
    return ours ? said + ": angle brackets are for public headers and for others' files" : std::string();
  }
  const std::string from = room_of(include.file);
  const std::string to = room_of(include.quoted ? include.target : "include/" + include.target);
  if (from.empty()) return said + ": " + include.file + " is in no room";
  if (to.empty()) return said + ": there is no such file of ours";
  if (include.file.starts_with(kPublicFolder) && include.quoted)
    return said + ": a public header includes a private one";
  if (include.file == kLeaf) return said + ": it is a leaf and includes nothing of ours";
  if (from == to || kAllowed.find(from)->second.contains(to)) return {};
  return said + ": " + from + " must not know " + to;
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
  for (const char* folder : {"include", "shaders", "engine", "scenegraph", "elements", "effects", "sensors", "simvis",
                             "bench", "tests", "scenes"}) {
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
  for (const auto& [room, allowed] : kAllowed) {
    CAPTURE(room);
    CHECK(std::any_of(includes.begin(), includes.end(), [&](const Include& include) {
      return room_of(include.file) == room || room == "shaders" || room == "scenes";
    }));
  }
  for (const std::string& text : complaints(includes)) FAIL_CHECK(text);
}

TEST_CASE("every public header belongs to a room, and every name in the table is a header") {
  std::set<std::string> headers;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / kPublicFolder)) {
    headers.insert(entry.path().stem().string());
  }
  std::set<std::string> named;
  for (const auto& [name, room] : kPublic) named.insert(name);
  CHECK(headers == named);
}

TEST_CASE("no folder of sources has more than forty files") {
  std::map<fs::path, int> files;
  for (const char* folder :
       {"include", "engine", "scenegraph", "elements", "effects", "sensors", "simvis", "bench", "tests"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / folder)) {
      if (entry.is_regular_file() && is_source(entry.path())) ++files[entry.path().parent_path()];
    }
  }
  for (const auto& [folder, count] : files) {
    CAPTURE(folder);
    CHECK(count <= 40);
  }
}

TEST_CASE("an include against the arrows is named") {
  const auto wrong = [](const char* file, const char* target, bool quoted = true) {
    return !complaint({file, target, quoted}).empty();
  };
  CHECK(complaint({"sensors/psd/psd.cpp", "elements/pose.h"}) ==
        "sensors/psd/psd.cpp includes elements/pose.h: sensors/psd must not know elements");
  CHECK(wrong("engine/culling/occluders.cpp", "engine/render/renderer.h"));
  CHECK(wrong("engine/geometry/item_index.cpp", "engine/raycast/tlas.h"));
  CHECK(wrong("engine/draw/mesh.cpp", "simvis/node.h", false));
  CHECK(wrong("scenegraph/scene.cpp", "simvis/element.h", false));
  CHECK(wrong("sensors/psd/psd.cpp", "sensors/camera/camera.h"));
  CHECK(wrong("sensors/camera/camera.cpp", "simvis/simulation.h", false));
  CHECK(wrong("simvis/clock.cpp", "simvis/report/price.h"));
  CHECK(wrong("simvis/clock.cpp", "tests/support/error_of.h"));
  CHECK(wrong("bench/scale.cpp", "tests/support/error_of.h"));
  CHECK(wrong("tests/simvis/cli_test.cpp", "bench/timing.h"));
  CHECK(wrong("shaders/mesh_depth.vert", "simvis/mesh.h", false));
  CHECK(wrong("include/simvis/sensor.h", "engine/vulkan/buffer.h"));
  CHECK(wrong("include/simvis/mesh.h", "simvis/scene.h", false));
}

TEST_CASE("an include along the arrows is right") {
  const std::vector<Include> right = {
      {"engine/draw/mesh.cpp", "simvis/mesh.h", false},
      {"engine/render/renderer.cpp", "shaders/interop.h"},
      {"scenegraph/scene.cpp", "simvis/mesh.h", false},
      {"scenegraph/import/gltf/gltf_file.cpp", "simvis/node.h", false},
      {"elements/visualization/trail.cpp", "simvis/node.h", false},
      {"sensors/camera/camera.cpp", "simvis/frame_results.h", false},
      {"simvis/simulation.cpp", "simvis/sensor.h", false},
      {"simvis/cli/simvis_run.cpp", "simvis/report/price.h"},
      {"tests/plugin/plate.cpp", "simvis/element.h", false},
      {"bench/scale.cpp", "simvis/simulation.h", false},
      {"shaders/mesh_depth.vert", "shaders/interop.h"},
      {"engine/draw/mesh.cpp", "vector", false},
      {"include/simvis/mesh.h", "glm/glm.hpp", false},
      {"tests/simvis/a_test.cpp", "doctest/doctest.h", false},
  };
  CHECK(complaints(right) == std::vector<std::string>());
}

TEST_CASE("the leaf includes nothing of ours, and quotes are for our private files") {
  CHECK(complaint({"shaders/interop.h", "shaders/color.glsl"}) ==
        "shaders/interop.h includes shaders/color.glsl: it is a leaf and includes nothing of ours");
  CHECK(complaint({"shaders/interop.h", "glm/glm.hpp", false}).empty());
  CHECK_FALSE(complaint({"engine/draw/mesh.cpp", "mesh.h"}).empty());
  CHECK_FALSE(complaint({"engine/draw/mesh.cpp", "../scenegraph/node.h"}).empty());
  CHECK_FALSE(complaint({"engine/draw/mesh.cpp", "engine/draw/mesh.h", false}).empty());
  CHECK_FALSE(complaint({"engine/draw/mesh.cpp", "simvis/clock.h", false}).empty());
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
