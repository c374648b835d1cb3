// Which edges of the program a set of inputs reaches, for tools/fuzz_coverage.
#pragma once

#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {

/// Gives each file of the folders, except for faults, to the target and writes to `report` a line for each edge of the
/// program: its address in the program's file, and 1 if an input has reached it.
void report_coverage(const Target& target, const std::vector<std::filesystem::path>& folders,
                     const std::filesystem::path& report);

}  // namespace simvis::fuzz
