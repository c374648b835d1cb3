// Receivers of satellite navigation in scenes: satellites that walls hide and reflect, fixes, jammers.
#include <doctest/doctest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <fstream>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "sensors/navigation/position_fix.h"
#include "sensors/navigation/satellite_signals.h"
#include "sensors/navigation/satellites.h"
#include "simvis/built_scene.h"
#include "tests/sensors/sky_point.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

using test::SkyPoint;

std::vector<SkyPoint> even_sky() {
  std::vector<SkyPoint> sky;
  for (int elevation = 7; elevation < 90; elevation += 6) {
    for (int azimuth = 3; azimuth < 360; azimuth += 10) sky.push_back({double(azimuth), double(elevation)});
  }
  return sky;
}

std::string list_of(const std::vector<SkyPoint>& sky) {
  std::string text;
  for (const SkyPoint& each : sky) {
    text += std::to_string(each.azimuth_deg) + ":" + std::to_string(each.elevation_deg) + " ";
  }
  return text;
}

// A street along x with houses on both sides, and a receiver 2 m above the road in its middle.
constexpr double kHalfWidth_m = 8, kRoof_m = 12, kReceiver_m = 2, kAbove_m = kRoof_m - kReceiver_m;
const std::string
    kHouse = " insert_at='ROOT' shape='box' size='2000 6 12' pose_offset='0 ",
    kNorth = "<part name='NORTH'" + kHouse + "11 6 0 0 0'/>", kSouth = "<part name='SOUTH'" + kHouse + "-11 6 0 0 0'/>",
    kRoad = "<part name='ROAD' insert_at='ROOT' shape='box' size='2000 2000 1' pose_offset='0 0 -0.5 0 0 0'/>";

Simulation in_street(const std::string& sensors, const std::string& houses = kNorth + kSouth) {
  return Simulation::from_string("<s>" + kRoad + houses + "<part name='CAR' insert_at='ROOT'/>" +
                                 "<element type='pose' name='MOVE' insert_at='CAR' z='2'/>" + sensors + "</s>");
}

std::string sky_sensor(const std::string& attributes) {
  return "<sensor type='gnss_satellites' name='SKY' insert_at='CAR' " + attributes + "/>";
}

TEST_CASE("the houses of a street hide the satellites that geometry says, whatever way it and the receiver point") {
  const std::vector<SkyPoint> sky = even_sky();
  for (const int heading_deg : {0, 90, 33}) {
    for (const int yaw_deg : {0, 70}) {
      CAPTURE(heading_deg);
      CAPTURE(yaw_deg);
      Simulation simulation =
          in_street(sky_sensor("satellites='" + list_of(sky) + "' heading='" + std::to_string(heading_deg) +
                               "' pose_offset='0 0 0 0 0 " + std::to_string(yaw_deg) + "'"));
      simulation.step();
      const Reading& reading = simulation.reading("SKY");
      REQUIRE(reading.rows() == sky.size());
      std::size_t seen = 0, wrong = 0;
      for (std::size_t row = 0; row < sky.size(); ++row) {
        // The world is turned against north by its heading.
        const glm::dvec3 to = SkyPoint{sky[row].azimuth_deg + heading_deg, sky[row].elevation_deg}.along();
        const bool expected = to.z * kHalfWidth_m > kAbove_m * std::abs(to.y);
        seen += expected;
        wrong += *reading.find("direct", row) != double(expected);
        wrong += *reading.find("used", row) != double(expected);
        wrong += !std::isnan(*reading.find("extra_path_m", row));
      }
      CHECK(wrong == 0);
      CHECK(seen > 50);
      CHECK(sky.size() - seen > 50);
    }
  }
}

