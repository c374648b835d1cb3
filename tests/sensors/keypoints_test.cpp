// Keypoints against geometry, and against the pixels of a camera with the same lens and shutter.
#include "sensors/camera/keypoints.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/simulation.h>
#include "sensors/camera/camera_moment.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

using PointRow = std::map<std::string, double>;

/// The rows of the table of the sensor KEYS, by the names of the points.
std::map<std::string, PointRow> point_rows(const Simulation& simulation) {
  const Measurement measurement = simulation.measurement("KEYS");
  std::map<std::uint32_t, std::string> names;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.name == "KEYS") names = keypoint_names(sensor.report);
  }
  std::map<std::string, PointRow> rows;
  for (std::size_t row = 0; row < measurement.find("point")->count(); ++row) {
    PointRow& own = rows[names.at(static_cast<std::uint32_t>(measurement.find("point")->number(row)))];
    for (const MeasuredArray& each : measurement.arrays) own[each.name] = each.number(row);
  }
  return rows;
}

std::string named_point(const std::string& name, const std::string& place) {
  return "<part name='" + name + "' insert_at='ROOT' pose_offset='" + place + " 0 0 0'/>";
}

// Width 64 and 90 degrees: the focal length is 32 px. The camera is at the origin and looks along +x.
std::string keys(const std::string& more = "", const std::string& points = "P*") {
  return "<sensor type='keypoints' name='KEYS' insert_at='ROOT' points='" + points +
         "' width='64' height='48' hfov='90' " + more + "/>";
}

Simulation keyed(const std::string& commands) {
  Simulation simulation = Simulation::from_string("<simvis>" + commands + "</simvis>");
  simulation.step();
  return simulation;
}

// Projections are some ten roundings of double, in pixels of at most a hundred.
constexpr double kProjection_px = 1e-12;

TEST_CASE("a point is where the pinhole projects it, and has the place of its insertion point") {
  const Simulation simulation = keyed(named_point("P", "2 0.5 -0.25") + keys());
  const PointRow row = point_rows(simulation).at("P");
  // x right is -y of the sensor, y down is -z: 32 - 32 * 0.5 / 2, 24 + 32 * 0.25 / 2.
  CHECK(std::abs(row.at("x_px") - 24) < kProjection_px);
  CHECK(std::abs(row.at("y_px") - 28) < kProjection_px);
  CHECK(row.at("in_picture") == 1);
  CHECK(row.at("visible") == 1);
  CHECK(std::abs(row.at("distance_m") - std::sqrt(4 + 0.25 + 0.0625)) < 1e-15);
  CHECK(row.at("x_m") == 2);
  CHECK(row.at("y_m") == 0.5);
  CHECK(row.at("z_m") == -0.25);
  const Measurement measurement = simulation.measurement("KEYS");
  REQUIRE(measurement.calibration("") != nullptr);
  CHECK(measurement.calibration("")->width_px == 64);
  CHECK(measurement.calibration("")->pinhole.fx_px == doctest::Approx(32).epsilon(1e-15));
}

TEST_CASE("points beyond the edges, behind the camera and nearer than near are not seen") {
  // At 1 m the picture ends 1 m to the right and 0.75 m below.
  const auto rows = point_rows(keyed(named_point("P_IN", "1 -0.999 0") + named_point("P_OUT", "1 -1.001 0") +
                                     named_point("P_BELOW", "1 0 -0.751") + named_point("P_BEHIND", "-1 0 0") +
                                     named_point("P_NEAR", "0.04 0 0") + named_point("P_AT", "0 0 0") + keys()));
  REQUIRE(rows.size() == 6);
  CHECK(rows.at("P_IN").at("in_picture") == 1);
  CHECK(rows.at("P_IN").at("visible") == 1);
  CHECK(rows.at("P_OUT").at("in_picture") == 0);
  CHECK(rows.at("P_OUT").at("visible") == 0);
  CHECK(std::abs(rows.at("P_OUT").at("x_px") - (32 + 32 * 1.001)) < kProjection_px);
  CHECK(rows.at("P_BELOW").at("in_picture") == 0);
  for (const char* const nowhere : {"P_BEHIND", "P_AT"}) {
    CHECK(std::isnan(rows.at(nowhere).at("x_px")));
    CHECK(rows.at(nowhere).at("in_picture") == 0);
  }
  CHECK(rows.at("P_BEHIND").at("distance_m") == 1);
  CHECK(rows.at("P_NEAR").at("in_picture") == 1);
  CHECK(rows.at("P_NEAR").at("visible") == 0);
}

