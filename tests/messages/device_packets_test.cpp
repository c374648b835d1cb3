// Data packets of laser scanners: their bytes against the layouts of the manuals, worked out here; capture files; the
// options --record-pcap and --udp; and what the decoders of PyPI read.
#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include <simvis/simulation.h>
#include "packets/capture_file.h"
#include "packets/ouster_packets.h"
#include "packets/pcap.h"
#include "packets/velodyne_packets.h"
#include "sensors/beam_tables/device_tables.h"
#include "tests/messages/file_size_limit.h"
#include "tests/messages/pip_packages.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

namespace fs = std::filesystem;

std::uint64_t little(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << (8 * i);
  return value;
}

std::uint64_t network(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

std::shared_ptr<const BeamTable> device_table(std::string_view name) {
  const DeviceTable* const found = find_device_table(name);
  REQUIRE(found != nullptr);
  return std::make_shared<const BeamTable>(found->make(found->index));
}

// Ranges and intensities that tell every beam from its neighbours; some beams have no range.
Scan made_up_scan(const BeamTable& table) {
  Scan scan;
  scan.rings = table.rings;
  scan.beams = table.beams;
  scan.time_ns = 7'000'000'000;
  ScanChannel intensity{"intensity", "%.9g", {}, "1/m2"};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double range_m = 1 + static_cast<double>(i % 997) * 0.0613;
    const bool none = i % 11 == 0, blocked = i % 13 == 0;
    scan.range_m.edit().push_back(none      ? std::numeric_limits<float>::infinity()
                                  : blocked ? 0
                                            : static_cast<float>(range_m));
    intensity.values.edit().push_back(
        none || blocked ? std::nan("") : (0.01 + static_cast<double>(i % 89) * 0.031) / (range_m * range_m));
  }
  scan.channels.push_back(std::move(intensity));
  return scan;
}

bool returned(const Scan& scan, std::size_t i) { return scan.range_m[i] > 0 && std::isfinite(scan.range_m[i]); }

std::uint64_t reflectivity(const Scan& scan, std::size_t i) {
  if (!returned(scan, i)) return 0;
  const double range_m = scan.range_m[i];
  return static_cast<std::uint64_t>(
      std::min(255.0, std::round(100 * scan.channel("intensity")->values[i] * range_m * range_m)));
}

struct Datagram {
  std::uint64_t time_us = 0;
  std::uint16_t port = 0;
  std::string payload;
  std::size_t fragments = 0;
};

// Reads a capture file as its format says; whatever does not fit fails.
std::vector<Datagram> read_capture(const std::string& bytes) {
  REQUIRE(bytes.size() >= 24);
  REQUIRE(little(bytes, 0, 4) == 0xa1b2c3d4);
  REQUIRE(little(bytes, 4, 2) == 2);
  REQUIRE(little(bytes, 6, 2) == 4);
  REQUIRE(little(bytes, 20, 4) == 1);
  std::vector<Datagram> datagrams;
  std::string udp;
  std::size_t fragments = 0;
  for (std::size_t at = 24; at < bytes.size();) {
    const std::size_t size = little(bytes, at + 8, 4);
    REQUIRE(size == little(bytes, at + 12, 4));
    REQUIRE(size <= 1514);
    const std::string_view frame = std::string_view(bytes).substr(at + 16, size), ip = frame.substr(14);
    REQUIRE(network(frame, 12, 2) == 0x0800);
    REQUIRE(network(ip, 0, 1) == 0x45);
    REQUIRE(network(ip, 2, 2) == ip.size());
    REQUIRE(network(ip, 9, 1) == 17);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < 20; i += 2) sum += network(ip, i, 2);
    REQUIRE((sum & 0xffff) + (sum >> 16) == 0xffff);
    const std::uint64_t place = network(ip, 6, 2);
    REQUIRE(8 * (place & 0x1fff) == udp.size());
    REQUIRE(network(ip, 4, 2) == datagrams.size() % 65536);
    udp += ip.substr(20);
    ++fragments;
    const std::uint64_t time_us = little(bytes, at, 4) * 1'000'000 + little(bytes, at + 4, 4);
    at += 16 + size;
    if ((place & 0x2000) != 0) continue;
    REQUIRE(network(udp, 4, 2) == udp.size());
    datagrams.push_back({time_us, static_cast<std::uint16_t>(network(udp, 2, 2)), udp.substr(8), fragments});
    udp.clear();
    fragments = 0;
  }
  REQUIRE(udp.empty());
  return datagrams;
}

