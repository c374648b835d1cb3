#include "import/programs/part_source.h"

#include <algorithm>
#include <cstdint>
#include <system_error>

#include <simvis/attributes.h>
#include "engine/base/read_error.h"
#include "import/sandbox/import_limits.h"

namespace simvis {

void PartSource::fail(const std::string& message) const { fail_at({.file = file.string()}, message); }

void PartSource::warn(const std::string& message) { warn_at({.file = file.string()}, message); }

void PartSource::warn_at(const Location& where, const std::string& message) {
  const std::string text = to_string(where) + ": " + message;
  if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(text);
}

void PartSource::check_size() const {
  const double most = import_factor() * kLargestPart_bytes;
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) throw_read_error(file, "cannot be read", error.value());
  if (static_cast<double>(bytes) <= most) return;
  fail("has " + std::to_string(bytes) + " bytes, expected at most " + format_number(most) + kRaiseLimits);
}

}  // namespace simvis
