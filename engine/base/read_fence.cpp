#include "engine/base/read_fence.h"

#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/folder_entries.h"
#include "engine/base/read_error.h"

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModelFiles[] = {"package.xml", "manifest.xml", "model.config"};
constexpr const char* kRootMarks[] = {"pyproject.toml", ".git"};
constexpr int kLevelsToModel = 5;  // of folders above the part's
constexpr int kMaxFollowed = 40;   // as Linux follows in one path

// Without "." and "..", but with links.
fs::path whole_path(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

// Where the symbolic link leads; empty: it is none, or cannot be read. One call of the system, where
// std::filesystem::read_symlink() takes two.
fs::path target_of(const fs::path& link) {
  char target[PATH_MAX];
  const ssize_t size = ::readlink(link.c_str(), target, sizeof target);
  return size > 0 ? fs::path(target, target + size) : fs::path();
}

// Whoever may write into a folder can put a mark there, but in his own name alone.
bool is_mark(const fs::path& mark) {
  struct stat own = {}, folder = {};
  if (::lstat(mark.c_str(), &own) != 0 || ::stat(mark.parent_path().c_str(), &folder) != 0) return false;
  return own.st_uid == 0 || own.st_uid == ::geteuid() || own.st_uid == folder.st_uid;
}

bool is_marked_model(const fs::path& folder) {
  return std::ranges::any_of(kModelFiles,
                             [&](const char* name) { return is_input_file(folder / name) && is_mark(folder / name); });
}

// The nearest that a model file marks, from the folder of `file` upwards.
std::optional<fs::path> marked_folder(const fs::path& file) {
  fs::path folder = file.parent_path();
  for (int level = 0; level <= kLevelsToModel && !is_shared_folder(folder); ++level) {
    if (is_marked_model(folder)) return folder;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

// Whether wheels are installed there, in folders beside each other.
bool holds_wheels(const fs::path& folder) {
  if (is_shared_folder(folder)) return false;
  return std::ranges::any_of(folder_entries(folder), [](const fs::path& entry) {
    return entry.extension() == ".dist-info" && is_input_folder(entry) && is_mark(entry);
  });
}

// See ModelFence. A wheel's folder holds no other wheel, unlike the one in which all of them are installed.
std::optional<fs::path> root_of_model(const fs::path& model) {
  for (fs::path folder = without_links(model).parent_path(); !is_shared_folder(folder); folder = folder.parent_path()) {
    const bool is_root = is_marked_model(folder) || std::ranges::any_of(kRootMarks, [&](const char* name) {
                           return is_there(folder / name) && is_mark(folder / name);
                         });
    if (is_root || holds_wheels(folder.parent_path())) return folder;
  }
  return std::nullopt;
}

// The folders of the innermost fence with the root of the model; none: there is no fence.
std::optional<Folders> folders_of_model(const fs::path& model) {
  std::optional<Folders> folders = readable_folders();
  if (!folders) return folders;
  if (std::optional<fs::path> root = root_of_model(model)) folders->push_back(std::move(*root));
  return folders;
}

void add_folders_of(const fs::path& part, Folders& folders) {
  const fs::path own = part.parent_path(), above = own.parent_path();
  folders.push_back(own);
  if (const std::optional<fs::path> model = marked_folder(part)) {
    folders.push_back(*model);
  } else if (!is_shared_folder(above)) {
    folders.push_back(above);
  }
}

// The folders that both have.
Folders common_folders(const Folders& folders, const Folders& limit) {
  Folders common;
  for (const fs::path& folder : folders) {
    if (lies_in(folder, limit)) {
      common.push_back(folder);
      continue;
    }
    std::ranges::copy_if(limit, std::back_inserter(common),
                         [&](const fs::path& each) { return lies_in(each, {folder}); });
  }
  return common;
}

// The scope of these folders, within the limit of the innermost fence.
ReadScope scope_within(const Folders& folders) {
  ReadScope scope;
  for (const fs::path& folder : folders) scope.folders.push_back(without_links(folder));
  const ReadScope* const outer = innermost_read_scope();
  if (outer == nullptr || !outer->limit) return scope;
  scope.limit = outer->limit;
  scope.folders = common_folders(scope.folders, *scope.limit);
  return scope;
}

// Of a file that a link in the folders leads to: in a package or model, as those that colcon installs with
// --symlink-install.
bool is_of_linked_model(const fs::path& file, const fs::path& lies_at, const ReadScope& scope) {
  if (scope.limit) return false;
  const fs::path whole = whole_path(file);
  const fs::path named = without_links(whole.parent_path()) / whole.filename();
  return lies_in(named, scope.folders) && marked_folder(lies_at).has_value();
}

// Whether the innermost fence opens the file of this name that lies there.
bool is_open(const fs::path& file, const fs::path& lies_at) {
  const ReadScope* const scope = innermost_read_scope();
  return scope == nullptr || lies_in(lies_at, scope->folders) || is_of_linked_model(file, lies_at, *scope);
}

// As the system's list of users says; empty if that has none.
fs::path home_of_user() {
  std::vector<char> text(std::size_t{1} << 14);
  passwd entry{}, *found = nullptr;
  ::getpwuid_r(::getuid(), &entry, text.data(), text.size(), &found);
  return found == nullptr || found->pw_dir == nullptr ? "" : found->pw_dir;
}

// The folders that is_shared_folder() compares with.
struct SharedPlaces {
  Folders temporary, homes;
  bool can_be_kept = true;
};

SharedPlaces find_shared_places(const fs::path& home_by_variable) {
  SharedPlaces places;
  std::error_code error;
  const fs::path by_variables = fs::temp_directory_path(error);
  places.can_be_kept = !error;  // a folder that is not there may be made later
  // Those of the system count too, because the variables may be missing or name something else.
  for (const fs::path& folder : {by_variables, fs::path("/tmp"), fs::path("/var/tmp")}) {
    if (!folder.empty()) places.temporary.push_back(without_links(folder));
  }
  for (const fs::path& home : {home_by_variable, home_of_user()}) {
    if (home.is_absolute()) places.homes.push_back(without_links(home));
  }
  return places;
}

// The device and the inode of a folder; 0: nothing is there.
using FolderNumbers = std::pair<dev_t, ino_t>;

FolderNumbers numbers_of_folder(const char* name) {
  struct stat status = {};
  return ::stat(name, &status) == 0 ? FolderNumbers(status.st_dev, status.st_ino) : FolderNumbers();
}

// The working directory, the variables of the environment, and the folders to which they lead, on which the shared
// folders depend: links on the way may be moved. Those on the way to the folders of the system are root's.
struct PlaceInputs {
  std::string working_directory;
  std::vector<std::string> variables;
  std::vector<FolderNumbers> folders;
  bool operator==(const PlaceInputs&) const = default;
};

PlaceInputs place_inputs() {
  std::error_code error;
  PlaceInputs inputs{.working_directory = fs::current_path(error).string(), .variables = {}, .folders = {}};
  for (const char* const name : {"HOME", "TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {
    const char* const value = std::getenv(name);
    inputs.variables.emplace_back(value == nullptr ? "" : value);
    if (value != nullptr) inputs.folders.push_back(numbers_of_folder(value));
  }
  return inputs;
}

// Kept in each thread until the inputs change, because each part and each mesh compares several folders.
const SharedPlaces& shared_places() {
  thread_local PlaceInputs found_by;
  thread_local SharedPlaces places{.temporary = {}, .homes = {}, .can_be_kept = false};
  PlaceInputs inputs = place_inputs();
  if (places.can_be_kept && found_by == inputs) return places;
  places = find_shared_places(inputs.variables.front());
  found_by = std::move(inputs);
  return places;
}

}  // namespace

Folders folders_of_part(const fs::path& part) {
  Folders folders = readable_folders().value_or(Folders());
  const fs::path whole = whole_path(part), linked = without_links(part);
  add_folders_of(whole, folders);
  if (linked != whole) add_folders_of(linked, folders);
  return folders;
}

bool is_shared_folder(const fs::path& folder) {
  const fs::path canonical = without_links(folder);
  if (!canonical.has_relative_path()) return true;
  const SharedPlaces& shared = shared_places();
  return std::ranges::find(shared.temporary, canonical) != shared.temporary.end() ||
         std::ranges::any_of(shared.homes, [&](const fs::path& home) { return lies_in(home, {canonical}); });
}

bool is_model_folder(const fs::path& folder) {
  return std::ranges::any_of(kModelFiles, [&](const char* name) { return is_input_file(folder / name); });
}

fs::path without_links(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error);
  fs::path found = "/";
  std::vector<fs::path> rest;
  const auto add = [&](const fs::path& names) {
    const std::vector<fs::path> parts(names.begin(), names.end());
    rest.insert(rest.end(), parts.rbegin(), parts.rend());
  };
  add((error ? path : whole).relative_path());
  for (int links = 0; !rest.empty();) {
    const fs::path name = std::move(rest.back());
    rest.pop_back();
    if (name.empty() || name == ".") continue;
    if (name == "..") {
      found = found.parent_path();
      continue;
    }
    const fs::path link = links < kMaxFollowed ? target_of(found / name) : fs::path();
    if (link.empty()) {  // no link, or nothing
      found /= name;
      continue;
    }
    ++links;
    if (link.is_absolute()) found = "/";
    add(link.relative_path());
  }
  return found;
}

ReadFence::ReadFence(const Folders& folders) : ReadFence(scope_within(folders)) {}

ReadFence::ReadFence(ReadScope scope) : scope_(std::move(scope)), outer_(exchange_read_scope(&scope_)) {}

ReadFence::~ReadFence() { exchange_read_scope(outer_); }

PartFence::PartFence(const fs::path& part) : ReadFence((require_readable(part), folders_of_part(part))) {}

ModelFence::ModelFence(const fs::path& model) {
  if (const std::optional<Folders> folders = folders_of_model(model)) fence_.emplace(*folders);
}

ReadOpening::ReadOpening() : closed_(exchange_read_scope(nullptr)) {}

ReadOpening::~ReadOpening() { exchange_read_scope(closed_); }

std::optional<Folders> readable_folders() {
  const ReadScope* const scope = innermost_read_scope();
  return scope == nullptr ? std::nullopt : std::optional(scope->folders);
}

void admit_folder(const fs::path& folder) {
  ReadScope* const scope = innermost_read_scope();
  if (scope == nullptr) return;
  const Folders admitted = {without_links(folder)};
  for (const fs::path& each : scope->limit ? common_folders(admitted, *scope->limit) : admitted) {
    if (std::ranges::find(scope->folders, each) == scope->folders.end()) scope->folders.push_back(each);
  }
}

std::optional<fs::path> readable_place(const fs::path& file) {
  fs::path lies_at = without_links(file);
  return is_open(file, lies_at) ? std::optional(std::move(lies_at)) : std::nullopt;
}

bool is_readable(const fs::path& file) { return innermost_read_scope() == nullptr || readable_place(file).has_value(); }

bool is_readable(const fs::path& file, int descriptor) {
  return innermost_read_scope() == nullptr || is_open(file, place_of(file, descriptor));
}

void require_readable(const fs::path& file) {
  // The system would take the name to end there, and find another file.
  if (file.native().find('\0') != std::string::npos) {
    throw InputError(file.string() + ": error: has a NUL byte in its name, expected a file that can exist");
  }
  if (!is_readable(file)) refuse_to_read(file);
}

void refuse_to_read(const fs::path& file) {
  const ReadScope* const scope = innermost_read_scope();
  const bool is_of_request = scope != nullptr && scope->limit;
  throw OutsideFolders(
      file,
      file.string() + ": error: " +
          (is_of_request ? "lies outside the folders whose files a request may name; --allow FOLDER adds a folder"
                         : "lies outside the folders of the part that names it; --package NAME=FOLDER adds a folder"));
}

}  // namespace simvis
