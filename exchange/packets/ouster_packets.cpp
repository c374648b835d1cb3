#include "exchange/packets/ouster_packets.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"

namespace simvis {
namespace {

constexpr std::uint64_t kSerialNumber = 1;
constexpr double kStandardGravity_m_s2 = 9.80665;

// CRC-64 as XZ has it (ECMA-182, reflected): what ouster-sdk checks.
std::uint64_t crc64_of(std::string_view bytes) {
  constexpr std::uint64_t kPolynomial = 0xc96c5795d7870f42;
  static const auto table = [] {
    std::array<std::uint64_t, 256> entries{};
    for (std::uint64_t i = 0; i < entries.size(); ++i) {
      std::uint64_t entry = i;
      for (int bit = 0; bit < 8; ++bit) entry = entry >> 1 ^ (entry & 1 ? kPolynomial : 0);
      entries[i] = entry;
    }
    return entries;
  }();
  std::uint64_t crc = ~std::uint64_t{0};
  for (const char byte : bytes) crc = table[(crc ^ static_cast<unsigned char>(byte)) & 0xff] ^ crc >> 8;
  return ~crc;
}

class OusterEncoder {
 public:
  OusterEncoder(const Scan& scan, const BeamTable& table, std::uint32_t frame)
      : scan_(scan),
        table_(table),
        ouster_(table.device->ouster),
        intensity_(scan.channel("intensity")),
        frame_(frame),
        last_ns_(std::ranges::max(table.time_ns)),
        reach_m_(std::hypot(ouster_.beam_radius_mm, ouster_.beam_z_mm) / 1000) {
    SIMVIS_ASSERT(scan.range_m.size() == table.size());
  }

  // A device sends the packets that hold at least one column of its window.
  std::vector<DevicePacket> encode() const {
    std::vector<DevicePacket> packets;
    for (std::uint32_t beam = 0; beam < table_.beams;) {
      const std::uint32_t measurement = (ouster_.first_column + beam) % ouster_.columns;
      const std::uint32_t first = measurement / kOusterColumns * kOusterColumns;
      const std::uint32_t count = std::min(first + kOusterColumns - measurement, table_.beams - beam);
      packets.push_back(packet(first, beam, measurement, count));
      beam += count;
    }
    return packets;
  }

 private:
  // Of the columns of the packet, `count` from `measurement` on are measured, by the beams from `beam` on.
  DevicePacket packet(std::uint32_t first, std::uint32_t beam, std::uint32_t measurement, std::uint32_t count) const {
    DevicePacket packet{.time_ns = fired_ns(beam + count - 1)};
    std::string& bytes = packet.bytes;
    append_binary(bytes, std::uint16_t{1});
    append_binary(bytes, static_cast<std::uint16_t>(frame_));
    append_lowest(bytes, std::uint32_t{0}, 3);
    append_lowest(bytes, kSerialNumber, 5);
    bytes.resize(kOusterHeaderBytes, '\0');
    for (std::uint32_t column = first; column < first + kOusterColumns; ++column) {
      const bool measured = column >= measurement && column < measurement + count;
      append_column(column, measured, beam + column - measurement, bytes);
    }
    bytes.resize(bytes.size() + kOusterFooterBytes - sizeof(std::uint64_t), '\0');
    append_binary(bytes, crc64_of(bytes));
    return packet;
  }

  void append_column(std::uint32_t column, bool measured, std::uint32_t beam, std::string& bytes) const {
    const std::size_t end = bytes.size() + kOusterColumnHeaderBytes + table_.rings * kOusterPixelBytes;
    append_binary(bytes, measured ? static_cast<std::uint64_t>(fired_ns(beam)) : std::uint64_t{0});
    append_binary(bytes, static_cast<std::uint16_t>(column));
    append_binary(bytes, static_cast<std::uint16_t>(measured ? 1 : 0));
    for (std::uint32_t ring = 0; measured && ring < table_.rings; ++ring) {
      append_pixel(std::size_t{ring} * table_.beams + beam, bytes);
    }
    bytes.resize(end, '\0');
  }

