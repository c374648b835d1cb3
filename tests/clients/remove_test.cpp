// Clients remove things: ids stay, names are free, and what is written to the removed is ignored.
#include <doctest/doctest.h>

#include <simvis/simulation.h>
#include <simvis_client/connection.h>
#include "tests/clients/shared_host.h"
#include "tests/support/wall_scene.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

namespace {

struct ServedRoom {
  ServedRoom() { simulation.serve({.name = name, .folders = {folder.path()}}); }
  TemporaryFolder folder;
  std::string name = unique_name("remove");
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
    <part name="CART" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="CART"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="CART" samples="1" min_angle="0" max_angle="0"/>
    <sensor type="laser_scanner" name="OTHER" insert_at="ROOT" samples="3"/>)"));
};

}  // namespace

TEST_CASE("removed elements and sensors keep their entries, with a mark, and their names and memory are free") {
  ServedRoom room;
  Simulation& simulation = room.simulation;
  Connection connection(room.name, "editor");
  simulation.step();
  const std::int64_t x = connection.parameter("MOVE", "x"), scan = connection.sensor("SCAN");
  const auto view = connection.latest(scan);
  REQUIRE(view->whole());
  connection.send("<remove name='CART'/>");
  simulation.step();
  CHECK_THROWS(connection.element("MOVE"));
  CHECK_THROWS(connection.sensor("SCAN"));
  CHECK(simvis_element_at(connection.get(), 0)->removed == 1);
  CHECK(simvis_sensor_at(connection.get(), scan)->removed == 1);
  CHECK_FALSE(connection.latest(scan));
  CHECK_FALSE(view->whole());
  CHECK(simulation.sensors().size() == 1);
  CHECK(simulation.measured().size() == 1);
  CHECK(connection.latest(connection.sensor("OTHER"))->slot().frame == 1);

  // What a client writes to the removed is ignored, and not logged.
  const std::array<double, kPoseValues> pose{};
  connection.set(x, 1e300);
  connection.set_element(0, pose);
  std::uint64_t position = 0;
  while (connection.next_log(position)) {
  }
  simulation.step();
  CHECK_FALSE(connection.next_log(position));

  connection.send(R"(<part name="CART" insert_at="ROOT"/><element type="pose" name="MOVE" insert_at="CART" x="2"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="CART" samples="1" min_angle="0" max_angle="0"/>)");
  simulation.step();
  CHECK(connection.parameter("MOVE", "x") == x + static_cast<std::int64_t>(kPoseValues));
  CHECK(connection.value(connection.parameter("MOVE", "x")) == 2);
  CHECK(connection.sensor("SCAN") == 2);
  const auto again = connection.latest(2);
  CHECK(again->output<float>("range_m")[0] == 2);  // the wall stands 4 m away
  CHECK_FALSE(view->whole());                      // although the new sensor has the memory of the old one
  CHECK(&again->slot() == &view->slot());
}

TEST_CASE("a sensor that comes and goes again and again needs no more memory, and a tracked part comes back") {
  ServedRoom room;
  Simulation& simulation = room.simulation;
  simulation.track_part("CART");
  simulation.step();
  glm::dmat4 pose;
  CHECK(simulation.part_pose("CART", pose));
  Connection connection(room.name, "editor");
  const auto outputs = [&] { return connection.get() != nullptr ? simvis_sensor_count(connection.get()) : 0; };
  for (int round = 0; round < 5; ++round) {
    connection.send("<remove name='CART'/>");
    simulation.step();
    CHECK_FALSE(simulation.part_pose("CART", pose));
    connection.send(
        "<part name='CART' insert_at='ROOT' pose_offset='0 3 0 0 0 0'/>"
        "<sensor type='camera' view='visualization' name='SCAN' insert_at='CART' width='64' height='48'/>");
    simulation.step();
    CHECK(simulation.part_pose("CART", pose));
    CHECK(pose[3].y == 3);
  }
  CHECK(outputs() == 7);
}

TEST_SUITE_END();