std::string device_sensor(const std::string& preset, const std::string& more = {}) {
  return R"(<sensor type="laser_scanner" name="LIDAR" insert_at="ROOT" preset=")" + preset + R"(" intensity="on" )" +
         more + "/>";
}

}  // namespace

TEST_CASE("packets of Velodyne devices: flags, azimuths, distances, reflectivities and stamps of the manuals") {
  struct Device {
    const char* name;
    std::uint64_t model;
    std::uint32_t packets, columns_of_packet, group;
    double unit_m, cycle_us;
    std::int64_t stamp_offset_ns;
  };
  for (const Device& device : {Device{"velodyne_vlp16", 0x22, 75, 24, 2, 0.002, 55.296, 0},
                               Device{"velodyne_hdl32e", 0x21, 180, 12, 1, 0.002, 46.08, 0},
                               Device{"velodyne_vls128", 0xa1, 625, 3, 1, 0.004, 53.3, 3 * 2665}}) {
    CAPTURE(device.name);
    const auto table = device_table(device.name);
    const Scan scan = made_up_scan(*table);
    const std::vector<DevicePacket> packets = velodyne_packets(scan, *table, VelodyneReturn::strongest);
    REQUIRE(packets.size() == device.packets);
    std::vector<std::uint32_t> ring_of(table->rings);
    for (std::uint32_t ring = 0; ring < table->rings; ++ring)
      ring_of[table->device->velodyne.laser_of_ring[ring]] = ring;
    const std::uint16_t flags[] = {0xeeff, 0xddff, 0xccff, 0xbbff};
    const std::int64_t last_ns = *std::max_element(table->time_ns.begin(), table->time_ns.end());
    std::size_t wrong = 0, returns = 0;
    for (std::size_t p = 0; p < packets.size(); ++p) {
      const std::string& bytes = packets[p].bytes;
      REQUIRE(bytes.size() == 1206);
      const std::size_t first = p * device.columns_of_packet;
      const std::int64_t fired_ns = 3'600'000'000'000 + scan.time_ns - last_ns +
                                    std::llround(static_cast<double>(first) * device.cycle_us * 1000) +
                                    device.stamp_offset_ns;
      // Microseconds past the hour, rounded; the table rounds times to nanoseconds.
      wrong += std::abs(static_cast<double>(little(bytes, 1200, 4)) * 1000 -
                        static_cast<double>(fired_ns % 3'600'000'000'000)) > 501;
      wrong += little(bytes, 1204, 1) != 0x37 || little(bytes, 1205, 1) != device.model;
      for (std::size_t block = 0; block < 12; ++block) {
        const std::size_t before = 32 * block, column = first + before / table->rings,
                          bank = before % table->rings / 32;
        wrong += little(bytes, 100 * block, 2) != flags[bank];
        const auto azimuth = static_cast<double>(little(bytes, 100 * block + 2, 2));
        const double head = 18000 + 36000.0 * static_cast<double>(column) / table->beams;
        wrong += std::abs(std::remainder(azimuth - head, 36000)) > 0.5 || azimuth >= 36000;
        for (std::size_t k = 0; k < 32; ++k) {
          const std::size_t laser = (32 * bank + k) % table->rings, at = 100 * block + 4 + 3 * k;
          const std::size_t i = ring_of[laser] * std::size_t{table->beams} + column + (device.group == 2 ? k / 16 : 0);
          const double range_m = scan.range_m[i];
          const auto distance =
              returned(scan, i) ? static_cast<std::uint64_t>(std::llround(range_m / device.unit_m)) : 0;
          wrong += little(bytes, at, 2) != distance || little(bytes, at + 2, 1) != reflectivity(scan, i);
          returns += distance > 0;
        }
      }
    }
    CHECK(wrong == 0);
    CHECK(returns > table->size() * 4 / 5);
    CHECK(velodyne_packets(scan, *table, VelodyneReturn::last).front().bytes[1204] == 0x38);
    CHECK(packets.back().time_ns == 3'600'000'000'000 + scan.time_ns);
  }
}

