// Capture files, and the options --record-pcap and --udp.
#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include <simvis/simulation.h>
#include "exchange/packets/capture_file.h"
#include "exchange/packets/pcap.h"
#include "tests/messages/captured_datagrams.h"
#include "tests/messages/file_size_limit.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using test::Datagram;
using test::device_sensor;
using test::read_capture;

}  // namespace

TEST_CASE("a capture file has each datagram once, in fragments where it is long, and its time") {
  const std::string small = "abc", large(24'800, 'x');
  const std::string bytes = pcap_header() + pcap_datagram({.port = 2368}, 3'600'000'001'000, 0, small) +
                            pcap_datagram({.to = 0x7f000001, .port = 7502}, 3'601'123'456'789, 1, large);
  const std::vector<Datagram> datagrams = read_capture(bytes);
  REQUIRE(datagrams.size() == 2);
  CHECK(datagrams[0].payload == small);
  CHECK(datagrams[0].port == 2368);
  CHECK(datagrams[0].time_us == 3'600'000'001);
  CHECK(datagrams[0].fragments == 1);
  CHECK(datagrams[1].payload == large);
  CHECK(datagrams[1].time_us == 3'601'123'456);
  CHECK(datagrams[1].fragments == 17);  // 24808 bytes in parts of 1480
}

TEST_CASE("a file that cannot grow ends with its last whole part, and nothing half-begun is left") {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.pcap", link = folder / "link.pcap";
  {
    CaptureFile growing(file, "begin ");
    growing.append("first ");
    const FileSizeLimit limit(20);
    CHECK(contains(machine_error_of([&] { growing.append("a part that does not fit"); }),
                   "a.pcap: error: cannot be written"));
    CHECK(read_text(file) == "begin first ");
    growing.append("end");
    CHECK(growing.size() == 15);
  }
  CHECK(read_text(file) == "begin first end");
  fs::create_symlink("a.pcap", link);
  CaptureFile(link, "other").close();
  CHECK(fs::is_symlink(link));
  CHECK(read_text(file) == "other");
  const FileSizeLimit limit(2);
  CHECK(
      contains(machine_error_of([&] { CaptureFile(folder / "b.pcap", "begin"); }), "b.pcap: error: cannot be written"));
  CHECK(files_below(folder.path()) == std::vector<std::string>{"a.pcap", "link.pcap"});
}

TEST_CASE("--record-pcap writes the packets of every scan, the metadata of an Ouster, and says so in run.json") {
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), device_sensor("ouster_os0_32")).string();
  const fs::path file = folder / "os.pcap", out = folder / "out";
  const ProcessResult result =
      run_simvis({scene, "--out", out.string(), "--rate", "20", "--frames", "4", "--record-pcap", file.string()});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const std::vector<Datagram> datagrams = read_capture(read_text(file));
  CHECK(datagrams.size() == 2 * 64);  // of four frames at 20 Hz
  CHECK(datagrams.front().port == 7502);
  CHECK(nlohmann::json::parse(read_text(folder / "os.pcap.json")).at("sensor_info").at("prod_line") == "OS-0-32-U1");
  CHECK(nlohmann::json::parse(read_text(out / "run.json")).at("packets") ==
        nlohmann::json{{{"sensor", "LIDAR"}, {"packets", 128}, {"bytes", fs::file_size(file)}}});
  CHECK(contains(result.out, "os.pcap (128 packets)"));
}

TEST_CASE("--record-pcap given twice records two scanners, each in its file") {
  const TemporaryFolder folder;
  const std::string other = R"(<sensor type="laser_scanner" name="SECOND" insert_at="ROOT" preset="velodyne_hdl32e"/>)";
  const std::string scene = write_wall_scene(folder.path(), device_sensor("velodyne_vlp16") + other).string();
  const fs::path one = folder / "one.pcap", two = folder / "two.pcap", out = folder / "out";
  const ProcessResult result =
      run_simvis({scene, "--out", out.string(), "--rate", "10", "--frames", "1", "--record-pcap",
                  "LIDAR=" + one.string(), "--record-pcap", "SECOND=" + two.string()});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const nlohmann::json packets = nlohmann::json::parse(read_text(out / "run.json")).at("packets");
  REQUIRE(packets.size() == 2);
  CHECK(packets[0].at("sensor") == "LIDAR");
  CHECK(packets[1].at("sensor") == "SECOND");
  CHECK(packets[0].at("packets") == read_capture(read_text(one)).size());
  CHECK(packets[1].at("packets") == read_capture(read_text(two)).size());
  CHECK(read_text(one) != read_text(two));
  const ProcessResult same = run_simvis({scene, "--out", out.string(), "--record-pcap", "LIDAR=" + one.string(),
                                         "--record-pcap", "SECOND=" + one.string()});
  CHECK(same.exit_code != 0);
}

TEST_CASE("the imu of an Ouster has packets of its own in the capture, in the order of time") {
  const TemporaryFolder folder;
  const auto imu = [](const std::string& place) {
    return "<sensor type=\"imu\" name=\"LIDAR_IMU\" insert_at=\"ROOT\"" + place + "/>";
  };
  const std::string scene = write_wall_scene(folder.path(), device_sensor("ouster_os0_32") + imu("")).string();
  const fs::path file = folder / "os.pcap";
  const ProcessResult result = run_simvis(
      {scene, "--out", (folder / "out").string(), "--rate", "100", "--frames", "21", "--record-pcap", file.string()});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  std::size_t inertial = 0;
  for (const Datagram& each : read_capture(read_text(file))) {
    if (each.port != 7503) continue;
    REQUIRE(each.payload.size() == 48);
    std::array<float, 6> numbers{};  // acceleration in g, angular velocity in degrees per second
    std::memcpy(numbers.data(), each.payload.data() + 24, sizeof numbers);
    CHECK(numbers == std::array<float, 6>{0, 0, 1, 0, 0, 0});  // at rest: exact
    std::uint64_t time_ns = 0;
    std::memcpy(&time_ns, each.payload.data(), sizeof time_ns);
    CHECK(time_ns == 3'600'000'000'000 + 10'000'000 * inertial++);
  }
  CHECK(inertial == 21);
  check_refused({"--record-pcap", "LIDAR=a.pcap"}, device_sensor("ouster_os0_32") + imu(" pose_offset=\"0 0 1 0 0 0\""),
                {R"(sensor "LIDAR_IMU" is not an imu at the place of "LIDAR")"});
}

TEST_CASE("--udp sends the same packets") {
  const int receiver = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  REQUIRE(receiver >= 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::bind(receiver, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  socklen_t length = sizeof address;
  REQUIRE(::getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &length) == 0);
  const int buffer_bytes = 1 << 22;  // more than the packets of two scans
  ::setsockopt(receiver, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  const TemporaryFolder folder;
  SimulationDesc desc;
  desc.rate_hz = 10;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), device_sensor("velodyne_vlp16")), desc);
  simulation.record_packets({.file = folder / "v.pcap"});
  simulation.send_packets({.address = "127.0.0.1:" + std::to_string(ntohs(address.sin_port)), .sensor = "LIDAR"});
  std::vector<std::string> received;
  for (int frame = 0; frame < 2; ++frame) {
    simulation.step();
    std::string bytes(2000, '\0');
    for (ssize_t size = 0; (size = ::recv(receiver, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0;) {
      received.push_back(bytes.substr(0, static_cast<std::size_t>(size)));
    }
  }
  ::close(receiver);
  CHECK(simulation.stop_packets().packets == 150);
  CHECK(simulation.finish_packet_recording().packets == 150);
  const std::vector<Datagram> recorded = read_capture(read_text(folder / "v.pcap"));
  REQUIRE(recorded.size() == 150);
  REQUIRE(received.size() == 150);
  for (std::size_t i = 0; i < 150; ++i) CHECK(received[i] == recorded[i].payload);
  CHECK(files_below(folder.path()) == std::vector<std::string>{"scene.xml", "v.pcap", "wall.gltf"});
}

TEST_CASE("scanners without packets, other files and wrong addresses are refused before anything is written") {
  const std::string known = R"(sensor "SCAN" does not have the beams of a device whose packets are known)";
  check_refused({"--record-pcap", "a.pcap"}, std::string(kWallSensors), {"--record-pcap: " + known});
  check_refused({"--udp", "127.0.0.1"}, std::string(kWallSensors), {"--udp: " + known});
  check_refused({"--record-pcap", "NO=a.pcap"}, std::string(kWallSensors),
                {R"("NO" is not a laser scanner, expected one of: SCAN)"});
  check_refused({"--record-pcap", "a.pcap"}, "", {"the scene has no laser scanner"});
  check_refused({"--record-pcap", "a.pcap"}, device_sensor("velodyne_vls128", R"(return="dual")"),
                {R"(has return="dual", and packets with two returns are known of a VLP-16 and of an HDL-32E only)"});
  const std::string device = device_sensor("velodyne_vlp16");
  check_refused({"--record-pcap", "a.pcap"}, std::string(kWallSensors) + device,
                {"the scene has several laser scanners, expected the name of one: "});
  check_refused({"--udp", "127.0.0.1:0"}, device,
                {R"(--udp: "127.0.0.1:0" is no address, expected HOST or HOST:PORT)"});
  check_refused({"--udp", "no where"}, device, {R"("no where" names no host)"});
  const TemporaryFolder folder;
  write_text(folder / "notes.txt", "mine");
  check_refused({"--record-pcap", (folder / "notes.txt").string()}, device,
                {"notes.txt: error: exists and is no capture file"});
  CHECK(read_text(folder / "notes.txt") == "mine");
}

TEST_CASE("metadata of a capture replace those of an earlier one, and nothing else") {
  const TemporaryFolder folder;
  const fs::path file = folder / "os.pcap", metadata = folder / "os.pcap.json";
  const auto record = [&](const std::string& preset, const Strings& more) {
    const std::string scene = write_wall_scene(folder.path(), device_sensor(preset)).string();
    Strings arguments{scene,     "--rate",        "10",          "--frames", "2",
                      "--quiet", "--record-pcap", file.string(), "--out",    (folder / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_simvis(arguments);
  };
  const auto is_of = [&](const std::string& product_line) {
    return nlohmann::json::parse(read_text(metadata)).at("sensor_info").at("prod_line") == product_line;
  };
  write_text(metadata, "mine");
  for (const bool has_capture : {false, true}) {
    if (has_capture) write_text(file, pcap_header());
    const ProcessResult refused = record("ouster_os0_32", {});
    CHECK(refused.exit_code == 2);
    CHECK(contains(refused.err, "os.pcap.json: error: exists and is no metadata of a capture"));
    CHECK(read_text(metadata) == "mine");
    CHECK(fs::exists(file) == has_capture);
  }
  fs::remove(metadata);
  CHECK(record("ouster_os0_32", {}).exit_code == 0);
  CHECK(is_of("OS-0-32-U1"));
  const std::uint64_t bytes = fs::file_size(file);
  const ProcessResult kept = record("ouster_os1_64", {"--no-replace"});
  CHECK(kept.exit_code == 2);
  CHECK(is_of("OS-0-32-U1"));
  CHECK(fs::file_size(file) == bytes);
  CHECK(record("ouster_os1_64", {}).exit_code == 0);
  CHECK(is_of("OS-1-64"));
  CHECK(2 * fs::file_size(file) > 3 * bytes);
  // As a run that was killed before its capture has its name.
  fs::remove(file);
  fs::remove_all(folder / "out");
  const ProcessResult other = record("ouster_os0_32", {});
  CHECK(other.exit_code == 2);
  CHECK(contains(other.err, "os.pcap.json: error: exists without its capture file"));
  CHECK(is_of("OS-1-64"));
  CHECK(record("ouster_os1_64", {"--no-replace"}).exit_code == 0);
  CHECK(fs::exists(file));
}

TEST_CASE("--udp: a resolver that does not answer is a fault of the machine, a wrong name is one of the input") {
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), device_sensor("velodyne_vlp16")).string();
  const auto send_to = [&](const char* host) {
    // Without any network, no resolver answers.
    return Process({"unshare", "--user", "--map-root-user", "--net", simvis_run(), scene, "--rate", "10", "--frames",
                    "1", "--quiet", "--out", (folder / "out").string(), "--udp", host})
        .wait();
  };
  const ProcessResult unanswered = send_to("nowhere.invalid");
  if (unanswered.err.starts_with("unshare")) return test::skip("no network namespaces: " + unanswered.err);
  CHECK(unanswered.exit_code == 1);
  CHECK(contains(unanswered.err, R"(error: the address of "nowhere.invalid" cannot be looked up: )"));
  CHECK_FALSE(fs::exists(folder / "out"));
  const ProcessResult wrong = send_to("no where");
  CHECK(wrong.exit_code == 2);
  CHECK(contains(wrong.err, R"(--udp: "no where" names no host: )"));
}

TEST_CASE("--udp sends to all of a network, as devices do by default") {
  const int receiver = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  REQUIRE(receiver >= 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  REQUIRE(::bind(receiver, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  socklen_t length = sizeof address;
  REQUIRE(::getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &length) == 0);
  const TemporaryFolder folder;
  SimulationDesc desc;
  desc.rate_hz = 10;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), device_sensor("velodyne_vlp16")), desc);
  // The broadcast address of the loopback network.
  simulation.send_packets({.address = "127.255.255.255:" + std::to_string(ntohs(address.sin_port))});
  simulation.step();
  std::string bytes(2000, '\0');
  CHECK(::recv(receiver, bytes.data(), bytes.size(), MSG_DONTWAIT) == 1206);
  ::close(receiver);
}
}  // namespace simvis

TEST_SUITE_END();
