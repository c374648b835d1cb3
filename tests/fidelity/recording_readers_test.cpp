// Readers of recordings: captures of every form, packets of devices against the scans that they are from, MCAP files.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>

#include <simvis/simulation.h>
#include "exchange/fidelity/recordings.h"
#include "exchange/messages/mcap_reader.h"
#include "exchange/messages/mcap_records.h"
#include "exchange/messages/record_file.h"
#include "exchange/packets/device_reader.h"
#include "exchange/packets/ouster_packets.h"
#include "exchange/packets/pcap.h"
#include "exchange/packets/pcap_reader.h"
#include "exchange/packets/velodyne_packets.h"
#include "sensors/beam_tables/device_tables.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("fidelity");

namespace simvis {
namespace {

namespace fs = std::filesystem;

struct ReadDatagram {
  std::uint16_t port;
  std::string payload;
  bool operator==(const ReadDatagram&) const = default;
};

std::vector<ReadDatagram> datagrams_of(const fs::path& file) {
  std::vector<ReadDatagram> all;
  read_pcap(file, [&](const CapturedDatagram& datagram) {
    all.push_back({datagram.port, std::string(datagram.payload)});
    return true;
  });
  return all;
}

BeamTable table_of(std::string_view name) {
  const DeviceTable* const found = find_device_table(name);
  REQUIRE(found != nullptr);
  return found->make(found->index);
}

// Ranges and intensities that tell every beam from its neighbours; some beams have no range.
Scan scan_of(const BeamTable& table) {
  Scan scan(table.rings, table.beams);
  scan.time_ns = 7'000'000'000;
  const std::span<float> ranges_m = scan.edit_ranges().range_m;
  std::vector<double> intensities;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double range_m = 1 + static_cast<double>(i % 997) * 0.0613;
    ranges_m[i] = i % 11 == 0 ? std::numeric_limits<float>::infinity() : static_cast<float>(range_m);
    intensities.push_back((0.01 + static_cast<double>(i % 89) * 0.031) / (range_m * range_m));
  }
  scan.add_channel({.name = "intensity", .format = "%.9g"}, std::move(intensities));
  return scan;
}

// The same record with the numbers of its head in the other order.
std::string swapped(const std::string& pcap) {
  std::string bytes = pcap;
  const auto swap = [&](std::size_t at, std::size_t count) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + count));
  };
  for (const std::size_t at : {0, 8, 12, 16, 20}) swap(at, 4);
  swap(4, 2);
  swap(6, 2);
  for (std::size_t at = 24; at < bytes.size();) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + at + 8, 4);
    for (std::size_t i = 0; i < 16; i += 4) swap(at + i, 4);
    at += 16 + size;
  }
  return bytes;
}

std::string mcap_text(std::string_view text) {
  const auto size = static_cast<std::uint32_t>(text.size());
  return std::string(reinterpret_cast<const char*>(&size), sizeof size) + std::string(text);
}

}  // namespace

