// README.md and docs/ are complete and current: length, links, the generated reference.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <string>
#include <vector>

#include <simvis/effect.h>
#include <simvis/element.h>
#include <simvis/part_importer.h>
#include <simvis/sensor_type.h>
#include <simvis/version.h>
#include "scenegraph/language/markdown.h"
#include "tests/support/markdown.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t kReadmeLines = 200, kExampleLines = 40;

const fs::path kRoot = SIMVIS_SOURCE_DIR;
std::string described(const std::string& type) {
  const ProcessResult result = Process({simvis_run(), "--describe", type, "--markdown"}).wait();
  REQUIRE(result.exit_code == 0);
  return result.out;
}

}  // namespace

TEST_CASE("docs/reference.md is the output of the program") {
  INFO("to write it again: build/release/bin/simvis-run --describe all --markdown > docs/reference.md");
  // Not one CHECK of two long texts, because doctest would print both.
  const bool current = read_text(kRoot / "docs/reference.md") == described("all");
  CHECK(current);
}

TEST_CASE("docs/devices.md is the output of the program") {
  INFO("to write it again: build/release/bin/simvis-run --describe presets --markdown > docs/devices.md");
  const bool current = read_text(kRoot / "docs/devices.md") == described("presets");
  CHECK(current);
}

TEST_CASE("the options in docs/command-line.md are the output of the program") {
  const ProcessResult help = Process({simvis_run(), "--help", "--markdown"}).wait();
  REQUIRE(help.exit_code == 0);
  CHECK(help.out.starts_with("### The run\n"));
  INFO("between the two comments of the page stands the output of: build/release/bin/simvis-run --help --markdown");
  const bool current =
      read_text(kRoot / "docs/command-line.md")
          .find("<!-- made by: simvis-run --help --markdown -->\n" + help.out + "<!-- end -->\n") != std::string::npos;
  CHECK(current);
}

TEST_CASE("the reference has every type with its summary, notes and attributes") {
  const std::string page = described("all");
  const auto check = [&](const std::string& heading, const auto& type) {
    CAPTURE(heading);
    const std::size_t start = page.find("### " + heading + " `" + std::string(type.name) + "`\n");
    REQUIRE(start != page.npos);
    const std::string section = page.substr(start, page.find("\n### ", start) - start);
    CHECK(section.find(markdown_text(type.summary)) != section.npos);
    CHECK(section.find(markdown_text(type.notes.substr(0, type.notes.find('\n')))) != section.npos);
    for (const AttributeSpec& row : type.attributes) {
      CAPTURE(row.name);
      CHECK(section.find("| `" + std::string(row.name) + "` |") != section.npos);
    }
  };
  // Types that other files of this test program register are not SimVis's.
  constexpr std::string_view kOfTests[] = {"painter", "test_scale"};
  for (const ElementType* type : element_types()) {
    if (std::ranges::find(kOfTests, type->name) == std::end(kOfTests)) check("Element", *type);
  }
  for (const SensorType* type : sensor_types()) check("Sensor", *type);
  for (const EffectType* type : effect_types()) check("Effect", *type);
}

TEST_CASE("--describe gives the notes of a type within 120 columns, and as Markdown its section") {
  const ProcessResult text = Process({simvis_run(), "--describe", "fog"}).wait();
  CHECK(text.out.find("Of several fog elements the last one counts.") != std::string::npos);
  std::istringstream lines(text.out);
  for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 120);
  const std::string section = described("fog");
  CHECK(section.starts_with("### Element `fog`\n"));
  CHECK(section.find("### Effect `fog`\n") != section.npos);
  CHECK(described("all").find(section.substr(0, section.find("### Effect"))) != std::string::npos);
  CHECK(Process({simvis_run(), "--markdown"}).wait().exit_code == 2);
}

TEST_CASE("README.md is short, and so is the example of an element") {
  CHECK(std::ranges::count(read_text(kRoot / "README.md"), '\n') <= kReadmeLines);
  CHECK(std::ranges::count(read_text(kRoot / "tests/plugin/door.cpp"), '\n') < kExampleLines);
}

