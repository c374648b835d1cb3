#include "import/model/package_files.h"

#include <algorithm>
#include <climits>
#include <pugixml.hpp>
#include <string_view>
#include <system_error>

#include <simvis/location.h>
#include "engine/base/folder_entries.h"
#include "engine/base/input_log.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "engine/base/words.h"
#include "import/mesh/name_case.h"
#include "import/model/small_xml.h"

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRosPath = "ROS_PACKAGE_PATH";
constexpr const char* kAmentPath = "AMENT_PREFIX_PATH";
constexpr const char* kModelPaths[] = {"GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH",
                                       "SDF_PATH"};
constexpr const char* kModelsFolder = "models";
constexpr int kMaxDepth = 32;         // of packages below ROS_PACKAGE_PATH: links may lead in circles
constexpr int kLevelsOfPackages = 5;  // folders above the URDF whose packages are read
constexpr int kLevelsNear = 3;        // folders above the URDF in which a lost file is searched

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::path& each : folder_entries(folder)) {
    const bool hidden = each.filename().string().starts_with('.');
    if (!hidden && is_input_folder(each)) folders.push_back(each);
  }
  return folders;
}

// The <name> in the folder's package.xml; empty if there is none.
std::string read_package_name(const fs::path& folder) {
  const ReadOpening opening;
  pugi::xml_document document;
  if (!load_if_there(folder / "package.xml", document)) return "";
  return std::string(trimmed(document.child("package").child_value("name")));
}

// As rospack: a package has no packages below it, and a file CATKIN_IGNORE hides a folder.
void add_packages_below(const fs::path& folder, int depth, std::multimap<std::string, fs::path>& packages) {
  if (depth > kMaxDepth || is_there(folder / "CATKIN_IGNORE")) return;
  if (is_input_file(folder / "package.xml")) {
    packages.emplace(read_package_name(folder), folder);
    return;
  }
  for (const fs::path& child : folders_in(folder)) add_packages_below(child, depth + 1, packages);
}

std::vector<fs::path> folder_and_above(const fs::path& folder) {
  std::vector<fs::path> folders{folder};
  while (folders.back() != folders.back().parent_path()) folders.push_back(folders.back().parent_path());
  return folders;
}

std::vector<fs::path> nearest(std::vector<fs::path> folders, int levels_above) {
  folders.resize(std::min(folders.size(), static_cast<std::size_t>(levels_above) + 1));
  return folders;
}

std::string state_of(const char* variable) {
  const std::size_t folders = folders_of_variable(variable).size();
  return std::string(variable) + (folders == 0 ? " (not set)" : "");
}

// Whether a name with ".." still leads to a place at or below the folder.
bool lies_below(const fs::path& file, const fs::path& folder) {
  const fs::path rest = file.lexically_normal().lexically_relative(folder.lexically_normal());
  return !rest.empty() && *rest.begin() != "..";
}

bool take_prefix(std::string& name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return false;
  name.erase(0, prefix.size());
  return true;
}

}  // namespace

std::vector<fs::path> folders_of_variable(const char* variable) {
  const char* const value = noted_variable(variable);
  std::vector<fs::path> folders;
  for (std::string_view rest = value == nullptr ? "" : value; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    if (!folder.empty()) folders.emplace_back(folder);
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
  }
  return folders;
}

PackageFiles::PackageFiles(const fs::path& urdf, std::vector<PackageFolder> given) : given_(std::move(given)) {
  std::error_code error;
  folder_ = fs::absolute(urdf, error).lexically_normal().parent_path();
}

std::optional<fs::path> PackageFiles::find(const std::string& written, const Location& where) {
  tried_.clear();
  std::string name = written;
  std::ranges::replace(name, '\\', '/');
  take_prefix(name, "file://");
  const bool is_model = take_prefix(name, "model://");
  std::string_view end_of_package = "/";
  bool in_package = is_model || take_prefix(name, "package://");
  if (!in_package && take_prefix(name, "$(find ")) {
    in_package = true;
    end_of_package = ")";
  }
  if (!in_package) {
    if (const auto found = try_file(folder_, name)) return found;
    return find_near(name, "file " + in_quotes(written), where);
  }
  const std::size_t end = std::min(name.find(end_of_package), name.size());
  if (end == name.size() && !is_model) {  // a file without a package
    if (const auto found = try_file(folder_, name)) return found;
    return find_near(name, "file " + in_quotes(written), where);
  }
  const std::string package = name.substr(0, end);
  std::string rest = name.substr(std::min(end + 1, name.size()));
  rest.erase(0, std::min(rest.find_first_not_of('/'), rest.size()));
  if (const auto found = find_in_package(package, rest, is_model)) return found;
  return find_near(rest, (is_model ? "model " : "package ") + in_quotes(package), where);
}

