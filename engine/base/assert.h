// SIMVIS_ASSERT states what our own code guarantees. It is on in every build: a wrong range is worse than a stop.
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
