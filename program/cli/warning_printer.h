// Prints the warnings of a simulation as they come.
#pragma once

#include <cstddef>
#include <ostream>

#include <simvis/simulation.h>

namespace simvis {

/// Writes each warning as one line "warning: FILE:LINE:COLUMN: WHAT".
class WarningPrinter {
 public:
  /// `out` must outlive the printer.
  explicit WarningPrinter(std::ostream& out) : out_(out) {}

  /// Prints the warnings that the simulation has got since the last call.
  void print_new(const Simulation& simulation) {
    for (; printed_ < simulation.warnings().size(); ++printed_) {
      out_ << "warning: " << simulation.warnings()[printed_] << '\n';
    }
  }

 private:
  std::ostream& out_;
  std::size_t printed_ = 0;
};

}  // namespace simvis
