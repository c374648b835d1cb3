// A number that was fitted, with its interval.
#pragma once

namespace simvis {

struct FittedNumber {
  double value = 0, low = 0, high = 0;  ///< the interval of 95 %
  bool determined = false;              ///< false: the target says nothing about it, and the others mean nothing
};

}  // namespace simvis
