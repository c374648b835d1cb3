// Small files that the decoders of others would turn into gigabytes, made here: Draco, OpenEXR, HDR, KTX 2, zstd,
// xacro. Each is refused with one message, within the limits of memory and of processor time of its helper program.
#include <doctest/doctest.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <zstd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "import/sandbox/sandboxed_decode.h"
#include "tests/fuzz/bomb.h"
#include "tests/support/parts/gltf_fixture.h"

TEST_SUITE_BEGIN("fuzz");

using namespace simvis;
using namespace simvis::test;

namespace {

/// Draco data of a flat grid with so many vertices along each side, 2^bits of them: it is as regular as its encoding
/// expects, so that hundreds of triangles take a byte.
ByteString draco_grid(int bits, int method) {
  const std::uint32_t side = 1u << bits;
  draco::Mesh mesh;
  mesh.set_num_points(side * side);
  draco::GeometryAttribute positions;
  positions.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int attribute = mesh.AddAttribute(positions, true, mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const float place[3] = {static_cast<float>(i % side), static_cast<float>(i / side), 0};
    mesh.attribute(attribute)->SetAttributeValue(draco::AttributeValueIndex(i), place);
  }
  for (std::uint32_t i = 0; i < side * (side - 1); ++i) {
    if (i % side == side - 1) continue;
    const draco::PointIndex a(i), b(i + 1), c(i + side), d(i + side + 1);
    mesh.AddFace({a, b, c});
    mesh.AddFace({c, b, d});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetSpeedOptions(0, 0);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

void put_varint(ByteString& bytes, std::uint32_t value) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 0x80));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

/// The same data that claim other counts: these stand behind the 11 bytes of Draco's header.
ByteString with_counts(const ByteString& data, std::uint32_t points, std::uint32_t triangles) {
  constexpr std::size_t kHeader = 11;
  std::size_t rest = kHeader;
  for (int numbers = 0; numbers < 2; ++rest) numbers += (data.at(rest) & 0x80) == 0 ? 1 : 0;
  ByteString changed(data.begin(), data.begin() + kHeader);
  put_varint(changed, triangles);
  put_varint(changed, points);
  changed.insert(changed.end(), data.begin() + static_cast<std::ptrdiff_t>(rest), data.end());
  return changed;
}

std::string refusal_of_draco(const ByteString& data, std::size_t points, std::size_t corners) {
  GltfBuilder builder;
  builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  json& primitive = builder.primitive(
      {{"POSITION", builder.append("accessors", {{"componentType", kFloat}, {"count", points}, {"type", "VEC3"}})}});
  primitive["indices"] =
      builder.append("accessors", {{"componentType", kUInt}, {"count", corners}, {"type", "SCALAR"}});
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", builder.view(data.data(), data.size())},
                                                           {"attributes", {{"POSITION", 0}}}};
  Bomb bomb;
  write_text(bomb / "draco.gltf", builder.text());
  return bomb.message("draco.gltf");
}

void put_text(ByteString& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.push_back(0);
}

void put_i32(ByteString& bytes, std::int32_t value) { put_u32(bytes, static_cast<std::uint32_t>(value), false); }

/// An attribute of the header of an EXR, of 32-bit numbers.
void put_attribute(ByteString& exr, std::string_view name, std::string_view type,
                   std::initializer_list<std::int32_t> values) {
  put_text(exr, name);
  put_text(exr, type);
  put_i32(exr, static_cast<std::int32_t>(4 * values.size()));
  for (const std::int32_t value : values) put_i32(exr, value);
}

void put_byte_attribute(ByteString& exr, std::string_view name, std::string_view type, std::uint8_t value) {
  put_text(exr, name);
  put_text(exr, type);
  put_i32(exr, 1);
  exr.push_back(value);
}

struct ExrClaim {
  std::int32_t width = 0, height = 0;
  int channels = 1;
  std::int32_t tile = 0;  ///< side of the tiles; 0: lines
};

