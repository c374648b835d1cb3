// The sanitizers are in the library that is tested: faults that it is led to on purpose are caught. Run where the build
// has sanitizers, and nowhere else; the test cases are named after them.
#include <doctest/doctest.h>

#include <cstring>

#include "engine/base/cache_file.h"
#include "scenegraph/import/inventor/foreign_scene.h"
#include "scenegraph/import/inventor/guarded_child.h"

TEST_SUITE_BEGIN("simvis");

using namespace simvis;

namespace {

/// Ends the process that it runs in, which is why that is one of its own.
bool is_caught(void (*fault)()) {
  const ChildReport report = run_in_child([fault](ChildLog&) {
    fault();
    return std::vector<std::uint8_t>();
  });
  return report.end != ChildEnd::finished;
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
    ForeignScene scene;
    scene.materials.resize(1);
    std::memset(&scene.materials[0].material.double_sided, 2, 1);
    pack_foreign_scene(scene);
  }));
}

TEST_SUITE_END();
