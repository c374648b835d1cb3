// SIMVIS_ASSERT checks invariants of SimVis's own code in every build: an abort is better than wrong measurements.
#pragma once

#include <cstdio>
#include <cstdlib>

#define SIMVIS_ASSERT(condition)                                                                     \
  do {                                                                                               \
    if (!(condition)) {                                                                              \
      std::fprintf(stderr, "%s:%d: SimVis bug: %s does not hold\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                                  \
    }                                                                                                \
  } while (false)
