// Each input of tests/fuzz/corpora once: those that a fuzzer began with, and those that were faults once.
#include <doctest/doctest.h>

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("fuzz");

namespace simvis::fuzz {
namespace {

const std::filesystem::path kCorpora = std::filesystem::path(SIMVIS_SOURCE_DIR) / "tests/fuzz/corpora";

TEST_CASE("every target reads its corpus") {
  std::size_t inputs = 0;
  for (const Target& target : targets()) {
    CAPTURE(target.name);
    const std::vector<std::string> files = files_below(kCorpora / target.name);
    CHECK(files.size() >= 2);
    for (const std::string& file : files) {
      CAPTURE(file);
      const std::string bytes = read_text(kCorpora / target.name / file);
      CHECK_NOTHROW(run_target(target, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
      ++inputs;
    }
  }
  CHECK(inputs > 2 * targets().size());
}

// The beginnings of each input, one of which ends within every length and count.
TEST_CASE("every target reads beginnings of its corpus") {
  for (const Target& target : targets()) {
    CAPTURE(target.name);
    for (const std::string& file : files_below(kCorpora / target.name)) {
      CAPTURE(file);
      const std::string bytes = read_text(kCorpora / target.name / file);
      constexpr std::size_t kBeginnings = 16;
      for (std::size_t i = 0; i < kBeginnings; ++i) {
        const std::size_t size = bytes.size() * i / kBeginnings;
        CHECK_NOTHROW(run_target(target, {reinterpret_cast<const std::uint8_t*>(bytes.data()), size}));
      }
    }
  }
}

TEST_CASE("every corpus and every dictionary is that of a target") {
  std::set<std::string> names;
  for (const Target& target : targets()) names.emplace(target.name);
  for (const auto& entry : std::filesystem::directory_iterator(kCorpora)) {
    CHECK(names.contains(entry.path().filename().string()));
  }
  for (const auto& entry : std::filesystem::directory_iterator(kCorpora.parent_path() / "dictionaries")) {
    CHECK(names.contains(entry.path().stem().string()));
  }
}

}  // namespace
}  // namespace simvis::fuzz

TEST_SUITE_END();