TEST_CASE("reflected signals are longer by the path of the image behind the wall, and arrive where geometry says") {
  constexpr double kWall_m = 1e-9;  // of ranges up to 1000 m whose walls are rounded to float32 exactly
  const std::vector<SkyPoint> sky = even_sky();
  for (const bool has_south : {false, true}) {
    CAPTURE(has_south);
    Simulation simulation = in_street(sky_sensor("satellites='" + list_of(sky) + "' reflection='0.5'"),
                                      has_south ? kNorth + kSouth : kNorth);
    simulation.step();
    const Reading& reading = simulation.reading("SKY");
    std::size_t reflected = 0, alone = 0, wrong = 0;
    double largest_m = 0;
    for (std::size_t row = 0; row < sky.size(); ++row) {
      const glm::dvec3 to = sky[row].along();
      const double slope = to.z / std::abs(to.y);  // height for each metre across the street
      // The wall in front of the satellite reflects: that of the north, if it stands in the south.
      const bool has_wall = to.y < 0 || has_south,
                 is_hidden = (to.y > 0 || has_south) && slope * kHalfWidth_m < kAbove_m;
      const bool is_below_roof = slope * kHalfWidth_m < kAbove_m,
                 is_over_other = !has_south || slope * 3 * kHalfWidth_m > kAbove_m;
      const double extra_m = *reading.find("extra_path_m", row), error_m = *reading.find("error_m", row);
      const bool expected = has_wall && is_below_roof && is_over_other;
      wrong += std::isnan(extra_m) == expected;
      wrong += *reading.find("direct", row) != double(!is_hidden);
      wrong += *reading.find("used", row) != double(!is_hidden || expected);
      if (!expected) continue;
      ++reflected;
      const double image_m = 2 * kHalfWidth_m * std::abs(to.y);
      largest_m = std::max(largest_m, std::abs(extra_m - image_m));
      if (is_hidden) {
        ++alone;
        wrong += error_m != extra_m;
      } else {
        wrong += error_m != multipath_error_m(0.5, extra_m);
      }
    }
    CHECK(wrong == 0);
    CHECK(largest_m <= kWall_m);
    CHECK(reflected > 40);
    CHECK((alone > 40) == has_south);
  }
}

TEST_CASE("an antenna receives nothing from below itself") {
  Simulation simulation = in_street(sky_sensor("satellites='90:60 270:60' pose_offset='0 0 0 0 45 0'"));
  simulation.step();
  // Pitched down by 45 degrees towards the east, its axis points 45 degrees up in the east.
  CHECK(simulation.reading("SKY").find("direct", 0) == 1.0);
  CHECK(simulation.reading("SKY").find("direct", 1) == 1.0);
  Simulation turned = in_street(sky_sensor("satellites='90:40 270:40' pose_offset='0 0 0 0 60 0'"));
  turned.step();
  CHECK(turned.reading("SKY").find("direct", 0) == 1.0);
  CHECK(turned.reading("SKY").find("direct", 1) == 0.0);
  CHECK(turned.reading("SKY").find("used", 1) == 0.0);
}

// The discriminator of a receiver with the correlation 1 - |x| of a code, in chips.
double discriminator(double error, double amplitude, double extra) {
  const auto correlation = [](double x) { return std::max(0.0, 1 - std::abs(x)); };
  const auto both = [&](double x) { return correlation(x) + amplitude * correlation(x - extra); };
  return both(error - 0.05) - both(error + 0.05);
}

TEST_CASE("the error by a reflected signal is where the correlators of a receiver are equal") {
  constexpr double kChip_m = 299792458 / 1.023e6, kWave_m = 299792458 / 1575.42e6;
  constexpr double kRounding_m = 1e-9;  // 1e-12 chips: of correlations below 2, over slopes of at least 0.1
  double largest_m = 0;
  int tried = 0;
  for (const double reflection : {0.1, 0.5, 0.9}) {
    for (double extra_m = 0.013; extra_m < 400; extra_m += 0.731, ++tried) {
      const double amplitude = -reflection * std::cos(2 * std::numbers::pi * extra_m / kWave_m);
      double low = -0.06, high = 0.06;
      for (int i = 0; i < 100; ++i) {
        const double middle = (low + high) / 2;
        (discriminator(middle, amplitude, extra_m / kChip_m) > 0 ? high : low) = middle;
      }
      const double error_m = multipath_error_m(reflection, extra_m);
      CAPTURE(extra_m);
      CHECK(std::abs(error_m - low * kChip_m) <= kRounding_m);
      largest_m = std::max(largest_m, std::abs(error_m));
    }
  }
  CHECK(tried > 1000);
  CHECK(largest_m > 0.8 * 0.9 * 0.05 * kChip_m);
}

const std::string kEvenSky = "satellites='0:30 90:30 180:30 270:30 0:90'";

std::string receiver(const std::string& attributes, const std::string& name = "GPS") {
  return "<sensor type='gnss' name='" + name + "' insert_at='CAR' latitude='49.44' longitude='7.75' " + attributes +
         "/>";
}

