// One warning for all parts of a file that have the same fault.
#pragma once

#include <string>
#include <string_view>

#include <simvis/location.h>
#include "import/programs/part_source.h"

namespace simvis {

class RepeatedWarning {
 public:
  void add(const Location& where, std::string_view name) {
    if (count_++ > 0) return;
    first_ = where;
    name_ = name;
  }

  /// Adds the warning `KIND "NAME" (and N more): WHAT` with the place of the first part, if there is one.
  void give(PartSource& file, std::string_view kind, std::string_view what) const {
    if (count_ == 0) return;
    const std::string more = count_ > 1 ? " (and " + std::to_string(count_ - 1) + " more)" : "";
    file.warn_at(first_, std::string(kind) + " " + in_quotes(name_) + more + ": " + std::string(what));
  }

 private:
  Location first_;
  std::string name_;
  int count_ = 0;
};

}  // namespace simvis
