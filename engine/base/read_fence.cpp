#include "engine/base/read_fence.h"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "engine/base/read_error.h"

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModelFiles[] = {"package.xml", "manifest.xml", "model.config"};
constexpr int kLevelsToModel = 5;  // of folders above the part's

thread_local ReadFence* innermost_fence = nullptr;

// Without links, as far as the path exists.
fs::path canonical_path(const fs::path& path) {
  std::error_code error;
  fs::path canonical = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path.lexically_normal() : canonical;
}

// Without "." and "..", but with links.
fs::path whole_path(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

bool is_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

bool is_in(const fs::path& file, const Folders& folders) {
  return std::ranges::any_of(folders, [&](const fs::path& folder) { return is_below(file, folder); });
}

// The nearest that a model file marks, from the folder of `file` upwards.
std::optional<fs::path> marked_folder(const fs::path& file) {
  fs::path folder = file.parent_path();
  for (int level = 0; level <= kLevelsToModel && folder.has_relative_path(); ++level) {
    if (is_model_folder(folder)) return folder;
    folder = folder.parent_path();
  }
  return std::nullopt;
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

// As the system's list of users says; empty if that has none.
fs::path home_of_user() {
  std::vector<char> text(std::size_t{1} << 14);
  passwd entry{}, *found = nullptr;
  ::getpwuid_r(::getuid(), &entry, text.data(), text.size(), &found);
  return found == nullptr || found->pw_dir == nullptr ? "" : found->pw_dir;
}

}  // namespace

Folders folders_of_part(const fs::path& part) {
  Folders folders = readable_folders().value_or(Folders());
  const fs::path whole = whole_path(part), linked = canonical_path(part);
  add_folders_of(whole, folders);
  if (linked != whole) add_folders_of(linked, folders);
  return folders;
}

bool is_shared_folder(const fs::path& folder) {
  const fs::path canonical = canonical_path(folder);
  if (!canonical.has_relative_path()) return true;
  // Those of the system count too, because the variables may be missing or name something else.
  std::error_code error;
  for (const fs::path& temporary : {fs::temp_directory_path(error), fs::path("/tmp"), fs::path("/var/tmp")}) {
    if (!temporary.empty() && canonical == canonical_path(temporary)) return true;
  }
  const char* const named = std::getenv("HOME");
  for (const fs::path& home : {fs::path(named == nullptr ? "" : named), home_of_user()}) {
    if (home.is_absolute() && is_below(canonical_path(home), canonical)) return true;
  }
  return false;
}

bool is_model_folder(const fs::path& folder) {
  return std::ranges::any_of(kModelFiles, [&](const char* name) { return is_input_file(folder / name); });
}

ReadFence::ReadFence(const Folders& folders) : outer_(innermost_fence) {
  for (const fs::path& folder : folders) folders_.push_back(canonical_path(folder));
  innermost_fence = this;
}

ReadFence::~ReadFence() { innermost_fence = outer_; }

PartFence::PartFence(const fs::path& part) : ReadFence((require_readable(part), folders_of_part(part))) {}

ReadOpening::ReadOpening() : closed_(std::exchange(innermost_fence, nullptr)) {}

ReadOpening::~ReadOpening() { innermost_fence = closed_; }

std::optional<Folders> readable_folders() {
  return innermost_fence == nullptr ? std::nullopt : std::optional(innermost_fence->folders_);
}

void admit_folder(const fs::path& folder) {
  if (innermost_fence == nullptr) return;
  fs::path canonical = canonical_path(folder);
  Folders& folders = innermost_fence->folders_;
  if (std::ranges::find(folders, canonical) == folders.end()) folders.push_back(std::move(canonical));
}

bool is_readable(const fs::path& file) {
  if (innermost_fence == nullptr) return true;
  const Folders& folders = innermost_fence->folders_;
  const fs::path linked = canonical_path(file);
  if (is_in(linked, folders)) return true;
  // A link, as those of packages that colcon installs with --symlink-install.
  const fs::path whole = whole_path(file);
  const fs::path named = canonical_path(whole.parent_path()) / whole.filename();
  return is_in(named, folders) && marked_folder(linked).has_value();
}

void require_readable(const fs::path& file) {
  // The system would take the name to end there, and find another file.
  if (file.native().find('\0') != std::string::npos) {
    throw InputError(file.string() + ": error: has a NUL byte in its name, expected a file that can exist");
  }
  if (is_readable(file)) return;
  throw InputError(file.string() +
                   ": error: lies outside the folders of the part that names it; --package NAME=FOLDER adds a folder");
}

}  // namespace simvis
