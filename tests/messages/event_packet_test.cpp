// Packets of event cameras in recordings, decoded by a reader of EVT 3.0 that follows the format's document.
#include <doctest/doctest.h>

#include <simvis/simulation.h>
#include "exchange/messages/from_events.h"
#include "exchange/messages/types/output_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "tests/messages/evt3_reader.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::test::McapFile;
using ros::test::McapReader;
using test::EventFields, test::Evt3Reader;

std::vector<EventFields> events_of(const Measurement& measurement) {
  std::vector<EventFields> events;
  const MeasuredArray &time = *measurement.find("t_us"), &x = *measurement.find("x"), &y = *measurement.find("y"),
                      &polarity = *measurement.find("polarity");
  for (std::size_t i = 0; i < time.count(); ++i) {
    events.emplace_back(static_cast<std::int64_t>(time.number(i)), static_cast<std::uint32_t>(x.number(i)),
                        static_cast<std::uint32_t>(y.number(i)), polarity.number(i) != 0);
  }
  return events;
}

struct Recorded {
  McapFile file;
  std::map<std::string, std::vector<std::vector<EventFields>>> events;  // by sensor, by frame
};

/// A bar that goes by, every 10 seconds, so that the time of EVT 3.0 begins again.
Recorded record(const std::string& sensors, std::vector<std::string> topics = {}) {
  const TemporaryFolder folder;
  SimulationDesc desc;
  desc.rate_hz = 0.1;
  Simulation simulation = Simulation::from_string(
      R"(<part shape="box" size="9 9 3" name="ROOM" insert_at="ROOT"/><part name="AT" insert_at="ROOT"/>
         <element type="pose" name="GO" insert_at="AT" x="2"/>
         <part shape="box" size="0.02 0.3 2" name="BAR" insert_at="AT"/>
         <element type="material" name="PAINT" insert_at="ROOT" part="BAR" red="0.1" green="0.1" blue="0.1"/>)" +
          sensors,
      desc);
  Recorded recorded;
  simulation.record({.file = folder / "run.mcap", .topics = std::move(topics)});
  for (int frame = 0; frame < 5; ++frame) {
    simulation.set("GO", "y", frame == 2 ? 0.0 : 0.1 * frame - 0.2);
    simulation.step();
    for (const SensorInfo& sensor : simulation.sensors()) {
      recorded.events[sensor.name].push_back(events_of(simulation.measurement(sensor.name)));
    }
  }
  simulation.finish_recording();
  recorded.file = McapReader::read(read_text(folder / "run.mcap"));
  return recorded;
}

TEST_CASE("packets of two event cameras have the events of their measurements, and a camera_info") {
  const Recorded run = record(
      "<sensor type='event_camera' name='LEFT' insert_at='ROOT' width='32' height='20' step='1'/>"
      "<sensor type='event_camera' name='RIGHT' insert_at='ROOT' width='16' height='8' step='1' leak='0.2'/>");
  for (const auto& [name, frames] : run.events) {
    CAPTURE(name);
    const auto packets = run.file.all<ros::EventPacket>("/" + name + "/events");
    REQUIRE(packets.size() == frames.size());
    Evt3Reader reader;
    std::size_t events = 0;
    for (std::size_t frame = 0; frame < packets.size(); ++frame) {
      const ros::EventPacket& packet = packets[frame];
      events += frames[frame].size();
      CHECK(packet.seq == frame);
      CHECK(packet.encoding == "evt3");
      CHECK(packet.header.frame_id == name + "_optical");
      // That of the measurement before.
      CHECK(packet.header.stamp.sec == (frame == 0 ? 0 : 10 * static_cast<int>(frame) - 10));
      CHECK(reader.read(packet.events) == frames[frame]);
      std::vector<EventFields> alone = Evt3Reader().read(packet.events);
      for (EventFields& each : alone) std::get<0>(each) += static_cast<std::int64_t>(packet.time_base / 1000);
      CHECK(alone == frames[frame]);
    }
    CHECK(events > 100);
    const auto infos = run.file.all<ros::CameraInfo>("/" + name + "/camera_info");
    REQUIRE(infos.size() == packets.size());
    CHECK(infos[0].width == packets[0].width);
    CHECK(infos[0].height == packets[0].height);
    CHECK(infos[0].header.frame_id == packets[0].header.frame_id);
    CHECK(run.file.all<ros::OutputStamped>("/" + name + "/time_s").empty());
  }
}

TEST_CASE("packets that nobody wants are not made, and exact times are a topic that one asks for") {
  const Recorded run = record(
      "<sensor type='event_camera' name='EV' insert_at='ROOT' width='32' height='20' step='1'/>", {"/EV/time_s"});
  CHECK(run.file.counts().size() == 1);
  CHECK(run.file.all<ros::OutputStamped>("/EV/time_s").size() == 4);  // the first measurement has no events
}

TEST_CASE("the events of an image that EVT 3.0 cannot address are columns, as those of other tables") {
  const Recorded run =
      record("<sensor type='event_camera' name='WIDE' insert_at='ROOT' width='2049' height='1' leak='0.2'/>");
  CHECK(run.file.counts().count("/WIDE/events") == 0);
  const auto columns = run.file.all<ros::OutputStamped>("/WIDE/x");
  REQUIRE(columns.size() == 4);
  CHECK(columns[0].output.rows == run.events.at("WIDE")[1].size());
}

TEST_CASE("a packet begins at its first event if that is earlier than the packet before it ends") {
  std::vector<TableColumn> columns;
  for (const char* const name : {"t_us", "x", "y", "polarity"}) columns.push_back({.name = name, .format = "%lld"});
  Reading reading(columns, {17'000'001, 3, 4, 1});
  reading.time_ns = 20'000'000'000;
  const ros::EventPacket packet = ros::event_packet(reading, 8, 8, "EV", {.number = 7, .begin_ns = 18'000'000'000});
  CHECK(packet.seq == 7);
  CHECK(packet.header.stamp.sec == 17);
  CHECK(packet.header.stamp.nanosec == 1000);
  CHECK(packet.time_base == 16'777'216'000);
  CHECK(Evt3Reader().read(packet.events) == std::vector<EventFields>{{17'000'001 - (1 << 24), 3, 4, true}});
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
