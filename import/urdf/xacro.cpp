#include "import/urdf/xacro.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/read_error.h"
#include "sandbox/python_path.h"
#include "sandbox/sandbox_process.h"
#include "scenegraph/language/control_characters.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxOutput_bytes = std::size_t{256} << 20;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  fail_at({.file = file.string()}, what);
}

std::filesystem::path find_program(const std::filesystem::path& file) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path program = std::filesystem::path(folder.empty() ? "." : folder) / "xacro";
    if (::access(program.c_str(), X_OK) == 0 && !std::filesystem::is_directory(program)) return program;
  }
  refuse(file,
         "is xacro, and there is no program xacro in PATH to expand it; install it (\"pip install xacro\", or the "
         "package xacro of a ROS distribution), or expand the file on another computer: xacro FILE > robot.urdf");
}

std::vector<std::string> split_arguments(const std::filesystem::path& file, const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> arguments;
  for (std::string word; words >> word;) {
    const std::size_t colon = word.find(":=");
    if (colon == 0 || colon == std::string::npos || word.starts_with('-')) {
      refuse(file, "attribute \"xacro_arguments\": " + in_quotes(word) + " is not allowed, expected NAME:=VALUE");
    }
    arguments.push_back(word);
  }
  return arguments;
}

// Stands in for the Python package ament_index_python, which xacro asks for the folders of packages. It knows the
// packages that PackageFiles finds.
class PackageIndex {
 public:
  explicit PackageIndex(const std::map<std::string, std::filesystem::path>& packages) {
    std::string name = (std::filesystem::temp_directory_path() / "simvis-xacro-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw MachineError("cannot make the folder " + name + ": " + error_text());
    folder_ = name;
    nlohmann::json folders = nlohmann::json::object();
    for (const auto& [package, folder] : packages) folders[package] = folder.string();
    const std::filesystem::path module = folder_ / "ament_index_python";
    std::error_code error;
    std::filesystem::create_directory(module, error);
    if (error) throw MachineError("cannot make the folder " + module.string() + ": " + error.message());
    write(module / "__init__.py", "");
    write(module / "packages.py",
          "PACKAGES = " + folders.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
              "\n\n\ndef get_package_share_directory(name):\n    if name not in PACKAGES:\n"
              "        raise KeyError('there is no package \"%s\", try --package %s=DIR' % (name, name))\n"
              "    return PACKAGES[name]\n");
  }
  ~PackageIndex() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  PackageIndex(const PackageIndex&) = delete;
  PackageIndex& operator=(const PackageIndex&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  static std::string error_text() { return std::strerror(errno); }
  static void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file);
    if (!(out << text).flush()) throw MachineError("cannot write the file " + file.string());
  }
  std::filesystem::path folder_;
};

std::vector<std::string> environment(const std::map<std::string, std::filesystem::path>& packages,
                                     const PackageIndex& index) {
  std::string ros_path;  // where xacro of ROS 1 finds packages
  for (const auto& [name, folder] : packages) ros_path += (ros_path.empty() ? "" : ":") + folder.string();
  const std::string users = python_path();
  return {"PYTHONPATH=" + index.folder().string() + (users.empty() ? "" : ":" + users), "ROS_PACKAGE_PATH=" + ros_path,
          "PYTHONDONTWRITEBYTECODE=1"};
}

// Messages come before the XML, since xacro writes its output at its end.
std::size_t start_of_xml(std::string_view output) {
  if (output.starts_with("<?xml")) return 0;
  const std::size_t line = output.find("\n<?xml");
  return line == std::string_view::npos ? line : line + 1;
}

// Whether Python ended with an exception for a fault of the machine: xacro prints its text and exits with 1 or 2.
bool is_fault_of_machine(const std::string& output) {
  constexpr std::string_view kNumber = "[Errno ";
  if (output.find("MemoryError") != std::string::npos) return true;
  const std::size_t at = output.rfind(kNumber);
  return at != std::string::npos && !is_fault_of_file(std::atoi(output.c_str() + at + kNumber.size()));
}

// What keeps xacro from printing XML. An exit status is its answer to a file that it cannot expand.
HelperFault fault_of_xacro(const HelperEnd& end, const std::string& output) {
  HelperFault fault = fault_of(end);
  if (end.kind != HelperEndKind::exited) return fault;
  if (fault.blame == Blame::nobody && start_of_xml(output) != std::string::npos) return fault;
  return {is_fault_of_machine(output) ? Blame::machine : Blame::file,
          fault.reason.empty() ? "it prints nothing" : fault.reason};
}

std::string joined_lines(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return on_one_line(std::move(text));
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
  const std::map<std::string, std::filesystem::path> known = packages.packages();
  const std::filesystem::path program = find_program(file);
  const PackageIndex index(known);
  SandboxCall call{.program = program, .arguments = {file.string()}, .environment = environment(known, index)};
  for (std::string& argument : split_arguments(file, arguments)) call.arguments.push_back(std::move(argument));
  call.streams = AnswerStreams::output_and_errors;
  call.time = kXacroTime;
  call.answer_bytes = kMaxOutput_bytes;
  call.memory_bytes = kXacroMemory_bytes;
  const SandboxReport report = run_in_sandbox(call);
  const std::string output(report.answer.begin(), report.answer.end());
  const HelperFault fault = fault_of_xacro(report.end, output);
  if (fault.blame != Blame::nobody) {
    const bool lacks_argument = output.find("Undefined substitution argument") != std::string::npos;
    const bool gave_up = report.end.kind == HelperEndKind::exited;
    std::string what = gave_up ? "xacro cannot expand it: " : "xacro ";
    what += gave_up && !output.empty() ? joined_lines(output) : fault.reason;
    throw_fault(fault.blame,
                file.string() + ": error: " + what +
                    (lacks_argument ? "; the part's attribute xacro_arguments=\"NAME:=VALUE\" sets arguments" : ""));
  }
  return XmlText(SourceText(output.substr(start_of_xml(output)), file.string() + "(expanded)"));
}

}  // namespace simvis
