// The matchers of <simvis/testing.h>: each is true up to its limit and false beyond it, and says why.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/testing.h>
#include "engine/base/srgb.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

// Stands for GoogleTest's namespace, whose names are not ambiguous in a test with `using namespace simvis`.
namespace testing {
struct Fixture {};
}  // namespace testing
namespace with_google_test {
using namespace simvis;
using Clear = testing::Fixture;
}  // namespace with_google_test

TEST_SUITE_BEGIN("public");

namespace simvis::test_kit {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// One ring of beams with these ranges and bounds.
Scan scan_of(const std::vector<float>& ranges, const std::vector<float>& bounds) {
  Scan scan(1, static_cast<std::uint32_t>(ranges.size()));
  const auto [ranges_m, bounds_m] = scan.edit_ranges();
  std::ranges::copy(ranges, ranges_m.begin());
  std::ranges::copy(bounds, bounds_m.begin());
  return scan;
}

bool says(const Verdict& verdict, std::string_view text) { return verdict.text.find(text) != std::string::npos; }

// Of GoogleTest's class what the conversion uses.
class AssertionResult {
 public:
  explicit AssertionResult(bool ok) : ok_(ok) {}
  AssertionResult& operator<<(const std::string& text) {
    text_ += text;
    return *this;
  }
  const char* failure_message() const { return text_.c_str(); }
  explicit operator bool() const { return ok_; }