TEST_CASE("what stands before a point hides it, but for its own surface and glass") {
  const std::string box = "<part name='BOX' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='2.5 0 0 0 0 0'/>";
  const auto visible = [&](const std::string& place, const std::string& more = "", const std::string& scene = "") {
    return point_rows(keyed(box + scene + named_point("P", place) + keys(more))).at("P").at("visible") == 1;
  };
  CHECK(visible("2 0.2 0.2"));        // on the face towards the camera
  CHECK_FALSE(visible("3 0.2 0.2"));  // on the face behind
  CHECK(visible("2.005 0.2 0.2"));    // below the surface, by less than the radius
  CHECK_FALSE(visible("2.02 0.2 0.2"));
  CHECK(visible("2.02 0.2 0.2", "radius='0.05'"));
  CHECK(visible("3 1.5 0"));  // beside the box
  const std::string pane = "<part name='PANE' insert_at='ROOT' shape='box' size='0.01 1 1' pose_offset='1 0 0 0 0 0'/>";
  CHECK_FALSE(visible("2 0 0", "", pane));
  CHECK(visible("2 0 0", "", pane + "<element type='material' name='M' insert_at='ROOT' part='PANE' opacity='0.2'/>"));
}

TEST_CASE("rows are those of the points that match, in the order of names, whatever is visible") {
  Simulation simulation = keyed(
      "<part name='HOLDER' insert_at='ROOT'/><element type='visibility' name='OFF' insert_at='HOLDER'/>"
      "<part name='P_B' insert_at='HOLDER' pose_offset='2 0 0 0 0 0'/>" +
      named_point("P_C", "2 0 0") + named_point("P_A", "2 0 0") + named_point("Q", "2 0 0") + keys());
  const auto numbers = [&] {
    const Measurement measurement = simulation.measurement("KEYS");
    std::vector<double> all;
    for (std::size_t i = 0; i < measurement.find("point")->count(); ++i)
      all.push_back(measurement.find("point")->number(i));
    return all;
  };
  CHECK(numbers() == std::vector<double>{0, 1, 2});
  const auto rows = point_rows(simulation);
  CHECK(rows.size() == 3);
  for (const char* const name : {"P_A", "P_B", "P_C"}) CHECK(rows.contains(name));
  simulation.set("OFF", "visible", 0);
  simulation.step();
  CHECK(numbers() == std::vector<double>{0, 1, 2});  // a point shows nothing that could be hidden
}

// By how much the mean of a ball's pixels may differ from the place of its centre. The ends of a row of these pixels
// cut fractions of pixels off the chord. Each is uniform, so the middle of a row varies by sqrt(1/24) px, and the mean
// of eight rows and more by sqrt(1/24/8) = 0.072 px; four times that is exceeded once in 16,000. And the outline of a
// ball of the angular radius a at the angle t from the axis has its own middle f tan(t) sin(a)^2 farther out, 0.04 px
// of the balls here; a fisheye's is as small, a^2/8 f (cot(t) - t / sin(t)^2).
constexpr double kBallMiddle_px = 4 * 0.072 + 0.04;
constexpr double kEightRows_px = 50;  // the pixels of a disc that has eight rows

