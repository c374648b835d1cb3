// ./test: its stages, the labels of the tests, and what it takes for the change.
#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/support/run_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

namespace fs = std::filesystem;

const fs::path kGateRoot = SIMVIS_SOURCE_DIR;

std::string stages(const std::vector<std::string>& options) {
  std::vector<std::string> command{(kGateRoot / "test").string(), "--list"};
  command.insert(command.end(), options.begin(), options.end());
  const ProcessResult result = Process(command).wait();
  REQUIRE_MESSAGE(result.exit_code == 0, result.err);
  return result.out;
}

/// A copy of ./test among programs that do nothing but print their name and arguments; that of `failing` fails.
std::string calls_of_test(const std::vector<std::string>& options, const std::string& failing, int exit_code) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "tools");
  fs::create_directories(folder / "bench/programs");
  fs::copy_file(kGateRoot / "test", folder / "test");
  const auto add_program = [&](const fs::path& file, const std::string& name) {
    write_text(file, "#!/bin/sh\necho " + name + " \"$*\"\n[ " + name + " != '" + failing + "' ]\n");
    fs::permissions(file, fs::perms::owner_all);
  };
  add_program(folder / "bench/programs/run", "programs");
  add_program(folder / "ctest", "ctest");
  for (const char* name : {"install", "python_tools", "build", "check_clang", "check_commits", "check_tidy",
                           "check_tsan", "check_deb", "site", "skipped_tests", "touched_tests"}) {
    add_program(folder / "tools" / name, name);
  }
  // On a bare machine there is no git before the packages are installed.
  write_text(folder / "tools/install", "#!/bin/sh\necho install \"$*\"\ntouch installed\n");
  write_text(folder / "tools/change_base", "#!/bin/sh\n[ -e installed ] && echo base-of-$1\n");
  fs::permissions(folder / "tools/change_base", fs::perms::owner_all);
  std::vector<std::string> command{(folder / "test").string()};
  command.insert(command.end(), options.begin(), options.end());
  const ProcessResult result = Process(command, {"PATH=" + folder.path().string() + ":" + std::getenv("PATH")}).wait();
  CHECK_MESSAGE(result.exit_code == exit_code, result.err);
  return result.out;
}

