// Presets of rotating scanners: the rays, the points of the cloud and the packets of a moving scanner say the same
// times.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "exchange/messages/types/sensor_types.h"
#include "sensors/beam_tables/device_tables.h"
#include "tests/messages/captured_datagrams.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/whole_files.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

constexpr double kSpeed_m_s = 10, kWall_m = 12, kTurn_s = 0.1;
constexpr double kHour_s = 3600;  // clocks of devices at time 0

/// The second turn of a scanner that drives towards a wall.
struct DrivenTurn {
  explicit DrivenTurn(const std::string& preset) {
    SimulationDesc desc;
    desc.rate_hz = 1 / kTurn_s;
    const std::string exact = R"(range_noise="0" range_bias="0" range_resolution="0")";
    simulation.emplace(Simulation::from_string(
        R"(<simvis><part shape="box" size="1 400 400" name="WALL" insert_at="ROOT" pose_offset="12.5 0 0 0 0 0"/>
           <part name="CAR" insert_at="ROOT"/><element type="pose" name="DRIVE" insert_at="CAR"/>
           <sensor type="laser_scanner" name="LIDAR" insert_at="CAR" intensity="on" ignore="none" preset=")" +
            preset + "\" " + exact + "/></simvis>",
        desc));
    simulation->record({.file = folder / "turn.mcap", .topics = {"/LIDAR/points"}});
    simulation->record_packets({.file = folder / "turn.pcap"});
    simulation->step();
    simulation->set("DRIVE", "x", kSpeed_m_s * kTurn_s);
    simulation->step();
    simulation->finish_recording();
    simulation->finish_packet_recording();
  }

  TemporaryFolder folder;
  std::optional<Simulation> simulation;
};

double point_time_s(const ros::PointCloud2& cloud, std::size_t i) {
  for (const ros::PointField& field : cloud.fields) {
    if (field.name != "time") continue;
    float offset_s = 0;
    std::memcpy(&offset_s, &cloud.data.at(i * cloud.point_step + field.offset), sizeof offset_s);
    return cloud.header.stamp.sec + cloud.header.stamp.nanosec * 1e-9 + static_cast<double>(offset_s);
  }
  FAIL("the cloud has no times");
  return 0;
}

/// When the first beam of a packet fired, in seconds of the simulation.
double packet_time_s(const std::string& payload, bool is_velodyne) {
  if (is_velodyne) return static_cast<double>(test::little(payload, 1200, 4)) * 1e-6;  // past the hour
  return static_cast<double>(test::little(payload, 32, 8)) * 1e-9 - kHour_s;           // of the first column
}

}  // namespace

TEST_CASE("rays, points and packets of a preset have the same times") {
  for (const char* preset : {"velodyne_vlp16", "velodyne_hdl32e", "ouster_os1_32"}) {
    CAPTURE(preset);
    const DrivenTurn turn(preset);
    const Scan& scan = turn.simulation->scan("LIDAR");
    const SharedNumbers<double> times_s = scan.channel("time_s");
    REQUIRE(times_s.size() == scan.range_m.size());

    // Each ray starts where the scanner was at its time. The times of a table are whole nanoseconds.
    const double place_m = kSpeed_m_s * 1e-9;
    std::size_t rays = 0, wrong = 0;
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      const glm::dvec3 direction = scan.direction(i);
      if (direction.x < 0.9) continue;
      const double x_m = kSpeed_m_s * times_s[i];
      const double range_m = (kWall_m - x_m - scan.origin(i).x) / direction.x;
      const double allowed_m = scan.error_bound_m[i] + place_m / direction.x + range_m * 0x1p-23;
      wrong += std::abs(scan.range_m[i] - range_m) <= allowed_m ? 0 : 1;
      ++rays;
    }
    CHECK(rays > scan.range_m.size() / 10);
    CHECK(wrong == 0);

    // The offsets of points are float32, of at most a turn.
    const double point_s = kTurn_s * 0x1p-23 + 1e-9;
    const auto clouds =
        ros::test::McapReader::read(read_text(turn.folder / "turn.mcap")).all<ros::PointCloud2>("/LIDAR/points");
    REQUIRE(clouds.size() == 2);
    std::size_t late = 0;
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      late += std::abs(point_time_s(clouds[1], i) - times_s[i]) <= point_s ? 0 : 1;
    }
    CHECK(late == 0);

    // Packets begin with the first laser, or with a column; their stamps are whole microseconds, or nanoseconds.
    const bool is_velodyne = std::string_view(preset).starts_with("velodyne");
    const double stamp_s = is_velodyne ? 0.5e-6 + 1e-9 : 2e-9;
    const std::vector<test::Datagram> packets = test::read_capture(read_text(turn.folder / "turn.pcap"));
    REQUIRE(packets.size() % 2 == 0);
    const std::size_t of_turn = packets.size() / 2, columns = (scan.beams + of_turn - 1) / of_turn;
    const std::size_t ring =
        is_velodyne ? static_cast<std::size_t>(std::ranges::find(scan.beam_table->device->velodyne.laser_of_ring, 0u) -
                                               scan.beam_table->device->velodyne.laser_of_ring.begin())
                    : 0;
    for (std::size_t packet = 0; packet < of_turn; ++packet) {
      CAPTURE(packet);
      const double fired_s = times_s[ring * scan.beams + packet * columns];
      CHECK(std::abs(packet_time_s(packets[of_turn + packet].payload, is_velodyne) - fired_s) <= stamp_s);
    }
  }
}

}  // namespace simvis

TEST_SUITE_END();