// The pixel that shows the middle of a small ball: the mean of those that show the ball.
glm::dvec2 middle_of_ball(const Simulation& simulation) {
  std::uint32_t ball = 0;
  for (const SceneItem& item : simulation.items()) ball = item.part == "BALL" ? item.instance : ball;
  glm::dvec2 sum(0);
  double count = 0;
  const Measurement measurement = simulation.measurement("CAM");
  const MeasuredArray& pixels = *measurement.find("instance");
  for (std::size_t i = 0; i < pixels.count(); ++i) {
    if (pixels.number(i) != ball) continue;
    sum += glm::dvec2(static_cast<double>(i % pixels.shape.columns) + 0.5,
                      static_cast<double>(i / pixels.shape.columns) + 0.5);
    ++count;
  }
  REQUIRE(count > kEightRows_px);
  return sum / count;
}

TEST_CASE("with a lens, a point is where the camera shows it") {
  struct Case {
    std::string lens, place, radius;
  };
  for (const Case& each :
       {Case{"hfov='60' distortion='brown_conrady' k1='-0.2' k2='0.05' p1='0.01'", "3 0.9 0.6", "0.06"},
        Case{"distortion='kannala_brandt' fx='90' k1='0.02'", "0.6 2.4 1.6", "0.15"}}) {
    CAPTURE(each.lens);
    const std::string shared = "insert_at='ROOT' width='320' height='240' " + each.lens;
    const Simulation simulation =
        keyed("<part name='BALL' insert_at='ROOT' shape='sphere' radius='" + each.radius + "' pose_offset='" +
              each.place + " 0 0 0'/><sensor type='camera' name='CAM' outputs='instance' " + shared +
              "/><sensor type='keypoints' name='KEYS' points='BALL' radius='0.2' " + shared + "/>");
    const PointRow row = point_rows(simulation).at("BALL");
    const glm::dvec2 middle = middle_of_ball(simulation);
    CHECK(std::abs(row.at("x_px") - middle.x) < kBallMiddle_px);
    CHECK(std::abs(row.at("y_px") - middle.y) < kBallMiddle_px);
    CHECK(row.at("visible") == 1);
    const Measurement camera = simulation.measurement("CAM"), own = simulation.measurement("KEYS");
    CHECK(own.calibration("")->distortion_model == camera.calibration("")->distortion_model);
    CHECK(own.calibration("")->distortion_coefficients == camera.calibration("")->distortion_coefficients);
  }
}

// Rows of 1 ms, each for itself; 48 of them. The frames are 0.1 s apart.
const std::string kShutter = "row_time='0.001' rows_per_pose='1'";

Simulation late_simulation(const std::string& commands) {
  SimulationDesc desc;
  desc.rate_hz = 10;
  return Simulation::from_string("<simvis>" + commands + "</simvis>", desc);
}

TEST_CASE("with a rolling shutter, a point is where it is when its row is exposed") {
  // The point moves to the left, +y, by 1 m/s at 2 m: 16 px/s. It is in row 24, 23 ms before the last row.
  const std::string moving =
      "<part name='HOLDER' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='HOLDER'/>"
      "<part name='P' insert_at='HOLDER' pose_offset='2 0 0 0 0 0'/>";
  Simulation simulation = late_simulation(moving + keys(kShutter));
  simulation.step();
  CHECK(std::abs(point_rows(simulation).at("P").at("x_px") - 32) < kProjection_px);  // at rest at first
  simulation.set("MOVE", "y", 0.1);
  simulation.step();
  const PointRow row = point_rows(simulation).at("P");
  CHECK(std::abs(row.at("y_m") - (0.1 - 0.023)) < 1e-12);
  CHECK(std::abs(row.at("x_px") - (32 - 16 * (0.1 - 0.023))) < 1e-10);
  CHECK(row.at("visible") == 1);
}

