// libsimvis.so and libsimvis-testing.so export the names that the public headers mark, the few that simvis-run needs,
// and nothing else.
#include <cxxabi.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("public");

namespace simvis {
namespace {

namespace fs = std::filesystem;

/// Names of private modules that simvis-run and the Python module use: those that engine/base/program_api.h marks. A
/// name that becomes public or moves into the program leaves this list; there should be no reason to add one.
const std::set<std::string> kProgramNames = {
    "AllowedFolders::AllowedFolders",
    "AllowedFolders::carry_out",
    "AllowedFolders::check",
    "AllowedFolders::parse",
    "AllowedFolders::start",
    "BackgroundTask::cancel",
    "BackgroundTask::finish",
    "Clock::Clock",
    "Clock::frame",
    "Deflater::Deflater",
    "Deflater::zlib_of",
    "FolderLock::FolderLock",
    "HeldLock::~HeldLock",
    "LiveScene::LiveScene",
    "Renderer::Renderer",
    "Renderer::collect",
    "Renderer::submit",
    "Renderer::~Renderer",
    "ResultLock::ResultLock",
    "SimulationServices::SimulationServices",
    "SimulationServices::end",
    "SimulationServices::end_early",
    "SimulationServices::end_steps",
    "SimulationServices::follow_frame",
    "SimulationServices::is_changed",
    "SimulationServices::serve",
    "TemporaryFile::TemporaryFile",
    "TemporaryFile::close",
    "TemporaryFile::put_in_place",
    "TemporaryFile::release",
    "TemporaryFile::~TemporaryFile",
    "ThreadPool::background_threads",
    "ThreadPool::run_in_background",
    "beam_following_effect",
    "built_scene",
    "call_environments_by",
    "command_inputs",
    "compare_recording",
    "compare_recording_file",
    "copy_numbers",
    "describe",
    "drawn_values",
    "encode_evt3",
    "encode_jpeg",
    "encode_png",
    "evt3_header",
    "files_of_robots",
    "find_physics",
    "find_scan_method",
    "fits_together",
    "frames_until",
    "from_json_text",
    "full_node_name",
    "host_by_dds",
    "is_beam_layout",
    "is_depth_visible",
    "keypoint_names",
    "kind_text",
    "leads_to",
    "markdown_rows",
    "markdown_table",
    "markdown_text",
    "measured_table",
    "min_planar_bound",
    "nested_points",
    "open_device",
    "oriented_box",
    "output_difference",
    "output_target",
    "own_bytes",
    "own_size",
    "png_bytes",
    "read_all_content",
    "read_in_pieces",
    "read_robot_file",
    "read_whole_file",
    "recorded_variables",
    "refers_to_file",
    "regular_target",
    "remove_leftovers",
    "remove_leftovers_of",
    "remove_unheld_locks",
    "replace_file",
    "require_own_name",
    "rigid_mount_frame",
    "ros::msg_text",
    "seen_solids_around",
    "sha256_of",
    "send_command",
    "send_messages",
    "shared_thread_pool",
    "srgb_codes",
    "text_table",
    "throw_file_error",
    "to_json_text",
    "unseen_items",
    "updated_scene",
    "walk_graph",
    "without_file_content",
    "write_all",
};

/// What the public headers declare outside of inline code.
struct Declared {
  std::set<std::string> classes, functions;  ///< with the mark
  std::vector<std::string> unmarked;         ///< functions that need a mark and have none
};

bool is_type(const std::string& head) {
  return std::regex_search(head, std::regex("\\b(class|struct)\\b")) && head.find("enum ") == head.npos &&
         head.find('(') == head.npos;
}

/// A declaration of a function whose definition stands in a source file.
bool is_function(const std::string& statement) {
  const std::size_t opening = statement.find('('), equals = statement.find('=');
  if (equals < opening && statement.find("operator") == statement.npos) return false;  // a value
  if (statement.find("(*") != statement.npos || statement.find("using ") != statement.npos) return false;
  if (statement.find("friend ") != statement.npos) return false;  // declared again at the namespace
  return std::regex_search(statement, std::regex("\\)( const)?( noexcept)?( override)?\\s*$"));
}

std::string last_word(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \n") + 1;
  const std::size_t begin = text.find_last_of(" &*\n", end - 1) + 1;
  return text.substr(begin, end - begin);
}

void read_header(std::string text, Declared& declared) {
  text = std::regex_replace(text, std::regex("//[^\n]*|(^|\n)#[^\n]*"), "\n");
  struct Scope {
    bool holds_declarations, marked;
  };
  std::vector<Scope> scopes = {{true, false}};
  std::string statement;
  int parentheses = 0;
  const auto marked = [&] { return statement.find("SIMVIS_API") != statement.npos; };
  for (const char c : text) {
    parentheses += (c == '(') - (c == ')');
    if (parentheses > 0 || (c != '{' && c != '}' && c != ';')) {
      statement += c;
      continue;
    }
    if (c == '{') {
      const bool type = is_type(statement), space = statement.find("namespace") != statement.npos;
      if (std::smatch name; type && std::regex_search(statement, name, std::regex("SIMVIS_API (\\w+)"))) {
        declared.classes.insert(name[1]);
      }
      scopes.push_back({type || space, type && (marked() || scopes.back().marked)});
    } else if (c == '}') {
      scopes.pop_back();
    } else if (scopes.back().holds_declarations && is_function(statement) &&
               statement.find("static_assert") == statement.npos) {
      if (marked()) declared.functions.insert(last_word(statement.substr(0, statement.find('('))));
      if (!marked() && !scopes.back().marked) declared.unmarked.push_back(statement);
    }
    statement.clear();
  }
}

Declared read_headers() {
  Declared declared;
  for (const fs::directory_entry& header : fs::directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / "include/simvis")) {
    read_header(read_text(header.path()), declared);
  }
  return declared;
}

struct Symbol {
  char kind;         ///< as nm prints it
  std::string name;  ///< mangled
};

std::vector<Symbol> dynamic_symbols() {
  std::vector<Symbol> symbols;
  for (const char* const library : {"libsimvis.so", "libsimvis-testing.so"}) {
    const ProcessResult nm = Process({"nm", "-D", "--defined-only", tested_build() + "/lib/" + library}).wait();
    REQUIRE(nm.exit_code == 0);
    std::istringstream lines(nm.out);
    std::string address, kind, name;
    while (lines >> address >> kind >> name) symbols.push_back({kind.front(), name});
  }
  return symbols;
}

std::string demangled(const std::string& mangled) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(mangled.c_str(), nullptr, nullptr, &status), &std::free);
  return status == 0 ? text.get() : mangled;
}

