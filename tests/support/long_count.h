// How often a test tries something that is random: a few times in the suite, many times by hand.
#pragma once

#include <cstdlib>

namespace simvis {

/// The number in the environment variable `name`, or `usual`.
inline int count_of(const char* name, int usual) {
  const char* const text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : usual;
}

}  // namespace simvis
