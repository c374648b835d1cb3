// Data packets of laser scanners: their bytes against the layouts of the manuals, worked out here.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "exchange/packets/ouster_packets.h"
#include "exchange/packets/velodyne_packets.h"
#include "sensors/beam_tables/device_tables.h"
#include "tests/messages/captured_datagrams.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using test::little;
using test::network;

std::shared_ptr<const BeamTable> device_table(std::string_view name) {
  const DeviceTable* const found = find_device_table(name);
  REQUIRE(found != nullptr);
  return std::make_shared<const BeamTable>(found->make(found->index));
}

// Ranges and intensities that tell every beam from its neighbours; some beams have no range.
Scan made_up_scan(const BeamTable& table) {
  Scan scan(table.rings, table.beams);
  scan.time_ns = 7'000'000'000;
  const std::span<float> ranges_m = scan.edit_ranges().range_m;
  std::vector<double> intensities;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double range_m = 1 + static_cast<double>(i % 997) * 0.0613;
    const bool none = i % 11 == 0, blocked = i % 13 == 0;
    ranges_m[i] = none ? std::numeric_limits<float>::infinity() : blocked ? 0 : static_cast<float>(range_m);
    intensities.push_back(none || blocked ? std::nan("")
                                          : (0.01 + static_cast<double>(i % 89) * 0.031) / (range_m * range_m));
  }
  scan.add_channel({.name = "intensity", .format = "%.9g"}, std::move(intensities));
  return scan;
}

bool returned(const Scan& scan, std::size_t i) { return scan.range_m[i] > 0 && std::isfinite(scan.range_m[i]); }

std::uint64_t reflectivity(const Scan& scan, std::size_t i) {
  if (!returned(scan, i)) return 0;
  const double range_m = scan.range_m[i];
  return static_cast<std::uint64_t>(
      std::min(255.0, std::round(100 * scan.channel("intensity")[i] * range_m * range_m)));
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
    std::vector<double> second, light;
    for (std::size_t i = 0; i < table->size(); ++i) {
      // None, a farther one, a nearer one.
      const double second_m = i % 3 == 0 ? std::nan("") : i % 3 == 1 ? scan.range_m[i] + 1.25 : scan.range_m[i] - 0.875;
      second.push_back(second_m);
      light.push_back(0.4 / (second_m * second_m));
    }
    scan.add_channel({.name = "second_range_m", .format = "%.9g"}, std::move(second));
    scan.add_channel({.name = "second_intensity", .format = "%.9g"}, std::move(light));
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
          const double strongest_m = scan.range_m[i], other_m = scan.channel("second_range_m")[i];
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
        const double intensity = returned(scan, i) ? scan.channel("intensity")[i] : 0;
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
}  // namespace simvis

TEST_SUITE_END();
