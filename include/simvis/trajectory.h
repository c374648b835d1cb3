// Parameters that follow a table: a CSV file with a column of times and one column per parameter.
//
//   time_s,R_POSE.x,R_POSE.yaw
//   0,1.5,0
//   2.5,3,90
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <simvis/export.h>
#include <simvis/location.h>
#include <simvis/parameters.h>

namespace simvis {

/// Parameter values over time.
///
/// Units     times in seconds, finite and strictly increasing; values in the units of the elements' tables.
/// Between   rows a value changes linearly; an angle of full turns (AttributeSpec::full_turn) takes the short way: from
///           350 to 10 it passes through 360. Before the first row a value is that of the first row, after the last row
///           that of the last.
/// Lines     that are blank or begin with '#' are skipped.
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

  double end_s() const { return times_s_.back(); }                         ///< the time of the last row
  const std::vector<std::size_t>& parameters() const { return indices_; }  ///< indices of the columns' parameters
  /// Warnings, each with its place: an angle that changes by a full turn or more from one row to the next.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void check_turn(std::size_t column, const std::string& name, const Location& where);

  std::vector<std::size_t> indices_;  // of parameters, by column
  std::vector<double> times_s_;
  std::vector<double> values_;            // [row * columns + column]
  std::vector<bool> full_turn_, warned_;  // by column
  std::vector<std::string> warnings_;
};

}  // namespace simvis
