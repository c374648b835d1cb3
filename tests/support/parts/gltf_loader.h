// Loads glTF files that a test has built.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include <simvis/error.h>
#include "tests/support/parts/gltf_fixture.h"

namespace simvis::test {

struct GltfLoader {
  TemporaryFolder folder;
  ContentPool pool;

  LoadedPart load(const GltfBuilder& builder) {
    write_text(folder / "part.gltf", builder.text());
    return load_unturned(folder / "part.gltf", pool);
  }

  /// The error message of the importer for a file; empty if it accepts the file.
  std::string refusal(const std::string& text) {
    write_text(folder / "part.gltf", text);
    try {
      import_part(folder / "part.gltf", pool);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
};

inline const Mesh& only_mesh(const LoadedPart& part) {
  REQUIRE(part.list.meshes.size() == 1);
  return *part.list.meshes[0];
}

}  // namespace simvis::test
