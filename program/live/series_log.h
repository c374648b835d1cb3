// Numbers over the time of a run, for graphs: parameters that change, and the single numbers of sensors.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "engine/base/thinned_list.h"
#include "program/live/view_snapshot.h"

namespace simvis::live {

class SeriesLog {
 public:
  void add(const ViewFrame& frame);
  /// The message `series` of docs/live-view.md. Parameters that have not changed are left out. Of a long run, each
  /// series has evenly spaced points, or changes, as ThinnedList keeps them.
  std::string message() const;

 private:
  struct Series {
    std::string unit;
    bool steps = false;                             ///< a value holds until the next one
    ThinnedList<std::pair<double, double>> points;  ///< time in s and value; with `steps`, the changes alone
  };
  void note(const std::string& owner, const std::string& name, const std::string& unit, bool steps, double time_s,
            double value);

  std::map<std::pair<std::string, std::string>, Series> series_;  // by element or sensor, and name
};

}  // namespace simvis::live