TEST_CASE("packets with two returns: pairs of the last and the strongest, or of the last and the second strongest") {
  struct Device {
    const char* name;
    std::size_t packets, columns_of_packet;
  };
  for (const Device& device : {Device{"velodyne_vlp16", 150, 12}, Device{"velodyne_hdl32e", 360, 6}}) {
    CAPTURE(device.name);
    const auto table = device_table(device.name);
    Scan scan = made_up_scan(*table);
    ScanChannel second{"second_range_m", "%.9g", {}, "m"}, light{"second_intensity", "%.9g", {}, "1/m2"};
    for (std::size_t i = 0; i < table->size(); ++i) {
      // None, a farther one, a nearer one.
      const double second_m = i % 3 == 0 ? std::nan("") : i % 3 == 1 ? scan.range_m[i] + 1.25 : scan.range_m[i] - 0.875;
      second.values.edit().push_back(second_m);
      light.values.edit().push_back(0.4 / (second_m * second_m));
    }
    scan.channels.push_back(std::move(second));
    scan.channels.push_back(std::move(light));
    const std::vector<DevicePacket> packets = velodyne_packets(scan, *table, VelodyneReturn::dual);
    REQUIRE(packets.size() == device.packets);
    std::vector<std::uint32_t> ring_of(table->rings);
    for (std::uint32_t ring = 0; ring < table->rings; ++ring)
      ring_of[table->device->velodyne.laser_of_ring[ring]] = ring;
    std::size_t wrong = 0, different = 0;
    for (std::size_t p = 0; p < packets.size(); ++p) {
      const std::string& bytes = packets[p].bytes;
      wrong += bytes.size() != 1206 || little(bytes, 1204, 1) != 0x39;
      for (std::size_t pair = 0; pair < 6; ++pair) {
        const std::size_t even = 200 * pair, odd = even + 100;
        wrong += little(bytes, even, 4) != little(bytes, odd, 4);  // flag and azimuth
        for (std::size_t k = 0; k < 32; ++k) {
          const std::size_t column = p * device.columns_of_packet + (32 * pair + k) / table->rings;
          const std::size_t i = ring_of[k % table->rings] * std::size_t{table->beams} + column;
          const double strongest_m = scan.range_m[i], other_m = scan.channel("second_range_m")->values[i];
          const auto units = [](double range_m) { return static_cast<std::uint64_t>(std::llround(range_m / 0.002)); };
          std::uint64_t last = 0, odd_one = 0;
          if (returned(scan, i)) {
            last = units(i % 3 == 1 ? other_m : strongest_m);
            odd_one = units(i % 3 == 2 ? other_m : strongest_m);
            const std::uint64_t other_light = 40;
            wrong += little(bytes, even + 6 + 3 * k, 1) != (i % 3 == 1 ? other_light : reflectivity(scan, i));
            wrong += little(bytes, odd + 6 + 3 * k, 1) != (i % 3 == 2 ? other_light : reflectivity(scan, i));
          }
          wrong += little(bytes, even + 4 + 3 * k, 2) != last || little(bytes, odd + 4 + 3 * k, 2) != odd_one;
          different += last != odd_one;
        }
      }
    }
    CHECK(wrong == 0);
    CHECK(different > table->size() / 2);
  }
  check_refused({"--record-pcap", "a.pcap"}, device_sensor("velodyne_vls128", R"(return="dual")"),
                {R"(has return="dual", and packets with two returns are known of a VLP-16 and of an HDL-32E only)"});
}

