#include "import/urdf/xacro.h"

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "engine/base/words.h"
#include "import/sandbox/python_program.h"
#include "import/sandbox/sandboxed_import.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxOutput_bytes = std::size_t{256} << 20;

// The variables that Python needs to find its libraries and modules and to decode text, and those of ROS that
// import/programs/xacro/xacro_main.py leaves for the file.
constexpr const char* kVariables[] = {
    "PATH",           "HOME",       "LANG",          "LC_ALL",     "LC_CTYPE",    "LD_LIBRARY_PATH",   "PYTHONHOME",
    "PYTHONUSERBASE", "PYENV_ROOT", "PYENV_VERSION", "ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION"};

using PackagesByName = std::map<std::string, std::filesystem::path>;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  fail_at({.file = file.string()}, what);
}

// The interpreter that has the module xacro.
std::filesystem::path python_with_xacro(const std::filesystem::path& file) {
  const std::optional<std::filesystem::path> program = program_in_path("xacro");
  if (!program) {
    refuse(file,
           "is xacro, and there is no program xacro in PATH to expand it; install it (\"pip install xacro\", or the "
           "package xacro of a ROS distribution), or expand the file on another computer: xacro FILE > robot.urdf");
  }
  const std::optional<std::filesystem::path> python = python_of(*program);
  if (!python) refuse(file, "is xacro, and there is no python3 in PATH for the program " + program->string());
  return *python;
}

std::vector<std::string> split_arguments(const std::filesystem::path& file, const std::string& text) {
  std::vector<std::string> arguments;
  for (const std::string_view word : words_of(text)) {
    const std::size_t colon = word.find(":=");
    if (colon == 0 || colon == std::string::npos || word.starts_with('-')) {
      refuse(file, "attribute \"xacro_arguments\": " + in_quotes(word) + " is not allowed, expected NAME:=VALUE");
    }
    arguments.emplace_back(word);
  }
  return arguments;
}

// What import/programs/xacro/xacro_main.py reads.
std::string request_text(const std::vector<std::string>& arguments, const PackagesByName& packages) {
  nlohmann::json folders = nlohmann::json::object();
  for (const auto& [name, folder] : packages) folders[name] = folder.string();
  const nlohmann::json request{{"arguments", arguments}, {"packages", folders}};
  return request.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<std::string> kept_variables(const PackagesByName& packages) {
  std::string ros_path;  // where xacro of ROS 1 finds packages
  for (const auto& [name, folder] : packages) ros_path += (ros_path.empty() ? "" : ":") + folder.string();
  std::vector<std::string> variables{"ROS_PACKAGE_PATH=" + ros_path};
  for (const char* const name : kVariables) {
    if (const char* const value = std::getenv(name)) variables.push_back(std::string(name) + "=" + value);
  }
  return variables;
}

}  // namespace

bool is_xacro(const std::filesystem::path& file, const XmlText& text) {
  struct Walker : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      found = found || std::string_view(node.name()).starts_with("xacro:");
      return !found;
    }
    bool found = false;
  } walker;
  if (file.extension() == ".xacro") return true;
  pugi::xml_node document = text.document();
  document.traverse(walker);
  return walker.found;
}

XmlText expand_xacro(const std::filesystem::path& file, const std::string& arguments, PackageFiles& packages) {
  const PackagesByName known = packages.packages();
  const std::string request = request_text(split_arguments(file, arguments), known);
  Folders folders = folders_of_part(file);
  for (std::filesystem::path& folder : packages.package_folders()) folders.push_back(std::move(folder));
  const ReadFence fence(folders);
  SandboxedImport import = python_import(python_with_xacro(file), "xacro_main.py", "xacro", file);
  import.inherits_environment = false;
  for (std::string& variable : kept_variables(known)) import.environment.push_back(std::move(variable));
  import.input = {reinterpret_cast<const std::uint8_t*>(request.data()), request.size()};
  import.least = {.time = kXacroTime, .memory_bytes = kXacroMemory_bytes};
  import.most_answer_bytes = kMaxOutput_bytes;
  const SandboxedAnswer answer = ask_in_sandbox(import);
  const std::string_view text(reinterpret_cast<const char*>(answer.scene.data()), answer.scene.size());
  return XmlText(SourceText(text, file.string() + "(expanded)"));
}

}  // namespace simvis