 private:
  bool ok_;
  std::string text_;
};

TEST_CASE("a contact touches something if it has a row, a bumper and a touch if they are pressed") {
  const auto reading_of = [](std::vector<std::string> columns, std::vector<double> values) {
    std::vector<TableColumn> table;
    for (std::string& name : columns) table.push_back({.name = std::move(name), .format = "%.9g"});
    return Reading(table, std::move(values));
  };
  const std::vector<std::string> of_contact = {"x_m", "depth_m", "force_n"};
  CHECK(no_contact(reading_of(of_contact, {})));
  CHECK(says(no_contact(reading_of(of_contact, {1, 0, 5, 2, 0, 3})), "2 contacts, expected none"));
  CHECK(no_contact(reading_of({"pressed", "x_m"}, {0, 1})));
  CHECK_FALSE(no_contact(reading_of({"pressed", "x_m"}, {1, 1})));
  CHECK(says(no_contact(reading_of({"pressed"}, {1, 0, 1})), "2 contacts"));
  CHECK(contains(error_of([&] { no_contact(reading_of({"range_m"}, {1})); }), "not of a contact, a bumper or a touch"));
}

TEST_CASE("a range is near within the beam's own bound") {
  const Scan scan = scan_of({2, kInfinity}, {0.25f, 0});
  CHECK(range_near(scan, 0, 2.25));
  CHECK(range_near(scan, 0, 1.75));
  const Verdict beyond = range_near(scan, 0, 2.5);
  CHECK_FALSE(beyond);
  CHECK(says(beyond, "beam 0 measures 2 m, expected 2.5 m: 0.5 m apart, allowed 0.25 m"));
  CHECK(range_near(scan, 0, 2.5, 0.25));
  CHECK(range_near(scan, 1, kInfinity));
  CHECK_FALSE(range_near(scan, 1, 7));
  CHECK_FALSE(range_near(scan, 0, kInfinity));
  CHECK_FALSE(range_near(scan, 0, std::nan("")));
  CHECK(says(range_near(scan, 0, 3, 0.125), "allowed 0.25 m and 0.125 m"));
  Scan rings(2, 3);
  std::ranges::fill(rings.edit_ranges().range_m, 2.0f);
  CHECK(says(range_near(rings, 4, 3), "beam 1 of ring 1 measures 2 m"));
  CHECK(error_of([&] { range_near(scan, 2, 1); }).find("no beam 2") != std::string::npos);
}

TEST_CASE("an infinite bound does not make a range near that is infinitely far") {
  CHECK_FALSE(range_near(scan_of({2}, {kInfinity}), 0, kInfinity));
}

TEST_CASE("scans are near within the sum of their bounds") {
  const Scan one = scan_of({2, kInfinity, 3}, {0.25f, 0, kInfinity});
  CHECK(scans_near(one, scan_of({2.5, kInfinity, 9}, {0.25f, 0, 0})));
  const Verdict beyond = scans_near(one, scan_of({2.75, kInfinity, 9}, {0.25f, 0, 0}));
  CHECK_FALSE(beyond);
  CHECK(says(beyond, "1 of 3 beams"));
  CHECK(says(beyond, "worst: beam 0, 2 and 2.75 m, allowed 0.5 m"));
  CHECK_FALSE(scans_near(one, scan_of({2, 5, 3}, {0, 0, 0})));
  CHECK_FALSE(scans_near(one, scan_of({2}, {0})));
  const float nan = std::nanf("");
  CHECK_FALSE(scans_near(one, scan_of({nan, kInfinity, 3}, {0, 0, 0})));
  CHECK_FALSE(scans_near(scan_of({nan}, {0}), scan_of({nan}, {0})));
  CHECK(scans_near(one, scan_of({2, kInfinity, nan}, {0, 0, 0})));  // the third decides nothing
}

TEST_CASE("a scan is clear if its ranges less their bounds are") {
  const Scan scan = scan_of({3, 2, kInfinity}, {0, 0.5f, 0});
  CHECK(clear_of(scan, 1.5));
  const Verdict near = clear_of(scan, 1.75);
  CHECK_FALSE(near);
  CHECK(says(near, "beam 1 measures 2 m +- 0.5 m, the nearest of all; expected at least 1.75 m"));
  CHECK((near.beam.ranges == scan.range_m.data() && near.beam.index == 1));
  CHECK_FALSE(clear_of(scan_of({0, 2}, {0, 0}), 0.1));  // nearer than range_min
  CHECK_FALSE(clear_of(scan_of({3, std::nanf("")}, {0, 0}), 1));
}

TEST_CASE("a scan is not clear where a surface may be at any range") {
  const Verdict unknown = clear_of(scan_of({3, kInfinity}, {0.25f, kInfinity}), 1);
  CHECK_FALSE(unknown);
  CHECK(says(unknown, "beam 1 measures inf m +- inf m"));
  CHECK_FALSE(clear_of(scan_of({3, 5}, {0.25f, kInfinity}), 1));
  CHECK(clear_of(scan_of({3, kInfinity}, {0.25f, 0}), 2.75));
}

TEST_CASE("a scan that was not measured is neither clear nor near another one") {
  const Scan empty;
  const Verdict clear = clear_of(empty, 1);
  CHECK_FALSE(clear);
  CHECK(says(clear, "nothing was measured yet"));
  const Verdict near = scans_near(empty, empty);
  CHECK_FALSE(near);
  CHECK(says(near, "nothing was measured yet"));
}

TEST_CASE("poses are near by their origins and by the turn between them") {
  const auto turned = [](double degrees) {
    return glm::rotate(glm::translate(glm::dmat4(1.0), {1, 2, 3}), glm::radians(degrees), glm::dvec3(0, 0.6, 0.8));
  };
  constexpr double kRounding = 1e-12;  // of a matrix of unit length, in degrees far below
  for (const double degrees : {1e-6, 1.0, 89.0, 91.0, 180.0}) {
    CAPTURE(degrees);
    CHECK(pose_near(turned(0), turned(degrees), 0, degrees * (1 + 1e-6) + kRounding));
    CHECK_FALSE(pose_near(turned(0), turned(degrees), 0, degrees * (1 - 1e-6)));
  }
  glm::dmat4 moved = turned(30);
  moved[3] += glm::dvec4(0, 0, 0.5, 0);
  CHECK(pose_near(turned(30), moved, 0.5, kRounding * 1e3));
  CHECK_FALSE(pose_near(turned(30), moved, 0.499, 1));
}

TEST_CASE("a position is near a path of straight pieces") {
  const glm::dvec3 path[] = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}};
  CHECK(near_path({2, 0.5, 0}, path, 0.5));
  CHECK_FALSE(near_path({2, 0.5, 0}, path, 0.49));
  CHECK(near_path({4.25, 1, 0}, path, 0.25));
  CHECK(near_path({4, 5, 0}, path, 2));  // beyond the end
  CHECK_FALSE(near_path({4, 5, 0}, path, 1.99));
  CHECK_FALSE(near_path({0, 0, 0}, {}, 1e9));
}

