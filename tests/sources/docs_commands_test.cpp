// Everything in README.md and docs/ works: commands are run, scenes are loaded and C++ is compiled.
// tests/support/markdown.h describes the marks for blocks that cannot be run.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/markdown.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

namespace fs = std::filesystem;

const fs::path kCommandsRoot = SIMVIS_SOURCE_DIR;

std::string place(const fs::path& page, const MarkdownBlock& block) {
  return fs::relative(page, kCommandsRoot).string() + ":" + std::to_string(block.line);
}

// A folder that resembles the root of the sources after ./run, as far as the commands of the pages need it.
class PageFolder {
 public:
  PageFolder() {
    for (const char* name : {"scenes", "tests"}) fs::create_directory_symlink(kCommandsRoot / name, folder_ / name);
    fs::create_directory(folder_ / "build");
    fs::create_directory_symlink(tested_build(), folder_ / "build/release");
  }
  const fs::path& path() const { return folder_.path(); }

  ProcessResult run(const std::string& commands) const {
    const std::string path = "PATH=" + tested_build() + "/bin:" + std::getenv("PATH");
    return Process({"bash", "-euo", "pipefail", "-c", "cd \"$0\"\n" + commands, path_of(folder_)}, {path}).wait();
  }

 private:
  static std::string path_of(const TemporaryFolder& folder) { return folder.path().string(); }
  TemporaryFolder folder_;
};

// Whether `line` is `pattern`, in which "..." stands for any text.
bool matches(std::string_view line, std::string_view pattern) {
  const std::size_t dots = pattern.find("...");
  if (dots == pattern.npos) return line == pattern;
  if (!line.starts_with(pattern.substr(0, dots))) return false;
  const std::string_view rest = pattern.substr(dots + 3);
  for (std::size_t at = dots; at <= line.size(); ++at) {
    if (matches(line.substr(at), rest)) return true;
  }
  return false;
}

// The first line of `expected` that `seen` does not contain in this order; empty if it contains all.
std::string missing_line(const std::string& seen, const std::string& expected) {
  std::istringstream seen_lines(seen), expected_lines(expected);
  for (std::string line, seen_line; std::getline(expected_lines, line);) {
    bool found = false;
    while (!found && std::getline(seen_lines, seen_line)) found = matches(seen_line, line);
    if (!found) return line.empty() ? "(an empty line)" : line;
  }
  return "";
}

void run_page(const fs::path& page) {
  const PageFolder folder;
  ProcessResult last;
  for (const MarkdownBlock& block : markdown_blocks(page)) {
    CAPTURE(place(page, block));
    if (const auto file = block.mark("file")) {
      fs::create_directories((folder.path() / *file).parent_path());
      write_text(folder.path() / *file, block.text);
    }
    if (block.mark("output")) CHECK(missing_line(last.out + last.err, block.text) == "");
    if (block.language != "sh") continue;
    if (const auto reason = block.mark("not run")) {
      CHECK_FALSE(reason->empty());
      MESSAGE(place(page, block) << " is not run: " << *reason);
      continue;
    }
    last = folder.run(block.text);
    CAPTURE(last.out);
    CAPTURE(last.err);
    CHECK(last.exit_code == 0);
  }
}

bool names_file(const std::vector<MarkdownBlock>& blocks, const std::string& file) {
  return std::ranges::any_of(blocks, [&](const MarkdownBlock& block) {
    return block.language == "sh" && !block.mark("not run") && block.text.find(file) != std::string::npos;
  });
}

// Blocks of C++ as one source: their includes first, then each in a namespace, and in a function if it is a piece of
// one.
void add_cpp(const std::string& where, const MarkdownBlock& block, std::string& includes, std::string& source) {
  std::string body;
  std::istringstream lines(block.text);
  for (std::string line; std::getline(lines, line);) (line.starts_with("#include") ? includes : body) += line + '\n';
  const bool whole = body.find("namespace {") != body.npos || body.find("int main(") != body.npos;
  const std::string name = "block_" + std::to_string(source.size());
  source += "namespace " + name + " {  // " + where + "\n" + (whole ? body : "void piece() {\n" + body + "}\n") + "}\n";
}

}  // namespace

TEST_CASE("fenced blocks name their language, and commands are in blocks of sh") {
  for (const fs::path& page : documentation_pages()) {
    for (const MarkdownBlock& block : markdown_blocks(page)) {
      CAPTURE(place(page, block));
      CAPTURE(block.language);
      const std::string known[] = {"sh", "xml", "cpp", "python", "cmake", "text", "csv", "json", "glsl", "mermaid"};
      CHECK(std::ranges::find(known, block.language) != std::end(known));
      for (const MarkdownMark& mark : block.marks) {
        CAPTURE(mark.name);
        const std::string names[] = {"file", "same as", "not run", "output"};
        CHECK(std::ranges::find(names, mark.name) != std::end(names));
      }
    }
  }
}