// CRC-64/XZ bit by bit: its check value, that of the digits 1 to 9, is in the catalogue of parametrised CRC algorithms.
std::uint64_t crc64_by_bits(std::string_view bytes) {
  constexpr std::uint64_t kPolynomial = 0x42f0e1eba9ea3693;
  std::uint64_t crc = ~std::uint64_t{0};  // not reflected: bits of the bytes come from the lowest on
  for (const char byte : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      const bool in = (static_cast<unsigned char>(byte) >> bit & 1) != 0, top = crc >> 63 != 0;
      crc = crc << 1 ^ (in != top ? kPolynomial : 0);
    }
  }
  std::uint64_t reflected = 0;
  for (int bit = 0; bit < 64; ++bit) reflected |= (~crc >> bit & 1) << (63 - bit);
  return reflected;
}

TEST_CASE("packets of Ouster devices: header, columns, pixels, CRC and metadata") {
  REQUIRE(crc64_by_bits("123456789") == 0x995dc9bbdf1939fa);
  const auto table = device_table("ouster_os1_32");
  const Scan scan = made_up_scan(*table);
  const std::vector<DevicePacket> packets = ouster_packets(scan, *table, 65537);
  REQUIRE(packets.size() == 64);
  std::size_t wrong = 0, returns = 0;
  for (std::size_t p = 0; p < packets.size(); ++p) {
    const std::string& bytes = packets[p].bytes;
    REQUIRE(bytes.size() == 32 + 16 * (12 + 32 * 12) + 32);
    wrong += little(bytes, 0, 2) != 1 || little(bytes, 2, 2) != 1;
    wrong += little(bytes, bytes.size() - 8, 8) != crc64_by_bits(std::string_view(bytes).substr(0, bytes.size() - 8));
    for (std::size_t c = 0; c < 16; ++c) {
      const std::size_t column = 16 * p + c, at = 32 + c * (12 + 32 * 12);
      const auto fired_ns = 3'600'000'000'000 + 7'000'000'000 - 99'902'344 +
                            static_cast<std::int64_t>(std::llround(static_cast<double>(column) * 1e8 / 1024));
      wrong += little(bytes, at, 8) != static_cast<std::uint64_t>(fired_ns);
      wrong += little(bytes, at + 8, 2) != column || little(bytes, at + 10, 2) != 1;
      for (std::size_t ring = 0; ring < 32; ++ring) {
        const std::size_t i = ring * 1024 + column, pixel = at + 12 + 12 * ring;
        const double range_m = scan.range_m[i];
        const auto range_mm = returned(scan, i) ? static_cast<std::uint64_t>(std::llround(1000 * range_m + 15.806)) : 0;
        const double intensity = returned(scan, i) ? scan.channel("intensity")->values[i] : 0;
        const auto signal = static_cast<std::uint64_t>(std::llround(10000 * intensity));
        wrong += little(bytes, pixel, 4) != range_mm || little(bytes, pixel + 4, 2) != reflectivity(scan, i);
        wrong += little(bytes, pixel + 6, 2) != signal || little(bytes, pixel + 8, 4) != 0;
        returns += range_mm > 0;
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(returns > table->size() * 4 / 5);
  const auto metadata = nlohmann::json::parse(ouster_metadata(*table));
  CHECK(metadata.at("lidar_data_format").at("udp_profile_lidar") == "RNG19_RFL8_SIG16_NIR16");
  CHECK(metadata.at("beam_intrinsics").at("beam_azimuth_angles").size() == 32);
  CHECK(metadata.at("lidar_data_format").at("pixel_shift_by_row")[0] == -12);  // -4.22 degrees of 1024 columns
}

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
        nlohmann::json{{"sensor", "LIDAR"}, {"packets", 128}, {"bytes", fs::file_size(file)}});
  CHECK(contains(result.out, "os.pcap (128 packets)"));
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
  const ProcessResult kept = record("ouster_os1_128", {"--no-replace"});
  CHECK(kept.exit_code == 2);
  CHECK(is_of("OS-0-32-U1"));
  CHECK(fs::file_size(file) == bytes);
  CHECK(record("ouster_os1_128", {}).exit_code == 0);
  CHECK(is_of("OS-1-128"));
  CHECK(fs::file_size(file) > 2 * bytes);
  // As a run that was killed before its capture has its name.
  fs::remove(file);
  fs::remove_all(folder / "out");
  const ProcessResult other = record("ouster_os0_32", {});
  CHECK(other.exit_code == 2);
  CHECK(contains(other.err, "os.pcap.json: error: exists without its capture file"));
  CHECK(is_of("OS-1-128"));
  CHECK(record("ouster_os1_128", {"--no-replace"}).exit_code == 0);
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

const Strings kDecoders{"velodyne-decoder==3.1.0", "ouster-sdk==1.0.1", "numpy"};

TEST_CASE("the decoders of PyPI read our packets: points, rings, times and reflectivities to the device's resolution") {
  const TemporaryFolder folder;
  const auto packages = test::pip_packages(kDecoders);
  if (!packages) return;
  struct Device {
    const char *preset, *kind, *unit_m;
  };
  for (const Device& device :
       {Device{"velodyne_vlp16", "velodyne", "0.002"}, Device{"velodyne_hdl32e", "velodyne", "0.002"},
        Device{"velodyne_vls128", "velodyne", "0.004"}, Device{"ouster_os1_64", "ouster", "0.001"}}) {
    if (sanitized() && device.preset != std::string("velodyne_vlp16")) continue;  // minutes; the bytes are the same
    CAPTURE(device.preset);
    const fs::path out = folder / device.preset, file = folder / (std::string(device.preset) + ".pcap");
    const std::string sensor = device_sensor(device.preset, R"(firing="pattern" range_noise="0" range_resolution="0")");
    const std::string scene = write_wall_scene(folder.path(), sensor).string();
    const ProcessResult run =
        run_simvis({scene, "--out", out.string(), "--rate", "10", "--frames", "2", "--record-pcap", file.string()});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const Strings command = {"python3",     SIMVIS_SOURCE_DIR "/tests/messages/read_packets.py",
                             device.kind,   file.string(),
                             device.unit_m, (out / "LIDAR.csv").string()};
    const ProcessResult read = Process(command, {"PYTHONPATH=" + packages->string()}).wait();
    INFO(read.err);
    CHECK(read.exit_code == 0);
    CHECK(contains(read.out, " points\n"));
  }
}

TEST_CASE("the decoder of PyPI reads both returns of our packets") {
  const TemporaryFolder folder;
  const auto packages = test::pip_packages(kDecoders);
  if (!packages) return;
  // Boards in front of the wall, whose edges split beams of 0.3 degrees.
  std::string commands;
  for (int i = 0; i < 8; ++i) {
    commands += R"(<part shape="box" size="0.05 0.1 3" name="BOARD)" + std::to_string(i) +
                R"(" insert_at="ROOT" pose_offset="2.5 )" + std::to_string(0.4 * i - 1.4) + " 0 0 0 0\"/>\n";
  }
  commands += device_sensor("velodyne_vlp16", R"(return="dual" divergence="0.3" divergence_samples="16" )"
                                              R"(firing="pattern" range_noise="0" range_resolution="0")");
  const fs::path file = folder / "dual.pcap", out = folder / "out";
  const std::string scene = write_wall_scene(folder.path(), commands).string();
  const ProcessResult run =
      run_simvis({scene, "--out", out.string(), "--rate", "10", "--frames", "2", "--record-pcap", file.string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Strings command = {"python3", SIMVIS_SOURCE_DIR "/tests/messages/read_packets.py",
                           "dual",    file.string(),
                           "0.002",   (out / "LIDAR.csv").string()};
  const ProcessResult read = Process(command, {"PYTHONPATH=" + packages->string()}).wait();
  INFO(read.err);
  CHECK(read.exit_code == 0);
  CHECK(contains(read.out, " points\n"));
}

}  // namespace simvis

TEST_SUITE_END();
