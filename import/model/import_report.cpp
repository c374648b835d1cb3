#include "import/model/import_report.h"

namespace simvis {

void ImportReport::warn(const Location& where, const std::string& what) {
  warnings_.push_back(to_string(where) + ": " + what);
}

void ImportReport::warn_once(const Location& where, const std::string& what) {
  Kind& all = repeated_[what];
  if (all.count++ == 0) all.first = where;
}

void ImportReport::leave_out(const std::string& kind, const Location& where) {
  Kind& all = left_out_[kind];
  if (all.count++ == 0) all.first = where;
}

std::vector<std::string> ImportReport::release() {
  for (const auto& [what, all] : repeated_) {
    warn(all.first, what + (all.count > 1 ? "; this is so " + std::to_string(all.count) + " times" : ""));
  }
  repeated_.clear();
  for (const auto& [kind, all] : left_out_) {
    warn(all.first, kind + " is not taken over" +
                        (all.count > 1 ? ", " + std::to_string(all.count) + " in all, the first one here" : ""));
  }
  left_out_.clear();
  return std::move(warnings_);
}

}  // namespace simvis
