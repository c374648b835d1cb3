// What a program asks of failing_allocations.cpp that links it.
#pragma once

extern "C" {

struct SimvisAllocations {
  long calls, failed;  ///< of SimVis's own code, since the last simvis_fail_allocations()
};

/// From now on counts from 0, and `count` calls fail from the call with the number `first` on. None fails for 0, and
/// none is counted below.
void simvis_fail_allocations(long first, long count);
SimvisAllocations simvis_count_allocations();
}