glm::dvec3 place_of(const Simulation& simulation, const std::string& name) {
  glm::dvec3 place;
  GeographicLib::LocalCartesian(49.44, 7.75, 0)
      .Forward(simulation.value(name, "latitude_deg"), simulation.value(name, "longitude_deg"),
               simulation.value(name, "altitude_m"), place.x, place.y, place.z);
  return place;
}

constexpr double kGeodetic_m = 1e-8;  // as in navigation_test.cpp

TEST_CASE("a fix is off by what walls do to its satellites") {
  // The northern house hides the satellite of the north, and the southern one reflects it.
  const std::vector<SkyPoint> sky = {{0, 30}, {90, 30}, {180, 60}, {270, 30}, {0, 90}};
  const std::string satellites = "satellites='" + list_of(sky) + "'";
  Simulation simulation =
      in_street(receiver(satellites + " reflection='0.5'") + receiver("", "TRUE") + receiver(satellites, "BLOCKED"));
  simulation.step();
  std::vector<Pseudorange> pseudoranges;
  for (const SkyPoint& each : sky) pseudoranges.push_back({each.along(), 0});
  pseudoranges[0].error_m = 2 * kHalfWidth_m * std::cos(glm::radians(30.0));
  const PositionFix expected = fix_position(pseudoranges).value();
  CHECK(glm::length(expected.error_m) > 5);
  CHECK(simulation.value("GPS", "satellites_visible") == 4);
  CHECK(simulation.value("GPS", "satellites_used") == 5);
  CHECK(simulation.value("GPS", "pdop") == doctest::Approx(expected.pdop()).epsilon(1e-12));
  CHECK(simulation.value("GPS", "hdop") == doctest::Approx(expected.hdop()).epsilon(1e-12));
  CHECK(simulation.value("GPS", "vdop") == doctest::Approx(expected.vdop()).epsilon(1e-12));
  const glm::dvec3 place_m(0, 0, kReceiver_m);
  CHECK(glm::distance(place_of(simulation, "TRUE"), place_m) <= kGeodetic_m);
  CHECK(glm::distance(place_of(simulation, "GPS"), place_m + expected.error_m) <= kGeodetic_m);
  // Without its reflection, four satellites are left: the fix is exact, but less certain.
  CHECK(simulation.value("BLOCKED", "satellites_used") == 4);
  CHECK(glm::distance(place_of(simulation, "BLOCKED"), place_m) <= kGeodetic_m);
  CHECK(simulation.value("BLOCKED", "pdop") > simulation.value("GPS", "pdop"));
  CHECK(simulation.value("GPS", "velocity_east_m_s") == 0);
}

bool has_fix(const Simulation& simulation, const std::string& name) {
  const char* const numbers[] = {"latitude_deg",      "longitude_deg",      "altitude_m",
                                 "velocity_east_m_s", "velocity_north_m_s", "velocity_up_m_s"};
  int nans = 0;
  for (const char* const number : numbers) nans += std::isnan(simulation.value(name, number));
  CHECK((nans == 0 || nans == 6));
  return nans == 0;
}

TEST_CASE("there is no fix in a closed box, below the mask, and above the largest dilution") {
  const std::string hall =
      "<part name='HALL' insert_at='ROOT' shape='box' size='20 20 20'/>"
      "<element type='visibility' name='SHOW' insert_at='HALL' visible='1'/>";
  Simulation simulation = in_street(
      receiver(kEvenSky + " reflection='0.5'") + receiver("", "PLAIN") +
          receiver(kEvenSky + " elevation_mask='31'", "M") + receiver(kEvenSky + " elevation_mask='30'", "AT_MASK") +
          receiver(kEvenSky + " max_pdop='2.5'", "WEAK") + receiver(kEvenSky + " max_pdop='2.6'", "GOOD") +
          receiver("satellites='gps'", "NOMINAL"),
      hall);
  simulation.step();
  CHECK(has_fix(simulation, "PLAIN"));
  for (const char* const name : {"GPS", "M", "AT_MASK", "WEAK", "GOOD", "NOMINAL"}) {
    CAPTURE(name);
    CHECK_FALSE(has_fix(simulation, name));
    CHECK(simulation.value(name, "satellites_visible") == 0);
    CHECK(simulation.value(name, "satellites_used") == 0);
    CHECK(std::isnan(simulation.value(name, "pdop")));
  }
  simulation.set("SHOW", "visible", 0);
  simulation.step();
  // The dilution is sqrt(4 / 3 + 5) = 2.517.
  const std::map<std::string, bool> expected = {{"PLAIN", true}, {"GPS", true},  {"M", false},     {"AT_MASK", true},
                                                {"WEAK", false}, {"GOOD", true}, {"NOMINAL", true}};
  for (const auto& each : expected) {
    CAPTURE(each.first);
    CHECK(has_fix(simulation, each.first) == each.second);
  }
  CHECK(simulation.value("M", "satellites_visible") == 1);
  CHECK(simulation.value("WEAK", "satellites_visible") == 5);
  CHECK(simulation.value("WEAK", "satellites_used") == 0);
}

