// The tested library contains the sanitizers: they detect deliberate faults. These test cases run only in builds with
// sanitizers and are named after them.
#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <vector>

#include "engine/base/cache_file.h"
#include "import/sandbox/imported_scene.h"

TEST_SUITE_BEGIN("simvis");

using namespace simvis;

namespace {

/// A fault ends the process in which it runs, so it runs in a child process.
bool is_caught(void (*fault)()) {
  const pid_t child = ::fork();  // this program has one thread
  REQUIRE(child >= 0);
  if (child == 0) {
    fault();
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return !WIFEXITED(status) || WEXITSTATUS(status) != 0;
}

}  // namespace

TEST_CASE("address: a block of memory is read beyond its end") {
  CHECK(is_caught([] {
    const std::vector<char> block(16);
    cache_checksum({block.data(), block.size() + 1});
  }));
}

TEST_CASE("undefined: a bool is read that is neither true nor false") {
  CHECK(is_caught([] {
    ImportedScene scene;
    scene.materials.resize(1);
    std::memset(&scene.materials[0].material.double_sided, 2, 1);
    pack_imported_scene(scene);
  }));
}

TEST_SUITE_END();