std::optional<fs::path> PackageFiles::find_model_file(const std::string& name, const std::string& rest) {
  tried_.clear();
  return find_in_package(name, rest, true);
}

std::string PackageFiles::tried() const {
  std::string list = "tried ";
  for (std::size_t i = 0; i < tried_.size(); ++i) list += (i == 0 ? "" : ", ") + tried_[i];
  return list;
}

std::optional<fs::path> PackageFiles::try_file(const fs::path& folder, const std::string& rest) {
  const fs::path file = folder / rest;
  if (is_input_file(file)) return file;
  const bool is_new = std::ranges::find(tried_, file.string()) == tried_.end();
  if (is_new && is_input_folder(folder)) tried_.push_back(file.string());
  return std::nullopt;
}

std::optional<fs::path> PackageFiles::try_package(const fs::path& folder, const std::string& rest) {
  std::optional<fs::path> found = try_file(folder, rest);
  if (found) admit_folder(folder);  // where REST leads out of it, the file is refused when it is opened
  return found;
}

std::optional<fs::path> PackageFiles::find_in_package(const std::string& name, const std::string& rest, bool is_model) {
  // The folders that "..", "." or a path would name are no packages.
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos) {
    tried_.push_back(in_quotes(name) + ", which is no name of a package");
    return std::nullopt;
  }
  for (const PackageFolder& given : given_) {
    if (given.name != name) continue;
    if (const auto found = try_package(given.folder, rest)) return found;
  }
  if (is_model) {
    for (const char* variable : kModelPaths) {
      for (const fs::path& models : folders_of_variable(variable)) {
        if (const auto found = try_package(models / name, rest)) return found;
      }
      tried_.push_back(state_of(variable));
    }
  } else {
    const auto [first, last] = ros_packages().equal_range(name);
    for (auto package = first; package != last; ++package) {
      if (const auto found = try_package(package->second, rest)) return found;
    }
    tried_.push_back(state_of(kRosPath));
    for (const fs::path& prefix : folders_of_variable(kAmentPath)) {
      if (const auto found = try_package(prefix / "share" / name, rest)) return found;
    }
    tried_.push_back(state_of(kAmentPath));
  }
  return find_beside_or_above(name, rest, is_model);
}

std::optional<fs::path> PackageFiles::find_beside_or_above(const std::string& name, const std::string& rest,
                                                           bool is_model) {
  int level = 0;
  for (const fs::path& above : folder_and_above(folder_)) {
    const bool reads_packages = level++ <= kLevelsOfPackages;
    // In folders that all share, /etc is no package.
    const bool is_shared = is_shared_folder(above);
    const auto may_be_package = [&](const fs::path& folder) { return !is_shared || is_model_folder(folder); };
    if ((above.filename() == name && !is_shared) || (reads_packages && declared_name(above) == name)) {
      if (const auto found = try_package(above, rest)) return found;
    }
    for (const fs::path& folder : {above / name, above / kModelsFolder / name}) {
      if (folder.parent_path() != above && !is_model) continue;
      if (!may_be_package(folder)) continue;
      if (const auto found = try_package(folder, rest)) return found;
    }
    if (!reads_packages) continue;
    for (const fs::path& beside : packages_in(above)) {
      if (declared_name(beside) != name || beside.filename() == name) continue;
      if (const auto found = try_package(beside, rest)) return found;
    }
  }
  tried_.push_back("folders of this name beside and above " + folder_.string());
  return std::nullopt;
}