TEST_CASE("a jammer is switched by its parameter and reaches as far as it says") {
  Simulation simulation = in_street(receiver(kEvenSky) + receiver("", "PLAIN") + sky_sensor(kEvenSky) +
                                        "<part name='TRUCK' insert_at='ROOT' pose_offset='30 0 2 0 0 0'/>"
                                        "<element type='gnss_jammer' name='JAM' insert_at='TRUCK' range='0'/>",
                                    "");
  const auto check = [&](bool is_jammed) {
    simulation.step();
    CHECK(has_fix(simulation, "GPS") == !is_jammed);
    CHECK(has_fix(simulation, "PLAIN") == !is_jammed);
    CHECK(simulation.value("GPS", "satellites_visible") == 5);
    CHECK(simulation.value("GPS", "satellites_used") == (is_jammed ? 0 : 5));
    CHECK(simulation.reading("SKY").find("direct", 0) == 1.0);
    CHECK(simulation.reading("SKY").find("used", 0) == (is_jammed ? 0.0 : 1.0));
  };
  check(false);
  simulation.set("JAM", "range", 30.1);
  check(true);
  simulation.set("JAM", "range", 29.9);
  check(false);
  simulation.set("MOVE", "x", 0.2);
  check(true);
  simulation.set("JAM", "range", 0);
  check(false);
  simulation.set("MOVE", "x", 30);
  check(false);
}

TEST_CASE("errors of fixes are as large as their covariance says: chi-square over 400 fixes") {
  SimulationDesc desc;
  desc.rate_hz = 10;
  Simulation simulation = Simulation::from_string(
      "<s><part name='CAR' insert_at='ROOT'/>" +
          receiver("satellites='10:20 80:35 140:60 200:15 290:40 330:75' pseudorange_stddev='2' vertical_stddev='1'") +
          "</s>",
      desc);
  constexpr int kFixes = 400;
  double sum = 0;
  for (int i = 0; i < kFixes; ++i) {
    simulation.step();
    const Reading& reading = simulation.reading("GPS");
    const auto number = [&](const char* name) { return reading.constant(name).value(); };
    const double en = number("east_north_covariance"), eu = number("east_up_covariance"),
                 nu = number("north_up_covariance");
    const glm::dmat3 covariance(number("east_variance"), en, eu, en, number("north_variance"), nu, eu, nu,
                                number("up_variance"));
    const glm::dvec3 error_m = place_of(simulation, "GPS");
    sum += glm::dot(error_m, glm::inverse(covariance) * error_m);
  }
  // A sum of n squares of normal numbers has the mean n and the variance 2 n.
  constexpr double kSquares = 3.0 * kFixes;
  CHECK(std::abs(sum / kSquares - 1) <= 5 * std::sqrt(2 / kSquares));
}

std::vector<double> rows_of(Simulation& simulation) {
  std::vector<double> all;
  for (const char* const name : {"GPS", "SKY"}) {
    const std::vector<double>& values = simulation.reading(name).values();
    for (const double value : values) all.push_back(std::isnan(value) ? -1e9 : value);
  }
  return all;
}

TEST_CASE("a restored state goes on with the same fixes, jammed or not") {
  const std::string sensors =
      receiver("satellites='gps' reflection='0.5' pseudorange_stddev='2' pseudorange_random_walk='0.1'") +
      sky_sensor("reflection='0.5'") + "<part name='TRUCK' insert_at='ROOT'/>" +
      "<element type='gnss_jammer' name='JAM' insert_at='TRUCK' range='20'/>";
  Simulation first = in_street(sensors, kNorth), second = in_street(sensors, kNorth);
  const auto drive = [](Simulation& simulation, int i) {
    simulation.set("MOVE", "x", 5.0 * i);
    simulation.step();
    return rows_of(simulation);
  };
  for (int i = 0; i < 3; ++i) drive(first, i);
  second.restore_state(first.save_state());
  int without_fix = 0, with_fix = 0;
  for (int i = 3; i < 8; ++i) {
    const std::vector<double> rows = drive(first, i);
    CHECK(drive(second, i) == rows);
    (has_fix(first, "GPS") ? with_fix : without_fix) += 1;
  }
  CHECK(with_fix > 0);
  CHECK(without_fix > 0);
}