/// A repository with the scripts of this one and a few sources, in which commits are made up.
class MadeUpRepository {
 public:
  MadeUpRepository() {
    fs::create_directories(folder_ / "tools");
    for (const char* name : {"change_base", "check_commits", "touched.py", "touched_tests"}) {
      fs::copy_file(kGateRoot / "tools" / name, folder_ / "tools" / name);
    }
    run({"git", "init", "--quiet", "--initial-branch=main"});
    change({{"engine/mesh.h", "struct Mesh {};\n"},
            {"engine/mesh.cpp", "#include \"engine/mesh.h\"\n"},
            {"engine/tree.cpp", "#include \"engine/tree.h\"\n"},
            {"engine/tree.h", "#include \"engine/mesh.h\"\n"},
            {"include/simvis/scan.h", "struct Scan {};\n"},
            {"sensors/scanner.cpp", "#include <simvis/scan.h>\n"},
            {"tests/mesh_test.cpp", "#include \"engine/mesh.h\"\n"}});
  }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    write_text(folder_ / name, text);
  }
  /// Writes the files and commits them; returns the commit.
  std::string change(const std::vector<std::pair<std::string, std::string>>& files,
                     const std::string& message = "change") const {
    for (const auto& [name, text] : files) write(name, text);
    run({"git", "add", "--all"});
    run({"git", "-c", "user.name=A", "-c", "user.email=a@b", "commit", "--quiet", "--message=" + message});
    return run({"git", "rev-parse", "HEAD"});
  }
  /// What tools/check_commits prints of the commits since `base`.
  std::string wrong_messages(const std::string& base) const {
    return Process({"env", "-C", folder_.path().string(), "tools/check_commits", "--since", base}).wait().out;
  }
  std::string change_base(const std::string& revision = "") const {
    return revision.empty() ? run({"tools/change_base"}) : run({"tools/change_base", revision});
  }
  /// What the function of tools/touched.py returns for the product's sources and the change since `base`.
  std::string touched(const std::string& base, const std::string& function) const {
    return run({"python3", "-B", "-c",
                "import sys, pathlib\n"
                "sys.path.insert(0, 'tools')\n"
                "import touched\n"
                "sources = [file.relative_to(touched.root) for top in ('engine', 'sensors')\n"
                "           for file in sorted((touched.root / top).rglob('*.cpp'))]\n"
                "found = touched.touched_sources(sources, set(filter(touched.is_product, touched.changed_files('" +
                    base + "'))))\nprint(*sorted(map(str, " + function + "(found))))\n"});
  }
  std::string run(std::vector<std::string> command) const {
    command.insert(command.begin(), {"env", "-C", folder_.path().string(), "PYTHONDONTWRITEBYTECODE=1"});
    const ProcessResult result = Process(command).wait();
    REQUIRE_MESSAGE(result.exit_code == 0, result.err);
    return result.out.substr(0, result.out.find('\n'));
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("./test has the stages that its help names, and continuous integration runs all of them") {
  CHECK(stages({}) == "packages\nbuild\nsuite\n");
  const std::string further =
      "build\nsuite\nsanitizer_build\nsanitizer_suite\nclang_tidy\nthread_sanitizer\nbenchmarks\n";
  const std::string all = "packages\ncommits\n" + further;
  CHECK(stages({"--all"}) == all);
  CHECK(stages({"--all", "--base", "HEAD"}) == all);
  CHECK(stages({"--everything"}) == "packages\n" + further + "clang\ndebian_package\nprograms\nsite\n");
  CHECK(read_text(kGateRoot / ".ci/run").find("/../test\" --all\n") != std::string::npos);
  const std::string program = (kGateRoot / "test").string();
  const ProcessResult wrong = Process({program, "--al"}).wait();
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.err.find("--al: expected --all, --everything, --touched, --base REV, --list or --help") !=
        std::string::npos);
  CHECK(Process({program, "--base", "HEAD"}).wait().exit_code == 2);
}

TEST_CASE("messages of commits have a short subject and say why") {
  const MadeUpRepository repository;
  const std::string begin = repository.run({"git", "rev-parse", "HEAD"});
  repository.change({{"a.txt", "1"}}, "Add a file\n\nIt is needed.");
  CHECK(repository.wrong_messages(begin).empty());
  const std::string long_subject(73, 'A');
  const std::string commit = repository.change({{"a.txt", "2"}}, long_subject + "\n\nIt changed.").substr(0, 7);
  CHECK(repository.wrong_messages(begin) ==
        commit + " " + long_subject + ": the subject has 73 characters; expected at most 72\n");
  const std::string after = repository.run({"git", "rev-parse", "HEAD"});
  repository.change({{"a.txt", "3"}}, "change the file.");
  const std::string wrong = repository.wrong_messages(after);
  for (const char* text : {"small letter", "full stop", "no body"}) CHECK(wrong.find(text) != std::string::npos);
}

TEST_CASE("./test runs the suite; --all checks what the change touches, and --everything all files") {
  const auto has = [](const std::string& text, const std::string& line) {
    return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
  };
  const std::string plain = calls_of_test({}, "", 0);
  CHECK(has(plain, "build release"));
  CHECK(plain.find("ctest --preset release") != plain.npos);
  CHECK(has(plain, "skipped_tests build/release"));
  CHECK(plain.find("asan") == plain.npos);
  CHECK(plain.find("     0 s  suite\n") != plain.npos);
  const std::string all = calls_of_test({"--all", "--base", "REV"}, "", 0);
  CHECK(has(all, "build asan sanitized_tests"));
  CHECK(all.find("--label-regex ^sanitized$\n") != all.npos);
  for (const std::string check : {"check_commits", "check_tidy", "check_tsan"})
    CHECK(has(all, check + " --since base-of-REV"));
  CHECK(all.find("check_clang") == all.npos);
  CHECK(has(all, "build release bench_programs"));
  const std::string everything = calls_of_test({"--everything"}, "", 0);
  CHECK(has(everything, "build asan all"));
  CHECK(everything.find("--label-regex") == everything.npos);
  for (const std::string check : {"check_clang ", "check_tidy ", "check_tsan ", "check_deb ",
                                  "programs --check apriltag small_gicp_pairs", "site "})
    CHECK(has(everything, check));
  CHECK(calls_of_test({}, "skipped_tests", 1).find("     0 s  suite\n") == std::string::npos);
  const std::string failed = calls_of_test({"--all"}, "check_tidy", 1);
  CHECK(failed.find("check_tsan") == failed.npos);
  CHECK(failed.find(" s  sanitizer_suite\n") != failed.npos);
}

