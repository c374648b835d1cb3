// Elements of type randomize: what is drawn, that nothing but seed, frame, element and parameter decides it, and one
// message for each mistake.
#include "elements/randomize.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("datasets");

namespace simvis {
namespace {

const std::string kRandomPose = "<part name='P' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='P'/>";

std::string scene_of_draws(const std::string& draws) { return "<simvis>" + kRandomPose + draws + "</simvis>"; }

/// The values of a parameter in the first frames.
std::vector<double> drawn(const std::string& draws, const std::string& parameter, int frames, std::uint64_t seed = 0) {
  SimulationDesc desc;
  desc.seed = seed;
  Simulation simulation = Simulation::from_string(scene_of_draws(draws), desc);
  std::vector<double> values;
  for (int frame = 0; frame < frames; ++frame) {
    simulation.step();
    values.push_back(simulation.parameters().values()[simulation.parameters().index("MOVE", parameter)]);
  }
  return values;
}

const std::string kDrawX = "<randomize element='MOVE' param='x' min='-2' max='4'/>",
                  kDrawY = "<randomize element='MOVE' param='y' distribution='normal' mean='1' deviation='0.5'/>",
                  kDrawZ = "<randomize element='MOVE' param='z' distribution='choice' values='3 5 8'/>";

// A mean of n draws is off by at most five of its standard deviations, s / sqrt(n), with a probability of 6e-7 that a
// wrong generator would exceed, and the seed is fixed.
constexpr double kDeviations = 5;

TEST_CASE("draws have the distribution that is asked for") {
  constexpr int kFrames = 400;
  const std::vector<double> x = drawn(kDrawX, "x", kFrames), y = drawn(kDrawY, "y", kFrames),
                            z = drawn(kDrawZ, "z", kFrames);
  const auto mean = [](const std::vector<double>& all) {
    double sum = 0;
    for (const double each : all) sum += each;
    return sum / static_cast<double>(all.size());
  };
  for (const double each : x) CHECK((each >= -2 && each <= 4));
  CHECK(std::abs(mean(x) - 1) <= kDeviations * 6 / std::sqrt(12.0 * kFrames));
  CHECK(std::abs(mean(y) - 1) <= kDeviations * 0.5 / std::sqrt(kFrames));
  std::vector<double> squares;
  for (const double each : y) squares.push_back((each - 1) * (each - 1));
  CHECK(std::abs(mean(squares) - 0.25) <= kDeviations * 0.25 * std::sqrt(2.0 / kFrames));
  for (const double value : {3.0, 5.0, 8.0}) {
    const auto count = static_cast<double>(std::ranges::count(z, value));
    CHECK(std::abs(count - kFrames / 3.0) <= kDeviations * std::sqrt(kFrames * 2.0 / 9));
  }
}

TEST_CASE("a draw depends on the seed, the frame, the element and the parameter, and on nothing else") {
  const std::vector<double> alone = drawn(kDrawX, "x", 5);
  CHECK(alone != drawn(kDrawX, "x", 5, 1));
  CHECK(alone == drawn(kDrawZ + kDrawY + kDrawX, "x", 5));
  CHECK(alone == drawn(kDrawX + kDrawY, "x", 5));
  CHECK(std::ranges::count(alone, alone[0]) == 1);
  const std::vector<double> other = drawn("<randomize element='MOVE' param='y' min='-2' max='4'/>", "y", 5);
  CHECK(alone != other);
  // Frames that are skipped change nothing.
  Simulation skipping = Simulation::from_string(scene_of_draws(kDrawX));
  for (int frame = 0; frame < 3; ++frame) skipping.skip_frame();
  skipping.step();
  CHECK(skipping.parameters().values()[skipping.parameters().index("MOVE", "x")] == alone[3]);
  // An element of this type is the same as the short form.
  CHECK(drawn("<element type='randomize' name='R' insert_at='ROOT' element='MOVE' param='x' min='-2' max='4'/>", "x",
              5) == alone);
}

TEST_CASE("a normal number stays within the limits of its parameter") {
  const std::string scene =
      "<simvis><element type='light' name='SUN' insert_at='ROOT'/>"
      "<randomize element='SUN' param='intensity' distribution='normal' mean='0' deviation='3'/></simvis>";
  Simulation simulation = Simulation::from_string(scene);
  double largest = 0;
  for (int frame = 0; frame < 40; ++frame) {
    simulation.step();
    const double value = simulation.parameters().values()[simulation.parameters().index("SUN", "intensity")];
    CHECK(value > 0);
    largest = std::max(largest, value);
  }
  CHECK(largest > 1);
}

TEST_CASE("mistakes of a randomize have one message each") {
  const auto refused = [](const std::string& draws, const std::string& expected) {
    const std::string message = error_of([&] { Simulation::from_string(scene_of_draws(draws)); });
    CHECK_MESSAGE(message.find(expected) != std::string::npos, message);
    CHECK_MESSAGE(message.find(":1:") != std::string::npos, message);
  };
  refused("<randomize element='MOVED' param='x' min='0' max='1'/>",
          "there is no element \"MOVED\", did you mean \"MOVE\"");
  refused("<randomize element='MOVE' param='ex' min='0' max='1'/>", "element \"MOVE\" has no parameter \"ex\"");
  refused("<randomize element='MOVE' param='x' min='0'/>", "distribution \"uniform\" needs the attribute \"max\"");
  refused("<randomize element='MOVE' param='x' min='1' max='0'/>", "attribute \"max\" is below \"min\"");
  refused("<randomize element='MOVE' param='x' min='0' max='1' mean='2'/>",
          "attribute \"mean\" is allowed only with distribution=\"normal\"");
  refused("<randomize element='MOVE' param='x' distribution='choice' values='1 two'/>",
          "attribute \"values\": \"two\" is not allowed");
  refused("<randomize element='MOVE' param='x' distribution='lognormal'/>", "\"lognormal\" is not allowed");
  refused(kDrawX + "<randomize name='B' element='MOVE' param='x' min='0' max='1'/>",
          "\"MOVE.x\" is drawn by another element of type randomize");
  refused("<randomize type='pose' element='MOVE' param='x' min='0' max='1'/>", "unknown attribute \"type\"");
  const std::string message = error_of([] {
    Simulation::from_string(
        "<simvis><element type='light' name='SUN' insert_at='ROOT'/>"
        "<randomize element='SUN' param='intensity' min='-1' max='1'/></simvis>");
  });
  CHECK_MESSAGE(message.find("SUN.intensity: ") != std::string::npos, message);
}

TEST_CASE("a scene without randomize has no element that moves for it") {
  const auto moving = [](const std::string& draws) {
    const Simulation simulation = Simulation::from_string(scene_of_draws(draws));
    return simulation.parameters().elements().size();
  };
  CHECK(moving("") == 1);
  CHECK(moving(kDrawX) == 2);
}

}  // namespace
}  // namespace simvis
