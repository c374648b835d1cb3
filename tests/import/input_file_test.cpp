// Files that are read in pieces, and glTF buffers that stay in their files.
#include "engine/base/input_file.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "import/gltf/gltf_accessors.h"
#include "import/gltf/gltf_document.h"
#include "tests/support/parts/gltf_fixture.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;
namespace fs = std::filesystem;

namespace {

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

// More vertices than are read at once, each (i, 2 i, 3 i), its normal (0, 0, 1) beside it; a triangle of the last ones.
constexpr std::uint32_t kVertices = 70'001;

GltfBuilder interleaved() {
  GltfBuilder builder;
  std::vector<float> values;
  for (std::uint32_t i = 0; i < kVertices; ++i) {
    const auto x = static_cast<float>(i);
    values.insert(values.end(), {x, 2 * x, 3 * x, 0, 0, 1});
  }
  constexpr std::size_t kStride = 6 * sizeof(float);
  const int view = builder.view(values.data(), values.size() * sizeof(float));
  builder.root["bufferViews"][0]["byteStride"] = kStride;
  const auto accessor = [&](std::size_t offset) {
    return builder.append("accessors", {{"bufferView", view},
                                        {"byteOffset", offset},
                                        {"componentType", kFloat},
                                        {"count", kVertices},
                                        {"type", "VEC3"}});
  };
  json& primitive = builder.primitive({{"POSITION", accessor(0)}, {"NORMAL", accessor(3 * sizeof(float))}});
  primitive["indices"] = builder.accessor<std::uint32_t>("SCALAR", {kVertices - 3, kVertices - 2, kVertices - 1});
  return builder;
}

}  // namespace

TEST_CASE("a file that is refused after it was opened is closed") {
  const TemporaryFolder folder;
  write_text(folder / "pointer", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n");
  const auto open_files = [] {
    const fs::directory_iterator files("/proc/self/fd");
    return std::distance(begin(files), end(files));
  };
  const auto before = open_files();
  CHECK_THROWS_AS(InputFile(folder / "pointer"), InputError);
  CHECK(open_files() == before);
}

TEST_CASE("the pieces of a file are those of the whole") {
  const TemporaryFolder folder;
  write_text(folder / "file", "0123456789");
  const InputFile input(folder / "file");
  CHECK(input.size() == 10);
  CHECK(text_of(input.read(0, 10)) == "0123456789");
  CHECK(text_of(input.read(3, 4)) == "3456");
  CHECK(input.read(10, 0).empty());
  CHECK(text_of(read_whole_file(folder / "file")) == "0123456789");
}

TEST_CASE("a file truncated during reading is an error, and a new file of the same name is another file") {
  const TemporaryFolder folder;
  write_text(folder / "file", "0123456789");
  const InputFile input(folder / "file");
  write_text(folder / "other", "abcdefghij");
  fs::rename(folder / "other", folder / "file");
  CHECK(text_of(input.read(0, 10)) == "0123456789");

  const InputFile cut(folder / "file");
  fs::resize_file(folder / "file", 4);
  CHECK(text_of(cut.read(0, 4)) == "abcd");
  CHECK_THROWS_WITH_AS(cut.read(0, 5), ((folder / "file").string() + ": error: could not be read to its end").c_str(),
                       InputError);
}

TEST_CASE("a path that is not a file is refused by name") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(InputFile{folder / "none"},
                       ((folder / "none").string() + ": error: there is no such file").c_str(), InputError);
  CHECK_THROWS_WITH_AS(InputFile{folder.path()}, (folder.path().string() + ": error: is not a regular file").c_str(),
                       InputError);
}

TEST_CASE("large buffers stay in their files, and their views are read from there") {
  const TemporaryFolder folder;
  const GltfBuilder builder = interleaved();
  write_bytes(folder / "part.glb", builder.glb());
  GltfBuilder apart = builder;
  apart.root["buffers"] = {{{"byteLength", builder.bytes.size()}, {"uri", "part.bin"}}};
  write_bytes(folder / "part.bin", builder.bytes);
  write_text(folder / "part.gltf", apart.text());
  write_text(folder / "whole.gltf", builder.text());
  for (const char* name : {"part.glb", "part.gltf", "whole.gltf"}) {
    CAPTURE(name);
    const GltfDocument document = read_gltf_document(folder / name);
    REQUIRE(document.buffers.size() == 1);
    CHECK(document.buffers[0].size() == builder.bytes.size());
    CHECK(document.buffers[0].bytes_held() == (name == std::string("whole.gltf") ? builder.bytes.size() : 0));
    CHECK(view_bytes(document, 0, "") == Bytes(builder.bytes.begin(), builder.bytes.begin() + kVertices * 24));
  }
}

TEST_CASE("elements that are read in several pieces are complete and in order for all kinds of buffers") {
  const TemporaryFolder folder;
  ContentPool pool;
  const GltfBuilder builder = interleaved();
  write_bytes(folder / "part.glb", builder.glb());
  write_text(folder / "part.gltf", builder.text());
  for (const char* name : {"part.glb", "part.gltf"}) {
    CAPTURE(name);
    const LoadedPart part = load_unturned(folder / name, pool);
    REQUIRE(part.list.meshes.size() == 1);
    const Mesh& mesh = *part.list.meshes[0];
    REQUIRE(mesh.positions.size() == kVertices);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < kVertices; ++i) {
      const auto x = static_cast<float>(i);
      wrong += mesh.positions[i] != glm::vec3(x, 2 * x, 3 * x) || mesh.attributes[i].normal != glm::vec3(0, 0, 1);
    }
    CHECK(wrong == 0);
    CHECK(mesh.indices == std::vector<std::uint32_t>{kVertices - 3, kVertices - 2, kVertices - 1});
  }
}

TEST_SUITE_END();
