// Events of a moving edge and of a turning half plane against their formulas, and what costs nothing.
#include "sensors/event_camera/event_camera.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/simulation.h>
#include "sensors/event_camera/visible_faces.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// What the sensor promises at its defaults.
constexpr double kPromised_s = 1e-6;
// A plate of this luminance before a sky of luminance 1, and the sensor's defaults.
constexpr double kPlate = 5, kSky = 1, kDark = 1e-3, kThreshold = 0.2;
constexpr double kFrame_s = 1.0 / 15;
constexpr std::uint32_t kColumns = 16, kRows = 6;
constexpr double kFocal_px = kColumns / 2.0;  // of 90 degrees

struct Event {
  double time_s;
  bool on;
};
using EventsByPixel = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Event>>;  // column, row

// A plate that sends light by itself; its front stands at x = 2.
std::string plate_scene(const std::string& size, const std::string& offset, const std::string& camera) {
  return R"(<simvis><element type="sky" name="SKY" insert_at="ROOT" red="1" green="1" blue="1"/>
    <part name="CARRIER" insert_at="ROOT"/><element type="pose" name="MOVE" insert_at="CARRIER"/>
    <part name="PLATE" shape="box" size=")" +
         size + R"(" insert_at="CARRIER" pose_offset=")" + offset + R"("/>
    <element type="material" name="M" insert_at="ROOT" part="PLATE" red="0" green="0" blue="0" emission_red="5"
             emission_green="5" emission_blue="5"/>
    <sensor type="event_camera" name="E" insert_at="ROOT" hfov="90" width="16" height="6" )" +
         camera + "/></simvis>";
}

void add_events(Simulation& simulation, EventsByPixel& events) {
  const Reading& reading = simulation.reading("E");
  double before_s = 0;
  for (std::size_t row = 0; row < reading.rows(); ++row) {
    const double time_s = *reading.find("time_s", row);
    REQUIRE(time_s >= before_s);
    before_s = time_s;
    REQUIRE(*reading.find("t_us", row) == std::floor(time_s * 1e6 + 1e-6));
    const auto column = static_cast<std::uint32_t>(*reading.find("x", row)),
               line = static_cast<std::uint32_t>(*reading.find("y", row));
    events[{column, line}].push_back({time_s, *reading.find("polarity", row) == 1});
  }
}

/// Drives the plate through values of a parameter, one for each frame.
EventsByPixel events_of(const std::string& scene, const std::string& parameter, const std::vector<double>& values) {
  Simulation simulation = Simulation::from_string(scene);
  EventsByPixel events;
  for (const double value : values) {
    simulation.set("MOVE", parameter, value);
    simulation.step();
    add_events(simulation, events);
  }
  return events;
}

double covered(double light) { return (light - kSky) / (kPlate - kSky); }

/// The largest error of a time. The numbers of events and their polarities must be those expected.
double largest_error_s(const EventsByPixel& events, const EventsByPixel& expected) {
  REQUIRE(events.size() == expected.size());
  double largest_s = 0;
  for (const auto& [pixel, all] : expected) {
    CAPTURE(pixel.first);
    CAPTURE(pixel.second);
    REQUIRE(events.contains(pixel));
    const std::vector<Event>& found = events.at(pixel);
    REQUIRE(found.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      REQUIRE(found[i].on == all[i].on);
      largest_s = std::max(largest_s, std::abs(found[i].time_s - all[i].time_s));
    }
  }
  return largest_s;
}

// The plate covers what lies left of its right edge, which moves from column 8.4 to the right by 2.36 columns a frame.
// With y < 0 the edge is that of the front.
constexpr double kEdge_m = -0.1, kWay_m = -0.59;
const std::vector<double> kEdgeWay = {kEdge_m, kEdge_m + kWay_m, kEdge_m + 2 * kWay_m, kEdge_m + 3 * kWay_m};

std::string edge_scene(const std::string& camera = "") { return plate_scene("0.5 4 40", "2.25 2 0 0 0 0", camera); }

