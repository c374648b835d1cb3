#include "scenegraph/import/mesh/name_case.h"

#include <strings.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace simvis {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

std::optional<fs::path> file_ignoring_case(const fs::path& folder, const fs::path& name) {
  std::error_code error;
  fs::path at = folder;
  for (const fs::path& component : name) {
    const bool is_there = component == ".." || component == "." || fs::exists(at / component, error);
    const std::optional<fs::path> next =
        is_there ? std::optional(at / component) : entry_ignoring_case(at, component.string());
    if (!next) return std::nullopt;
    at = *next;
  }
  return fs::is_regular_file(at, error) ? std::optional(at) : std::nullopt;
}

}  // namespace simvis
