#include "exchange/fidelity/least_squares.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace simvis {
namespace {

constexpr double kReduced = 0.1;

/// A symmetric matrix, of which both halves are kept.
class SquareMatrix {
 public:
  explicit SquareMatrix(std::size_t size) : size_(size), values_(size * size) {}
  double& operator()(std::size_t row, std::size_t column) { return values_[row * size_ + column]; }
  double operator()(std::size_t row, std::size_t column) const { return values_[row * size_ + column]; }
  std::size_t size() const { return size_; }

 private:
  std::size_t size_;
  std::vector<double> values_;
};

// The inverse of a positive definite matrix, by Cholesky's decomposition of the matrix scaled to a diagonal of ones.
SquareMatrix inverse_of(const SquareMatrix& matrix) {
  const std::size_t n = matrix.size();
  std::vector<double> scale(n);
  for (std::size_t i = 0; i < n; ++i) scale[i] = 1 / std::sqrt(matrix(i, i));
  SquareMatrix lower(n), inverse(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix(i, j) * scale[i] * scale[j];
      for (std::size_t k = 0; k < j; ++k) sum -= lower(i, k) * lower(j, k);
      // Rounding may take what the prior alone determines below 0.
      lower(i, j) = i == j ? std::sqrt(std::max(sum, 1e-15)) : sum / lower(j, j);
    }
  }
  std::vector<double> column(n);
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t i = c; i < n; ++i) {
      double sum = i == c ? 1 : 0;
      for (std::size_t k = c; k < i; ++k) sum -= lower(i, k) * column[k];
      column[i] = sum / lower(i, i);
    }
    for (std::size_t i = n; i-- > c;) {
      double sum = column[i];
      for (std::size_t k = i + 1; k < n; ++k) sum -= lower(k, i) * inverse(k, c);
      inverse(i, c) = sum / lower(i, i);
    }
    for (std::size_t i = c; i < n; ++i) inverse(c, i) = inverse(i, c);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) inverse(i, j) *= scale[i] * scale[j];
  }
  return inverse;
}

/// What the rows of one cluster add to the normal equations.
class ClusterSums {
 public:
  explicit ClusterSums(std::size_t unknowns) : place_(unknowns, kNone) {}

  void clear() {
    for (const std::uint32_t unknown : touched_) place_[unknown] = kNone;
    touched_.clear();
    rows_.clear();
    residuals_.clear();
  }

  void add(const LeastSquaresRow& row, const std::vector<double>& value) {
    double residual = row.value;
    for (std::size_t a = 0; a < row.terms; ++a) {
      residual -= row.factor[a] * value[row.index[a]];
      std::size_t& place = place_[row.index[a]];
      if (place != kNone) continue;
      place = touched_.size();
      touched_.push_back(row.index[a]);
    }
    rows_.push_back(row);
    residuals_.push_back(residual);
  }

  const std::vector<std::uint32_t>& touched() const { return touched_; }

  /// The score of the cluster as a fit without it sees it, (I - A_c A^-1)^-1 s_c: a cluster pulls the fit towards
  /// itself, so that its own residuals are too small. By touched().
  std::vector<double> score_without(const SquareMatrix& bread) const {
    const std::size_t n = touched_.size();
    SquareMatrix information(n), system(n);
    std::vector<double> score(n);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const LeastSquaresRow& row = rows_[i];
      for (std::size_t a = 0; a < row.terms; ++a) {
        const std::size_t at = place_[row.index[a]];
        score[at] += row.weight * residuals_[i] * row.factor[a];
        for (std::size_t b = 0; b < row.terms; ++b) {
          information(at, place_[row.index[b]]) += row.weight * row.factor[a] * row.factor[b];
        }
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        system(a, b) = a == b ? 1 : 0;
        for (std::size_t k = 0; k < n; ++k) system(a, b) -= information(a, k) * bread(touched_[k], touched_[b]);
      }
    }
    std::vector<double> solved = score;
    return solve(system, solved) ? solved : score;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  // Gauss's elimination. False: without the cluster an unknown would not be determined.
  static bool solve(SquareMatrix& system, std::vector<double>& right) {
    const std::size_t n = right.size();
    constexpr double kMinPivot = 1e-3;
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < n; ++i) {
        if (std::abs(system(i, k)) > std::abs(system(pivot, k))) pivot = i;
      }
      if (!(std::abs(system(pivot, k)) > kMinPivot)) return false;
      for (std::size_t j = 0; j < n; ++j) std::swap(system(k, j), system(pivot, j));
      std::swap(right[k], right[pivot]);
      for (std::size_t i = k + 1; i < n; ++i) {
        const double share = system(i, k) / system(k, k);
        for (std::size_t j = k; j < n; ++j) system(i, j) -= share * system(k, j);
        right[i] -= share * right[k];
      }
    }
    for (std::size_t k = n; k-- > 0;) {
      for (std::size_t j = k + 1; j < n; ++j) right[k] -= system(k, j) * right[j];
      right[k] /= system(k, k);
    }
    return true;
  }

  std::vector<std::size_t> place_;  // of each unknown in touched_
  std::vector<std::uint32_t> touched_;
  std::vector<LeastSquaresRow> rows_;
  std::vector<double> residuals_;
};

}  // namespace

