// A part file while a helper program reads it, with its warnings and its errors.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <simvis/location.h>

namespace simvis {

struct PartSource {
  std::filesystem::path file;
  std::vector<std::string> warnings{};

  /// Throws InputError "FILE: error: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;
  /// Adds the warning "FILE: MESSAGE". Equal warnings are added once.
  void warn(const std::string& message);
  /// Adds the warning "FILE:LINE:COLUMN: MESSAGE".
  void warn_at(const Location& where, const std::string& message);
  /// Throws InputError if the file has more than 1 GiB times import_factor(), and MachineError if its size cannot be
  /// read.
  void check_size() const;
};

}  // namespace simvis
