// Clients change the scene of one environment of a vector within a frame: rows of outputs never show foreign memory.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <simvis/vector_simulation.h>
#include <simvis_client/connection.h>
#include "tests/clients/shared_host.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr std::size_t kServed = 1;  // of two environments

constexpr std::size_t kSamples = 20001;  // of the scanner: 80 KB, so that foreign memory would show

struct ServedEnvironment {
  ServedEnvironment() {
    vector.environment(kServed)->serve({.name = name});
    vector.step();
  }
  // What the next step says if a client sends these commands before it.
  std::string step_with(const std::string& commands) {
    client::Connection connection(name, "editor");
    connection.send(commands);
    return error_of([&] { vector.step(); });
  }
  std::vector<std::size_t> failed() const { return {vector.failed().begin(), vector.failed().end()}; }
  std::uint64_t frame() const { return vector.environment(kServed)->last_frame()->index; }

  TemporaryFolder folder;
  std::string name = unique_name("environment");
  VectorSimulation vector = VectorSimulation::load(write_wall_scene(folder.path(), R"(
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="20001"/>
    <sensor type="camera" name="EYE" insert_at="ROOT" width="80" height="60" light="path" samples="1"/>
    <part name="CART" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="CART"/>
    <sensor type="laser_scanner" name="OTHER" insert_at="CART" samples="1" min_angle="0" max_angle="0"/>)"),
                                                   2);
  // The scanner that is removed comes first: the outputs behind it are written nevertheless.
  const VectorOutput& ranges = vector.output("SCAN", "range_m");
  const VectorOutput& codes = vector.output("EYE", "rgb");
  const VectorOutput& others = vector.output("OTHER", "range_m");
};

// The numbers of an output in one environment.
template <typename Number>
std::vector<Number> numbers_of(const VectorOutput& output, std::size_t environment) {
  const auto& all = std::get<SharedArray<Number>>(output.numbers);
  const std::size_t count = all.size() / output.environments;
  return {all.begin() + static_cast<std::ptrdiff_t>(environment * count),
          all.begin() + static_cast<std::ptrdiff_t>((environment + 1) * count)};
}

bool is_nothing(const std::vector<float>& row) {
  return std::ranges::all_of(row, [](float number) { return std::isnan(number); });
}

// The wall stands 4 m away, and the cart of the served environment at x = 1.
void check_others(const ServedEnvironment& served) {
  CHECK(numbers_of<float>(served.others, 0) == std::vector<float>{4});
  CHECK(numbers_of<float>(served.others, kServed) == std::vector<float>{3});
}

TEST_CASE("if a client gives an output another shape within a frame, its row has nothing and the frame is made") {
  ServedEnvironment served;
  served.vector.set("MOVE", "x", std::array{0.0, 1.0});
  const std::string message = served.step_with(
      "<remove name='SCAN'/><sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='5'/>"
      "<remove name='EYE'/><sensor type='camera' name='EYE' insert_at='ROOT' width='8' height='6' light='path'/>");
  CHECK(contains(message, "has the shape 1 x 5, expected that of the other environments, 1 x 20001 (environment 1)"));
  const std::vector<float> row = numbers_of<float>(served.ranges, kServed);
  CHECK(row.size() == kSamples);
  CHECK(is_nothing(row));
  CHECK_FALSE(is_nothing(numbers_of<float>(served.ranges, 0)));
  CHECK(numbers_of<std::uint8_t>(served.codes, kServed) == std::vector<std::uint8_t>(std::size_t{80} * 60 * 3));
  check_others(served);
  CHECK(served.failed().empty());
  CHECK(served.frame() == 1);
  // Before the next frame the shape is known: this frame is not made.
  CHECK(contains(error_of([&] { served.vector.step(); }), "has the shape 1 x 5"));
  CHECK(served.failed() == std::vector<std::size_t>{kServed});
  CHECK(served.frame() == 1);
  CHECK(served.vector.environment(0)->last_frame()->index == 2);
}

TEST_CASE("if a client removes a sensor within a frame, its row has nothing, and the others are of this frame") {
  ServedEnvironment served;
  served.vector.set("MOVE", "x", std::array{0.0, 1.0});
  CHECK(contains(served.step_with("<remove name='SCAN'/>"), "there is no sensor \"SCAN\" (environment 1)"));
  CHECK(is_nothing(numbers_of<float>(served.ranges, kServed)));
  CHECK_FALSE(is_nothing(numbers_of<float>(served.ranges, 0)));
  check_others(served);
  CHECK(served.failed().empty());
  CHECK(served.frame() == 1);
}

}  // namespace

TEST_SUITE_END();
