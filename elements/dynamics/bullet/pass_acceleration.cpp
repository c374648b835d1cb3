#include "elements/dynamics/bullet/pass_acceleration.h"

#include <limits>
#include <utility>

namespace simvis {
namespace {

// Passes between two extrapolations smooth what these stir up.
constexpr int kPeriod = 4;
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

void subtract(const std::vector<double>& a, const std::vector<double>& b, std::vector<double>& difference) {
  difference.resize(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
}

}  // namespace

void PassAcceleration::start(std::vector<double> impulses, std::vector<double> weights) {
  before_ = std::move(impulses);
  weights_ = std::move(weights);
  best_size_ = std::numeric_limits<double>::infinity();
  forget_columns();
  passes_ = 0;
  is_extrapolated_ = false;
}

bool PassAcceleration::go_on(std::vector<double>& impulses, bool extrapolates) {
  const bool was_extrapolated = std::exchange(is_extrapolated_, false);
  if (is_much_worse(impulses)) {
    forget_columns();
    if (was_extrapolated) impulses = best_;
    before_ = impulses;
    return was_extrapolated;
  }
  add_column(impulses);
  if (extrapolates && !columns_.empty() && ++passes_ == kPeriod) {
    passes_ = 0;
    is_extrapolated_ = extrapolate(impulses);
  }
  before_ = impulses;
  return is_extrapolated_;
}

void PassAcceleration::forget_columns() {
  columns_.clear();
  next_column_ = 0;
  last_impulses_.clear();
}

bool PassAcceleration::is_much_worse(const std::vector<double>& impulses) {
  double size = 0;
  change_.resize(weights_.size());
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    change_[i] = impulses[i] - before_[i];
    size += weights_[i] * change_[i] * change_[i];
  }
  if (size > kMuchWorse * best_size_) return true;
  if (size < best_size_) {
    best_size_ = size;
    best_ = impulses;
  }
  return false;
}

void PassAcceleration::add_column(const std::vector<double>& impulses) {
  if (!last_impulses_.empty()) {
    if (columns_.size() < kMaxColumns) columns_.emplace_back();
    const std::size_t added = next_column_++ % kMaxColumns;
    subtract(change_, last_change_, columns_[added].change);
    subtract(impulses, last_impulses_, columns_[added].impulses);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      products_[added][k] = products_[k][added] = product(columns_[added].change, columns_[k].change);
    }
  }
  last_change_ = change_;
  last_impulses_ = impulses;
}

// Four sums, which do not wait for each other.
double PassAcceleration::product(const std::vector<double>& a, const std::vector<double>& b) const {
  std::array<double, 4> sums{};
  for (std::size_t i = 0; i < weights_.size(); ++i) sums[i % 4] += weights_[i] * a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

bool PassAcceleration::extrapolate(std::vector<double>& impulses) const {
  auto matrix = products_;
  std::array<double, kMaxColumns> shares;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    matrix[k][k] *= 1 + kRegular;
    shares[k] = product(columns_[k].change, change_);
  }
  if (!solve(matrix, shares, columns_.size())) return false;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    for (std::size_t i = 0; i < impulses.size(); ++i) impulses[i] -= shares[k] * columns_[k].impulses[i];
  }
  return true;
}

}  // namespace simvis
