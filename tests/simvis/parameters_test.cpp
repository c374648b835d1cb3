// The parameter arrays: names, limits and change logs.
#include <simvis/parameters.h>

#include <doctest/doctest.h>

#include <limits>

#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

Parameters make() {
  Parameters parameters;
  const AttributeSpec yaw{.name = "yaw", .default_value = "0", .unit = "deg", .live = true};
  const AttributeSpec height{.name = "height", .default_value = "1", .unit = "m", .min = 0, .max = 2, .live = true};
  const double two[] = {5, 1}, one[] = {7};
  parameters.add_element({.name = "A", .type = "t", .insertion_point = "ROOT", .parameters = {yaw, height}}, two);
  parameters.add_element({.name = "EMPTY", .type = "t", .insertion_point = "ROOT", .parameters = {}}, {});
  parameters.add_element({.name = "B", .type = "t", .insertion_point = "ROOT", .parameters = {yaw}}, one);
  return parameters;
}

TEST_CASE("values are in one vector and are found by name") {
  const Parameters p = make();
  CHECK(std::vector<double>(p.values().begin(), p.values().end()) == std::vector<double>{5, 1, 7});
  CHECK(p.index("A", "yaw") == 0);
  CHECK(p.index("A", "height") == 1);
  CHECK(p.index("B", "yaw") == 2);
  CHECK(p.name(1) == "A.height");
  CHECK(p.name(2) == "B.yaw");
  CHECK(p.elements()[2].first_value == 2);
}

TEST_CASE("unknown names are refused with the nearest name") {
  const Parameters p = make();
  CHECK(error_of([&] { p.index("EMPTI", "yaw"); }) == "there is no element \"EMPTI\", did you mean \"EMPTY\"?");
  CHECK(error_of([&] { p.index("A", "hieght"); }) ==
        "element \"A\" has no parameter \"hieght\", did you mean \"height\"? (expected one of: yaw, height)");
  CHECK(error_of([&] { p.index("EMPTY", "yaw"); }) == "element \"EMPTY\" has no parameter \"yaw\" (it has none)");
}

TEST_CASE("an invalid value is refused and the old one kept") {
  Parameters p = make();
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(error_of([&] { p.set(0, std::numeric_limits<double>::quiet_NaN()); }) ==
        "A.yaw: nan is not allowed, expected a finite number");
  CHECK(error_of([&] { p.set(0, inf); }) == "A.yaw: inf is not allowed, expected a finite number");
  CHECK(error_of([&] { p.set(0, -inf); }) == "A.yaw: -inf is not allowed, expected a finite number");
  CHECK(error_of([&] { p.set(1, 2.5); }) == "A.height: 2.5 is not allowed, expected a number from 0 to 2 (m)");
  CHECK(contains(error_of([&] { p.set(3, 0); }), "there is no parameter of index 3, expected one below 3"));
  CHECK(p.values()[0] == 5);
  CHECK(p.values()[1] == 1);
  CHECK(p.drain_changed_elements().empty());
}

TEST_CASE("only changed values count as changes, once") {
  Parameters p = make();
  CHECK(p.drain_changed_elements().empty());
  p.set(2, 7);
  CHECK(p.drain_changed_elements().empty());
  p.set(2, 8);
  p.set(0, 1);
  p.set(1, 2);
  CHECK(p.drain_changed_elements() == std::vector<std::size_t>{0, 2});
  CHECK(p.drain_changed_elements().empty());
}

TEST_CASE("the logs keep their entries in order") {
  Parameters p = make();
  p.log_request("a");
  p.log_request("b");
  p.log_change("c");
  CHECK(p.change_requests() == std::vector<std::string>{"a", "b"});
  CHECK(p.changes() == std::vector<std::string>{"c"});
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
