// Where the passes of a solver lead to: Anderson's acceleration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011).
//
// Passes that take one row after the other come near the solution slowly if a light body carries a heavy one: each of
// them leaves nearly the whole error. After some passes, the sum of the last impulses whose changes would cancel each
// other best is far nearer. Contacts that open and friction that begins to slip make the passes nonlinear; so the next
// pass settles what no longer holds, and if the one after it still changes much more than the last one before the sum,
// the solver goes back to where it was.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace simvis {

class PassAcceleration {
 public:
  /// Begins with the impulses before a pass. A change c of one counts as its weight * c^2.
  void start(const std::vector<double>& impulses, const std::vector<double>& weights);
  /// Takes the impulses after a pass. Returns whether the next pass begins with others, which `impulses` are then.
  bool go_on(std::vector<double>& impulses, bool extrapolates);

 private:
  struct Column {  // the difference of two passes; changes are times the roots of their weights
    std::vector<double> change, impulses;
  };
  static constexpr std::size_t kMaxColumns = 20;

  std::size_t column_count() const { return std::min(added_columns_, kMaxColumns); }
  void forget_columns();
  double find_change(const std::vector<double>& impulses);  // returns the sum of its squares
  void add_column(const std::vector<double>& impulses);
  bool extrapolate(std::vector<double>& impulses) const;

  std::vector<double> roots_, before_, change_, last_change_, last_impulses_, before_extrapolation_;
  double size_ = 0;                          // of the last change
  std::array<Column, kMaxColumns> columns_;  // a new one replaces the oldest
  std::size_t added_columns_ = 0;
  std::array<std::array<double, kMaxColumns>, kMaxColumns> products_;  // of the columns' changes
  int passes_ = 0;                                                     // with a column since the last extrapolation
  enum class Stage { plain, extrapolated, settled } stage_ = Stage::plain;
};

}  // namespace simvis
