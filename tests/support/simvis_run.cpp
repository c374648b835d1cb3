#include "tests/support/simvis_run.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <sstream>

#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

namespace simvis {
namespace {

Strings cells(const std::string& line) {
  Strings result{""};
  for (const char c : line) {
    if (c == ',') {
      result.emplace_back();
    } else {
      result.back() += c;
    }
  }
  return result;
}

}  // namespace

const std::string& simvis_run() {
  static const std::string program = tested_build() + "/bin/simvis-run";
  return program;
}

ProcessResult run_simvis(Strings arguments, const Strings& environment) {
  arguments.insert(arguments.begin(), simvis_run());
  return Process(arguments, environment).wait();
}

void check_refused(const Strings& options, const std::string& commands, const Strings& expected) {
  const TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(folder.path(), commands);
  Strings arguments = {scene.string(), "--out", (folder / "out").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProcessResult result = run_simvis(arguments);
  INFO(commands, " ", result.err);
  CHECK(result.exit_code == 2);
  CHECK(result.out == "");
  for (const std::string& text : expected) {
    CHECK_MESSAGE(result.err.find(text) != std::string::npos, "\"", text, "\" is missing");
  }
  CHECK(files_below(folder.path()) == Strings{"scene.xml", "wall.gltf"});
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
}

Table read_csv(const std::filesystem::path& file) {
  std::istringstream in(read_text(file));
  Table table;
  std::string line;
  std::getline(in, line);
  table.columns = cells(line);
  while (std::getline(in, line)) table.rows.push_back(cells(line));
  return table;
}

}  // namespace simvis
