#include "import/programs/assimp_file.h"

#include <algorithm>

namespace simvis {

void AssimpFile::fail(const std::string& message) const { fail_at({.file = file.string()}, message); }

void AssimpFile::warn(const std::string& message) { warn_at({.file = file.string()}, message); }

void AssimpFile::warn_at(const Location& where, const std::string& message) {
  const std::string text = to_string(where) + ": " + message;
  if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(text);
}

}  // namespace simvis
