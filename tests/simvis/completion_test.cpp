// Completion of the command line, typed into the shells themselves, and the manual page.
#include <doctest/doctest.h>

#include <filesystem>
#include <sstream>

#include "engine/base/words.h"
#include "program/options/command_line.h"
#include "program/options/option_table.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr const char* kShells[] = {"bash", "zsh", "fish"};

bool lacks(const std::string& program) {
  if (fs::exists("/usr/bin/" + program)) return false;
  test::skip(program + " is not installed");
  return true;
}

/// What is typed, and the arguments that it becomes. Shells choose between "--out DIR" and "--out=DIR".
struct Typed {
  std::string text, arguments;
};

const std::vector<Typed>& all_typed() {
  static const std::vector<Typed> all = {
      {"--datas\tcoc\t", "--dataset coco"},                          // an option and a word out of a registry
      {"--record-pol\tdr\t", "--record-policy drop"},                // a word out of the table
      {"--describe laser_s\t", "--describe laser_scanner"},          // a type
      {"--method hyb\t", "--method hybrid"},                         // a method
      {"--live --strict sce\t", "--live --strict scene.xml"},        // a scene, not scene.txt; the port may be missing
      {"--trajectory dri\t", "--trajectory drive.csv"},              // a file by its ending, not drive.xml
      {"-o res\t", "-o results"},                                    // a folder, not results.xml
      {"--out=res\t", "--out results"},                              // the same behind "="
      {"--frames 3 --quiet sce\t", "--frames 3 --quiet scene.xml"},  // no file in place of a number
  };
  return all;
}

/// zsh removes the "/" behind a folder when the line ends.
std::string as_typed(std::string arguments) {
  std::ranges::replace(arguments, '=', ' ');
  if (arguments.ends_with('/')) arguments.pop_back();
  return std::string(trimmed(arguments));
}

}  // namespace

TEST_CASE("bash, zsh and fish complete options, words, files and folders") {
  for (const char* shell : kShells) {
    CAPTURE(std::string(shell));
    if (lacks(shell)) continue;
    const TemporaryFolder folder;
    fs::create_directory(folder / "work");
    fs::create_directory(folder / "home");
    fs::create_directory(folder / "work/results");
    for (const char* file : {"scene.xml", "scene.txt", "drive.csv", "drive.xml", "results.xml"}) {
      write_text(folder / "work" / file, "");
    }
    write_text(folder / "script", run_simvis({"--completion", shell}).out);
    std::string command = "cd '" + (folder / "work").string() +
                          "' && exec /usr/bin/python3 " SIMVIS_SOURCE_DIR "/tests/simvis/type_in_shell.py " + shell +
                          " ../script '" + (folder / "home").string() + "'";
    for (const Typed& typed : all_typed()) command += " $'" + typed.text + "'";
    const ProcessResult result = Process({"/bin/bash", "-c", command}).wait();
    CHECK_MESSAGE(result.exit_code == 0, result.err);
    std::istringstream lines(result.out);
    for (const Typed& typed : all_typed()) {
      std::string line;
      std::getline(lines, line);
      CHECK(as_typed(line) == typed.arguments);
    }
  }
}

TEST_CASE("the scripts are well formed and have every option") {
  for (const char* shell : kShells) {
    CAPTURE(std::string(shell));
    const std::string script = run_simvis({"--completion", shell}).out;
    for (const OptionSpec& option : option_table()) {
      for (const std::string_view name : words_of(option.names, ",")) {
        const bool is_fish = std::string_view(shell) == "fish";
        const std::string written = !is_fish                 ? std::string(name)
                                    : name.starts_with("--") ? " -l " + std::string(name.substr(2)) + " "
                                                             : " -s " + std::string(name.substr(1)) + " ";
        CHECK_MESSAGE(script.find(written) != script.npos, name);
      }
    }
    if (lacks(shell)) continue;
    const TemporaryFolder folder;
    write_text(folder / "script", script);
    const ProcessResult checked = Process({shell, "-n", (folder / "script").string()}).wait();
    CHECK_MESSAGE(checked.exit_code == 0, checked.err);
    CHECK(checked.err == "");
  }
}

TEST_CASE("the examples of --help are command lines") {
  const std::string help = run_simvis({"--help"}).out;
  CHECK(usage_examples().size() >= 5);
  for (const UsageNote& example : usage_examples()) {
    CAPTURE(example.head);
    CHECK(help.find("\n  " + std::string(example.head) + "\n") != help.npos);
    std::vector<std::string> arguments;
    for (const std::string_view word : words_of(example.head)) arguments.emplace_back(word);
    CHECK(arguments.front() == "simvis-run");
    arguments.erase(arguments.begin());
    CHECK_FALSE(parse_options(arguments).exit_status.has_value());
  }
}

TEST_CASE("the manual page has every option, and groff takes it without a warning") {
  const std::string page = run_simvis({"--man"}).out;
  CHECK(page.starts_with(".TH SIMVIS\\-RUN 1"));
  if (lacks("groff")) return;
  const TemporaryFolder folder;
  write_text(folder / "simvis-run.1", page);
  const ProcessResult shown =
      Process({"groff", "-man", "-ww", "-Tascii", "-P-cbou", "-rLL=300n", (folder / "simvis-run.1").string()}).wait();
  CHECK(shown.exit_code == 0);
  CHECK(shown.err == "");
  for (const OptionSpec& option : option_table()) {
    const std::string name(words_of(option.names, ",").back());
    CHECK_MESSAGE(
        shown.out.find(name + (option.value.empty() ? "" : " " + std::string(option.value))) != std::string::npos,
        name);
  }
  for (const char* head : {"NAME\n", "SYNOPSIS\n", "OPTIONS\n", "EXAMPLES\n", "EXIT STATUS\n"}) {
    CHECK_MESSAGE(shown.out.find(head) != std::string::npos, head);
  }
}

}  // namespace simvis

TEST_SUITE_END();