TEST_CASE("a skip for a reason that is not in tests/skips.txt fails") {
  const TemporaryFolder build;
  const auto skipped_tests = [&](const std::string& output) {
    fs::create_directories(build / "Testing/Temporary");
    write_text(build / "Testing/Temporary/LastTest.log",
               "1/1 Test: a/b\nCommand: x\nOutput:\n---\n" + output + "<end of output>\nTest Passed.\n");
    return Process({(kGateRoot / "tools/skipped_tests").string(), build.path().string()}).wait();
  };
  CHECK(skipped_tests("[doctest] 194 skipped\n").out.empty());
  const ProcessResult listed =
      skipped_tests("skipped: this build has no DDS\nt (T.t) ... skipped 'mypy is not installed'\n");
  CHECK(listed.exit_code == 0);
  CHECK(listed.out == "simvis: skipped: a/b: mypy is not installed\nsimvis: skipped: a/b: this build has no DDS\n");
  const ProcessResult other = skipped_tests("skipped: it rains\n");
  CHECK(other.exit_code == 1);
  CHECK(other.out == "simvis: skipped: a/b: it rains: this reason is not in tests/skips.txt\n");
}

TEST_CASE("the tests that a change touches include its headers or say its name") {
  const MadeUpRepository repository;
  repository.change({{"tests/engine/tree_test.cpp", "#include \"engine/tree.h\"\n"},
                     {"tests/sensors/scene_test.cpp", "// runs a scanner\n"},
                     {"tests/simvis/other_test.cpp", "// runs scanners\n"},
                     {"python/tests/test_a.py", "\n"}});
  const auto touched = [&](const std::string& file) {
    repository.write(file, "// changed\n");
    const std::string all = repository.run({"sh", "-c", "tools/touched_tests HEAD | paste -s -d' '"});
    repository.run({"git", "checkout", "--quiet", "."});
    return all.substr(0, all.find("format_test"));
  };
  CHECK(touched("engine/mesh.cpp") == "engine/tree_test ");
  CHECK(touched("sensors/scanner.cpp") == "sensors/scene_test ");
  CHECK(touched("tests/simvis/other_test.cpp") == "simvis/other_test ");
  CHECK(touched("python/tests/test_a.py") == "python/test_a ");
  CHECK(touched("README.md").empty());
}

TEST_CASE("each test is a unit, a program or a soak") {
  // In a folder of its own: ctest writes over the log of a run under way in the same folder.
  const TemporaryFolder folder;
  write_text(folder / "CTestTestfile.cmake", "subdirs(\"" + tested_build() + "\")\n");
  const ProcessResult listed = Process({"ctest", "--test-dir", folder.path().string(), "--show-only=json-v1"}).wait();
  REQUIRE(listed.exit_code == 0);
  const std::set<std::string> kinds{"unit", "program", "soak"};
  std::set<std::string> seen;
  const nlohmann::json suite = nlohmann::json::parse(listed.out);
  for (const nlohmann::json& test : suite.at("tests")) {
    const std::string name = test.at("name");
    CAPTURE(name);
    std::vector<std::string> own;
    for (const nlohmann::json& property : test.at("properties")) {
      if (property.at("name") != "LABELS") continue;
      for (const std::string label : property.at("value")) {
        if (kinds.contains(label)) own.push_back(label);
      }
    }
    REQUIRE(own.size() == 1);
    seen.insert(own[0]);
    if (name == "engine/free_ranges_test") CHECK(own[0] == "unit");
    if (name == "live/live_follow_test") CHECK(own[0] == "program");    // by live_program.h
    if (name == "messages/cdr_test") CHECK(own[0] == "soak");           // by long_count.h
    if (name == "sources/docs_commands_test") CHECK(own[0] == "soak");  // by its name
  }
  CHECK(seen == kinds);
}

