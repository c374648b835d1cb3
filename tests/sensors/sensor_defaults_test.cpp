// Defaults that depend on other attributes, and those of elements: an omitted attribute or command means what the
// table says, and the value in a default-constructed struct.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>
#include <simvis/simulation.h>
#include "effects/scanner/returns.h"
#include "sensors/laser_scanner/laser_scanner.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

std::string text_of(std::string_view type, std::string_view attribute) {
  const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type(type));
  const auto row = std::ranges::find(table, attribute, &AttributeSpec::name);
  REQUIRE(row != table.end());
  return std::string(row->text);
}

// Whether the number is a word of the row's text.
void check_says(std::string_view type, std::string_view attribute, double value) {
  CAPTURE(attribute);
  CAPTURE(value);
  std::istringstream words(text_of(type, attribute));
  bool says = false;
  for (std::string word; words >> word;) {
    double number = 0;
    says = says || (parse_number(word, number) && number == value);
  }
  CHECK(says);
}

}  // namespace

TEST_CASE("defaults that depend on other attributes: the table describes the behaviour of the code") {
  check_says("laser_scanner", "max_error_rel", kDefaultMaxErrorRel);
  check_says("laser_scanner", "resolution", kPlanarResolution);
  check_says("laser_scanner", "resolution", kRingsResolution);
  check_says("laser_scanner", "pulse_length", kPulseLength_m);
}

TEST_CASE("a scene without a sky has the environment of a sky element without attributes") {
  Simulation without = Simulation::from_string("");
  Simulation with = Simulation::from_string(R"(<element type="sky" name="SKY" insert_at="ROOT"/>)");
  without.step();
  with.step();
  CHECK(without.diagnostics().draw_list().environment == with.diagnostics().draw_list().environment);
}

TEST_CASE("fog without attributes scatters the same light as a default-constructed medium") {
  Simulation foggy = Simulation::from_string(R"(<element type="fog" name="FOG" insert_at="ROOT"/>)");
  foggy.step();
  CHECK(foggy.diagnostics().draw_list().medium.extinction_per_m > 0);
  CHECK(foggy.diagnostics().draw_list().medium.airlight == Medium{}.airlight);
}

}  // namespace simvis

TEST_SUITE_END();
