// SECURITY.md against what is built: its figures are those of the sources, and docs/reliability.md names for each of
// its claims the tests that hold it.
#include <doctest/doctest.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "import/programs/process_limits.h"
#include "import/sandbox/sandbox_process.h"
#include "import/sandbox/sandboxed_decode.h"
#include "import/urdf/xacro.h"
#include "import/usd/usd_model.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

std::string text_of_page(const char* page) { return read_text(std::filesystem::path(SIMVIS_SOURCE_DIR) / page); }

std::string with_single_spaces(const std::string& text) { return std::regex_replace(text, std::regex("\\s+"), " "); }

std::string gib(std::size_t bytes) { return std::to_string(bytes >> 30) + " GiB"; }

std::string seconds(std::chrono::seconds time) { return std::to_string(time.count()) + " s"; }

/// The rows of the tables between two headings: first cell and the rest of the line.
std::map<std::string, std::string> rows_between(const std::string& text, const std::string& first,
                                                const std::string& last) {
  const std::size_t begin = text.find("\n" + first),
                    end = last.empty() ? text.size() : text.find("\n" + last, begin + 1);
  REQUIRE(begin != std::string::npos);
  REQUIRE(end != std::string::npos);
  std::istringstream lines(text.substr(begin, end - begin));
  std::map<std::string, std::string> rows;
  bool is_body = false;  // of a table
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("|---")) {
      is_body = true;
    } else if (!line.starts_with("|")) {
      is_body = false;
    } else if (is_body) {
      const std::size_t bar = line.find(" |", 2);
      rows[line.substr(2, bar - 2)] = line.substr(bar);
    }
  }
  return rows;
}

TEST_CASE("the limits in SECURITY.md are those of the sources") {
  const std::string text = with_single_spaces(text_of_page("SECURITY.md"));
  const SandboxCall call;
  const DecodeLimits decode;
  CHECK(call.time == decode.time);
  CHECK(call.answer_bytes == decode.memory_bytes);
  const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(call.wall_time).count();
  const std::string helpers = "limits on processor time (" +
                              seconds(std::chrono::floor<std::chrono::seconds>(call.time)) + "; " + seconds(kUsdTime) +
                              " for USD), time by the clock (" + std::to_string(minutes) +
                              " min), memory and the size of files (" + gib(decode.memory_bytes) +
                              ") and the number of open files (" + std::to_string(kMaxOpenFiles) + ")";
  CAPTURE(helpers);
  CHECK(text.find(helpers) != std::string::npos);
  const std::string xacro = "by the program xacro, where it is installed, with limits on processor time (at least " +
                            seconds(kXacroTime) + ") and memory (at least " + gib(kXacroMemory_bytes) + ")";
  CAPTURE(xacro);
  CHECK(text.find(xacro) != std::string::npos);
}

TEST_CASE("docs/reliability.md names tests for every claim of SECURITY.md") {
  const std::string security = text_of_page("SECURITY.md");
  std::map<std::string, std::string> claims =
      rows_between(security, "## What SimVis does not trust", "## What SimVis does trust");
  claims.merge(rows_between(security, "## The network", "## Reporting"));
  claims.erase("");  // the head of a table without one
  const std::map<std::string, std::string> tested =
      rows_between(text_of_page("docs/reliability.md"), "## What SECURITY.md claims", "## ");
  CHECK(claims.size() > 20);
  for (const auto& [claim, text] : claims) {
    CAPTURE(claim);
    CHECK(tested.contains(claim));
  }
  for (const auto& [claim, text] : tested) {
    CAPTURE(claim);
    CHECK(claims.contains(claim));
    const std::regex test("`(tests/[a-z_/]+_test\\.cpp)`");
    std::sregex_iterator each(text.begin(), text.end(), test);
    CHECK(each != std::sregex_iterator());
    for (; each != std::sregex_iterator(); ++each) {
      CHECK(std::filesystem::exists(std::filesystem::path(SIMVIS_SOURCE_DIR) / std::string((*each)[1])));
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