EventsByPixel edge_events() {
  const double begin_px = kColumns / 2.0 - kFocal_px * kEdge_m / 2, speed_px = -kFocal_px * kWay_m / 2 / kFrame_s;
  const double end_px = begin_px + 3 * speed_px * kFrame_s;
  EventsByPixel events;
  for (std::uint32_t column = 0; column < kColumns; ++column) {
    const double first = std::clamp(begin_px - column, 0.0, 1.0), last = std::clamp(end_px - column, 0.0, 1.0);
    // References begin at the light of the first frame.
    const double start = kSky + first * (kPlate - kSky);
    for (int k = 1;; ++k) {
      const double share = covered((start + kDark) * std::exp(kThreshold * k) - kDark);
      if (share > last) break;
      for (std::uint32_t row = 0; row < kRows; ++row) {
        events[{column, row}].push_back({(column + share - begin_px) / speed_px, true});
      }
    }
  }
  return events;
}

/// Area of the square from -1/2 to 1/2 where a x + b y <= d.
double half_plane_area(double a, double b, double d) {
  a = std::abs(a);
  b = std::abs(b);
  const auto corner = [&](double at) { return at > 0 ? at * at : 0; };
  if (std::min(a, b) < 1e-12) return std::clamp(d / std::max(a, b) + 0.5, 0.0, 1.0);
  return (corner(d + (a + b) / 2) - corner(d + (a - b) / 2) - corner(d - (a - b) / 2) + corner(d - (a + b) / 2)) /
         (2 * a * b);
}

// The plate covers a half plane whose edge goes through the axis. It turns by 24 degrees a frame, from 10 degrees on.
constexpr double kTurn_deg = 24, kStart_deg = 10;
const std::vector<double> kTurnWay = {kStart_deg, kStart_deg + kTurn_deg, kStart_deg + 2 * kTurn_deg,
                                      kStart_deg + 3 * kTurn_deg};

std::string turning_scene(const std::string& camera = "") {
  return plate_scene("0.5 40 80", "2.25 20 0 0 0 0", camera);
}

/// Share of the pixel that the plate covers. Rolled by r it covers y cos r + z sin r >= 0, with x in the image -y and y
/// in the image -z.
double turned_area(std::uint32_t column, std::uint32_t row, double roll_deg) {
  const double roll = glm::radians(roll_deg), a = std::cos(roll), b = std::sin(roll);
  const double x = column + 0.5 - kColumns / 2.0, y = row + 0.5 - kRows / 2.0;
  return half_plane_area(a, b, -(a * x + b * y));
}

EventsByPixel turning_events() {
  EventsByPixel events;
  for (std::uint32_t column = 0; column < kColumns; ++column) {
    for (std::uint32_t row = 0; row < kRows; ++row) {
      const auto light = [&](double frames) {
        return kSky + (kPlate - kSky) * turned_area(column, row, kStart_deg + kTurn_deg * frames);
      };
      // The edge passes each pixel once, so that its light rises or falls only.
      const double start = light(0), last = light(3);
      const bool is_on = last > start;
      for (int k = 1;; ++k) {
        const double at = (start + kDark) * std::exp(kThreshold * (is_on ? k : -k)) - kDark;
        if (is_on ? at > last : at < last) break;
        double low = 0, high = 3;
        for (int i = 0; i < 60; ++i) {
          const double middle = (low + high) / 2;
          ((light(middle) < at) == is_on ? low : high) = middle;
        }
        events[{column, row}].push_back({low * kFrame_s, is_on});
      }
    }
  }
  return events;
}

TEST_CASE("the events of a moving edge come when the formula says") {
  const EventsByPixel events = events_of(edge_scene(), "y", kEdgeWay), expected = edge_events();
  CHECK(expected.at({10, 2}).size() == 8);  // ln 5 / 0.2
  const double error_s = largest_error_s(events, expected);
  MESSAGE("moving edge: largest error " << error_s * 1e6 << " us");
  CHECK(error_s < kPromised_s);
  const EventsByPixel half = events_of(edge_scene("step='0.125' time_error='2.5e-7'"), "y", kEdgeWay);
  CHECK(largest_error_s(half, events) < kPromised_s);
}

TEST_CASE("the events of a turning half plane come when the formula says") {
  const EventsByPixel events = events_of(turning_scene(), "roll", kTurnWay), expected = turning_events();
  std::size_t on = 0, off = 0;
  for (const auto& [pixel, all] : expected) (all.front().on ? on : off) += all.size();
  CHECK(on > 100);
  CHECK(off > 100);
  const double error_s = largest_error_s(events, expected);
  MESSAGE("turning half plane: largest error " << error_s * 1e6 << " us, " << on + off << " events");
  CHECK(error_s < kPromised_s);
  const EventsByPixel half = events_of(turning_scene("step='0.125'"), "roll", kTurnWay);
  CHECK(largest_error_s(half, events) < kPromised_s);
}

