// ./run builds every program that a document calls: the commands of the pages work after it.
#include <doctest/doctest.h>

#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/markdown.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

const std::filesystem::path kRunRoot = SIMVIS_SOURCE_DIR;

/// The programs of SimVis that commands call. A comment may name others.
std::set<std::string> called_programs(const std::string& commands) {
  static const std::regex kComment("(^|\\s)#[^\\n]*"), kProgram("(^|[\\s/|&;(])(simvis-[a-z-]+)(?=[\\s)]|$)");
  const std::string code = std::regex_replace(commands, kComment, "$1");
  std::set<std::string> names;
  for (auto at = std::sregex_iterator(code.begin(), code.end(), kProgram); at != std::sregex_iterator(); ++at) {
    names.insert((*at)[2]);
  }
  return names;
}

}  // namespace

TEST_CASE("the programs that commands call are found") {
  CHECK(called_programs("simvis-run a.xml --out simvis-out.png\n") == std::set<std::string>{"simvis-run"});
  CHECK(called_programs("cd out && build/release/bin/simvis-run a | simvis-ctl demo log  # or simvis-other\n") ==
        std::set<std::string>{"simvis-ctl", "simvis-run"});
  CHECK(called_programs("cmake --install build/release --prefix out/simvis\n").empty());
}

TEST_CASE("./run builds every program that a document calls") {
  std::set<std::string> built;
  std::istringstream lines(read_text(tested_build() + "/programs.txt"));
  for (std::string line; std::getline(lines, line);) built.insert(line);
  CHECK(read_text(kRunRoot / "run").find("tools/build\" release simvis_programs\n") != std::string::npos);
  std::set<std::string> called;
  for (const std::filesystem::path& page : documentation_pages()) {
    for (const MarkdownBlock& block : markdown_blocks(page)) {
      if (block.language != "sh") continue;
      for (const std::string& program : called_programs(block.text)) {
        CAPTURE(page);
        CAPTURE(block.line);
        CHECK_MESSAGE(built.contains(program), program, " is not in the list simvis_programs of CMakeLists.txt");
        called.insert(program);
      }
    }
  }
  CHECK(called.contains("simvis-run"));
  CHECK(called.contains("simvis-ctl"));
}

}  // namespace simvis

TEST_SUITE_END();
