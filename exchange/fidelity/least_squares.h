// Linear least squares with standard deviations that hold without knowing how errors are distributed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace simvis {

/// The largest number of unknowns in one row.
inline constexpr std::size_t kMaxRowTerms = 8;

/// value = sum of factor[k] * unknown[index[k]] + error.
struct LeastSquaresRow {
  std::uint64_t cluster = 0;     ///< errors of rows of one cluster may depend on each other
  double value = 0, weight = 1;  ///< the weight is one over the variance of the error, as far as it is known
  std::size_t terms = 0;
  std::array<std::uint32_t, kMaxRowTerms> index{};
  std::array<double, kMaxRowTerms> factor{};

  void add(std::uint32_t unknown, double its_factor) {
    index[terms] = unknown;
    factor[terms++] = its_factor;
  }
};

/// A normally distributed number lies within so many standard deviations of its mean with a probability of 95 %.
inline constexpr double kDeviationsOf95 = 1.959963984540054;

struct LeastSquaresFit {
  std::vector<double> value;            ///< of each unknown
  std::vector<double> deviation;        ///< their standard deviations
  std::vector<bool> determined;         ///< whether the rows say more about it than `prior` does
  double half_width = kDeviationsOf95;  ///< half of an interval of 95 %, in standard deviations
};

/// Fits the unknowns to `rows` rows, of which row(i) gives one. Rows of one cluster must follow each other, and have
/// the same indices.
///
/// Prior    each unknown is 0 within the standard deviation `prior`, so that there is always one solution; an unknown
///          that was measured before comes with what that measurement left. An unknown counts as determined if the rows
///          reduce that by a factor of ten: the prior then moves it by less than 1 % of its distance from 0.
/// Errors   standard deviations are those of the sandwich estimator over clusters, with each cluster's residuals from
///          the fit without it (CR3, the jackknife): they hold whatever the variances are, and whatever the errors of
///          one cluster have to do with each other. K.-Y. Liang, S. L. Zeger, Longitudinal data analysis using
///          generalized linear models, Biometrika 73, 1986; R. M. Bell, D. F. McCaffrey, Survey Methodology 28, 2002.
///          Intervals are those of Student's distribution with as many degrees of freedom as there are clusters beyond
///          the unknowns.
LeastSquaresFit least_squares(std::size_t rows, std::span<const double> prior,
                              const std::function<LeastSquaresRow(std::size_t)>& row);

}  // namespace simvis
