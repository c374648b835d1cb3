// Parameters that follow a table: a CSV file with a column of times and one column per parameter.
//
//   time_s,R_POSE.x,R_POSE.yaw
//   0,1.5,0
//   2.5,3,90
//
// The orientation of a pose may be a quaternion: R_POSE.qx,R_POSE.qy,R_POSE.qz,R_POSE.qw.
#pragma once

#include <array>
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
///           350 to 10 it passes through 360. An orientation turns about one axis at a constant speed, the short way.
///           Before the first row a value is that of the first row, after the last row that of the last.
/// Columns   qx, qy, qz, qw of an element with roll, pitch and yaw set these three: of a unit quaternion in the
/// element's
///           parent frame. A length within 0.001 of 1 is scaled to 1.
/// Lines     that are blank or begin with '#' are skipped.
/// Errors    InputError.
/// Lifetime  holds indices of parameters, which stay valid when elements are added.
class SIMVIS_API Trajectory {
 public:
  /// Reads a file. Throws InputError if the file cannot be read, and with FILE:LINE:COLUMN for a header that does not
  /// begin with time_s, an unknown parameter or one given twice, a cell that is missing, not a finite number or not
  /// allowed, a quaternion whose length is not 1 or that is not complete, and a table without rows.
  Trajectory(const std::filesystem::path& file, const Parameters& parameters);

  /// Sets the parameters to their values at that time. `parameters` are those that the trajectory was read for.
  void apply(double time_s, Parameters& parameters) const;

  double end_s() const { return times_s_.back(); }                         ///< the time of the last row
  const std::vector<std::size_t>& parameters() const { return indices_; }  ///< indices of all parameters that it sets
  /// Warnings, each with its place: an angle that changes by a full turn or more from one row to the next.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Header;
  struct Track {
    std::size_t column = 0, parameter = 0;
    bool full_turn = false, warned = false;
  };
  struct Rotation {
    std::array<std::size_t, 4> columns{};     // x, y, z, w
    std::array<std::size_t, 3> parameters{};  // roll, pitch, yaw
  };

  void check_turn(Track& track, const std::string& name, const Location& where);
  void add_columns(const Header& header);
  void scale_last(const Rotation& rotation, const Location& where);
  double value(std::size_t row, std::size_t column) const { return values_[row * columns_ + column]; }
  void turn(const Rotation& rotation, std::size_t from, std::size_t to, double part, Parameters& parameters) const;

  std::vector<std::size_t> indices_;  // of parameters
  std::vector<Track> tracks_;
  std::vector<Rotation> rotations_;
  std::size_t columns_ = 0;  // besides the time
  std::vector<double> times_s_;
  std::vector<double> values_;  // [row * columns + column]
  std::vector<std::string> warnings_;
};

}  // namespace simvis
