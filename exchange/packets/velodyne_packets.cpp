#include "exchange/packets/velodyne_packets.h"

#include <algorithm>

#include "effects/scanner/dual_return.h"
#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"

namespace simvis {
namespace {

constexpr std::int64_t kHour_us = 3'600'000'000;

class VelodyneEncoder {
 public:
  VelodyneEncoder(const Scan& scan, const BeamTable& table, VelodyneReturn reported)
      : scan_(scan),
        table_(table),
        velodyne_(table.device->velodyne),
        intensity_(scan.channel("intensity")),
        second_m_(scan.channel(kSecondRange)),
        second_intensity_(scan.channel(kSecondIntensity)),
        reported_(reported),
        last_ns_(std::ranges::max(table.time_ns)),
        ring_of_laser_(table.rings) {
    SIMVIS_ASSERT(scan.range_m.size() == table.size() && velodyne_.laser_of_ring.size() == table.rings);
    SIMVIS_ASSERT(!is_dual() || (!second_m_.empty() && !second_intensity_.empty() && has_dual_packets(*table.device)));
    for (std::uint32_t ring = 0; ring < table.rings; ++ring) ring_of_laser_[velodyne_.laser_of_ring[ring]] = ring;
  }

  std::vector<DevicePacket> encode() const {
    const std::uint32_t columns = columns_of_packet();
    std::vector<DevicePacket> packets;
    for (std::uint32_t first = 0; first < table_.beams; first += columns) packets.push_back(packet(first, columns));
    return packets;
  }

 private:
  enum class Part : std::uint8_t { only, last, strongest };

  struct Return {
    double range_m = 0;  // 0 or +infinity: none
    std::uint8_t reflectivity = 0;
  };

  bool is_dual() const { return reported_ == VelodyneReturn::dual; }
  std::uint32_t columns_of_packet() const {
    return kVelodyneBlocks * kVelodyneBlockLasers / table_.rings / (is_dual() ? 2 : 1);
  }

  DevicePacket packet(std::uint32_t first, std::uint32_t columns) const {
    DevicePacket packet{.time_ns = fired_ns(std::min(first + columns, table_.beams) - 1, table_.rings - 1)};
    packet.bytes.reserve(kVelodyneBytes);
    for (std::uint32_t block = 0; block < kVelodyneBlocks; ++block) {
      const std::uint32_t lasers = (is_dual() ? block / 2 : block) * kVelodyneBlockLasers;  // before the block
      const Part part = !is_dual() ? Part::only : block % 2 == 0 ? Part::last : Part::strongest;
      const std::uint32_t column = first + lasers / table_.rings, laser = lasers % table_.rings;
      append_binary(packet.bytes, kVelodyneFlags[laser / kVelodyneBlockLasers]);
      append_binary(packet.bytes, head_azimuth(column));
      for (std::uint32_t i = 0; i < kVelodyneBlockLasers; ++i) {
        const std::uint32_t at = laser + i;
        append_beam(column + at / table_.rings, at % table_.rings, part, packet.bytes);
      }
    }
    append_binary(packet.bytes, stamp_us(first));
    packet.bytes += static_cast<char>(reported_);
    packet.bytes += static_cast<char>(velodyne_.model);
    SIMVIS_ASSERT(packet.bytes.size() == kVelodyneBytes);
    return packet;
  }

  // Beyond the turn's last column there is no measurement.
  void append_beam(std::uint32_t column, std::uint32_t laser, Part part, std::string& bytes) const {
    const Return reported =
        column < table_.beams ? return_of(std::size_t{ring_of_laser_[laser]} * table_.beams + column, part) : Return{};
    const std::uint32_t distance = quantised_range(reported.range_m, velodyne_.distance_unit_m, 0xffff);
    append_binary(bytes, static_cast<std::uint16_t>(distance));
    append_binary(bytes, reported.reflectivity);
  }

  Return return_of(std::size_t i, Part part) const {
    const Return first{scan_.range_m[i], quantised_reflectivity(scan_, intensity_, i)};
    if (part == Part::only || !(first.range_m > 0) || std::isinf(first.range_m)) return first;
    const double second_m = second_m_[i];
    if (!(second_m > 0)) return first;
    const double intensity = second_intensity_[i];
    const Return second{second_m, intensity_.empty()
                                      ? std::uint8_t{0}
                                      : static_cast<std::uint8_t>(calibrated_reflectivity(intensity, second_m))};
    const bool second_is_last = second_m > first.range_m;
    // The strongest return comes first in the scan. Where it is the last one, the other block has the second.
    return (part == Part::last) == second_is_last ? second : first;
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
  SharedNumbers<double> intensity_;
  SharedNumbers<double> second_m_, second_intensity_;  // of two returns
  VelodyneReturn reported_;
  std::int64_t last_ns_;
  std::vector<std::uint32_t> ring_of_laser_;
};

}  // namespace

bool has_dual_packets(const ScannerDevice& device) {
  return device.format == PacketFormat::velodyne && device.velodyne.laser_of_ring.size() <= kVelodyneBlockLasers;
}

std::vector<DevicePacket> velodyne_packets(const Scan& scan, const BeamTable& table, VelodyneReturn reported) {
  return VelodyneEncoder(scan, table, reported).encode();
}

}  // namespace simvis
