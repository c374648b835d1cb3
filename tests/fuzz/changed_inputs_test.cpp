// Inputs of tests/fuzz/corpora with random changes, without a fuzzer's knowledge of what they reach: for builds without
// libFuzzer, and for numbers of inputs that a fuzzer takes days for. By hand:
//
//   SIMVIS_TEST_INPUTS=10000000 build/release/bin/fuzz_tests -tc='every target reads changed inputs'
//   SIMVIS_TEST_TARGETS=urdf,sdf     these targets alone
//   SIMVIS_TEST_SEED=7               other changes
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/long_count.h"
#include "tests/support/random_numbers.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("fuzz");

namespace simvis::fuzz {
namespace {

using Corpus = std::vector<std::string>;

Corpus corpus_of(std::string_view target) {
  const std::filesystem::path folder =
      std::filesystem::path(SIMVIS_SOURCE_DIR) / "tests/fuzz/corpora" / std::string(target);
  Corpus inputs;
  for (const std::string& file : files_below(folder)) inputs.push_back(read_text(folder / file));
  return inputs;
}

/// Whether SIMVIS_TEST_TARGETS names the target; without the variable all are named.
bool is_asked_for(std::string_view target) {
  const char* const names = std::getenv("SIMVIS_TEST_TARGETS");
  std::istringstream all(names == nullptr ? std::string(target) : names);
  for (std::string name; std::getline(all, name, ',');) {
    if (name == target) return true;
  }
  return false;
}

class Changes {
 public:
  Changes(const Corpus& corpus, std::uint64_t seed) : corpus_(corpus), random_(seed) {}

  std::string next() {
    std::string input = corpus_[random_.below(corpus_.size())];
    for (std::uint64_t i = 1 + random_.below(6); i > 0; --i) change(input);
    constexpr std::size_t kMost = 65536;
    input.resize(std::min(input.size(), kMost));
    return input;
  }

 private:
  void change(std::string& input) {
    // Numbers at limits, and pieces of text that mean something to some reader.
    static const std::vector<std::string> kPieces = {std::string(8, '\0'),
                                                     std::string(8, '\xff'),
                                                     std::string("\x00\x00\x00\x80", 4),
                                                     "\x7f\xff\xff\xff",
                                                     "-1",
                                                     "0",
                                                     "1e308",
                                                     "nan",
                                                     "-0",
                                                     "4294967296",
                                                     "99999999999999999999",
                                                     "<",
                                                     ">",
                                                     "</",
                                                     "\"",
                                                     "'",
                                                     "&",
                                                     "{",
                                                     "}",
                                                     "[",
                                                     "]",
                                                     ",",
                                                     ":",
                                                     "\n",
                                                     "\r\n\r\n",
                                                     "../",
                                                     "%2e%2e",
                                                     "\xc3\x28",
                                                     " "};
    const std::size_t at = random_.below(input.size() + 1),
                      size = random_.below(1 + std::min<std::size_t>(input.size() - at, 64));
    switch (random_.below(7)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<char>(input[at] ^ (1 << random_.below(8)));
        break;
      case 1:
        if (at < input.size()) input[at] = static_cast<char>(random_.below(256));
        break;
      case 2:
        input.erase(at, size);
        break;
      case 3:
        input.insert(at, input.substr(random_.below(input.size() + 1), size));
        break;
      case 4:
        input.insert(at, kPieces[random_.below(kPieces.size())]);
        break;
      case 5: {
        const std::string& piece = kPieces[random_.below(kPieces.size())];
        input.replace(at, std::min(piece.size(), input.size() - at), piece);
        break;
      }
      default: {
        const std::string& other = corpus_[random_.below(corpus_.size())];
        input.replace(at, std::string::npos, other.substr(std::min(other.size(), random_.below(other.size() + 1))));
      }
    }
  }

  const Corpus& corpus_;
  test::Random random_;
};

TEST_CASE("every target reads changed inputs") {
  const int inputs = count_of("SIMVIS_TEST_INPUTS", 100);
  const auto seed = static_cast<std::uint64_t>(count_of("SIMVIS_TEST_SEED", 1));
  std::size_t targets_read = 0;
  for (const Target& target : targets()) {
    if (!is_asked_for(target.name)) continue;
    CAPTURE(target.name);
    const Corpus corpus = corpus_of(target.name);
    Changes changes(corpus, seed);
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < inputs; ++i) {
      const std::string input = changes.next();
      CAPTURE(i);
      REQUIRE_NOTHROW(run_target(target, {reinterpret_cast<const std::uint8_t*>(input.data()), input.size()}));
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (std::getenv("SIMVIS_TEST_INPUTS") != nullptr) {
      std::printf("%-14.*s %9d inputs %8.0f/s\n", static_cast<int>(target.name.size()), target.name.data(), inputs,
                  inputs / took.count());
      std::fflush(stdout);
    }
    ++targets_read;
  }
  CHECK(targets_read > 0);
}

}  // namespace
}  // namespace simvis::fuzz

TEST_SUITE_END();
