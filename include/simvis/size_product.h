// Products of sizes that come from outside: from files, messages, pickles and other processes.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <limits>

namespace simvis {

/// The product of the sizes; the largest std::size_t if no std::size_t holds it. No memory has that many numbers, so a
/// comparison with what is there refuses such sizes.
constexpr std::size_t size_product(std::initializer_list<std::size_t> sizes) {
  constexpr std::size_t kMax = std::numeric_limits<std::size_t>::max();
  std::size_t product = 1;
  for (const std::size_t size : sizes) {
    if (size == 0) return 0;
    product = size > kMax / product ? kMax : product * size;
  }
  return product;
}

}  // namespace simvis
