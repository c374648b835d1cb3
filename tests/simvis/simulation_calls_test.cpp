// Calls of a Simulation: by whom they may be made, poses as a whole, and what a scan says of itself.
#include <simvis/simulation.h>

#include <doctest/doctest.h>

#include <condition_variable>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <mutex>
#include <thread>

#include <simvis/pose.h>
#include "tests/support/error_of.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

const std::string kMovedScanner =
    R"(<element type="pose" name="P" insert_at="ROOT"/>
       <sensor type="laser_scanner" name="S" insert_at="ROOT" samples="5" min_angle="-80" max_angle="80" vertical_samples="2"
               range_max="6"/>)";

Simulation by_the_wall(const std::string& commands, const SimulationDesc& desc = {}) {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  return Simulation::from_string(std::string(kWallPart) + commands, desc, folder.path());
}

TEST_CASE("a simulation that was moved from refuses every call") {
  Simulation first = Simulation::from_string("");
  const Simulation second = std::move(first);
  // NOLINTBEGIN(bugprone-use-after-move)
  for (const std::string& message : {error_of([&] { first.step(); }), error_of([&] { first.set("A", "x", 1); }),
                                     error_of([&] { first.warnings(); }), error_of([&] { first.parameters(); }),
                                     error_of([&] { first.sensors(); }), error_of([&] { first.diagnostics(); })}) {
    CHECK(contains(message, "this simulation was moved from"));
  }
  // NOLINTEND(bugprone-use-after-move)
  first = Simulation::from_string("");
  first.step();
}

TEST_CASE("a call while another thread is in a call is refused and changes nothing") {
  std::mutex mutex;
  std::condition_variable changed;
  bool inside = false, leave = false;
  std::string nested = "not called";
  Simulation* simulation = nullptr;
  SimulationDesc desc;
  desc.progress = [&](const Progress&) {
    if (simulation == nullptr) return;
    nested = error_of([&] { simulation->next_frame(); });  // by the same thread: allowed
    std::unique_lock lock(mutex);
    inside = true;
    changed.notify_all();
    changed.wait(lock, [&] { return leave; });
    simulation = nullptr;
  };
  Simulation running = Simulation::from_string("", desc);
  simulation = &running;
  std::thread other([&] { running.execute(R"(<element type="pose" name="P" insert_at="ROOT"/>)"); });
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return inside; });
  }
  for (const std::string& message : {error_of([&] { running.step(); }), error_of([&] { running.get("P", "x"); }),
                                     error_of([&] { running.measured(); })}) {
    CHECK(contains(message, "another thread is using this simulation"));
  }
  {
    const std::lock_guard lock(mutex);
    leave = true;
  }
  changed.notify_all();
  other.join();
  CHECK(nested == error_of([] {}));
  CHECK(running.next_frame().index == 0);
  running.step();  // by another thread than before
  CHECK(running.get("P", "x") == 0);
}

/// The largest difference of two matrices' elements.
double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) largest = std::max(largest, std::abs(a[column][row] - b[column][row]));
  }
  return largest;
}

// Angles pass through degrees and back: a few roundings of numbers up to 180.
constexpr double kAngleRounding = 1e-14;

TEST_CASE("a pose element takes a matrix, also one that looks straight up or down") {
  Simulation simulation = by_the_wall(kMovedScanner);
  glm::dmat4 seen;
  for (const double pitch : {0.0, 30.0, -89.9999999, 90.0, -90.0}) {
    for (const double yaw : {0.0, 120.0, -180.0}) {
      for (const double roll : {0.0, -45.0, 170.0}) {
        const glm::dmat4 wanted = matrix_from_degrees({1, -2, 0.5}, roll, pitch, yaw);
        simulation.set_pose("P", wanted);
        simulation.step();
        REQUIRE(simulation.sensor_pose("S", seen));
        CHECK_MESSAGE(difference(seen, wanted) <= kAngleRounding, "roll ", roll, " pitch ", pitch, " yaw ", yaw);
      }
    }
  }
  simulation.set_pose("P", {1, 2, 3}, glm::angleAxis(glm::radians(90.0), glm::dvec3(0, 0, 1)));
  CHECK(simulation.get("P", "x") == 1);
  CHECK(simulation.get("P", "yaw") == doctest::Approx(90));
}

TEST_CASE("poses that are refused keep the old one") {
  Simulation simulation = by_the_wall(kMovedScanner + R"(<element type="light" name="L" insert_at="ROOT"/>)");
  simulation.set("P", "x", 7);
  const glm::dmat4 one(1);
  glm::dmat4 scaled = one, mirrored = one, nan = one, far = one;
  scaled[0][0] = 1.001;
  mirrored[1][1] = -1;
  nan[3][1] = std::numeric_limits<double>::quiet_NaN();
  far[3] = {1, 1e16, 0, 1};
  for (const glm::dmat4& wrong : {scaled, mirrored, nan}) {
    CHECK(contains(error_of([&] { simulation.set_pose("P", wrong); }), "the matrix is not rigid"));
  }
  CHECK(contains(error_of([&] { simulation.set_pose("P", far); }), "P.y: "));
  CHECK(
      contains(error_of([&] { simulation.set_pose("L", one); }), "\"L\" is a light, expected an element of type pose"));
  CHECK(contains(error_of([&] { simulation.set_pose("Q", one); }), "there is no element \"Q\""));
  CHECK(contains(error_of([&] { simulation.set_pose("P", {0, 0, 0}, glm::dquat(2, 0, 0, 0)); }), "length 2"));
  CHECK(simulation.get("P", "x") == 7);
}

TEST_CASE("a scan has its time, its pose and its points") {
  Simulation simulation = by_the_wall(kMovedScanner);
  CHECK(simulation.scan("S").points().empty());
  simulation.set("P", "x", 1);
  simulation.set("P", "yaw", 20);
  simulation.step();
  simulation.step();
  const Scan& scan = simulation.scan("S");
  CHECK(scan.time_ns == 66'666'667);
  glm::dmat4 pose;
  REQUIRE(simulation.sensor_pose("S", pose));
  CHECK(scan.world_from_sensor == pose);
  const std::vector<glm::dvec3> points = scan.points(), world = scan.world_points();
  REQUIRE(points.size() == scan.range_m.size());
  std::size_t hits = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isinf(scan.range_m[i])) {
      CHECK(std::isnan(points[i].x));
      continue;
    }
    ++hits;
    CHECK(std::abs(glm::length(points[i]) - scan.range_m[i]) <= kAngleRounding * scan.range_m[i]);
    CHECK(std::abs(world[i].x - 4) <= scan.error_bound_m[i] + kAngleRounding * 10);  // the wall stands at x = 4 m
  }
  CHECK(hits > 0);
  CHECK(hits < points.size());
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