/// Instances of the standard library's templates. They stay as the standard library marks them: what must be one in a
/// process, such as the waiters behind std::atomic::wait(), has to be shared.
bool is_of_standard_library(const Symbol& symbol) {
  static const std::regex kMangled("_Z(T[VTIS]|GV)?Z?N?K?(S[tabsiod]|9__gnu_cxx).*");
  return std::string_view("WVu").find(symbol.kind) != std::string_view::npos && std::regex_match(symbol.name, kMangled);
}

/// "Class::member", "Class" or "function", without parameters; "" outside of namespace simvis. Names of the public
/// namespace simvis::test_kit count as those of simvis.
std::string name_in_simvis(const std::string& mangled) {
  std::string name = demangled(mangled);
  name = std::regex_replace(name, std::regex("\\[abi:cxx11\\]"), "");
  name = std::regex_replace(name, std::regex("^(vtable|VTT|typeinfo|typeinfo name) for "), "");
  for (const std::string space : {"simvis::test_kit::", "simvis::"}) {
    if (name.starts_with(space)) return name.substr(space.size(), name.find('(') - space.size());
  }
  return "";
}

bool is_public(const std::string& name, const Declared& declared) {
  const std::size_t colons = name.find("::");
  if (colons == name.npos) return declared.classes.contains(name) || declared.functions.contains(name);
  return declared.classes.contains(name.substr(0, colons)) && name.find("::", colons + 2) == name.npos;
}

}  // namespace

TEST_CASE("the libraries export what the public headers mark and what simvis-run needs, and nothing else") {
  if (sanitized()) return test::skip("a sanitizer exports names of its own");
  const Declared declared = read_headers();
  std::set<std::string> exported;
  std::vector<std::string> private_names;
  for (const Symbol& symbol : dynamic_symbols()) {
    if (is_of_standard_library(symbol)) continue;
    const std::string name = name_in_simvis(symbol.name);
    exported.insert(name);
    if (!is_public(name, declared) && !kProgramNames.contains(name)) private_names.push_back(demangled(symbol.name));
  }
  CHECK_MESSAGE(private_names.empty(), private_names.size(), " private names, such as ", private_names.front());
  // All that is marked is there.
  for (const std::set<std::string>* names : {&declared.functions, &kProgramNames}) {
    for (const std::string& name : *names) {
      CAPTURE(name);
      CHECK(exported.contains(name));
    }
  }
  CHECK(exported.contains("Simulation::step"));
  CHECK(exported.contains("Run::step"));
  CHECK(exported.contains("InputError"));  // its type, which is thrown
}

TEST_CASE("every function of the public headers that is not inline is marked") {
  const Declared declared = read_headers();
  CHECK(declared.functions.contains("version"));
  CHECK(declared.functions.contains("fail_at"));
  CHECK(declared.classes.contains("Simulation"));
  for (const std::string& declaration : declared.unmarked) {
    CAPTURE(declaration);
    CHECK(false);
  }
}

}  // namespace simvis

TEST_SUITE_END();