TEST_CASE("depth images are near within a bound") {
  const auto image = [](std::vector<float> pixels) {
    Image made{.width = 2, .height = 1, .channels = 1, .pixels = {}};
    made.pixels = pixels;
    return made;
  };
  CHECK(depths_near(image({1, kInfinity}), image({1.5, kInfinity}), 0.5));
  const Verdict beyond = depths_near(image({1, 2}), image({1, 2.75}), 0.5);
  CHECK_FALSE(beyond);
  CHECK(says(beyond, "1 of 2 pixels"));
  CHECK(says(beyond, "pixel (1, 0), 2 and 2.75 m"));
  CHECK_FALSE(depths_near(image({1, kInfinity}), image({1, 2}), 0.5));
  CHECK_FALSE(depths_near(image({1, std::nanf("")}), image({1, 2}), 0.5));
}

TEST_CASE("a verdict becomes GoogleTest's result, and text") {
  const AssertionResult result = Verdict{false, "why"};
  CHECK_FALSE(static_cast<bool>(result));
  CHECK(std::string(result.failure_message()) == "why");
  CHECK((std::ostringstream() << Verdict{true, "so"}).str() == "so");
}

/// A colour image of two pixels in grey of these sRGB codes.
Image grey_image(int left, int right) {
  Image image{.width = 2, .height = 1, .channels = 4, .pixels = {}};
  for (const int code : {left, right}) {
    for (int c = 0; c < 3; ++c) image.pixels.edit().push_back(linear_from_srgb(code / 255.0));
    image.pixels.edit().push_back(1);
  }
  return image;
}

TEST_CASE("pictures are near up to some codes in a share of the pixels, and a picture shows where they are not") {
  const TemporaryFolder folder;
  const std::filesystem::path shown = folder / "difference.png";
  CHECK(pictures_near(grey_image(10, 200), grey_image(11, 199), 1, 0, shown));
  CHECK_FALSE(std::filesystem::exists(shown));
  CHECK(pictures_near(grey_image(10, 200), grey_image(10, 203), 1, 0.5));
  const Verdict beyond = pictures_near(grey_image(10, 200), grey_image(10, 203), 2, 0.49, shown);
  CHECK_FALSE(beyond);
  CHECK(beyond.text ==
        "1 of 2 pixels differ by more than 2 codes, allowed 0; most: pixel (1, 0), (200, 200, 200) and "
        "(203, 203, 203); see " +
            shown.string());
  CHECK(std::filesystem::file_size(shown) > 0);
  CHECK_FALSE(pictures_near(grey_image(10, 200), Image{.width = 2, .height = 1, .channels = 1, .pixels = {}}));
  const std::filesystem::path fifo = folder / "fifo";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  CHECK_THROWS_AS(pictures_near(grey_image(0, 0), grey_image(0, 99), 1, 0, fifo), InputError);
  CHECK(std::filesystem::is_fifo(fifo));
  CHECK_THROWS_AS(pictures_near(grey_image(0, 0), grey_image(0, 99), 1, 0, folder / "no folder" / "d.png"),
                  MachineError);
}

}  // namespace
}  // namespace simvis::test_kit

TEST_SUITE_END();
