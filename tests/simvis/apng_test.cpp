// Films as animated PNG: their chunks, times and pictures, read by the definition of the format.
#include "program/output/apng_file.h"

#include <doctest/doctest.h>
#include <stb_image.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <simvis/image.h>
#include "scenegraph/pictures/png_file.h"
#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::size_t kSignatureBytes = 8;

std::uint32_t u32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

// CRC-32 of ISO 3309, bit by bit.
std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
  }
  return ~crc;
}

struct Chunk {
  std::string type, data;
};

std::vector<Chunk> chunks_of(const std::string& png) {
  REQUIRE(png.substr(0, kSignatureBytes) == "\x89PNG\r\n\x1a\n");
  std::vector<Chunk> chunks;
  for (std::size_t at = kSignatureBytes; at < png.size();) {
    const std::size_t size = u32(png, at);
    REQUIRE(at + size + 12 <= png.size());
    chunks.push_back({png.substr(at + 4, 4), png.substr(at + 8, size)});
    CHECK(u32(png, at + 8 + size) == crc_of(png.substr(at + 4, size + 4)));
    at += size + 12;
  }
  return chunks;
}

struct FilmFrame {
  std::uint32_t delay_ms = 0;
  std::string rgb;
};

// A picture that a decoder for PNG reads.
std::string plain_png(const std::string& film, const std::string& data) {
  std::string png = film.substr(0, kSignatureBytes + 25);
  for (const auto& [type, content] : {std::pair<std::string, std::string>("IDAT", data), {"IEND", ""}}) {
    for (const int shift : {24, 16, 8, 0}) png += static_cast<char>(content.size() >> shift & 0xff);
    png += type + content + "none";  // the decoder does not read checksums
  }
  return png;
}

std::vector<FilmFrame> frames_of(const std::string& film) {
  const std::vector<Chunk> chunks = chunks_of(film);
  REQUIRE(chunks.size() >= 5);
  CHECK(chunks[0].type == "IHDR");
  CHECK(chunks[1].type == "acTL");
  CHECK(chunks.back().type == "IEND");
  CHECK(u32(chunks[1].data, 4) == 0);  // without end
  std::vector<FilmFrame> frames;
  std::uint32_t sequence = 0;
  for (std::size_t i = 2; i + 1 < chunks.size(); i += 2) {
    const std::string &control = chunks[i].data, &data = chunks[i + 1].data;
    REQUIRE(chunks[i].type == "fcTL");
    CHECK(u32(control, 0) == sequence++);
    CHECK(control.substr(4, 8) == chunks[0].data.substr(0, 8));  // the size
    CHECK(u32(control, 20) % 65536 == 1000);                     // the divisor of the delay
    const bool is_first = frames.empty();
    REQUIRE(chunks[i + 1].type == (is_first ? "IDAT" : "fdAT"));
    if (!is_first) CHECK(u32(data, 0) == sequence++);
    const std::string png = plain_png(film, is_first ? data : data.substr(4));
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(png.data()), static_cast<int>(png.size()), &width,
                              &height, &channels, 3),
        stbi_image_free);
    REQUIRE(pixels != nullptr);
    frames.push_back(
        {u32(control, 20) / 65536, std::string(pixels.get(), pixels.get() + std::size_t{3} * width * height)});
  }
  CHECK(u32(chunks[1].data, 0) == frames.size());
  return frames;
}

Image picture_of(float value) {
  Image image{.width = 5, .height = 3, .channels = 4, .pixels = {}};
  std::vector<float>& pixels = image.pixels.overwrite();
  for (int i = 0; i < 15; ++i) pixels.insert(pixels.end(), {value, 0.05f * static_cast<float>(i), 1 - value, 1});
  return image;
}

std::string rgb_of(const Image& image) {
  const std::vector<std::uint8_t> codes = srgb_codes(image);
  return {codes.begin(), codes.end()};
}

TEST_CASE("a film has each picture until the time of the next one, and the last as long as the one before it") {
  TemporaryFolder folder;
  const std::filesystem::path path = folder / "film.apng";
  ApngFile film(path);
  // At 15 Hz the k-th time is k * 66.67 ms: 0, 67, 133, 200. After a gap of 100 s a picture is shown as long as can be.
  const std::vector<std::int64_t> times_ns{0, 66'666'667, 133'333'333, 200'000'000, 100'200'000'000};
  for (std::size_t i = 0; i < times_ns.size(); ++i) {
    film.add(times_ns[i], encode_png(picture_of(0.2f * static_cast<float>(i))));
    CHECK_FALSE(std::filesystem::exists(path));
  }
  film.finish();
  const std::vector<FilmFrame> frames = frames_of(read_text(path));
  REQUIRE(frames.size() == 5);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    CHECK(frames[i].delay_ms == std::vector<std::uint32_t>{67, 66, 67, 65535, 65535}[i]);
    CHECK(frames[i].rgb == rgb_of(picture_of(0.2f * static_cast<float>(i))));
  }
}

TEST_CASE("a film of one picture, and a film without one, which leaves no file") {
  TemporaryFolder folder;
  {
    ApngFile one(folder / "one.apng"), none(folder / "none.apng");
    one.add(0, encode_png(picture_of(0.5f)));
    one.finish();
    none.finish();
  }
  CHECK(frames_of(read_text(folder / "one.apng")).size() == 1);
  int files = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(folder.path())) ++files;
  CHECK(files == 1);
}

TEST_CASE("--format color=apng writes the frames of each camera as a film with the pictures of its PNG files") {
  TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(
      folder.path(),
      R"(<sensor type="event_camera" name="EV" insert_at="ROOT" width="16" height="12" shot_noise="100" picture="on"/>
         <sensor type="stereo_camera" name="EYES" insert_at="ROOT" width="16" height="12" baseline="0.1"/>)");
  const auto run = [&](const char* out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{tested_build() + "/bin/simvis-run",
                                       scene.string(),
                                       "--quiet",
                                       "--out",
                                       (folder / out).string(),
                                       "--frames",
                                       "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Process(arguments).wait();
  };
  REQUIRE(run("out", {"--format", "color=apng,png"}).exit_code == 0);
  for (const auto& [film, pictures] : {std::pair("EV.apng", "EV"), std::pair("EYES_left.apng", "EYES_left")}) {
    CAPTURE(film);
    const std::vector<FilmFrame> frames = frames_of(read_text(folder / "out" / film));
    REQUIRE(frames.size() == 4);
    for (int i = 0; i < 4; ++i) {
      const std::string file = (folder / "out" / pictures / ("00000" + std::to_string(i) + ".png")).string();
      int width = 0, height = 0, channels = 0;
      const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(stbi_load(file.c_str(), &width, &height, &channels, 3),
                                                             stbi_image_free);
      REQUIRE(pixels != nullptr);
      CHECK(frames[static_cast<std::size_t>(i)].rgb ==
            std::string(pixels.get(), pixels.get() + std::size_t{3} * width * height));
    }
  }
  const ProcessResult shard = run("shard", {"--format", "color=apng", "--shard", "0/2", "--sensor", "EYES"});
  INFO(shard.err);
  CHECK(shard.exit_code == 2);
  CHECK(contains(shard.err, "color=apng is a film of all frames of a run, expected neither --resume nor --shard"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
