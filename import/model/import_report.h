// The warnings about a file: one for each kind of content that its importer ignores, and others.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <simvis/location.h>

namespace simvis {

class ImportReport {
 public:
  void warn(const Location& where, const std::string& what);
  void warn(std::string warning) { warnings_.push_back(std::move(warning)); }
  /// Equal texts are one warning, with the first place and their number.
  void warn_once(const Location& where, const std::string& what);
  /// Counts content of a kind, such as "plugin", that is not taken over.
  void leave_out(const std::string& kind, const Location& where);
  /// All warnings: those of warn() in order, those of warn_once(), then one for each kind with its first place.
  std::vector<std::string> release();

 private:
  struct Kind {
    Location first;
    std::size_t count = 0;
  };
  std::vector<std::string> warnings_;
  std::map<std::string, Kind> repeated_, left_out_;
};

}  // namespace simvis