/// The header of an EXR in ZIP compression, and the beginning of a table of chunks that do not follow.
ByteString exr_of(const ExrClaim& claim) {
  constexpr std::uint8_t kZip = 3, kPerLevel = 0;
  constexpr std::int32_t kFloatNumber = 2, kTiled = 0x200;
  ByteString exr = {0x76, 0x2F, 0x31, 0x01}, channels;
  put_i32(exr, 2 | (claim.tile > 0 ? kTiled : 0));
  for (int i = 0; i < claim.channels; ++i) {
    put_text(channels, i == 0 ? "Y" : "c" + std::to_string(i));
    for (const std::int32_t value : {kFloatNumber, 0, 1, 1}) put_i32(channels, value);
  }
  channels.push_back(0);
  put_text(exr, "channels");
  put_text(exr, "chlist");
  put_i32(exr, static_cast<std::int32_t>(channels.size()));
  exr.insert(exr.end(), channels.begin(), channels.end());
  put_byte_attribute(exr, "compression", "compression", kZip);
  for (const char* window : {"dataWindow", "displayWindow"}) {
    put_attribute(exr, window, "box2i", {0, 0, claim.width - 1, claim.height - 1});
  }
  put_byte_attribute(exr, "lineOrder", "lineOrder", 0);
  constexpr std::int32_t kOne = 0x3F800000;  // as a float
  put_attribute(exr, "pixelAspectRatio", "float", {kOne});
  put_attribute(exr, "screenWindowCenter", "v2f", {0, 0});
  put_attribute(exr, "screenWindowWidth", "float", {kOne});
  if (claim.tile > 0) {
    put_text(exr, "tiles");
    put_text(exr, "tiledesc");
    put_i32(exr, 9);
    put_i32(exr, claim.tile);
    put_i32(exr, claim.tile);
    exr.push_back(kPerLevel);
  }
  exr.push_back(0);
  exr.insert(exr.end(), 64, 0);
  return exr;
}

std::string refusal_of_heights_file(const ByteString& exr) {
  const Bomb bomb;
  return bomb.refusal([&] { decode_heights_in_sandbox(exr, "heights.exr"); });
}

std::string refusal_of_sky_file(const ByteString& picture) {
  const Bomb bomb;
  return bomb.refusal([&] { decode_sky_in_sandbox(picture, "sky.exr"); });
}

ByteString hdr_of(int width, int height) {
  const std::string head =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
  return {head.begin(), head.end()};
}

/// A variable of the environment, until the object goes.
class ChangedVariable {
 public:
  ChangedVariable(const char* name, const std::string& value) : name_(name), had_(std::getenv(name) != nullptr) {
    if (had_) before_ = std::getenv(name);
    ::setenv(name, value.c_str(), 1);
  }
  ~ChangedVariable() { had_ ? ::setenv(name_, before_.c_str(), 1) : ::unsetenv(name_); }
  ChangedVariable(const ChangedVariable&) = delete;
  ChangedVariable& operator=(const ChangedVariable&) = delete;

 private:
  const char* name_;
  bool had_;
  std::string before_;
};

/// A program xacro in PATH, and a module xacro whose main() is `code`.
class PythonAsXacro {
 public:
  explicit PythonAsXacro(const Bomb& bomb, const std::string& code)
      : path_("PATH", (bomb / "xacro").parent_path().string() + ":/usr/bin:/bin"),
        modules_("PYTHONPATH", (bomb / "modules").string()) {
    write_text(bomb / "xacro", "#!/usr/bin/env python3\n");
    std::filesystem::create_directory(bomb / "modules");
    write_text(bomb / "modules/xacro.py", "def main():\n    " + code + "\n");
    std::filesystem::permissions(bomb / "xacro", std::filesystem::perms::owner_all);
    write_text(bomb / "r.urdf.xacro", "<robot name='r' xmlns:xacro='x'/>");
  }

 private:
  ChangedVariable path_, modules_;
};

}  // namespace