  void append_pixel(std::size_t i, std::string& bytes) const {
    const double range_m = scan_.range_m[i];
    const std::uint32_t range_mm = quantised_range(range_m > 0 ? range_m + reach_m_ : 0, 0.001, kOusterMaxRange_mm);
    append_binary(bytes, range_mm);
    append_binary(bytes, static_cast<std::uint16_t>(range_mm > 0 ? quantised_reflectivity(scan_, intensity_, i) : 0));
    append_binary(bytes, range_mm > 0 ? quantised_signal(intensity_, i) : std::uint16_t{0});
    append_binary(bytes, std::uint32_t{0});
  }

  std::int64_t fired_ns(std::uint32_t beam) const {
    return kDeviceClock_ns + scan_.time_ns - (last_ns_ - table_.time_ns[beam]);
  }

  const Scan& scan_;
  const BeamTable& table_;
  const OusterPackets& ouster_;
  SharedNumbers<double> intensity_;
  std::uint32_t frame_;
  std::int64_t last_ns_;
  double reach_m_;
};

std::vector<int> pixel_shifts(const OusterPackets& ouster) {
  std::vector<int> shifts;
  for (const double azimuth_deg : ouster.azimuth_deg) {
    shifts.push_back(static_cast<int>(std::lround(azimuth_deg * ouster.columns / 360)));
  }
  return shifts;
}

}  // namespace

std::vector<DevicePacket> ouster_packets(const Scan& scan, const BeamTable& table, std::uint32_t frame) {
  return OusterEncoder(scan, table, frame).encode();
}

DevicePacket ouster_imu_packet(const InertialNumbers& measured, std::int64_t time_ns) {
  DevicePacket packet{.time_ns = kDeviceClock_ns + time_ns};
  for (int clock = 0; clock < 3; ++clock) append_binary(packet.bytes, static_cast<std::uint64_t>(packet.time_ns));
  for (const double each : measured.specific_force_m_s2) {
    append_binary(packet.bytes, static_cast<float>(each / kStandardGravity_m_s2));
  }
  for (const double each : measured.angular_velocity_rad_s) {
    append_binary(packet.bytes, static_cast<float>(each * 180 / std::numbers::pi));
  }
  return packet;
}

std::string ouster_metadata(const BeamTable& table) {
  const OusterPackets& ouster = table.device->ouster;
  const std::string mode = std::to_string(ouster.columns) + "x" + std::to_string(ouster.rate_hz);
  const std::uint32_t last = (ouster.first_column + table.beams - 1) % ouster.columns;
  nlohmann::json metadata;
  metadata["beam_intrinsics"] = {
      {"beam_altitude_angles", ouster.elevation_deg},
      {"beam_azimuth_angles", ouster.azimuth_deg},
      {"beam_to_lidar_transform", {1, 0, 0, ouster.beam_radius_mm, 0, 1, 0, 0, 0, 0, 1, ouster.beam_z_mm, 0, 0, 0, 1}},
      {"lidar_origin_to_beam_origin_mm", ouster.beam_radius_mm}};
  metadata["calibration_status"] = {{"reflectivity", {{"timestamp", ""}, {"valid", true}}}};
  metadata["config_params"] = {{"lidar_mode", mode},
                               {"udp_port_lidar", 7502},
                               {"udp_port_imu", 7503},
                               {"udp_profile_imu", "LEGACY"},
                               {"udp_profile_lidar", "RNG19_RFL8_SIG16_NIR16"},
                               {"columns_per_packet", kOusterColumns}};
  metadata["imu_intrinsics"] = {{"imu_to_sensor_transform", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}};
  metadata["lidar_data_format"] = {{"column_window", {ouster.first_column, last}},
                                   {"columns_per_frame", ouster.columns},
                                   {"columns_per_packet", kOusterColumns},
                                   {"pixel_shift_by_row", pixel_shifts(ouster)},
                                   {"pixels_per_column", table.rings},
                                   {"udp_profile_imu", "LEGACY"},
                                   {"udp_profile_lidar", "RNG19_RFL8_SIG16_NIR16"}};
  metadata["lidar_intrinsics"] = {{"lidar_to_sensor_transform", ouster.lidar_to_sensor}};
  metadata["sensor_info"] = {{"build_date", ""},
                             {"build_rev", "v3.0.1"},
                             {"image_rev", "ousteros-image-prod-bootes-v3.0.1+0"},
                             {"initialization_id", 0},
                             {"prod_line", ouster.product_line},
                             {"prod_pn", ""},
                             {"prod_sn", std::to_string(kSerialNumber)},
                             {"status", "RUNNING"}};
  return metadata.dump(1) + "\n";
}

}  // namespace simvis