TEST_CASE("captures are read in every byte order and link, with fragments and VLAN tags, to the last whole record") {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.pcap";
  const std::vector<ReadDatagram> expected = {{2368, "abc"}, {7502, std::string(24'800, 'x')}};
  const std::string one = pcap_datagram({.port = 2368}, 1'000, 0, expected[0].payload);
  const std::string two = pcap_datagram({.port = 7502}, 2'000, 1, expected[1].payload);
  write_text(file, pcap_header() + one + two);
  CHECK(datagrams_of(file) == expected);
  write_text(file, swapped(pcap_header() + one + two));
  CHECK(datagrams_of(file) == expected);
  std::string nanoseconds = pcap_header() + one + two;
  nanoseconds[0] = '\x4d';
  nanoseconds[1] = '\x3c';
  write_text(file, nanoseconds);
  CHECK(datagrams_of(file) == expected);
  // A VLAN tag, behind the stations' addresses.
  std::string tagged = one;
  tagged.insert(16 + 12, std::string("\x81\x00\x00\x07", 4));
  const auto size = static_cast<std::uint32_t>(tagged.size() - 16);
  std::memcpy(tagged.data() + 8, &size, sizeof size);
  write_text(file, pcap_header() + tagged);
  CHECK(datagrams_of(file) == std::vector{expected[0]});
  // Without the link's header.
  std::string raw_header = pcap_header(), raw = one;
  raw_header[20] = 101;
  raw.erase(16, 14);
  const auto raw_size = static_cast<std::uint32_t>(raw.size() - 16);
  std::memcpy(raw.data() + 8, &raw_size, sizeof raw_size);
  write_text(file, raw_header + raw);
  CHECK(datagrams_of(file) == std::vector{expected[0]});
  write_text(file, pcap_header() + one + two.substr(0, two.size() - 5));
  CHECK(datagrams_of(file) == std::vector{expected[0]});
}

TEST_CASE("files that are no captures are refused with what they are") {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.pcap";
  const auto refused = [&](const std::string& bytes) {
    write_text(file, bytes);
    return error_of([&] { datagrams_of(file); });
  };
  CHECK(contains(refused(""), "a.pcap: error: is no capture file, expected pcap"));
  CHECK(contains(refused(std::string(100, 'x')), "is no capture file"));
  CHECK(contains(refused(std::string("\x0a\x0d\x0d\x0a", 4) + std::string(100, '\0')), "editcap -F pcap"));
  std::string link = pcap_header(), version = pcap_header();
  link[20] = 105;
  version[4] = 3;
  CHECK(contains(refused(link), "on a link of type 105"));
  CHECK(contains(refused(version), "another version of pcap"));
  CHECK(contains(refused(pcap_header() + std::string(16, '\xff')), "has a record of 4294967295 bytes at byte 24"));
  CHECK(contains(error_of([&] { datagrams_of(folder / "none.pcap"); }), "none.pcap"));
}

TEST_CASE("packets of every device give back the beams of the scan, where its table has them") {
  for (const std::string_view name : {"velodyne_vlp16", "velodyne_hdl32e", "velodyne_vls128", "ouster_os1_32"}) {
    CAPTURE(name);
    const BeamTable table = table_of(name);
    const Scan scan = scan_of(table);
    const bool ouster = table.device->format == PacketFormat::ouster;
    const double unit_m = ouster ? 0.001 : table.device->velodyne.distance_unit_m;
    const std::unique_ptr<DeviceReader> reader = make_device_reader(table);
    BeamRecording recording{.source = "test"};
    for (const DevicePacket& packet :
         ouster ? ouster_packets(scan, table, 5) : velodyne_packets(scan, table, VelodyneReturn::strongest)) {
      REQUIRE(reader->add(packet.bytes, recording));
    }
    CHECK(recording.scans == 1);
    REQUIRE(recording.beams.size() == table.size());
    // The azimuth of a head is rounded to 0.01 degrees, twice where a turn within a packet follows from two of them.
    const double angle_rad = ouster ? 1e-12 : glm::radians(0.02);
    std::vector<std::uint32_t> next(table.rings);
    std::size_t wrong = 0;
    for (const RecordedBeam& beam : recording.beams) {
      const std::size_t i = std::size_t{beam.ring} * table.beams + next[beam.ring]++;
      wrong += std::abs(std::remainder(beam.azimuth_rad - glm::radians(table.azimuth_deg[i]), 2 * M_PI)) > angle_rad;
      wrong += beam.elevation_rad != glm::radians(table.elevation_deg[i]) || beam.origin_m != table.origin_m[i];
      const double range_m = scan.range_m[i];
      wrong += std::isinf(range_m) ? !std::isinf(beam.range_m) : !(std::abs(beam.range_m - range_m) <= 0.501 * unit_m);
      if (std::isinf(range_m)) continue;
      const double reflectivity = std::min(255.0, std::round(100 * scan.channel("intensity")[i] * range_m * range_m));
      wrong += beam.intensity != reflectivity;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("of packets with two returns the stronger one is read, whichever of both is the last") {
  for (const std::string_view name : {"velodyne_vlp16", "velodyne_hdl32e"}) {
    CAPTURE(name);
    const BeamTable table = table_of(name);
    Scan scan = scan_of(table);
    std::vector<double> second, light;
    for (std::size_t i = 0; i < table.size(); ++i) {
      // None, a farther one, a nearer one; each has a quarter of the light of the first.
      const double range_m = scan.range_m[i];
      second.push_back(i % 3 == 0 ? std::nan("") : i % 3 == 1 ? range_m + 1.25 : range_m - 0.875);
      light.push_back(scan.channel("intensity")[i] / 4);
    }
    scan.add_channel({.name = "second_range_m", .format = "%.9g"}, std::move(second));
    scan.add_channel({.name = "second_intensity", .format = "%.9g"}, std::move(light));
    const std::unique_ptr<DeviceReader> reader = make_device_reader(table);
    BeamRecording recording{.source = "test"};
    for (const DevicePacket& packet : velodyne_packets(scan, table, VelodyneReturn::dual)) {
      REQUIRE(reader->add(packet.bytes, recording));
    }
    CHECK(recording.scans == 1);
    REQUIRE(recording.beams.size() == table.size());
    std::vector<std::uint32_t> next(table.rings);
    std::size_t wrong = 0;
    for (const RecordedBeam& beam : recording.beams) {
      const double range_m = scan.range_m[std::size_t{beam.ring} * table.beams + next[beam.ring]++];
      // Half a unit of 2 mm, and the rounding of float32.
      wrong += std::isinf(range_m) ? !std::isinf(beam.range_m) : !(std::abs(beam.range_m - range_m) <= 0.501 * 0.002);
    }
    CHECK(wrong == 0);
  }
}

namespace {

// A turn of a VLS-128 with two returns, as its manual lays it out (VLS-128 User Manual, ch. 9): the same bank twice,
// the last return before the strongest; a packet has one firing cycle in its first eight blocks, and four blocks of
// nothing.
std::vector<std::string> dual_packets_of_vls128(const BeamTable& table, const Scan& scan) {
  std::vector<std::string> packets;
  const auto append = [](std::string& bytes, std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
  };
  std::vector<std::uint32_t> ring_of(table.rings);
  for (std::uint32_t ring = 0; ring < table.rings; ++ring) ring_of[table.device->velodyne.laser_of_ring[ring]] = ring;
  for (std::uint32_t column = 0; column < table.beams; ++column) {
    std::string bytes;
    const auto azimuth = static_cast<std::uint64_t>(std::lround(18000 + 36000.0 * column / table.beams) % 36000);
    for (std::uint32_t block = 0; block < 12; ++block) {
      const std::uint64_t flags[] = {0xeeff, 0xddff, 0xccff, 0xbbff};
      append(bytes, block < 8 ? flags[block / 2] : 0xffff, 2);
      append(bytes, block < 8 ? azimuth : 0, 2);
      for (std::uint32_t i = 0; i < 32; ++i) {
        if (block >= 8) {
          append(bytes, 0, 3);
          continue;
        }
        const std::uint32_t ring = ring_of[block / 2 * 32 + i];
        const double range_m = scan.range_m[std::size_t{ring} * table.beams + column];
        const bool none = std::isinf(range_m), is_last = block % 2 == 0;
        // The last return is 2 m behind, and has a tenth of the light; every third beam has one return alone.
        const double of_block_m = is_last && (ring + column) % 3 != 0 ? range_m + 2 : range_m;
        append(bytes, none ? 0 : static_cast<std::uint64_t>(std::lround(of_block_m / 0.004)), 2);
        append(bytes, none ? 0 : is_last && of_block_m != range_m ? 10 : 100, 1);
      }
    }
    append(bytes, 1000 + column, 4);
    append(bytes, 0x39, 1);
    append(bytes, 0xa1, 1);
    packets.push_back(bytes);
  }
  return packets;
}

}  // namespace

TEST_CASE("packets of a VLS-128 with two returns are read by its manual: one firing cycle, and the stronger return") {
  const BeamTable table = table_of("velodyne_vls128");
  const Scan scan = scan_of(table);
  const std::unique_ptr<DeviceReader> reader = make_device_reader(table);
  BeamRecording recording{.source = "test"};
  for (const std::string& packet : dual_packets_of_vls128(table, scan)) REQUIRE(reader->add(packet, recording));
  CHECK(recording.scans == 1);
  REQUIRE(recording.beams.size() == table.size());
  std::vector<std::uint32_t> next(table.rings);
  std::size_t wrong = 0;
  for (const RecordedBeam& beam : recording.beams) {
    const std::size_t i = std::size_t{beam.ring} * table.beams + next[beam.ring]++;
    const double range_m = scan.range_m[i];
    // The head's azimuth is rounded to 0.01 degrees; half a unit of 4 mm, and the rounding of float32.
    wrong +=
        std::abs(std::remainder(beam.azimuth_rad - glm::radians(table.azimuth_deg[i]), 2 * M_PI)) > glm::radians(0.01);
    wrong += beam.elevation_rad != glm::radians(table.elevation_deg[i]);
    wrong += std::isinf(range_m) ? !std::isinf(beam.range_m)
                                 : !(std::abs(beam.range_m - range_m) <= 0.501 * 0.004) || beam.intensity != 100;
  }
  CHECK(wrong == 0);
}

TEST_CASE("a capture of a head that stands is refused before it fills the memory") {
  const TemporaryFolder folder;
  const BeamTable table = table_of("velodyne_vlp16");
  std::string packet = velodyne_packets(scan_of(table), table, VelodyneReturn::strongest).front().bytes;
  for (std::size_t block = 0; block < 12; ++block) packet.replace(block * 100 + 2, 2, packet, 2, 2);  // its azimuth
  std::string capture = pcap_header();
  const std::size_t packets = 9 * table.size() / (12 * 32);
  for (std::size_t i = 0; i < packets; ++i) capture += pcap_datagram({.port = 2368}, 1'000 + i, i % 65536, packet);
  write_text(folder / "still.pcap", capture);
  const std::string error = error_of([&] { read_capture(folder / "still.pcap", table, 20); });
  CHECK(contains(error, "still.pcap: error: has more than 230400 beams in one turn, expected a "));
  CHECK(contains(error, "that turns"));
}

TEST_CASE("packets of other devices and of no device are told apart, whatever their bytes are") {
  const BeamTable vlp16 = table_of("velodyne_vlp16"), hdl32e = table_of("velodyne_hdl32e"),
                  os1 = table_of("ouster_os1_32");
  const std::string packet = velodyne_packets(scan_of(vlp16), vlp16, VelodyneReturn::last).front().bytes;
  BeamRecording recording{.source = "test"};
  CHECK(contains(error_of([&] { make_device_reader(hdl32e)->add(packet, recording); }),
                 "holds packets of a VLP-16, expected those of a Velodyne HDL-32E"));
  CHECK_FALSE(make_device_reader(os1)->add(packet, recording));
  CHECK_FALSE(make_device_reader(vlp16)->add("", recording));
  CHECK_FALSE(make_device_reader(vlp16)->add(std::string(512, 'x'), recording));  // as those of its clock
  std::string mode = packet, block = packet;
  mode[1204] = 3;
  block[0] = 0;
  CHECK(contains(error_of([&] { make_device_reader(vlp16)->add(mode, recording); }), "return mode 3"));
  CHECK(contains(error_of([&] { make_device_reader(vlp16)->add(block, recording); }), "wrong block"));
  CHECK(recording.beams.empty());
  // Random bytes in the places of numbers are refused or read, and nothing else.
  std::mt19937 random(1);
  const std::string ouster = ouster_packets(scan_of(os1), os1, 1).front().bytes;
  for (int i = 0; i < 200; ++i) {
    std::string broken = i % 2 == 0 ? packet : ouster;
    for (int k = 0; k < 20; ++k) broken[random() % broken.size()] = static_cast<char>(random());
    try {
      make_device_reader(i % 2 == 0 ? vlp16 : os1)->add(broken, recording);
    } catch (const InputError&) {
    }
  }
}

TEST_CASE("MCAP files that are no recordings are refused with what they are") {
  using ros::McapOpcode;
  using ros::McapRecord;
  const TemporaryFolder folder;
  const fs::path file = folder / "a.mcap";
  Scan nominal;
  const auto refused = [&](const std::string& bytes, const std::string& topic = {}) {
    write_text(file, bytes);
    return error_of([&] { read_cloud_messages(file, topic, nominal, 1); });
  };
  const std::string magic(ros::kMcapMagic);
  CHECK(contains(refused("no MCAP"), "a.mcap: error: is no MCAP file"));
  CHECK(contains(refused(magic), "has no topic with PointCloud2 or LaserScan"));
  const auto channel = [](std::uint16_t id, const char* topic, const char* type, const char* encoding = "cdr") {
    return McapRecord(McapOpcode::schema).number(id).text(type).text("ros2msg").text("").bytes() +
           McapRecord(McapOpcode::channel)
               .number(id)
               .number(id)
               .text(topic)
               .text(encoding)
               .map(std::map<std::string, std::string>())
               .bytes();
  };
  const auto message = [](std::uint16_t id, std::string_view bytes) {
    return McapRecord(McapOpcode::message)
        .number(id)
        .number(std::uint32_t{0})
        .number(std::uint64_t{0})
        .number(std::uint64_t{0})
        .raw(bytes)
        .bytes();
  };
  const std::string scan = channel(1, "/scan", "sensor_msgs/msg/LaserScan"),
                    cloud = channel(2, "/points", "sensor_msgs/msg/PointCloud2");
  const std::string other = channel(3, "/imu", "sensor_msgs/msg/Imu");
  CHECK(contains(refused(magic + other + message(3, "x")), "but /imu, expected the scans of a laser scanner"));
  CHECK(contains(refused(magic + scan + cloud + message(1, "") + message(2, "")), "one of: /points, /scan"));
  CHECK(contains(refused(magic + scan + message(1, ""), "/scam"),
                 "has no scans in the topic \"/scam\", expected one of: /scan"));
  CHECK(contains(refused(magic + scan + message(1, "xx")),
                 "topic /scan, message 0: message sensor_msgs/msg/LaserScan, byte 0: has no encapsulation"));
  CHECK(contains(refused(magic + channel(1, "/scan", "sensor_msgs/msg/LaserScan", "json") + message(1, "{}")),
                 R"(encoded as "json", expected cdr)"));
  CHECK(contains(refused(magic + message(9, "")), "a channel that it does not describe"));
  const auto chunk = [](const std::string& compression, const std::string& bytes, std::uint32_t checksum = 0) {
    const std::uint64_t size = bytes.size();
    return McapRecord(McapOpcode::chunk)
        .number(std::uint64_t{0})
        .number(std::uint64_t{0})
        .number(std::uint64_t{100})
        .number(checksum)
        .raw(mcap_text(compression))
        .number(size)
        .raw(bytes)
        .bytes();
  };
  CHECK(contains(refused(magic + chunk("lz4", "x")), "is compressed with lz4, expected zstd or none"));
  CHECK(contains(refused(magic + chunk("zstd", "x")), "has a damaged chunk"));
  CHECK(contains(refused(magic + chunk("", "\x05xx")), "has a record that ends too early"));
  CHECK(contains(refused(magic + chunk("", scan, 1)), "has a damaged chunk: its checksum differs"));
  CHECK_FALSE(contains(refused(magic + chunk("", scan, ros::mcap_crc(scan))), "checksum"));
}

}  // namespace simvis

TEST_SUITE_END();