TEST_CASE("documents name the version of the library") {
  const std::string whole(version()), minor = whole.substr(0, whole.rfind('.')), find = "find_package(simvis ";
  CHECK(read_text(kRoot / "CITATION.cff").find("\nversion: " + whole + "\n") != std::string::npos);
  int named = 0;
  for (const fs::path& page : documentation_pages()) {
    const std::string text = read_text(page);
    for (std::size_t at = text.find(find); at != text.npos; at = text.find(find, at + 1), ++named) {
      const std::string named_version = text.substr(at + find.size(), minor.size() + 1);
      CHECK_MESSAGE((named_version == minor + " " || std::isalpha(named_version[0]) != 0), page.string());
    }
  }
  CHECK(named > 0);
}

TEST_CASE("the tutorial shows the plug-in that the tests compile and run") {
  const auto blocks = markdown_blocks(kRoot / "docs/tutorial.md");
  CHECK(std::ranges::any_of(
      blocks, [](const MarkdownBlock& block) { return block.mark("same as") == "tests/plugin/door.cpp"; }));
}

TEST_CASE("README.md and docs/performance.md have the same figures, with their machine and commit") {
  const std::string mark = "<!-- figures: written by bench/readme_figures -->\n";
  std::vector<std::string> figures;
  for (const char* name : {"README.md", "docs/performance.md"}) {
    const std::string page = read_text(kRoot / name);
    const std::size_t start = page.find(mark);
    REQUIRE_MESSAGE(start != page.npos, name);
    figures.push_back(page.substr(start, page.find("<!-- end -->\n", start) - start));
  }
  CHECK(figures[0] == figures[1]);
  CHECK(std::regex_search(figures[0], std::regex("On \\d+ cores of an .+, commit [0-9a-f]{7,}")));
}

TEST_CASE("docs/performance.md names the machine and the commit of each file of results") {
  const std::string page = read_text(kRoot / "docs/performance.md");
  const std::regex commit("\ncommit ([^\n]+)\n");
  int files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kRoot / "bench/results")) {
    if (entry.path().extension() != ".txt") continue;
    ++files;
    CAPTURE(entry.path());
    const std::string text = read_text(entry.path());
    std::smatch found;
    REQUIRE(std::regex_search(text, found, commit));
    const std::string row = "| `" + entry.path().stem().string() + "` | " + text.substr(0, text.find('\n')) + " | " +
                            found[1].str() + " | ";
    CHECK_MESSAGE(page.find(row) != page.npos, "bench/readme_figures --machines writes the table");
  }
  CHECK(files > 20);
}

TEST_CASE("SECURITY.md says how each format of parts is read, and names no other") {
  const std::string page = read_text(kRoot / "SECURITY.md");
  std::vector<std::string> rows;  // endings in the first column
  const std::regex row("\\n\\| (`[^|]*) \\|"), ending("`(\\.[a-z]+)`");
  for (std::sregex_iterator each(page.begin(), page.end(), row), end; each != end; ++each) {
    const std::string cell = (*each)[1];
    for (std::sregex_iterator found(cell.begin(), cell.end(), ending); found != end; ++found) {
      rows.push_back((*found)[1]);
    }
  }
  std::ranges::sort(rows);
  std::vector<std::string> endings = known_part_endings();
  std::ranges::sort(endings);
  CHECK(rows == endings);
}

TEST_CASE("links within the documentation lead to files") {
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  for (const fs::path& page : documentation_pages()) {
    const std::string text = read_text(page);
    for (auto at = std::sregex_iterator(text.begin(), text.end(), link); at != std::sregex_iterator(); ++at) {
      CAPTURE(page.string());
      CAPTURE((*at)[1].str());
      CHECK(fs::exists(page.parent_path() / (*at)[1].str()));
    }
  }
}

}  // namespace simvis

TEST_SUITE_END();
