// The price list of cameras: rows, what they change, and the program.
#include "program/report/camera_costs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::string_view kPricedBalls = R"(<scene>
<part shape="sphere" radius="0.6" name="BALL" insert_at="ROOT" pose_offset="12 0 0 0 0 0"/>
<part shape="sphere" radius="0.6" name="FAR_BALL" insert_at="ROOT" pose_offset="30 3 0 0 0 0"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="160" height="120" max_error_px="3" msaa="4"/>
<sensor type="camera" name="DEPTH" insert_at="ROOT" width="8" height="8" outputs="depth"/>
<sensor type="camera" name="PEOPLE" insert_at="ROOT" width="8" height="8" view="visualization"/>
<sensor type="imu" name="IMU" insert_at="ROOT"/></scene>)";

struct PricedBalls {
  PricedBalls() { write_text(folder / "scene.xml", kPricedBalls); }
  std::string scene() const { return (folder / "scene.xml").string(); }

  TemporaryFolder folder;
};

ProcessResult run_price(Strings arguments) {
  arguments.insert(arguments.begin(), simvis_run());
  return Process(arguments).wait();
}

}  // namespace

TEST_CASE("a camera's price list has the exact picture, the priced values and that of the scene") {
  const PricedBalls balls;
  CHECK(costed_cameras(Simulation::load(balls.scene())) == Strings{"CAM"});
  const std::vector<CameraCosts> all_costs =
      camera_costs(Simulation::load(balls.scene()), {.frames = 2, .warm_up = 0, .on_frame = {}});
  REQUIRE(all_costs.size() == 1);
  const std::vector<CameraVariantCosts>& rows = all_costs[0].variants;
  REQUIRE(rows.size() == std::size(kCostedErrors_px) + 1);
  CHECK(std::ranges::is_sorted(rows, {}, &CameraVariantCosts::max_error_px));
  CHECK(std::ranges::count(rows, true, &CameraVariantCosts::in_scene) == 1);
  CHECK(std::ranges::min(rows, {}, &CameraVariantCosts::ratio).ratio == 1);
  std::uint64_t triangles = rows[0].triangles;
  for (const CameraVariantCosts& row : rows) {
    CAPTURE(row.max_error_px);
    CHECK(row.median_ms > 0);
    CHECK(row.first_quartile_ms <= row.median_ms);
    CHECK(row.third_quartile_ms >= row.median_ms);
    CHECK(row.processor_ms > 0);
    CHECK(row.in_scene == (row.max_error_px == 3));
    CHECK(row.triangles <= triangles);
    triangles = row.triangles;
    CHECK(row.bound_px <= row.max_error_px);
    // Each of the two silhouettes lies in the pixel beside the outline: one pixel's diagonal of play for each.
    CHECK(row.change.silhouette_largest_px <= row.max_error_px + 2 * std::sqrt(2.0));
  }
  CHECK(rows[0].coarse_items == 0);
  CHECK(rows[0].change.rms_color == 0);
  CHECK(rows[0].change.silhouette_largest_px == 0);
  CHECK(rows[0].change.other_surface_share == 0);
  CHECK(rows.back().coarse_items == 2);
  CHECK(rows.back().triangles < rows[0].triangles / 2);
  CHECK(rows.back().change.rms_color > 0);
}

TEST_CASE("advice names the most exact value that is not surely slower than the fastest of its bound") {
  CameraCosts costs{.camera = "CAM", .frames = 4, .load = 0.5, .variants = {}};
  const auto add = [&](double max_error_px, double bound_px, double first_ms, double median_ms, double third_ms) {
    CameraVariantCosts row{.max_error_px = max_error_px, .bound_px = bound_px, .change = {}};
    row.first_quartile_ms = first_ms;
    row.median_ms = median_ms;
    row.third_quartile_ms = third_ms;
    costs.variants.push_back(row);
  };
  add(0, 0, 9, 10, 11);
  add(0.5, 0.4, 7, 8, 9.5);  // its quartiles reach into those of the exact image
  add(1, 0.9, 4, 5, 6);
  add(2, 1.8, 4, 4.5, 5);
  CHECK(cheapest_for(costs, 0) == 0);
  CHECK(cheapest_for(costs, 0.5) == 0);
  CHECK(cheapest_for(costs, 1) == 2);
  CHECK(cheapest_for(costs, 2) == 2);
  CHECK(contains(to_table(costs), "CAM: colour, 4 frames of each, load 0.50 at the start\n"));
  CHECK(contains(to_table(costs),
                 "\nCAM: for 0 0.5 px write max_error_px=\"0\" (10.000 ms); for 1 2 px write "
                 "max_error_px=\"1\" (5.000 ms)\n"));
}

TEST_CASE("what changes between two pictures") {
  constexpr std::uint32_t kSide = 16;
  struct Step {  // a wall in front of another one, from a column on
    explicit Step(std::uint32_t column) {
      for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        depth.push_back(i % kSide < column ? 0.5f : 0.25f);
        color.emplace_back(i % kSide < column ? 1.0f : 0.0f);
      }
    }
    ComparedView view() const { return {kSide, kSide, color, depth}; }
    std::vector<glm::vec4> color;
    std::vector<float> depth;
  };
  const PictureDifference none = difference(Step(8).view(), Step(8).view());
  CHECK(none.rms_color == 0);
  CHECK(none.silhouette_largest_px == 0);
  const PictureDifference moved = difference(Step(8).view(), Step(11).view());
  CHECK(moved.silhouette_largest_px == 3);
  CHECK(moved.silhouette_p99_px == 3);
  CHECK(moved.other_surface_share == 3.0 / kSide);
  CHECK(moved.rms_color == doctest::Approx(std::sqrt(3.0 / kSide)));
  CHECK(difference(Step(8).view(), Step(kSide).view()).silhouette_largest_px == kFarSilhouette_px);
}

TEST_CASE("simvis-run --price prints the cameras' table, and writes camera_price.csv if --out is given") {
  const PricedBalls balls;
  const std::string out = (balls.folder / "out").string();
  const ProcessResult printed = run_price({balls.scene(), "--price", "--frames", "1", "--sensor", "CAM", "--out", out});
  INFO(printed.err);
  REQUIRE(printed.exit_code == 0);
  CHECK(contains(printed.out, "CAM: colour, 1 frame of each, load "));
  CHECK(contains(printed.out, "CAM: for 0"));
  CHECK(contains(printed.out, "\n3 * "));
  CHECK(contains(printed.out, camera_cost_legend()));
  CHECK(contains(printed.out, "wrote " + out + "/camera_price.csv\n"));
  std::istringstream csv(read_text(balls.folder / "out/camera_price.csv"));
  std::size_t lines = 0;
  for (std::string line; std::getline(csv, line); ++lines) CHECK(std::ranges::count(line, ',') == 17);
  CHECK(lines == 2 + std::size(kCostedErrors_px));

  const ProcessResult imu = run_price({balls.scene(), "--price", "--sensor", "IMU"});
  CHECK(imu.exit_code == 2);
  CHECK(
      contains(imu.err, "--sensor IMU: --price lists laser scanners and cameras with colour, and this is of type imu"));
}

}  // namespace simvis

TEST_SUITE_END();
