#include "packets/velodyne_packets.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr std::uint32_t kBlocks = 12, kBlockLasers = 32;
constexpr std::uint16_t kBankFlags[] = {0xeeff, 0xddff, 0xccff, 0xbbff};
constexpr std::int64_t kHour_us = 3'600'000'000;

class VelodyneEncoder {
 public:
  VelodyneEncoder(const Scan& scan, const BeamTable& table, VelodyneReturn reported)
      : scan_(scan),
        table_(table),
        velodyne_(table.device->velodyne),
        intensity_(scan.channel("intensity")),
        reported_(reported),
        last_ns_(std::ranges::max(table.time_ns)),
        ring_of_laser_(table.rings) {
    SIMVIS_ASSERT(scan.range_m.size() == table.size() && velodyne_.laser_of_ring.size() == table.rings);
    for (std::uint32_t ring = 0; ring < table.rings; ++ring) ring_of_laser_[velodyne_.laser_of_ring[ring]] = ring;
  }

  std::vector<DevicePacket> encode() const {
    const std::uint32_t columns = columns_of_packet();
    std::vector<DevicePacket> packets;
    for (std::uint32_t first = 0; first < table_.beams; first += columns) packets.push_back(packet(first, columns));
    return packets;
  }

 private:
  std::uint32_t columns_of_packet() const { return kBlocks * kBlockLasers / table_.rings; }

  DevicePacket packet(std::uint32_t first, std::uint32_t columns) const {
    DevicePacket packet{.time_ns = fired_ns(std::min(first + columns, table_.beams) - 1, table_.rings - 1)};
    packet.bytes.reserve(kVelodyneBytes);
    for (std::uint32_t block = 0; block < kBlocks; ++block) {
      const std::uint32_t lasers = block * kBlockLasers;  // before the block
      const std::uint32_t column = first + lasers / table_.rings, laser = lasers % table_.rings;
      append_whole(packet.bytes, kBankFlags[laser / kBlockLasers]);
      append_whole(packet.bytes, head_azimuth(column));
      for (std::uint32_t i = 0; i < kBlockLasers; ++i) {
        const std::uint32_t at = laser + i;
        append_beam(column + at / table_.rings, at % table_.rings, packet.bytes);
      }
    }
    append_whole(packet.bytes, stamp_us(first));
    packet.bytes += static_cast<char>(reported_);
    packet.bytes += static_cast<char>(velodyne_.model);
    SIMVIS_ASSERT(packet.bytes.size() == kVelodyneBytes);
    return packet;
  }

  // Beyond the turn's last column there is no measurement.
  void append_beam(std::uint32_t column, std::uint32_t laser, std::string& bytes) const {
    const std::size_t i = std::size_t{ring_of_laser_[laser]} * table_.beams + column;
    const bool measured = column < table_.beams;
    append_whole(bytes, static_cast<std::uint16_t>(
                            measured ? quantised_range(scan_.range_m[i], velodyne_.distance_unit_m, 0xffff) : 0));
    append_whole(bytes, measured ? quantised_reflectivity(scan_, intensity_, i) : std::uint8_t{0});
  }

  // Clockwise, in hundredths of a degree. The first column looks backwards.
  std::uint16_t head_azimuth(std::uint32_t column) const {
    return static_cast<std::uint16_t>(std::lround(18000 + 36000.0 * column / table_.beams) % 36000);
  }

  std::int64_t fired_ns(std::uint32_t column, std::uint32_t laser) const {
    const std::size_t i = std::size_t{ring_of_laser_[laser]} * table_.beams + column;
    return kDeviceClock_ns + scan_.time_ns - (last_ns_ - table_.time_ns[i]);
  }

  std::uint32_t stamp_us(std::uint32_t column) const {
    const std::int64_t stamp_ns = fired_ns(column, velodyne_.stamped_laser);
    return static_cast<std::uint32_t>((stamp_ns + 500) / 1000 % kHour_us);
  }

  const Scan& scan_;
  const BeamTable& table_;
  const VelodynePackets& velodyne_;
  const ScanChannel* intensity_;
  VelodyneReturn reported_;
  std::int64_t last_ns_;
  std::vector<std::uint32_t> ring_of_laser_;
};

}  // namespace

std::vector<DevicePacket> velodyne_packets(const Scan& scan, const BeamTable& table, VelodyneReturn reported) {
  return VelodyneEncoder(scan, table, reported).encode();
}

}  // namespace simvis
