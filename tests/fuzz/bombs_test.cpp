// Small files that would become gigabytes: each is refused with a message, before the memory is taken.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <zlib.h>

#include "tests/fuzz/bomb.h"
#include "tests/support/parts/gltf_fixture.h"

TEST_SUITE_BEGIN("fuzz");

using namespace simvis;
using namespace simvis::test;

namespace {

void append_chunk(ByteString& bytes, const char* type, const ByteString& data) {
  put_u32(bytes, static_cast<std::uint32_t>(data.size()), true);
  const std::size_t begin = bytes.size();
  bytes.insert(bytes.end(), type, type + 4);
  bytes.insert(bytes.end(), data.begin(), data.end());
  put_u32(bytes, static_cast<std::uint32_t>(::crc32(0, bytes.data() + begin, static_cast<uInt>(bytes.size() - begin))),
          true);
}

/// A grey PNG of one bit, in which the cells are black and white in turn.
ByteString chess_board(std::uint32_t side) {
  ByteString rows;
  for (std::uint32_t y = 0; y < side; ++y) {
    rows.push_back(0);
    rows.insert(rows.end(), side / 8, static_cast<std::uint8_t>(y % 2 == 0 ? 0xAA : 0x55));
  }
  uLongf size = ::compressBound(static_cast<uLong>(rows.size()));
  ByteString packed(size);
  REQUIRE(::compress(packed.data(), &size, rows.data(), static_cast<uLong>(rows.size())) == Z_OK);
  packed.resize(size);
  ByteString png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}, head;
  put_u32(head, side, true);
  put_u32(head, side, true);
  head.insert(head.end(), {1, 0, 0, 0, 0});
  append_chunk(png, "IHDR", head);
  append_chunk(png, "IDAT", packed);
  append_chunk(png, "IEND", {});
  return png;
}

}  // namespace

TEST_CASE("a ROS map whose cells alternate") {
  Bomb bomb;
  constexpr std::uint32_t kSide = 2000;  // 2 million occupied cells, each of 6 sides
  const ByteString picture = chess_board(kSide);
  CHECK(picture.size() < 100'000);
  write_bytes(bomb / "map.png", picture);
  write_text(bomb / "map.yaml", "image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n");
  CHECK(bomb.message("map.yaml") ==
        "map.yaml: error: has walls of more than 1000000 rectangles, expected a map with less noise");
}

TEST_CASE("an OctoMap of two leaves in opposite corners of a wall one cell thick") {
  Bomb bomb;
  // Cells (0, 0, 0) and (0, 65535, 4095) of the root: the second is in child 2 (y) of the first four nodes of its path,
  // and in child 6 (y and z) of the other twelve.
  const auto node = [](unsigned bits) {
    return std::string{static_cast<char>(bits & 0xff), static_cast<char>(bits >> 8)};
  };
  constexpr unsigned kOccupied = 2, kInner = 3;
  std::string tree = node(kInner | kInner << 4);
  for (int depth = 1; depth < 15; ++depth) tree += node(kInner);
  tree += node(kOccupied);
  for (int depth = 1; depth < 15; ++depth) tree += node(kInner << (depth < 4 ? 4 : 12));
  tree += node(kOccupied << 12);
  const std::string file = "# Octomap OcTree binary file\nid OcTree\nsize 33\nres 0.05\ndata\n" + tree;
  CHECK(file.size() < 130);
  write_text(bomb / "wall.bt", file);
  CHECK(bomb.message("wall.bt") ==
        "wall.bt: error: its occupied cells span 1 x 65536 x 4096 cells, expected at most 1073741824 after rows along "
        "x are filled up to a multiple of 64");
}

TEST_CASE("glTF accessors of zeros") {
  for (const bool sparse : {false, true}) {
    CAPTURE(sparse);
    Bomb bomb;
    GltfBuilder builder;
    json accessor = {
        {"componentType", kFloat}, {"type", "VEC3"}, {"count", 1'000'000'000}, {"min", {0, 0, 0}}, {"max", {0, 0, 0}}};
    if (sparse) {
      const std::uint32_t index = 5;
      const float values[3] = {};
      accessor["sparse"] = {{"count", 1},
                            {"indices", {{"bufferView", builder.view(&index, 4)}, {"componentType", kUInt}}},
                            {"values", {{"bufferView", builder.view(values, 12)}}}};
    }
    builder.primitive({{"POSITION", builder.append("accessors", accessor)}});
    write_text(bomb / "zeros.gltf", builder.text());
    const std::string message = bomb.message("zeros.gltf");
    INFO(message);
    CHECK(message.starts_with("zeros.gltf: error: accessors/0"));
  }
}

TEST_CASE("meshopt data that stand for more than they hold") {
  Bomb bomb;
  GltfBuilder builder;
  builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  const ByteString data(64, 0xA0);  // the first byte of a stream of vertices, and nothing sensible
  const int view = builder.view(data.data(), data.size());
  json& described = builder.root["bufferViews"][static_cast<std::size_t>(view)];
  constexpr std::uint64_t kCount = 300'000'000;
  described["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},      {"byteOffset", 0},      {"byteLength", 64},
                                                        {"byteStride", 12}, {"mode", "ATTRIBUTES"}, {"count", kCount}};
  described["byteLength"] = kCount * 12;
  builder.root["buffers"].push_back(
      {{"byteLength", kCount * 12}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  described["buffer"] = 1;
  builder.primitive({{"POSITION", builder.append("accessors", {{"bufferView", view},
                                                               {"componentType", kFloat},
                                                               {"type", "VEC3"},
                                                               {"count", kCount},
                                                               {"min", {0, 0, 0}},
                                                               {"max", {1, 1, 1}}})}});
  write_text(bomb / "meshopt.gltf", builder.text());
  const std::string message = bomb.message("meshopt.gltf");
  INFO(message);
  CHECK(message.starts_with("meshopt.gltf: error: bufferViews/0"));
}

TEST_CASE("MJCF bodies that are nested without end, and an SDF world of models") {
  Bomb bomb;
  std::string deep = "<mujoco><worldbody>", boxes;
  for (int i = 0; i < 100'000; ++i) deep += "<body>";
  write_text(bomb / "deep.xml", deep);
  CHECK(bomb.message("deep.xml").starts_with("deep.xml"));
  for (int i = 0; i < 30'000; ++i) boxes += "<model name='m" + std::to_string(i) + "'><link name='l'/></model>";
  write_text(bomb / "many.sdf", "<sdf version='1.9'><world name='w'>" + boxes + "</world></sdf>");
  CHECK(bomb.message("many.sdf").find("is one of more than 20000 models") != std::string::npos);
}

TEST_SUITE_END();