TEST_CASE("a camera that turns sees the events of a scene that turns the other way") {
  std::string scene = turning_scene();
  const std::string of_root = R"(name="E" insert_at="ROOT")";
  const std::size_t at = scene.find(of_root);
  REQUIRE(at != scene.npos);
  // The plate stays, and the camera stands on the part that turns.
  scene.replace(at, of_root.size(), R"(name="E" insert_at="CARRIER")");
  const std::string on_carrier = R"(insert_at="CARRIER" pose_offset)";
  scene.replace(scene.find(on_carrier), on_carrier.size(), R"(insert_at="ROOT" pose_offset)");
  std::vector<double> back = kTurnWay;
  for (double& angle : back) angle = -angle;
  CHECK(largest_error_s(events_of(scene, "roll", back), turning_events()) < kPromised_s);
}

// A small square of this luminance, as wide as 0.04 columns, that moves by 1.9 columns and rows a frame. It moves along
// the diagonals of pixels, a quarter of its width beside their corners.
constexpr double kSpark = 2000, kSparkHalf_px = 0.02, kSparkAside_px = 0.01, kSparkSpeed_px = 1.9;
constexpr double kOffThreshold = 0.23;
// y and z of the square for the columns and rows to its right and below; a column is 0.25 m wide at x = 2.
constexpr double kColumn_m = 2 / kFocal_px;

std::string spark_scene() {
  // So thin that its front and its back are seen within 2e-6 columns of x = 2, which it passes in 0.1 us.
  std::string scene = plate_scene("1e-6 0.01 0.01", "2 0 0 0 0 0", "threshold_off=\"0.23\"");
  const std::string plate = "=\"5\"", spark = "=\"2000\"";
  for (std::size_t at = scene.find(plate); at != scene.npos; at = scene.find(plate, at)) {
    scene.replace(at, plate.size(), spark);
  }
  return scene;
}

/// The events of a light that begins at its reference.
std::vector<Event> events_of_light(const std::function<double(double)>& light, double end_s) {
  constexpr double kStep_s = 1e-5;  // in which the spark moves by 0.0003 columns
  std::vector<Event> events;
  double level = std::log(light(0) + kDark), before_s = 0;
  const auto logarithm = [&](double time_s) { return std::log(light(time_s) + kDark); };
  while (before_s < end_s) {
    const double now_s = std::min(before_s + kStep_s, end_s), now = logarithm(now_s);
    while (now >= level + kThreshold || now <= level - kOffThreshold) {
      const bool is_on = now > level;
      level += is_on ? kThreshold : -kOffThreshold;
      double low = before_s, high = now_s;
      for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        ((logarithm(middle) < level) == is_on ? low : high) = middle;
      }
      events.push_back({low, is_on});
    }
    before_s = now_s;
  }
  return events;
}

TEST_CASE("the corner of a small thing that comes into a pixel between two samples is not missed") {
  const double start_px[] = {3.5, 0.5 + kSparkAside_px};
  std::vector<std::pair<double, double>> way;  // y and z of each frame
  for (int frame = 0; frame < 4; ++frame) {
    const double moved_px = frame * kSparkSpeed_px;
    way.emplace_back(kColumn_m * (kColumns / 2.0 - start_px[0] - moved_px),
                     kColumn_m * (kRows / 2.0 - start_px[1] - moved_px));
  }
  EventsByPixel expected;
  std::size_t clipped = 0;
  for (std::uint32_t column = 0; column < kColumns; ++column) {
    for (std::uint32_t row = 0; row < kRows; ++row) {
      const auto light = [&](double time_s) {
        const double moved_px = kSparkSpeed_px * time_s / kFrame_s;
        const auto overlap = [&](double centre_px, double pixel) {
          return std::max(0.0,
                          std::min(centre_px + kSparkHalf_px, pixel + 1) - std::max(centre_px - kSparkHalf_px, pixel));
        };
        return kSky + (kSpark - kSky) * overlap(start_px[0] + moved_px, column) * overlap(start_px[1] + moved_px, row);
      };
      std::vector<Event> events = events_of_light(light, 3 * kFrame_s);
      if (events.empty()) continue;
      clipped += column != row + 3;
      expected[{column, row}] = std::move(events);
    }
  }
  CHECK(clipped == 11);  // beside six corners, one of them at the lower end of the image
  Simulation simulation = Simulation::from_string(spark_scene());
  EventsByPixel events;
  for (const auto& [y, z] : way) {
    simulation.set("MOVE", "y", y);
    simulation.set("MOVE", "z", z);
    simulation.step();
    add_events(simulation, events);
  }
  const double error_s = largest_error_s(events, expected);
  MESSAGE("small square: largest error " << error_s * 1e6 << " us in " << clipped << " clipped pixels");
  CHECK(error_s < kPromised_s);
}

