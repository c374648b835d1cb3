// The points of a scan as formats of datasets have them: the beams with a return, in their order.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <simvis/measurement.h>
#include "sensors/measured_table.h"

namespace simvis {

class ScanPoints {
 public:
  explicit ScanPoints(const Measurement& scan);

  /// float32 x y z intensity of each point, in the scanner's frame, in metres; without the column `intensity` it is 0.
  std::string xyz_intensity() const;
  /// float32 x y z intensity ring of each point, as above.
  std::string xyz_intensity_ring() const;
  /// uint32 of each point: the class in the lower 16 bits, in the upper ones the rank of the instance among
  /// `instances`, which are all that the scene has, from 1.
  std::string labels(const std::set<std::uint32_t>& instances) const;

  /// Whether the scan says which item a point is on.
  bool has_instances() const { return columns_[kInstance] < table_.columns.size(); }
  /// The number of points on each item, by instance. Points on no known item count for the instance 0.
  std::map<std::uint32_t, std::uint64_t> points_of() const;

 private:
  static constexpr std::size_t kIntensity = 3, kSemantic = 4, kInstance = 5, kRing = 6, kColumns = 7;
  double number(std::size_t row, std::size_t column) const;
  double number_or_0(std::size_t row, std::size_t column) const;
  void append_point(std::size_t row, std::string& bytes) const;

  MeasuredTable table_;
  std::array<std::size_t, kColumns> columns_{};  // places in the table; its number of columns stands for a missing one
  std::vector<std::size_t> rows_;                // those with a return
};

}  // namespace simvis
