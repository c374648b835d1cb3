#include "scenegraph/import/mesh/picture_search.h"

#include <strings.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>

namespace simvis {
namespace {

namespace fs = std::filesystem;

// A folder that is searched, and the name below it.
struct Candidate {
  fs::path folder, name;
  bool elsewhere = false;
};

bool has_drive(std::string_view name) {
  return name.size() > 1 && name[1] == ':' && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
}

// Of several entries that differ in upper and lower case the first in the order of bytes counts.
std::optional<fs::path> entry_ignoring_case(const fs::path& folder, const std::string& name) {
  std::vector<std::string> same;
  std::error_code error;
  for (fs::directory_iterator each(folder, error), end; !error && each != end; each.increment(error)) {
    std::string entry = each->path().filename().string();
    if (::strcasecmp(entry.c_str(), name.c_str()) == 0) same.push_back(std::move(entry));
  }
  if (same.empty()) return std::nullopt;
  return folder / *std::ranges::min_element(same);
}

std::optional<fs::path> file_ignoring_case(const Candidate& candidate) {
  std::error_code error;
  fs::path at = candidate.folder;
  for (const fs::path& component : candidate.name) {
    const bool is_there = component == ".." || component == "." || fs::exists(at / component, error);
    const std::optional<fs::path> next =
        is_there ? std::optional(at / component) : entry_ignoring_case(at, component.string());
    if (!next) return std::nullopt;
    at = *next;
  }
  return fs::is_regular_file(at, error) ? std::optional(at) : std::nullopt;
}

std::vector<Candidate> candidates_of(std::string name, const fs::path& part_file) {
  std::ranges::replace(name, '\\', '/');
  if (name.starts_with("file://")) name.erase(0, 7);
  // file:///C:/...
  if (name.starts_with('/') && has_drive(std::string_view(name).substr(1))) name.erase(0, 1);
  const fs::path folder = part_file.parent_path(), path(name), last = path.filename();
  std::vector<Candidate> candidates;
  if (!has_drive(name)) candidates.push_back({path.is_absolute() ? fs::path() : folder, path});
  if (last.empty() || last == "." || last == "..") return candidates;
  candidates.push_back({folder / ".." / "materials" / "textures", last});
  candidates.push_back({folder, last, true});
  return candidates;
}

}  // namespace

std::string PictureSearch::not_found() const {
  std::string text = "is not there; the material's colour replaces it; tried ";
  for (std::size_t i = 0; i < tried.size(); ++i) text += (i == 0 ? "" : ", ") + tried[i];
  return text;
}

PictureSearch find_picture(const std::string& name, const fs::path& part_file) {
  const std::vector<Candidate> candidates = candidates_of(name, part_file);
  PictureSearch search;
  std::error_code error;
  for (const Candidate& candidate : candidates) {
    const fs::path file = candidate.folder / candidate.name;
    if (fs::is_regular_file(file, error)) {
      search.file = file;
      search.elsewhere = candidate.elsewhere;
      return search;
    }
    if (std::ranges::find(search.tried, file.string()) == search.tried.end()) search.tried.push_back(file.string());
  }
  search.elsewhere = true;
  for (const Candidate& candidate : candidates) {
    search.file = file_ignoring_case(candidate);
    if (search.file) break;
  }
  return search;
}

}  // namespace simvis