/// How often the light of a pixel was computed in the last frame.
std::uint64_t samples_of(const Simulation& simulation) {
  for (const SensorInfo& sensor : simulation.sensors()) {
    for (const SensorNote& note : sensor.report.notes) {
      if (note.name == "light_samples") return std::get<std::uint64_t>(note.value);
    }
  }
  FAIL("the sensor does not report its samples");
  return 0;
}

TEST_CASE("only pixels in which something moves are sampled, and the plan says so") {
  Simulation simulation = Simulation::from_string(edge_scene());
  simulation.set("MOVE", "y", kEdge_m);
  simulation.step();
  CHECK(samples_of(simulation) == kColumns * kRows);  // the first light
  simulation.step();
  CHECK(samples_of(simulation) == 0);
  CHECK(simulation.diagnostics().frame_plan().casts.empty());
  simulation.set("MOVE", "y", kEdge_m - 0.01);
  simulation.step();
  CHECK(samples_of(simulation) > 0);
  REQUIRE(simulation.diagnostics().frame_plan().casts.size() == 1);
  CHECK(simulation.diagnostics().frame_plan().casts[0].reason.find("pixels in which something moves") !=
        std::string::npos);
}

/// The largest error of times that are interpolated in the logarithm of the light between pictures, as ESIM does, of
/// the moving edge in the columns that it passes as a whole.
double error_of_pictures_s(double rate_hz) {
  const double speed_px = -kFocal_px * kWay_m / 2 / kFrame_s, begin_px = kColumns / 2.0 - kFocal_px * kEdge_m / 2;
  double largest_s = 0;
  for (std::uint32_t column = 9; column < 15; ++column) {
    const auto logarithm = [&](double picture) {
      const double covers = std::clamp(begin_px + speed_px * picture / rate_hz - column, 0.0, 1.0);
      return std::log(kSky + covers * (kPlate - kSky) + kDark);
    };
    double picture = 0;
    for (int k = 1; k <= 8; ++k) {
      const double level = std::log(kSky + kDark) + kThreshold * k;
      while (logarithm(picture + 1) < level) ++picture;
      const double before = logarithm(picture), after = logarithm(picture + 1);
      const double found_s = (picture + (level - before) / (after - before)) / rate_hz;
      const double true_s = (column + covered(std::exp(level) - kDark) - begin_px) / speed_px;
      largest_s = std::max(largest_s, std::abs(found_s - true_s));
    }
  }
  return largest_s;
}

TEST_CASE("exact times cost less than pictures at 1 kHz, which are off by a hundred times as much") {
  Simulation simulation = Simulation::from_string(edge_scene());
  std::uint64_t samples = 0;
  for (std::size_t frame = 0; frame < kEdgeWay.size(); ++frame) {
    simulation.set("MOVE", "y", kEdgeWay[frame]);
    simulation.step();
    if (frame > 0) samples += samples_of(simulation);
  }
  const double of_pictures = 3 * kFrame_s * 1000 * kColumns * kRows, error_s = error_of_pictures_s(1000);
  double rate_hz = 1000;
  while (error_of_pictures_s(rate_hz) > kPromised_s) rate_hz *= 1.1;
  MESSAGE("light of pixels computed: " << samples << "; by pictures at 1 kHz " << of_pictures << ", with errors of "
                                       << error_s * 1e6 << " us; for 1 us at " << rate_hz << " Hz "
                                       << of_pictures * rate_hz / 1000);
  CHECK(static_cast<double>(samples) < of_pictures);
  CHECK(error_s > 100 * kPromised_s);
}

