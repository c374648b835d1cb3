// The pictures of a run read back by other libraries: every number, for contents that compress well and for noise.
#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <random>

#include "engine/base/srgb.h"
#include "program/output/exr_file.h"
#include "scenegraph/pictures/png_file.h"
#include "tests/support/picture_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::uint32_t kChunkRows = 16;  // of EXR's compression ZIP

// The upper rows are one number, the lower ones are random bits below 2.
Image half_noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  std::vector<float> pixels;
  std::mt19937 random(1);
  const std::size_t numbers = std::size_t{width} * height * channels;
  for (std::size_t i = 0; i < numbers; ++i) {
    const bool upper = i < numbers / 2;
    pixels.push_back(upper ? 0.25f : std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0x3fffffffu));
  }
  return {width, height, channels, std::move(pixels)};
}

std::vector<float> channel_of(const Image& image, std::size_t channel) {
  std::vector<float> numbers;
  for (std::size_t i = channel; i < image.pixels.size(); i += image.channels) numbers.push_back(image.pixels[i]);
  return numbers;
}

ExrPicture read_back(const std::string& bytes) {
  const TemporaryFolder folder;
  write_text(folder / "picture.exr", bytes);
  return read_exr(folder / "picture.exr");
}

}  // namespace

TEST_CASE("EXR: every number of every channel, in chunks that are compressed and in chunks that are not") {
  for (const std::uint32_t height : {1u, kChunkRows, 4 * kChunkRows, 4 * kChunkRows + 5}) {
    CAPTURE(height);
    const Image color = half_noise(33, height, 4), depth = half_noise(33, height, 1);
    const ExrPicture read = read_back(encode_exr(&color, &depth, {}));
    CHECK(read.compression == Imf::ZIP_COMPRESSION);
    REQUIRE(read.channels.size() == 4);
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) CHECK(read.channels.at(names[c]) == channel_of(color, c));
    CHECK(read.channels.at("Z") == depth.pixels);
  }
}

TEST_CASE("EXR: what repeats itself is compressed, noise is stored as it is") {
  constexpr std::uint32_t kSide = 64;
  const Image mixed = half_noise(kSide, kSide, 1);
  const std::size_t half = kSide * kSide * sizeof(float) / 2;
  const std::size_t size = encode_exr(nullptr, &mixed, {}).size();
  CHECK(size > half);
  CHECK(size < half + half / 10);  // the other half, the header, and the table of chunks
}

TEST_CASE("EXR: a plane with a name that the first version of the format does not allow") {
  const Image plane = half_noise(5, 3, 1);
  const std::string name = "a name of more than thirty-one letters";
  CHECK(read_back(encode_exr(image_array(name, plane, ImageContent::numbers), {})).channels.at(name) == plane.pixels);
}

TEST_CASE("EXR: whole numbers stay exact, and each channel has a name") {
  const auto image = [](MeasuredNumbers numbers, ValueType type, std::uint32_t channels) {
    return MeasuredArray{{.name = "id", .kind = OutputKind::image, .value_type = type, .shape = {1, 2, channels}},
                         std::move(numbers)};
  };
  const SharedArray<std::uint32_t> ids{4'294'967'295U, 16'777'217U};
  const ExrPicture exact = read_back(encode_exr(image(ids, ValueType::u32, 1), {}));
  CHECK(exact.channels.empty());
  CHECK(exact.integers.at("id") == ids.numbers());
  const ExrPicture bytes = read_back(encode_exr(image(SharedArray<std::uint8_t>{255, 1}, ValueType::u8, 1), {}));
  CHECK(bytes.integers.at("id") == std::vector<std::uint32_t>{255, 1});
  const ExrPicture parts = read_back(encode_exr(image(SharedArray<float>{1, 2, 3, 4, 5, 6}, ValueType::f32, 3), {}));
  CHECK(parts.channels.at("id.X") == std::vector<float>{1, 4});
  CHECK(parts.channels.at("id.Y") == std::vector<float>{2, 5});
  CHECK(parts.channels.at("id.Z") == std::vector<float>{3, 6});
  CHECK_FALSE(fits_exr(image(SharedArray<std::int32_t>{-1, 2}, ValueType::i32, 1)));
}

TEST_CASE("PNG: the codes of smooth pictures and of noise, of any width") {
  const TemporaryFolder folder;
  for (const std::uint32_t width : {1u, 2u, 77u}) {
    CAPTURE(width);
    const Image color = half_noise(width, 31, 4);
    write_text(folder / "picture.png", encode_png(color));
    const PngPicture read = read_png(folder / "picture.png");
    CHECK(read.width == static_cast<int>(width));
    CHECK(read.height == 31);
    REQUIRE(read.channels == 3);
    std::vector<std::uint8_t> codes;
    for (std::size_t i = 0; i < color.pixels.size(); ++i) {
      if (i % 4 != 3) codes.push_back(srgb_code(color.pixels[i]));
    }
    CHECK(read.pixels == codes);
  }
}

}  // namespace simvis

TEST_SUITE_END();