TEST_CASE("a change begins where HEAD leaves the branch of origin, or at the last commits") {
  const MadeUpRepository repository;
  const std::string first = repository.run({"git", "rev-parse", "HEAD"});
  // There is nothing before it: all files count.
  const std::string empty_tree = repository.run({"git", "hash-object", "-t", "tree", "/dev/null"});
  CHECK(repository.change_base() == empty_tree);
  CHECK(repository.touched(empty_tree, "sorted") == "engine/mesh.cpp engine/tree.cpp sensors/scanner.cpp");
  const std::string second = repository.change({{"engine/mesh.h", "struct Mesh { int a; };\n"}});
  CHECK(repository.change_base() == first);
  // The clone of a continuous integration: HEAD is what origin has.
  repository.run({"git", "update-ref", "refs/remotes/origin/main", "HEAD"});
  CHECK(repository.change_base() == first);
  const std::string third = repository.change({{"engine/mesh.h", "struct Mesh { int b; };\n"}});
  CHECK(repository.change_base() == second);
  CHECK(repository.change_base(first) == first);
  CHECK(repository.change_base("HEAD") == third);
  repository.run({"git", "update-ref", "-d", "refs/remotes/origin/main"});
  std::vector<std::string> commits;
  for (int i = 0; i < 11; ++i) commits.push_back(repository.change({{"README.md", std::to_string(i)}}));
  CHECK(repository.change_base() == commits[0]);  // the last ten
  // A commit of many files counts alone, and ends those that count before it.
  std::vector<std::pair<std::string, std::string>> many;
  for (int i = 0; i < 41; ++i) many.emplace_back("engine/many" + std::to_string(i) + ".cpp", "");
  repository.change(many);
  CHECK(repository.change_base() == commits[10]);
  const std::string small = repository.change({{"engine/tree.h", "\n"}});
  CHECK(repository.run({"git", "rev-parse", "HEAD^"}) == repository.change_base());
  CHECK(repository.change_base() != small);
}

TEST_CASE("a change touches the sources that include it, on disk too, and clang-tidy reads each changed file once") {
  const MadeUpRepository repository;
  CHECK(repository.touched("HEAD", "sorted").empty());
  repository.write("tests/mesh_test.cpp", "");
  repository.write("README.md", "");
  CHECK(repository.touched("HEAD", "sorted").empty());
  repository.write("engine/mesh.h", "struct Mesh { int a; };\n");
  CHECK(repository.touched("HEAD", "sorted") == "engine/mesh.cpp engine/tree.cpp");
  CHECK(repository.touched("HEAD", "touched.covering") == "engine/mesh.cpp");
  repository.write("include/simvis/scan.h", "struct Scan { int a; };\n");
  repository.write("engine/tree.cpp", "#include \"engine/tree.h\"\n\n");
  repository.write("engine/new.cpp", "");
  CHECK(repository.touched("HEAD", "sorted") == "engine/mesh.cpp engine/new.cpp engine/tree.cpp sensors/scanner.cpp");
  CHECK(repository.touched("HEAD", "touched.covering") == "engine/new.cpp engine/tree.cpp sensors/scanner.cpp");
}

TEST_CASE("the test of a cluster is skipped within seconds where a daemon of Slurm ends, and says why") {
  const TemporaryFolder folder;
  for (const char* name : {"munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel"}) {
    write_text(folder / name, "#!/bin/sh\necho 'error: made up' >&2\nexit 1\n");
    fs::permissions(folder / name, fs::perms::owner_all);
  }
  const std::string path = "PATH=" + folder.path().string() + ":" + std::getenv("PATH");
  const ProcessResult result =
      Process({"python3", (kGateRoot / "tests/cluster/slurm_test.py").string(), "/bin/true"}, {path})
          .wait(std::chrono::seconds(20));
  CAPTURE(result.err);
  CHECK(result.exit_code == 77);
  CHECK(result.out == "skipped: munged does not run here: error: made up\n");
}

}  // namespace simvis

TEST_SUITE_END();
