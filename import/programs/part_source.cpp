#include "import/programs/part_source.h"

#include <algorithm>
#include <cstdint>
#include <system_error>

#include "engine/base/read_error.h"

namespace simvis {

void PartSource::fail(const std::string& message) const { fail_at({.file = file.string()}, message); }

void PartSource::warn(const std::string& message) { warn_at({.file = file.string()}, message); }

void PartSource::warn_at(const Location& where, const std::string& message) {
  const std::string text = to_string(where) + ": " + message;
  if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(text);
}

void PartSource::check_size() const {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) throw_read_error(file, "cannot be read", error.value());
  if (bytes > kMaxBytes) fail("has " + std::to_string(bytes) + " bytes, expected at most 1 GiB");
}

}  // namespace simvis
