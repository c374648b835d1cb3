#include "import/mesh/name_case.h"

#include <strings.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/folder_entries.h"
#include "engine/base/read_error.h"

namespace simvis {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> entry_ignoring_case(const fs::path& folder, const std::string& name) {
  std::vector<std::string> same;
  for (const fs::path& each : folder_entries(folder)) {
    std::string entry = each.filename().string();
    if (::strcasecmp(entry.c_str(), name.c_str()) == 0) same.push_back(std::move(entry));
  }
  if (same.empty()) return std::nullopt;
  return folder / *std::ranges::min_element(same);
}

}  // namespace

std::optional<fs::path> file_ignoring_case(const fs::path& folder, const fs::path& name) {
  fs::path at = folder;
  for (const fs::path& component : name) {
    const bool is_exact = component == ".." || component == "." || is_there(at / component);
    const std::optional<fs::path> next =
        is_exact ? std::optional(at / component) : entry_ignoring_case(at, component.string());
    if (!next) return std::nullopt;
    at = *next;
  }
  return is_input_file(at) ? std::optional(at) : std::nullopt;
}

}  // namespace simvis