TEST_CASE("Draco data whose symbols take almost no bits, and Draco data that claim more than they hold") {
  CHECK(refusal_of_draco(draco_grid(3, draco::MESH_EDGEBREAKER_ENCODING), 64, 6 * 49) == "");
  const ByteString grid = draco_grid(10, draco::MESH_EDGEBREAKER_ENCODING);
  CHECK(grid.size() < 10'000);
  CHECK(refusal_of_draco(grid, 1024 * 1024, std::size_t{6} * 1023 * 1023) ==
        "draco.gltf: error: meshes/0/primitives/0 gives 1048576 vertices and 2093058 triangles, more than its " +
            std::to_string(grid.size()) + " bytes can hold");
  const ByteString sequential = draco_grid(3, draco::MESH_SEQUENTIAL_ENCODING);
  CHECK(refusal_of_draco(sequential, 64, 6 * 49) == "");
  constexpr std::uint32_t kHuge = 400'000'000;
  const std::string huge = refusal_of_draco(with_counts(sequential, kHuge, kHuge), kHuge, kHuge);
  INFO(huge);
  CHECK(huge.starts_with("draco.gltf: error: meshes/0/primitives/0"));
}

TEST_CASE("EXR headers that ask for gigabytes") {
  const ExrClaim claims[] = {{.width = INT32_MAX, .height = INT32_MAX},
                             {.width = 16384, .height = 16384},
                             {.width = 8192, .height = 64, .channels = 20'000},
                             {.width = 8192, .height = 4096, .channels = 20'000},
                             {.width = 8192, .height = 8192, .channels = 1, .tile = INT32_MAX},
                             {.width = 8192, .height = 8192, .channels = 64, .tile = 8192}};
  for (const ExrClaim& claim : claims) {
    CAPTURE(claim.width);
    CAPTURE(claim.channels);
    CAPTURE(claim.tile);
    const std::string message = refusal_of_heights_file(exr_of(claim));
    INFO(message);
    CHECK(message.starts_with("heights.exr"));
    CHECK(message.find('\n') == std::string::npos);
    const std::string of_sky = refusal_of_sky_file(exr_of(claim));
    INFO(of_sky);
    CHECK(of_sky.starts_with("sky.exr"));
    CHECK(of_sky.find('\n') == std::string::npos);
  }
}

TEST_CASE("headers of HDR pictures that ask for gigabytes") {
  struct Case {
    int width, height;
    const char* reason;
  };
  for (const Case& each : {Case{INT32_MAX, INT32_MAX, "has 2147483647 x 2147483647"}, Case{16385, 2, "has 16385 x 2"},
                           Case{8192, 4096, "claims 8192 x 4096 pixels but has only"}}) {
    CAPTURE(each.width);
    CHECK(refusal_of_sky_file(hdr_of(each.width, each.height)).find(each.reason) != std::string::npos);
  }
}

TEST_CASE("pictures in containers that SimVis does not open: KTX 2, and zstd in it and alone") {
  const std::string zeros(1 << 20, '\0');
  ByteString frame(ZSTD_compressBound(zeros.size()));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), zeros.data(), zeros.size(), 19));
  ByteString ktx = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
  constexpr std::uint32_t kZstdCompressed = 2, kSide = 1 << 30;
  for (const std::uint32_t value : {37u, 1u, kSide, kSide, 0u, 0u, 1u, 1u, kZstdCompressed}) put_u32(ktx, value, false);
  ktx.insert(ktx.end(), frame.begin(), frame.end());
  const Bomb bomb;
  CHECK(
      bomb.refusal([&] { decode_picture_in_sandbox(ktx, "p.ktx2"); }) ==
      "p.ktx2 is a picture of the kind KTX 2, which cannot be read; expected PNG, JPEG, TGA, BMP, PSD, GIF, HDR, PNM, "
      "TIFF or WebP");
  const std::string alone = bomb.refusal([&] { decode_picture_in_sandbox(frame, "p.zst"); });
  INFO(alone);
  CHECK(alone.starts_with("p.zst"));
}

TEST_CASE("xacro that asks for memory, or prints more than 256 MiB") {
  struct Case {
    const char *code, *message;
  };
  // An expression of xacro may be any of these, such as ${"x" * 10**10}.
  for (const Case& each : {Case{"x = bytearray(6 << 30); print(len(x))", "xacro cannot expand it: MemoryError"},
                           Case{"print(\"<?xml?>\" + \"x\" * (260 << 20))", "xacro gave more content than fits"}}) {
    CAPTURE(each.code);
    Bomb bomb;
    const PythonAsXacro xacro(bomb, each.code);
    const std::string message = bomb.message("r.urdf.xacro");
    INFO(message.substr(0, 1000));
    CHECK(message.starts_with("r.urdf.xacro: error: " + std::string(each.message)));
  }
}

TEST_SUITE_END();
