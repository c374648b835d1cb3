// COLLADA in zip archives (.zae).
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

std::uint32_t zip_checksum(const std::string& bytes) {
  std::uint32_t checksum = ~0u;
  for (const char byte : bytes) {
    checksum ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) checksum = (checksum >> 1) ^ ((checksum & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~checksum;
}

// A file of an archive. What the directory says may be false.
struct ZipFile {
  std::string name, data;  // as it lies in the archive
  std::uint32_t method = 0, flags = 0, unpacked = 0, checksum = 0;
};

ZipFile stored(const std::string& name, const std::string& content) {
  return {name, content, 0, 0, static_cast<std::uint32_t>(content.size()), zip_checksum(content)};
}

// The manifest that names "models/the box.dae", packed by zlib.
ZipFile deflated_manifest() {
  const std::string content = "<?xml version='1.0'?><dae_root>./models/the%20box.dae</dae_root>";
  constexpr std::uint8_t kPacked[] = {0xb3, 0xb1, 0xaf, 0xc8, 0xcd, 0x51, 0x28, 0x4b, 0x2d, 0x2a, 0xce, 0xcc,
                                      0xcf, 0xb3, 0x55, 0x37, 0xd4, 0x33, 0x50, 0xb7, 0xb7, 0xb3, 0x49, 0x49,
                                      0x4c, 0x8d, 0x2f, 0xca, 0xcf, 0x2f, 0xb1, 0xd3, 0xd3, 0xcf, 0xcd, 0x4f,
                                      0x49, 0xcd, 0x29, 0xd6, 0x2f, 0xc9, 0x48, 0x55, 0x35, 0x32, 0x48, 0xca,
                                      0xaf, 0xd0, 0x03, 0xca, 0xd9, 0xe8, 0xc3, 0x15, 0x00, 0x00};
  return {"manifest.xml",
          std::string(std::begin(kPacked), std::end(kPacked)),
          8,
          0,
          static_cast<std::uint32_t>(content.size()),
          zip_checksum(content)};
}

void put_number(std::string& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

std::string zip_of(const std::vector<ZipFile>& files) {
  std::string bytes, directory;
  for (const ZipFile& file : files) {
    std::string shared;
    put_number(shared, 20, 2);
    put_number(shared, file.flags, 2);
    put_number(shared, file.method, 2);
    put_number(shared, 0, 4);
    put_number(shared, file.checksum, 4);
    put_number(shared, file.data.size(), 4);
    put_number(shared, file.unpacked, 4);
    put_number(shared, file.name.size(), 2);
    put_number(shared, 0, 2);
    directory += "PK\1\2";
    put_number(directory, 20, 2);
    directory += shared;
    put_number(directory, 0, 10);
    put_number(directory, bytes.size(), 4);
    directory += file.name;
    bytes += "PK\3\4" + shared + file.name + file.data;
  }
  const std::size_t start = bytes.size();
  bytes += directory + "PK\5\6";
  put_number(bytes, 0, 4);
  put_number(bytes, files.size(), 2);
  put_number(bytes, files.size(), 2);
  put_number(bytes, directory.size(), 4);
  put_number(bytes, start, 4);
  put_number(bytes, 0, 2);
  return bytes;
}

// The box as an archive of these files, loaded.
Loaded load_archive(const std::vector<ZipFile>& files, const std::string& behind = "") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "box.zae", std::ios::binary) << zip_of(files) + behind;
  return load(folder.path() / "box.zae");
}

std::string archive_error(const std::vector<ZipFile>& files, const std::string& behind = "") {
  return error_of([&] { load_archive(files, behind); });
}

}  // namespace

TEST_CASE("packed COLLADA is the document that its manifest names, or the first one") {
  const ZipFile box = stored("models/the box.dae", dae_box(kMetresZUp)), other = stored("a.dae", "no COLLADA");
  const Loaded named = load_archive({other, deflated_manifest(), box});
  check_box(named.list);
  CHECK(named.warnings.empty());
  check_box(load_archive({stored("models/", ""), stored("a.txt", "x"), box, other}).list);
}

TEST_CASE("pictures of packed COLLADA lie in its archive") {
  std::string dae = dae_box(kMetresZUp, 1, "", "<diffuse><texture texture=\"i\" texcoord=\"UV\"/></diffuse>");
  dae.insert(dae.find("<library_effects>"),
             "<library_images><image id=\"i\"><init_from>../pictures/a%20b.png</init_from></image></library_images>");
  const ByteString picture = png(2, 1, 8, 2, {{255, 0, 0, 0, 0, 255}});
  const ZipFile document = stored("models/the box.dae", dae);
  const Loaded found =
      load_archive({document, stored("pictures/a b.png", std::string(picture.begin(), picture.end()))});
  check_box(found.list);
  CHECK(found.warnings.empty());
  const auto picture_of_box = found.list.materials.at(0)->base_color_texture;
  REQUIRE(picture_of_box != nullptr);
  CHECK(picture_of_box->rgba == std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 255, 255});
  const Loaded missing = load_archive({document});
  check_box(missing.list);
  REQUIRE(missing.warnings.size() == 1);
  CHECK(contains(missing.warnings[0], "does not hold the picture \"pictures/a b.png\"; materials with it are white"));
}

TEST_CASE("archives that are broken, or unpack to too much, are refused") {
  const ZipFile box = stored("box.dae", dae_box(kMetresZUp));
  CHECK(contains(archive_error({stored("a.txt", "x")}), "holds no .dae, and no manifest.xml that names one"));
  CHECK(contains(archive_error({deflated_manifest(), box}), "does not hold \"models/the box.dae\""));
  CHECK(contains(archive_error({}, "x" + std::string(70'000, ' ')), "has no directory, expected a zip archive"));
  ZipFile wrong = box;
  wrong.checksum ^= 1;
  CHECK(contains(archive_error({wrong}), "holds \"box.dae\", which is broken: its checksum differs"));
  wrong = box;
  wrong.flags = 1;
  CHECK(contains(archive_error({wrong}), "is encrypted"));
  wrong = box;
  wrong.method = 14;
  CHECK(contains(archive_error({wrong}), "is packed by method 14, expected deflate or none"));
  ZipFile bomb = deflated_manifest();
  bomb.unpacked = 0xffffffff;
  CHECK(contains(archive_error({bomb, box}), "unpacks to 4294967295 bytes, expected at most 1 GiB"));
  bomb.unpacked = 1 << 30;
  CHECK(contains(archive_error({bomb, box}), "claims more than it can unpack to"));
  bomb.unpacked = 10;  // fewer than there are
  CHECK(contains(archive_error({bomb, box}), "holds \"manifest.xml\", which is broken"));
  // Each byte of the last record, one wrong at a time, crashes nothing.
  const std::string whole = zip_of({deflated_manifest(), box});
  const TemporaryFolder folder;
  for (std::size_t at = whole.size() - 22; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    std::ofstream(folder.path() / "d.zae", std::ios::binary) << damaged;
    CHECK(error_of([&] { load(folder.path() / "d.zae"); }).find("crash") == std::string::npos);
  }
}

}  // namespace simvis::test

TEST_SUITE_END();
