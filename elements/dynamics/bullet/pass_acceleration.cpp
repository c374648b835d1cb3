#include "elements/dynamics/bullet/pass_acceleration.h"

#include <cmath>
#include <limits>
#include <utility>

namespace simvis {
namespace {

// Passes between two extrapolations smooth what these stir up.
constexpr int kPeriod = 6;
// A pass is much worse than the best one if the square of its change is so many times as large.
constexpr double kMuchWorse = 4;
// Keeps the weights of nearly parallel columns small.
constexpr double kRegular = 1e-8;

// Solves for `sides` in place, by elimination: the matrix is symmetric and positive. False: it is not.
template <typename Matrix, typename Numbers>
bool solve(Matrix& matrix, Numbers& sides, std::size_t size) {
  for (std::size_t r = 0; r < size; ++r) {
    if (!(matrix[r][r] > 0)) return false;
    for (std::size_t below = r + 1; below < size; ++below) {
      const double factor = matrix[below][r] / matrix[r][r];
      for (std::size_t c = r; c < size; ++c) matrix[below][c] -= factor * matrix[r][c];
      sides[below] -= factor * sides[r];
    }
  }
  for (std::size_t r = size; r-- > 0;) {
    for (std::size_t c = r + 1; c < size; ++c) sides[r] -= matrix[r][c] * sides[c];
    sides[r] /= matrix[r][r];
  }
  return true;
}

// Four sums, which do not wait for each other.
double product(const std::vector<double>& a, const std::vector<double>& b) {
  std::array<double, 4> sums{};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += a[i + k] * b[i + k];
  }
  for (; i < a.size(); ++i) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void subtract(const std::vector<double>& a, const std::vector<double>& b, std::vector<double>& difference) {
  difference.resize(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
}

}  // namespace

void PassAcceleration::start(const std::vector<double>& impulses, const std::vector<double>& weights) {
  before_ = impulses;
  roots_.resize(weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i) roots_[i] = std::sqrt(weights[i]);
  size_ = std::numeric_limits<double>::infinity();
  forget_columns();
  passes_ = 0;
  stage_ = Stage::plain;
}

bool PassAcceleration::go_on(std::vector<double>& impulses, bool extrapolates) {
  const Stage stage = std::exchange(stage_, Stage::plain);
  if (stage == Stage::extrapolated) {
    stage_ = Stage::settled;
    before_ = impulses;
    return false;
  }
  const double last_size = std::exchange(size_, find_change(impulses));
  const bool is_much_worse = size_ > kMuchWorse * last_size;
  if (is_much_worse) {
    forget_columns();
    passes_ = 0;
    if (stage == Stage::settled) {
      size_ = last_size;
      impulses = before_extrapolation_;
    }
    before_ = impulses;
    return stage == Stage::settled;
  }
  add_column(impulses);
  if (extrapolates && column_count() > 0 && ++passes_ >= kPeriod) {
    passes_ = 0;
    before_extrapolation_ = impulses;
    if (extrapolate(impulses)) stage_ = Stage::extrapolated;
  }
  before_ = impulses;
  return stage_ == Stage::extrapolated;
}

void PassAcceleration::forget_columns() {
  added_columns_ = 0;
  last_impulses_.clear();
}

double PassAcceleration::find_change(const std::vector<double>& impulses) {
  subtract(impulses, before_, change_);
  for (std::size_t i = 0; i < roots_.size(); ++i) change_[i] *= roots_[i];
  return product(change_, change_);
}

void PassAcceleration::add_column(const std::vector<double>& impulses) {
  if (!last_impulses_.empty()) {
    const std::size_t added = added_columns_++ % kMaxColumns;
    subtract(change_, last_change_, columns_[added].change);
    subtract(impulses, last_impulses_, columns_[added].impulses);
    for (std::size_t k = 0; k < column_count(); ++k) {
      products_[added][k] = products_[k][added] = product(columns_[added].change, columns_[k].change);
    }
  }
  last_change_ = change_;
  last_impulses_ = impulses;
}

bool PassAcceleration::extrapolate(std::vector<double>& impulses) const {
  auto matrix = products_;
  std::array<double, kMaxColumns> shares;
  for (std::size_t k = 0; k < column_count(); ++k) {
    matrix[k][k] *= 1 + kRegular;
    shares[k] = product(columns_[k].change, change_);
  }
  if (!solve(matrix, shares, column_count())) return false;
  for (std::size_t k = 0; k < column_count(); ++k) {
    for (std::size_t i = 0; i < impulses.size(); ++i) impulses[i] -= shares[k] * columns_[k].impulses[i];
  }
  return true;
}

}  // namespace simvis
