// Pictures of the sky: what is read from OpenEXR and Radiance HDR, and what is refused.
#include "import/mesh/sky_file.h"

#include <doctest/doctest.h>

#include <limits>

#include "sensors/camera/camera_outputs.h"
#include "tests/support/error_of.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sky_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

const std::string kNothing = "nothing was thrown";

std::string hdr_of(const std::string& size, const std::string& rgbe) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + rgbe;
}

SkyPicture with_value(float value) {
  SkyPicture picture = sky_picture(4, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); });
  picture.radiance[11].g = value;  // column 3 of row 1
  return picture;
}

class SkyFolder {
 public:
  std::filesystem::path file(const std::string& bytes) {
    write_text(folder_ / "sky", bytes);
    return folder_ / "sky";
  }
  std::string refusal(const std::string& bytes) {
    return error_of([&] { read_sky_picture(file(bytes)); });
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("an EXR gives the radiance of its pixels, rows from the top") {
  const SkyPicture made = sky_picture(4, [](std::uint32_t column, std::uint32_t row) {
    return glm::vec3(column, 1e6f * static_cast<float>(row), 0.1f);
  });
  SkyFolder folder;
  const SkyPicture read = read_sky_picture(folder.file(sky_exr(made)));
  CHECK(read.width == 8);
  CHECK(read.height == 4);
  CHECK(read.radiance == made.radiance);
}

TEST_CASE("an EXR of one channel Y is grey") {
  Image image{.width = 2, .height = 1, .channels = 1, .pixels = {}};
  image.pixels.overwrite() = {0.25f, 3};
  SkyFolder folder;
  const SkyPicture read = read_sky_picture(folder.file(encode_exr(image_array("Y", image, ImageContent::depth), {})));
  CHECK(read.radiance == std::vector{glm::vec3(0.25f), glm::vec3(3)});
  CHECK(contains(folder.refusal(encode_exr(image_array("W", image, ImageContent::depth), {})),
                 "has neither the channels R, G and B nor Y"));
}

TEST_CASE("a Radiance HDR gives its radiance") {
  SkyFolder folder;
  // A number is its byte times 2^(exponent - 136).
  const SkyPicture read =
      read_sky_picture(folder.file(hdr_of("-Y 1 +X 2", std::string("\x80\x40\x20\x81\x80\x00\x00\x91", 8))));
  CHECK(read.width == 2);
  CHECK(read.radiance == std::vector{glm::vec3(1, 0.5f, 0.25f), glm::vec3(65536, 0, 0)});
}

TEST_CASE("pictures of the sky that are refused, with the reason") {
  SkyFolder folder;
  const std::string values = "has a value that is negative, not finite or above 10^12 in column 3 of row 1";
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float value : {-1.0f, -1e-30f, nan, inf, -inf, 1.1e12f}) {
    CAPTURE(value);
    CHECK(contains(folder.refusal(sky_exr(with_value(value))), values));
  }
  CHECK(folder.refusal(sky_exr(with_value(1e12f))) == kNothing);
  SkyPicture square{2, 2, std::vector<glm::vec3>(4)};
  CHECK(contains(folder.refusal(sky_exr(square)), "has 2 x 2 pixels, expected twice as many columns as rows"));
  for (const std::string size : {"-Y 8192 +X 16384", "-Y 2 +X 2"}) {
    CHECK(contains(folder.refusal(hdr_of(size, "")), "pixels, expected twice as many columns as rows, at most 8192"));
  }
  CHECK(contains(folder.refusal("\x89PNG\r\n\x1a\n"), "is of another kind, expected OpenEXR or Radiance HDR"));
  CHECK(contains(folder.refusal(""), "is of another kind"));
  // Longer than what stb_image reads ahead.
  const std::string whole = hdr_of("-Y 4 +X 8", std::string(4 * 32, '\x80'));
  CHECK(folder.refusal(whole) == kNothing);
  for (std::size_t missing = 1; missing <= 120; ++missing) {
    CHECK(contains(folder.refusal(whole.substr(0, whole.size() - missing)), "the file ends too early"));
  }
  CHECK(contains(folder.refusal(whole.substr(0, whole.size() - 128)), "claims 8 x 4 pixels but has only"));
  CHECK(contains(folder.refusal(hdr_of("-Y 4096 +X 8192", "")), "claims 8192 x 4096 pixels but has only"));
}

// A run of length 0 makes stb_image wait for the next run, also behind the end of the file.
TEST_CASE("an HDR that ends within its runs is refused at once") {
  const std::string start("\x02\x02\x00\x08", 4), run("\x88\x80", 2), none(2, '\0');
  std::string row = start;
  for (int channel = 0; channel < 4; ++channel) row += run;
  SkyFolder folder;
  CHECK(folder.refusal(hdr_of("-Y 4 +X 8", row + row + row + row)) == kNothing);
  for (const std::string& runs :
       {row + row + row + start, row + row + row + start + run, start + std::string(60, '\0')}) {
    const std::string refusal = folder.refusal(hdr_of("-Y 4 +X 8", runs));
    CAPTURE(refusal);
    CHECK(contains(refusal, "error: the picture of the sky"));
    CHECK(contains(refusal, "cannot be decoded"));  // and not that its decoder takes too much time
  }
}

TEST_CASE("broken pictures of the sky are refused or read, and crash nothing") {
  constexpr int kTries = 30;  // each in a process of its own
  Random random;
  SkyFolder folder;
  for (const std::string& seed :
       {sky_exr(with_value(2)), hdr_of("-Y 1 +X 2", std::string("\x80\x40\x20\x81\x80\x00\x00\x91", 8))}) {
    for (int i = 0; i < kTries; ++i) {
      std::string broken = seed;
      if (random.below(3) == 0) broken.resize(random.below(broken.size()));
      for (std::uint64_t flips = 1 + random.below(4); flips > 0 && !broken.empty(); --flips) {
        broken[random.below(broken.size())] ^= static_cast<char>(1u << random.below(8));
      }
      const std::string error = folder.refusal(broken);
      CHECK((error == kNothing || contains(error, "error: the picture of the sky")));
    }
  }
}

TEST_SUITE_END();