LeastSquaresFit least_squares(std::size_t rows, std::span<const double> prior,
                              const std::function<LeastSquaresRow(std::size_t)>& row) {
  const std::size_t n = prior.size();
  SquareMatrix information(n);
  std::vector<double> right(n), value(n);
  for (std::size_t i = 0; i < rows; ++i) {
    const LeastSquaresRow each = row(i);
    for (std::size_t a = 0; a < each.terms; ++a) {
      const double weighted = each.weight * each.factor[a];
      right[each.index[a]] += weighted * each.value;
      for (std::size_t b = 0; b < each.terms; ++b)
        information(each.index[a], each.index[b]) += weighted * each.factor[b];
    }
  }
  for (std::size_t i = 0; i < n; ++i) information(i, i) += 1 / (prior[i] * prior[i]);
  const SquareMatrix bread = inverse_of(information);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) value[i] += bread(i, j) * right[j];
  }
  SquareMatrix meat(n);
  std::size_t clusters = 0;
  ClusterSums sums(n);
  for (std::size_t i = 0; i < rows;) {
    const std::uint64_t cluster = row(i).cluster;
    sums.clear();
    for (; i < rows; ++i) {
      const LeastSquaresRow each = row(i);
      if (each.cluster != cluster) break;
      sums.add(each, value);
    }
    ++clusters;
    const std::vector<double> score = sums.score_without(bread);
    const std::vector<std::uint32_t>& touched = sums.touched();
    for (std::size_t a = 0; a < touched.size(); ++a) {
      for (std::size_t b = 0; b < touched.size(); ++b) meat(touched[a], touched[b]) += score[a] * score[b];
    }
  }
  LeastSquaresFit fit{.value = value, .deviation = std::vector<double>(n), .determined = std::vector<bool>(n)};
  std::size_t unknowns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    fit.determined[i] = std::sqrt(bread(i, i)) < kReduced * prior[i];
    unknowns += fit.determined[i];
  }
  const bool enough = clusters > unknowns;
  const double free_clusters = enough ? static_cast<double>(clusters - unknowns) : 1;
  // What is known of an unknown beforehand counts as a measurement with an error of its own.
  for (std::size_t i = 0; i < n; ++i) meat(i, i) += 1 / (prior[i] * prior[i]);
  // Student's quantile by its expansion for many degrees of freedom.
  fit.half_width = kDeviationsOf95 * (1 + (kDeviationsOf95 * kDeviationsOf95 + 1) / (4 * free_clusters));
  SquareMatrix half(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      if (bread(i, k) == 0) continue;
      for (std::size_t j = 0; j < n; ++j) half(i, j) += bread(i, k) * meat(k, j);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    double variance = 0;
    for (std::size_t j = 0; j < n; ++j) variance += half(i, j) * bread(j, i);
    fit.deviation[i] = std::sqrt(std::max(variance, 0.0));
    if (!enough) fit.determined[i] = false;
  }
  return fit;
}

}  // namespace simvis
