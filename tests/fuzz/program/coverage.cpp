#include "tests/fuzz/program/coverage.h"

#include <cstdio>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

// The compiler puts a counter of 8 bits for each edge into one section, and its place into another, in the same order.
extern "C" {
struct EdgePlace {
  std::uintptr_t address, flags;
};
extern std::uint8_t __start___sancov_cntrs[], __stop___sancov_cntrs[];
extern const EdgePlace __start___sancov_pcs[];
extern const char __executable_start[];  // where the program's file begins in memory
}

namespace simvis::fuzz {

void report_coverage(const Target& target, const std::vector<std::filesystem::path>& folders,
                     const std::filesystem::path& report) {
  const auto edges = static_cast<std::size_t>(__stop___sancov_cntrs - __start___sancov_cntrs);
  std::vector<bool> reached(edges);
  std::fill_n(__start___sancov_cntrs, edges, std::uint8_t{0});  // those of the start of the program
  for (const std::filesystem::path& folder : folders) {
    for (const std::string& file : files_below(folder)) {
      const std::string bytes = read_text(folder / file);
      run_target(target, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
      for (std::size_t i = 0; i < edges; ++i) {
        if (__start___sancov_cntrs[i] != 0) reached[i] = true;
        __start___sancov_cntrs[i] = 0;
      }
    }
  }
  std::FILE* const out = std::fopen(report.c_str(), "w");
  if (out == nullptr) throw std::runtime_error("cannot write " + report.string());
  const auto base = reinterpret_cast<std::uintptr_t>(__executable_start);
  for (std::size_t i = 0; i < edges; ++i) {
    std::fprintf(out, "%lx %d\n", __start___sancov_pcs[i].address - base, reached[i] ? 1 : 0);
  }
  std::fclose(out);
}

}  // namespace simvis::fuzz
