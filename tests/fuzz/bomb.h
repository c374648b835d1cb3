// A folder of small files that would become gigabytes, and what it costs to refuse them.
#pragma once

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include <simvis/error.h>
#include "tests/support/parts/loaded_part.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

namespace simvis::test {

class Bomb {
 public:
  // What a refusal may add to the largest memory that this process has had: far below what the files ask for, and above
  // what a picture of 2000 x 2000 pixels takes with its copies (16 MB each).
  static constexpr long kMaxGrowth_kB = 512 << 10;
  // A helper may use 10 s of the processor, and this process reads an answer that is checked before it is used.
  static constexpr double kMaxProcessor_s = 30;

  std::filesystem::path operator/(const char* name) const { return folder_ / name; }

  /// The message of the import of the file, without its folder.
  std::string message(const char* name) {
    return refusal([&] { import_part(folder_ / name, pool_); });
  }

  /// The message of what `work` throws; empty: nothing.
  template <typename Work>
  std::string refusal(const Work& work) const {
    const rusage before = use(RUSAGE_SELF);
    const double before_s = processor_s();
    std::string text;
    try {
      work();
    } catch (const Error& error) {  // of the machine too, which a limit of a helper is
      text = error.what();
    }
    // The address sanitizer keeps 256 MB of freed memory, and a red zone around each allocation.
    if (!sanitized()) {
      CHECK(use(RUSAGE_SELF).ru_maxrss - before.ru_maxrss < kMaxGrowth_kB);
      CHECK(processor_s() - before_s < kMaxProcessor_s);
    }
    const std::string folder = folder_.path().string() + "/";
    return text.starts_with(folder) ? text.substr(folder.size()) : text;
  }

 private:
  static rusage use(int who) {
    rusage used{};
    ::getrusage(static_cast<__rusage_who>(who), &used);
    return used;
  }
  /// Of this process and of its helpers.
  static double processor_s() {
    double all = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
      const rusage used = use(who);
      for (const timeval& each : {used.ru_utime, used.ru_stime}) {
        all += static_cast<double>(each.tv_sec) + 1e-6 * static_cast<double>(each.tv_usec);
      }
    }
    return all;
  }

  TemporaryFolder folder_;
  ContentPool pool_;
};

}  // namespace simvis::test
