#include "sandbox/python_path.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace simvis {

std::string python_path() {
  std::string kept;
  const char* const path = std::getenv("PYTHONPATH");
  for (std::string_view rest = path == nullptr ? "" : path; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    if (folder.starts_with('/')) kept.append(kept.empty() ? "" : ":").append(folder);
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
  }
  return kept;
}

}  // namespace simvis