TEST_CASE("what changes otherwise than by a move changes at the last measurement") {
  Simulation simulation = Simulation::from_string(edge_scene());
  simulation.set("MOVE", "y", kEdge_m);
  for (int frame = 0; frame < 2; ++frame) simulation.step();
  for (const char* const color : {"emission_red", "emission_green", "emission_blue"}) simulation.set("M", color, 2.4);
  simulation.step();
  EventsByPixel events;
  add_events(simulation, events);
  REQUIRE(events.contains({3, 3}));
  CHECK_FALSE(events.contains({12, 3}));
  CHECK(events.at({3, 3}).size() == 3);  // ln(5.001 / 2.401) / 0.2 = 3.67
  for (const Event& event : events.at({3, 3})) {
    CHECK_FALSE(event.on);
    CHECK(event.time_s == doctest::Approx(kFrame_s).epsilon(1e-8));
  }
}

TEST_CASE("a picture shows the last polarity of each pixel") {
  Simulation simulation = Simulation::from_string(edge_scene("picture='on'"));
  simulation.set("MOVE", "y", kEdge_m);
  simulation.step();
  simulation.set("MOVE", "y", kEdge_m + kWay_m);
  simulation.step();
  const Image picture = to_image(*simulation.measurement("E").find("picture")).value();
  REQUIRE(picture.width == kColumns);
  REQUIRE(picture.height == kRows);
  const auto color = [&](std::uint32_t column) {
    const float* const at = picture.pixels.data() + 4 * (std::size_t{2} * kColumns + column);
    return glm::vec3(at[0], at[1], at[2]);
  };
  CHECK(color(9) == glm::vec3(1, 0, 0));
  CHECK(color(2) == glm::vec3(0.5f));
  CHECK(color(14) == glm::vec3(0.5f));
}

TEST_CASE("areas of triangles that hide and penetrate each other are those of their polygons") {
  const Pinhole pinhole{.fx_px = 1, .fy_px = 1, .cx_px = 0.5, .cy_px = 0.5};
  VisibleFaces faces;
  const auto areas = [&] {
    std::map<std::uint32_t, double> all;
    for (const VisibleFace& face : faces.find()) all[face.triangle] = face.area;
    return all;
  };
  // A wall at z = 2 that covers the square, and one at z = 1 with its edge at x = 0.2. Clockwise in x and y: fronts.
  const auto wall = [](double z, double from_x) {
    return std::array<glm::dvec3, 3>{glm::dvec3(from_x * z, -9 * z, z), {from_x * z, 9 * z, z}, {20 * z, 0, z}};
  };
  faces.begin(pinhole, 0.1, 0, 0);
  faces.add(1, wall(2, -5), false);
  faces.add(2, wall(1, 0.2), false);
  CHECK(areas().at(1) == doctest::Approx(0.7).epsilon(1e-12));
  CHECK(areas().at(2) == doctest::Approx(0.3).epsilon(1e-12));
  // A slanted wall z = 2 + x z' with z = 1 / (0.5 - 0.4 x): it is before the wall at z = 2 where x < 0.
  faces.begin(pinhole, 0.1, 0, 0);
  faces.add(1, wall(2, -5), false);
  const auto slanted = [](double x, double y) { return glm::dvec3(x, y, 1) / (0.5 - 0.4 * x); };
  faces.add(2, {slanted(-0.7, -3), slanted(-0.7, 3), slanted(1.1, 0)}, false);
  CHECK(areas().at(2) == doctest::Approx(0.5).epsilon(1e-12));
  CHECK(areas().at(1) == doctest::Approx(0.5).epsilon(1e-12));
  // Back faces are seen of double-sided surfaces only, and nothing before near.
  faces.begin(pinhole, 0.1, 0, 0);
  std::array<glm::dvec3, 3> back = wall(1, -5);
  std::swap(back[0], back[1]);
  faces.add(1, back, false);
  CHECK(areas().empty());
  faces.add(1, back, true);
  CHECK(areas().at(1) == doctest::Approx(1).epsilon(1e-12));
  faces.begin(pinhole, 1.5, 0, 0);
  faces.add(1, wall(1, -5), false);
  CHECK(areas().empty());
}

TEST_CASE("too many pixels and thresholds of 0 are errors at their attributes") {
  const auto error = [](const std::string& attributes) {
    return error_of([&] {
      Simulation::from_string("<simvis><sensor type='event_camera' name='E' insert_at='ROOT' " + attributes +
                              "/></simvis>");
    });
  };
  CHECK(error("width='16384' height='16384'").find("too many pixels") != std::string::npos);
  CHECK(error("threshold_on='0'").find("threshold_on") != std::string::npos);
  CHECK(error("step='nan'").find("step") != std::string::npos);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
