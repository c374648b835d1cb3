// The program simvis-fuzz: libFuzzer for the target that SIMVIS_FUZZ_TARGET names. With SIMVIS_FUZZ_COVERAGE=FILE it
// reads the files of the folders that are its arguments, and writes which edges of the program they have reached.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/program/coverage.h"

namespace {

const simvis::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  const char* const name = std::getenv("SIMVIS_FUZZ_TARGET");
  for (const simvis::fuzz::Target& target : simvis::fuzz::targets()) {
    if (name != nullptr && target.name == name) chosen = &target;
  }
  if (chosen != nullptr) {
    if (const char* const report = std::getenv("SIMVIS_FUZZ_COVERAGE")) {
      simvis::fuzz::report_coverage(*chosen, {*arguments + 1, *arguments + *count}, report);
      std::exit(0);
    }
    return 0;
  }
  std::fprintf(stderr, "SIMVIS_FUZZ_TARGET: expected one of");
  for (const simvis::fuzz::Target& target : simvis::fuzz::targets()) {
    std::fprintf(stderr, " %.*s", static_cast<int>(target.name.size()), target.name.data());
  }
  std::fprintf(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  simvis::fuzz::run_target(*chosen, {data, size});
  return 0;
}