TEST_CASE("shapes of files hide satellites, and are read only for receivers with satellites") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "roof.obj") << "v -8 -8 5\nv 8 -8 5\nv 8 8 5\nv -8 8 5\nf 1 2 3 4\n";
  const std::string roof = "<part name='ROOF' insert_at='ROOT' file='roof.obj'/>";
  for (const bool has_satellites : {false, true}) {
    Simulation simulation = Simulation::from_string(
        "<s>" + roof + "<part name='CAR' insert_at='ROOT'/>" + receiver(has_satellites ? kEvenSky : "") + "</s>", {},
        folder.path());
    CHECK(built_scene(simulation).scene.part_files().at(0).needed_by == (has_satellites ? "sensor \"GPS\"" : ""));
    simulation.step();
    CHECK(has_fix(simulation, "GPS") != has_satellites);  // four satellites on a cone are left
    if (has_satellites) CHECK(simulation.value("GPS", "satellites_visible") == 4);
    if (!has_satellites) CHECK_FALSE(simulation.find_value("GPS", "satellites_visible"));
  }
}

TEST_CASE("wrong attributes are errors that say where and what is allowed") {
  const auto error = [](const std::string& attributes, const std::string& type = "gnss") {
    return error_of([&] {
      Simulation::from_string("<s>\n<sensor type='" + type + "' name='G' insert_at='ROOT' " + attributes + "/></s>");
    });
  };
  for (const std::string wrong : {"'galileo'", "'0:30 90'", "'0:30 x:20'", "'0:91'", "'0:-1'", "'361:5'", "'0:nan'",
                                  "'inf:5'", "':'", "'1:2:3'", "''", "' '"}) {
    CAPTURE(wrong);
    const std::string message = error("satellites=" + wrong);
    CHECK(contains(message, ":2:"));
    CHECK(contains(message, "\"satellites\""));
  }
  CHECK(contains(error("satellites='0:30 90:x'"), "\"90:x\" is not allowed, expected none, gps, or AZIMUTH:ELEVATION"));
  const auto many = [](std::size_t count) {
    std::string list;
    for (std::size_t i = 0; i < count; ++i) list += "0:30 ";
    return "satellites='" + list + "'";
  };
  CHECK(error(many(kMaxSatellites)) == "nothing was thrown");
  CHECK(contains(error(many(kMaxSatellites + 1)),
                 "attribute \"satellites\": 1025 satellites are too many, expected at most 1024"));
  for (const std::string name : {"elevation_mask", "reflection", "constellation_time", "max_pdop", "pseudorange_stddev",
                                 "pseudorange_bias_mean"}) {
    CAPTURE(name);
    const std::string message = error(name + "='0.5'");
    CHECK(contains(message, ":2:"));
    const std::string allowed = name == "constellation_time" ? "\"gps\"" : "\"gps\" or their directions";
    CHECK(message.ends_with("\"" + name + "\" is allowed only with satellites=" + allowed));
    CHECK((error("satellites='0:30' " + name + "='0.5'") == "nothing was thrown") == (name != "constellation_time"));
    CHECK(error("satellites='gps' " + name + "='0.5'") == "nothing was thrown");
  }
  for (const std::string type : {"gnss", "gnss_satellites"}) {
    const std::string before = "<sensor type='" + type + "' name='G' insert_at='ROOT' satellites='0:30 90:30' ";
    CHECK(error("satellites='0:30 90:30' constellation_time='1'", type) ==
          "<string>:2:" + std::to_string(before.size() + 1) +
              ": error: attribute \"constellation_time\" is allowed only with satellites=\"gps\"");
  }
  for (const std::string wrong : {"elevation_mask='91'", "elevation_mask='-1'", "reflection='1'", "reflection='-0.1'",
                                  "constellation_time='-1'", "max_pdop='0'", "pseudorange_stddev='-1'"}) {
    CAPTURE(wrong);
    CHECK(contains(error("satellites='gps' " + wrong), ":2:"));
  }
  CHECK(contains(error("satellites='none'", "gnss_satellites"), "expected gps or directions"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