TEST_CASE("the commands of each page run in order in a folder like the root of the sources") {
  for (const fs::path& page : documentation_pages()) run_page(page);
}

TEST_CASE("a block that shows a file equals that file") {
  for (const fs::path& page : documentation_pages()) {
    for (const MarkdownBlock& block : markdown_blocks(page)) {
      const auto file = block.mark("same as");
      if (!file) continue;
      CAPTURE(place(page, block));
      CHECK(block.text == read_text(kCommandsRoot / *file));
    }
  }
}

TEST_CASE("scenes that no command uses can be loaded") {
  for (const fs::path& page : documentation_pages()) {
    const std::vector<MarkdownBlock> blocks = markdown_blocks(page);
    for (const MarkdownBlock& block : blocks) {
      const auto file = block.mark("file");
      if (block.language != "xml" || block.mark("not run")) continue;
      if (file && (!file->ends_with(".xml") || names_file(blocks, *file))) continue;  // a model, or a scene of commands
      const std::string where = place(page, block);
      CAPTURE(where);
      const auto same = block.mark("same as");
      const fs::path folder = same ? (kCommandsRoot / *same).parent_path() : kCommandsRoot;
      CHECK_NOTHROW(Simulation::from_string(block.text, {}, folder, where));
    }
  }
}

TEST_CASE("the C++ of the pages compiles against the public headers") {
  std::string includes, source;
  for (const fs::path& page : documentation_pages()) {
    for (const MarkdownBlock& block : markdown_blocks(page)) {
      if (block.language == "cpp" && !block.mark("not run")) add_cpp(place(page, block), block, includes, source);
    }
  }
  REQUIRE_FALSE(source.empty());
  const TemporaryFolder folder;
  write_text(folder / "pages.cpp", includes + source);
  const ProcessResult compiled = Process({SIMVIS_CXX_COMPILER, "-std=c++20", "-fsyntax-only", "-I",
                                          (kCommandsRoot / "include").string(), (folder / "pages.cpp").string()})
                                     .wait();
  CAPTURE(compiled.err);
  CHECK(compiled.exit_code == 0);
}

TEST_CASE("RapidCheck finds the smallest failure that the page on tests has") {
  if (!fs::exists("/usr/include/rapidcheck.h")) return test::skip("librapidcheck-dev is not installed");
  std::string example;
  for (const MarkdownBlock& block : markdown_blocks(kCommandsRoot / "docs/testing.md")) {
    if (block.text.find("rc::check") != block.text.npos) example = block.text;
  }
  REQUIRE_FALSE(example.empty());
  // The fault of the page's text: beyond 3 m, the wall is not where it should be.
  const std::string program = R"(
#include <rapidcheck.h>
#include <simvis/testing.h>
#include <string>
std::string scene_with_wall(int cm) {
  const double x = cm / 100.0 + (cm > 300 ? 0.05 : 0);
  return "<simvis><part shape='box' size='1 4 2' name='WALL' insert_at='ROOT' pose_offset='" + std::to_string(x + 0.5) +
         " 0 0 0 0 0'/><sensor type='laser_scanner' name='SCANNER' insert_at='ROOT' samples='1' min_angle='0' "
         "max_angle='0'/></simvis>";
}
int main() {
)" + example + "}\n";
  const TemporaryFolder folder;
  write_text(folder / "walls.cpp", program);
  const std::string libraries = tested_build() + "/lib", built = (folder / "walls").string();
  const ProcessResult compiled = Process({SIMVIS_CXX_COMPILER, "-std=c++20", "-I", (kCommandsRoot / "include").string(),
                                          (folder / "walls.cpp").string(), "-o", built, "-L" + libraries,
                                          "-Wl,-rpath," + libraries, "-lsimvis", "-lrapidcheck"})
                                     .wait();
  REQUIRE_MESSAGE(compiled.exit_code == 0, compiled.err);
  const ProcessResult run = Process({built}).wait();
  CAPTURE(run.err);
  CHECK(run.err.find("\n301\n") != run.err.npos);
  CHECK(run.err.find("expected 3.01 m") != run.err.npos);
}

TEST_CASE("output is compared line by line, with dots for parts that differ from run to run") {
  CHECK(matches("took 12 ms", "took ... ms"));
  CHECK(matches("a", "..."));
  CHECK_FALSE(matches("took 12 s", "took ... ms"));
  CHECK(missing_line("a\nb\nc\n", "a\nc\n") == "");
  CHECK(missing_line("a\nb\nc\n", "c\na\n") == "a");
}

}  // namespace simvis

TEST_SUITE_END();