TEST_CASE("with a rolling shutter, a camera that turns shows the point where the sensor says, and sees what hides it") {
  const std::string shared = "insert_at='HEAD' width='320' height='240' hfov='60' row_time='0.0003' rows_per_pose='1'";
  const std::string scene =
      "<part name='HEAD' insert_at='ROOT'/><element type='pose' name='TURN' insert_at='HEAD'/>"
      "<part name='BALL' insert_at='ROOT' shape='sphere' radius='0.05' pose_offset='3 0 0.7 0 0 0'/>"
      "<part name='SLIDE' insert_at='ROOT'/><element type='pose' name='SLIDE_POSE' insert_at='SLIDE'/>"
      "<part name='SCREEN' insert_at='SLIDE' shape='box' size='0.02 0.4 4' pose_offset='1.5 -0.5 0 0 0 0'/>"
      "<sensor type='camera' name='CAM' outputs='instance' " +
      shared + "/><sensor type='keypoints' name='KEYS' points='BALL' radius='0.06' " + shared + "/>";
  Simulation simulation = late_simulation(scene);
  simulation.step();
  simulation.set("TURN", "yaw", 6);
  simulation.step();
  const PointRow row = point_rows(simulation).at("BALL");
  const glm::dvec2 middle = middle_of_ball(simulation);
  CHECK(std::abs(row.at("x_px") - middle.x) < kBallMiddle_px);
  CHECK(std::abs(row.at("y_px") - middle.y) < kBallMiddle_px);
  CHECK(row.at("visible") == 1);
  // The row of the ball is exposed some 60 ms before the frame. By then the screen has gone two fifths of its way, and
  // stands before the ball; at the time of the frame it has left it.
  Simulation hidden = late_simulation(scene);
  hidden.set("SLIDE_POSE", "y", 0.1);
  hidden.step();
  hidden.set("SLIDE_POSE", "y", 1.1);
  hidden.step();
  CHECK(point_rows(hidden).at("BALL").at("visible") == 0);
  Simulation gone = late_simulation(scene);
  gone.set("SLIDE_POSE", "y", 1.1);
  gone.step();
  gone.step();
  CHECK(point_rows(gone).at("BALL").at("visible") == 1);
}

TEST_CASE("a frame after a skipped one gives the bytes that it has after a measured one") {
  const std::string scene =
      "<part name='HOLDER' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='HOLDER'/>"
      "<part name='P' insert_at='HOLDER' pose_offset='2 0 0 0 0 0'/>" +
      keys(kShutter);
  const auto last = [&](bool skips) {
    Simulation simulation = late_simulation(scene);
    skips ? simulation.skip_frame() : static_cast<void>(simulation.step());
    simulation.set("MOVE", "y", 0.1);
    simulation.set("MOVE", "yaw", 20);
    simulation.step();
    return point_rows(simulation).at("P");
  };
  const PointRow after_measured = last(false);
  CHECK(std::abs(after_measured.at("y_m")) > 0.1);
  CHECK(last(true) == after_measured);
}

// Points that go against the rows are at the heights of late rows early: from row to wanted row one would jump across
// the row that meets them.
TEST_CASE("the search for rows finds those that meet a point, or that none does") {
  constexpr std::size_t kRows = 10;
  CameraMoment moment{.time_ns = 0, .scene = nullptr, .rows = {}};
  for (std::uint32_t row = 0; row < kRows; ++row) moment.rows.push_back({.first = row, .count = 1});
  std::size_t met = 0, missed = 0;
  for (double at_begin = -3; at_begin < 13; at_begin += 0.25) {
    for (double rows_per_row = -3; rows_per_row < 0.9; rows_per_row += 0.125) {
      // The heights of a point when the rows are taken: it is before them first and behind them later, once.
      const auto height = [&](std::size_t row) { return at_begin + rows_per_row * static_cast<double>(row); };
      std::vector<std::size_t> wanted;
      for (std::size_t row = 0; row < kRows; ++row) {
        if (std::clamp(std::floor(height(row)), 0.0, kRows - 1.0) == static_cast<double>(row)) wanted.push_back(row);
      }
      for (std::size_t begin = 0; begin < kRows; ++begin) {
        CAPTURE(at_begin);
        CAPTURE(rows_per_row);
        CAPTURE(begin);
        RowSearch search(moment, begin);
        while (search.next(height(search.rows()))) {
        }
        CHECK(search.is_met() == !wanted.empty());
        if (search.is_met()) CHECK(std::ranges::find(wanted, search.rows()) != wanted.end());
        ++(search.is_met() ? met : missed);
      }
    }
  }
  CHECK(met > 1000);
  CHECK(missed > 1000);
}

}  // namespace
}  // namespace simvis