std::optional<fs::path> PackageFiles::find_near(const std::string& rest, const std::string& subject,
                                                const Location& where) {
  // Shorter and shorter ends of the name, down to a folder and a file. A name of one component has only itself. Longer
  // ends than PATH_MAX name no file, and all ends of a long name would take the square of its length.
  const std::size_t last_part = rest.size() - std::min<std::size_t>(rest.size(), PATH_MAX);
  std::vector<std::string> ends{rest.substr(std::min(rest.find_first_not_of('/', last_part), rest.size()))};
  while (std::ranges::count(ends.back(), '/') > 1) ends.push_back(ends.back().substr(ends.back().find('/') + 1));
  const auto as_written = [&](const fs::path& folder, const std::string& end) -> std::optional<fs::path> {
    const fs::path file = folder / end;
    return is_input_file(file) ? std::optional(file) : std::nullopt;
  };
  const auto search = [&](const auto& look) -> std::optional<fs::path> {
    for (const std::string& end : ends) {
      for (const fs::path& above : nearest(folder_and_above(folder_), kLevelsNear)) {
        const bool is_lost = end.empty() || (above != folder_ && is_shared_folder(above));
        const std::optional<fs::path> file = is_lost ? std::nullopt : look(above, end);
        if (!file || !lies_below(*file, above)) continue;
        admit_folder(above);
        return file->lexically_normal();
      }
    }
    return std::nullopt;
  };
  std::optional<fs::path> found = search(as_written);
  if (!found) found = search(file_ignoring_case);
  if (found) {
    const bool is_lost_package = subject.starts_with("package") || subject.starts_with("model");
    if (warned_.insert(subject).second) {
      warnings_.push_back(to_string(where) + ": " + subject + " is not there" +
                          (is_lost_package ? " or lacks " + in_quotes(rest) : "") + "; " + in_quotes(found->string()) +
                          " is taken instead" + (is_lost_package ? ", and other files from near by too" : ""));
    }
    return found;
  }
  tried_.push_back(in_quotes(ends.back()) + " up to " + std::to_string(kLevelsNear) + " folders above");
  return std::nullopt;
}

const std::multimap<std::string, fs::path>& PackageFiles::ros_packages() {
  if (!ros_packages_) {
    ros_packages_.emplace();
    for (const fs::path& folder : folders_of_variable(kRosPath)) add_packages_below(folder, 0, *ros_packages_);
  }
  return *ros_packages_;
}

// The folders in `folder` that have a package.xml with a name.
const std::vector<fs::path>& PackageFiles::packages_in(const fs::path& folder) {
  const auto [known, is_new] = packages_in_.try_emplace(folder);
  if (is_new) {
    for (const fs::path& child : folders_in(folder)) {
      if (!declared_name(child).empty()) known->second.push_back(child);
    }
  }
  return known->second;
}

const std::string& PackageFiles::declared_name(const fs::path& folder) {
  const auto [known, is_new] = declared_names_.try_emplace(folder);
  if (is_new) known->second = read_package_name(folder);
  return known->second;
}

std::map<std::string, fs::path> PackageFiles::packages() {
  std::map<std::string, fs::path> all;
  for (const PackageFolder& given : given_) all.emplace(given.name, given.folder);
  for (const auto& [name, folder] : ros_packages()) all.emplace(name, folder);
  for (const fs::path& prefix : folders_of_variable(kAmentPath)) {
    for (const fs::path& folder : folders_in(prefix / "share")) all.emplace(folder.filename(), folder);
  }
  for (const fs::path& above : nearest(folder_and_above(folder_), kLevelsOfPackages)) {
    std::vector<fs::path> folders = folders_in(above);
    folders.insert(folders.begin(), above);
    // In folders that all share, /etc is no package.
    if (is_shared_folder(above))
      std::erase_if(folders, [](const fs::path& folder) { return !is_model_folder(folder); });
    for (const fs::path& folder : folders) {
      if (!declared_name(folder).empty()) all.emplace(declared_name(folder), folder);
    }
    for (const fs::path& folder : folders) all.emplace(folder.filename(), folder);
  }
  return all;
}

Folders PackageFiles::package_folders() {
  Folders folders;
  for (const auto& [name, folder] : packages()) {
    folders.push_back(folder);
    std::error_code error;
    const fs::path source = fs::canonical(folder / "package.xml", error);
    if (!error && fs::is_symlink(folder / "package.xml", error)) folders.push_back(source.parent_path());
  }
  return folders;
}

}  // namespace simvis
