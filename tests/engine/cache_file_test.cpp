// Cache files that several threads write at the same time are complete.
#include "engine/base/cache_file.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/temporary_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine");

namespace simvis {
namespace {

constexpr int kThreads = 4;

template <typename Work>
void in_threads(const Work& work) {
  std::vector<std::jthread> threads;
  for (int i = 0; i < kThreads; ++i) threads.emplace_back([&work, i] { work(i); });
}

TEST_CASE("what a killed program left of a cache goes when the next one writes there") {
  const TemporaryFolder folder;
  std::string ended = TemporaryFile(folder / "file", "file").hidden_name().filename().string();
  const std::string process = "." + std::to_string(::getpid()) + ".";
  ended.replace(ended.find(process), process.size(), ".99999999.");  // beyond the largest number of a process
  write_text(folder / ended, "half");
  write_cache_file(folder / "file", "content");
  CHECK(files_below(folder.path()) == std::vector<std::string>{"file"});
}

TEST_CASE("if several threads write one file, it has the whole content of one of them, and no other file stays") {
  const TemporaryFolder folder;
  constexpr std::size_t kBytes = 200'000;
  int broken = 0;
  std::mutex mutex;
  in_threads([&](int thread) {
    const std::string content(kBytes * static_cast<std::size_t>(thread + 1), static_cast<char>('a' + thread));
    for (int round = 0; round < 25; ++round) {
      write_cache_file(folder / "file", content);
      const std::string read = read_text(folder / "file");
      const bool whole = !read.empty() && read.size() == kBytes * static_cast<std::size_t>(read[0] - 'a' + 1) &&
                         std::ranges::count(read, read[0]) == static_cast<std::ptrdiff_t>(read.size());
      const std::lock_guard lock(mutex);
      broken += !whole;
    }
  });
  CHECK(broken == 0);
  CHECK(files_below(folder.path()) == std::vector<std::string>{"file"});
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
