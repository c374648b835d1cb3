// Parameters that follow a table: a CSV file with a column of times and one column per parameter.
//
//   time_s,R_POSE.x,R_POSE.yaw
//   0,1.5,0
//   2.5,3,90
#pragma once

#include <filesystem>
#include <vector>

#include <simvis/parameters.h>

namespace simvis {

/// Units    times in seconds, finite and strictly increasing; values in the units of the elements' tables.
/// Between  rows a value changes linearly (an angle too: 350 to 10 goes back through 180); before the first row and
///          after the last it keeps that row's value.
class Trajectory {
 public:
  /// Throws InputError: the file cannot be read, or, with FILE:LINE:COLUMN, a header that does not begin with time_s,
  /// an unknown parameter or one given twice, a cell that is missing, no finite number or not allowed, no rows.
  Trajectory(const std::filesystem::path& file, const Parameters& parameters);

  /// Sets the parameters to what they are at that time. `parameters` are those that the trajectory was read for.
  void apply(double time_s, Parameters& parameters) const;

 private:
  std::vector<std::size_t> indices_;  // of parameters, by column
  std::vector<double> times_s_;
  std::vector<double> values_;  // [row * columns + column]
};

}  // namespace simvis
