// Parameters that follow a table: a CSV file with a column of times and one column per parameter.
//
//   time_s,R_POSE.x,R_POSE.yaw
//   0,1.5,0
//   2.5,3,90
#pragma once

#include <filesystem>
#include <vector>

#include <simvis/export.h>
#include <simvis/parameters.h>

namespace simvis {

/// Parameter values over time.
///
/// Units     times in seconds, finite and strictly increasing; values in the units of the elements' tables.
/// Between   rows a value changes linearly (an angle too: from 350 to 10 it passes through 180). Before the first row
///           it has the value of the first row, after the last row that of the last.
/// Errors    InputError.
/// Lifetime  holds indices of parameters, which stay valid when elements are added.
class SIMVIS_API Trajectory {
 public:
  /// Reads a file. Throws InputError if the file cannot be read, and with FILE:LINE:COLUMN for a header that does not
  /// begin with time_s, an unknown parameter or one given twice, a cell that is missing, not a finite number or not
  /// allowed, and a table without rows.
  Trajectory(const std::filesystem::path& file, const Parameters& parameters);

  /// Sets the parameters to their values at that time. `parameters` are those that the trajectory was read for.
  void apply(double time_s, Parameters& parameters) const;

 private:
  std::vector<std::size_t> indices_;  // of parameters, by column
  std::vector<double> times_s_;
  std::vector<double> values_;  // [row * columns + column]
};

}  // namespace simvis
