// A scan is the measurement itself: its views show the numbers of the arrays, whoever writes them and whatever copies
// exist.
#include <simvis/scan.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <doctest/doctest.h>

TEST_SUITE_BEGIN("scenegraph");

namespace simvis::test {
namespace {

constexpr std::uint32_t kRings = 2, kBeams = 3, kAll = kRings * kBeams;

/// A grid, or a beam table, with all that a scan may have.
Scan measured_scan(bool is_grid) {
  Scan scan(kRings, kBeams);
  const std::size_t azimuths = is_grid ? kBeams : kAll, elevations = is_grid ? kRings : kAll;
  scan.set_angles(std::vector<double>(azimuths, 0.5), std::vector<double>(elevations, 0.25),
                  std::vector<double>(azimuths, 28.6), std::vector<double>(elevations, 14.3));
  scan.set_rings({7, 7, 7, 9, 9, 9});
  scan.set_origins(std::vector<double>(3 * std::size_t{kAll}, 0.125));
  const auto [ranges_m, bounds_m] = scan.overwrite_ranges();
  for (std::size_t i = 0; i < kAll; ++i) ranges_m[i] = static_cast<float>(i);
  std::ranges::fill(bounds_m, 0.5f);
  scan.add_channel({.name = "intensity", .format = "%.9g", .unit = "1/m2"}, {6, 5, 4, 3, 2, 1});
  scan.time_ns = 11;
  return scan;
}

/// Whether the view and the array of this name have the same memory, and the array has this shape.
template <typename Number>
bool is_view(const Scan& scan, std::string_view name, const SharedNumbers<Number>& view, const OutputShape& shape) {
  const MeasuredArray* const array = scan.find(name);
  return array != nullptr && array->shape == shape && !view.empty() &&
         std::get<SharedArray<Number>>(array->numbers).data() == view.data() && array->count() == view.size();
}

void check_views(const Scan& scan, bool is_grid) {
  const OutputShape all{kRings, kBeams};
  CHECK(scan.rings == kRings);
  CHECK(scan.beams == kBeams);
  CHECK(is_view(scan, "range_m", scan.range_m, all));
  CHECK(is_view(scan, "error_bound_m", scan.error_bound_m, all));
  CHECK(is_view(scan, "azimuth_rad", scan.azimuth_rad, is_grid ? OutputShape{1, kBeams} : all));
  CHECK(is_view(scan, "elevation_rad", scan.elevation_rad, is_grid ? OutputShape{kRings, 1} : all));
  CHECK(is_view(scan, "ring", scan.ring, all));
  CHECK(is_view(scan, "origin_m", scan.origin_m, {kRings, kBeams, 3}));
  CHECK(is_view(scan, "intensity", scan.channel("intensity"), all));
  REQUIRE(scan.channels().size() == 1);
  CHECK(scan.channels()[0].unit == "1/m2");
  CHECK(scan.channel("reflectivity").empty());
}

TEST_CASE("views show the arrays: of what was written, of copies, of what was moved, and of foreign measurements") {
  for (const bool is_grid : {true, false}) {
    CAPTURE(is_grid);
    Scan scan = measured_scan(is_grid);
    check_views(scan, is_grid);
    const Scan copy = scan;
    check_views(copy, is_grid);
    CHECK(copy.range_m.data() == scan.range_m.data());
    check_views(Scan(std::move(scan)), is_grid);
    Measurement shuffled = copy;
    std::ranges::reverse(shuffled.arrays);
    const std::optional<Scan> foreign = to_scan(std::move(shuffled));
    REQUIRE(foreign);
    check_views(*foreign, is_grid);
    CHECK(foreign->time_ns == 11);
    CHECK(foreign->find("azimuth_deg") != nullptr);
  }
}

TEST_CASE("what is written later leaves copies as they are, and memory that no copy holds is used again") {
  Scan scan = measured_scan(true);
  const float* const first = scan.range_m.data();
  scan.edit_ranges().range_m[1] = 8;
  CHECK(scan.range_m.data() == first);  // its own view is no copy
  std::optional<Scan> copy = scan;
  scan.edit_ranges().range_m[1] = 9;
  CHECK(scan.range_m.data() != first);
  CHECK(copy->range_m == std::vector<float>{0, 8, 2, 3, 4, 5});
  CHECK(scan.range_m == std::vector<float>{0, 9, 2, 3, 4, 5});
  const float* const second = scan.range_m.data();
  copy = scan;
  scan.overwrite_ranges();
  const float* const third = scan.range_m.data();
  CHECK(third != second);
  copy = scan;
  scan.overwrite_ranges();
  CHECK(scan.range_m.data() == second);
  check_views(scan, true);
}

TEST_CASE("before the first measurement arrays have no numbers, and channels can be replaced") {
  Scan scan(kRings, kBeams);
  scan.set_angles({0, 1, 2}, {0, 1});
  REQUIRE(scan.find("range_m") != nullptr);
  CHECK(scan.find("range_m")->count() == 0);
  CHECK(scan.range_m.empty());
  CHECK_FALSE(to_scan(scan));
  scan.add_channel({.name = "time_s", .format = "%.9g"}, std::vector<double>(kAll));
  scan.clear_channels();
  CHECK(scan.channels().empty());
  CHECK(scan.find("time_s") == nullptr);
  CHECK(scan.arrays.size() == 4);
  CHECK(Scan().arrays.empty());
}

TEST_CASE(
    "measurements whose arrays do not fit together are no scans, and rings and origins that do not fit no views") {
  const Scan whole = measured_scan(true);
  const auto with = [&](std::string_view name, const auto& change) {
    Measurement measurement = whole;
    change(*std::ranges::find(measurement.arrays, name, &MeasuredArray::name));
    return to_scan(std::move(measurement));
  };
  for (const char* const name : {"range_m", "error_bound_m", "azimuth_rad", "elevation_rad"}) {
    CAPTURE(name);
    CHECK_FALSE(with(name, [](MeasuredArray& each) { each.name = "other"; }));
    CHECK_FALSE(with(name, [](MeasuredArray& each) { each.shape = {5, 7}; }));
    CHECK_FALSE(with(name, [](MeasuredArray& each) { each.numbers = SharedArray<std::uint8_t>{1, 2, 3, 4, 5, 6}; }));
  }
  for (const char* const name : {"ring", "origin_m"}) {
    CAPTURE(name);
    const std::optional<Scan> scan = with(name, [](MeasuredArray& each) { each.shape = {1, kBeams}; });
    REQUIRE(scan);
    CHECK((std::string(name) == "ring" ? scan->ring.empty() : scan->origin_m.empty()));
    CHECK(scan->ring_of(5) == (std::string(name) == "ring" ? 1 : 9));
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
