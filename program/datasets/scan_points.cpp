#include "program/datasets/scan_points.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/binary_numbers.h"

namespace simvis {

ScanPoints::ScanPoints(const Measurement& scan) : table_(measured_table(scan)) {
  const char* const names[] = {"x_m", "y_m", "z_m", "intensity", "true_semantic", "true_instance", "ring"};
  for (std::size_t i = 0; i < kColumns; ++i) {
    const auto found = std::ranges::find(table_.columns, names[i], &TableColumn::name);
    columns_[i] = static_cast<std::size_t>(found - table_.columns.begin());
  }
  for (std::size_t row = 0; row < table_.rows(); ++row) {
    if (!std::isnan(number(row, 0))) rows_.push_back(row);
  }
}

double ScanPoints::number(std::size_t row, std::size_t column) const {
  return table_.values[row * table_.columns.size() + columns_[column]];
}

double ScanPoints::number_or_0(std::size_t row, std::size_t column) const {
  if (columns_[column] == table_.columns.size()) return 0;
  const double value = number(row, column);
  return std::isnan(value) ? 0 : value;
}

void ScanPoints::append_point(std::size_t row, std::string& bytes) const {
  for (std::size_t column = 0; column <= kIntensity; ++column) {
    append_binary(bytes, static_cast<float>(number_or_0(row, column)));
  }
}

std::string ScanPoints::xyz_intensity() const {
  std::string bytes;
  for (const std::size_t row : rows_) append_point(row, bytes);
  return bytes;
}

std::string ScanPoints::xyz_intensity_ring() const {
  std::string bytes;
  for (const std::size_t row : rows_) {
    append_point(row, bytes);
    append_binary(bytes, static_cast<float>(number_or_0(row, kRing)));
  }
  return bytes;
}

std::string ScanPoints::labels(const std::set<std::uint32_t>& instances) const {
  std::string bytes;
  for (const std::size_t row : rows_) {
    const auto semantic = static_cast<std::uint32_t>(number_or_0(row, kSemantic)),
               instance = static_cast<std::uint32_t>(number_or_0(row, kInstance));
    const auto found = instances.find(instance);
    const auto rank =
        found == instances.end() ? 0 : static_cast<std::uint32_t>(std::distance(instances.begin(), found)) + 1;
    append_binary(bytes, semantic | rank << 16);
  }
  return bytes;
}

std::map<std::uint32_t, std::uint64_t> ScanPoints::points_of() const {
  std::map<std::uint32_t, std::uint64_t> points;
  for (const std::size_t row : rows_) ++points[static_cast<std::uint32_t>(number_or_0(row, kInstance))];
  return points;
}

}  // namespace simvis
