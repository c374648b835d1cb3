// Decodes data packets of Velodyne scanners, see exchange/packets/velodyne_packets.h for their layout. Of packets with
// two returns the strongest is read: the second block of a pair, and the first one where the strongest return is the
// last.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "exchange/packets/device_reader.h"
#include "exchange/packets/velodyne_packets.h"
#include "sensors/beam_tables/turn.h"

namespace simvis {
namespace {

constexpr std::size_t kReadBlockBytes = 100, kReadLaserBytes = 3;
constexpr std::uint32_t kTurn = 36000;  // hundredths of a degree

std::string model_name(std::uint64_t model) {
  switch (model) {
    case 0x21:
      return "an HDL-32E";
    case 0x22:
      return "a VLP-16";
    case 0x24:
      return "a Puck Hi-Res";
    case 0x28:
      return "a VLP-32C";
    case 0x63:
    case 0xa1:
      return "a VLS-128";
    default:
      return "an unknown model (byte " + std::to_string(model) + ")";
  }
}

class VelodyneReader : public DeviceReader {
 public:
  explicit VelodyneReader(const BeamTable& table) : table_(table) {
    const double cycle_ns = static_cast<double>(table.time_ns[1] - table.time_ns[0]);
    const double step_deg = 360.0 / table.beams;
    lasers_.resize(table.rings);
    for (std::uint32_t ring = 0; ring < table.rings; ++ring) {
      const std::size_t first = std::size_t{ring} * table.beams;
      Laser& laser = lasers_[velodyne_.laser_of_ring[ring]];
      laser.ring = ring;
      laser.fired = static_cast<double>(table.time_ns[first]) / cycle_ns;
      laser.rotation_deg = wrapped_deg(table.azimuth_deg[first] + 180 + step_deg * laser.fired);
    }
  }

  std::size_t packet_bytes() const override { return kVelodyneBytes; }

  bool add(std::string_view datagram, BeamRecording& recording) override {
    if (datagram.size() != kVelodyneBytes) return false;
    const auto mode = static_cast<VelodyneReturn>(binary_at<std::uint8_t>(datagram, kVelodyneBytes - 2));
    const std::uint64_t model = binary_at<std::uint8_t>(datagram, kVelodyneBytes - 1);
    if (model != velodyne_.model) {
      throw InputError("holds packets of " + model_name(model) + ", expected those of a " + table_.device->name);
    }
    if (mode != VelodyneReturn::strongest && mode != VelodyneReturn::last && mode != VelodyneReturn::dual) {
      throw InputError("holds packets with the return mode " + std::to_string(static_cast<int>(mode)) +
                       ", expected 55, 56 or 57");
    }
    is_dual_ = mode == VelodyneReturn::dual;
    check_blocks(datagram);
    for (std::size_t block = is_dual_ ? 1 : 0; block < used_blocks(); block += is_dual_ ? 2 : 1) {
      add_block(datagram, block, recording);
    }
    return true;
  }

 private:
  struct Laser {
    std::uint32_t ring = 0;
    double fired = 0;         // after the beginning of its cycle, as a share of the cycle
    double rotation_deg = 0;  // counter-clockwise from the head
  };

  // Blocks of one firing cycle, or of one return of it.
  std::size_t blocks_of_cycle() const { return banks() * (is_dual_ ? 2 : 1); }

  // A firing cycle does not go on in the next packet: the last four blocks of a VLS-128 with two returns are empty.
  std::size_t used_blocks() const { return kVelodyneBlocks / blocks_of_cycle() * blocks_of_cycle(); }

  void check_blocks(std::string_view datagram) const {
    for (std::size_t block = 0; block < used_blocks(); ++block) {
      const std::uint64_t azimuth = binary_at<std::uint16_t>(datagram, block * kReadBlockBytes + 2);
      if (bank_of(datagram, block) < banks() && azimuth < kTurn) continue;
      throw InputError("holds a packet with a wrong block, expected data packets of a " + table_.device->name);
    }
  }

  std::size_t banks() const { return std::max<std::size_t>(1, table_.rings / kVelodyneBlockLasers); }

  static std::size_t bank_of(std::string_view datagram, std::size_t block) {
    const std::uint64_t flag = binary_at<std::uint16_t>(datagram, block * kReadBlockBytes);
    return static_cast<std::size_t>(std::ranges::find(kVelodyneFlags, flag) - std::begin(kVelodyneFlags));
  }

  static double azimuth_of(std::string_view datagram, std::size_t block) {
    return static_cast<double>(binary_at<std::uint16_t>(datagram, block * kReadBlockBytes + 2));
  }

  // How far the head turns in one firing cycle, in hundredths of a degree: over the cycles of this packet.
  double turned_in_cycle(std::string_view datagram) const {
    const std::size_t step = blocks_of_cycle(), last = (used_blocks() - 1) / step * step;
    if (last == 0) return static_cast<double>(kTurn) / table_.beams;  // the packet has one cycle
    const double cycles_of_block = table_.rings < kVelodyneBlockLasers ? kVelodyneBlockLasers / table_.rings : 1;
    double turned = azimuth_of(datagram, last) - azimuth_of(datagram, 0);
    if (turned < 0) turned += kTurn;
    const std::size_t blocks = last / step;
    return turned / (static_cast<double>(blocks) * cycles_of_block);
  }

  void add_block(std::string_view datagram, std::size_t block, BeamRecording& recording) {
    const double head = azimuth_of(datagram, block), step = turned_in_cycle(datagram);
    count_turns(head, recording);
    for (std::size_t i = 0; i < kVelodyneBlockLasers; ++i) {
      const std::size_t number = bank_of(datagram, block) * kVelodyneBlockLasers + i;
      const Laser& laser = lasers_[number % table_.rings];
      const std::size_t cycle_of_laser = i / table_.rings;
      const double cycle = table_.rings < kVelodyneBlockLasers ? static_cast<double>(cycle_of_laser) : 0;
      const std::size_t at = block * kReadBlockBytes + 4 + i * kReadLaserBytes;
      std::uint64_t distance = binary_at<std::uint16_t>(datagram, at),
                    reflectivity = binary_at<std::uint8_t>(datagram, at + 2);
      if (is_dual_) take_stronger(datagram, at - kReadBlockBytes, distance, reflectivity);
      const double azimuth_deg = wrapped_deg(laser.rotation_deg - (head + step * (cycle + laser.fired)) / 100);
      const std::size_t beam = std::size_t{laser.ring} * table_.beams;
      RecordedBeam recorded{.ring = laser.ring,
                            .scan = recording.scans - 1,
                            .azimuth_rad = glm::radians(azimuth_deg),
                            .elevation_rad = glm::radians(table_.elevation_deg[beam]),
                            .origin_m = table_.origin_m.empty() ? glm::dvec3(0) : table_.origin_m[beam]};
      if (distance > 0) {
        recorded.range_m = static_cast<double>(distance) * velodyne_.distance_unit_m;
        recorded.intensity = static_cast<double>(reflectivity);
      }
      recording.beams.push_back(recorded);
    }
  }

  // If the strongest return is the last one, the second block has the second strongest.
  static void take_stronger(std::string_view datagram, std::size_t at, std::uint64_t& distance,
                            std::uint64_t& reflectivity) {
    const std::uint64_t last_distance = binary_at<std::uint16_t>(datagram, at);
    const std::uint64_t last_reflectivity = binary_at<std::uint8_t>(datagram, at + 2);
    const auto power = [](std::uint64_t units, std::uint64_t unitless) {
      return units == 0 ? 0.0
                        : static_cast<double>(unitless) / (static_cast<double>(units) * static_cast<double>(units));
    };
    if (distance != 0 && power(last_distance, last_reflectivity) <= power(distance, reflectivity)) return;
    distance = last_distance;
    reflectivity = last_reflectivity;
  }

  void count_turns(double head, BeamRecording& recording) {
    if (recording.scans == 0) {
      recording.scans = 1;
      turned_ = 0;
    } else {
      const double step = head - head_;
      turned_ += step < 0 ? step + kTurn : step;
    }
    head_ = head;
    for (; turned_ >= kTurn; turned_ -= kTurn) ++recording.scans;
  }

  BeamTable table_;
  const VelodynePackets& velodyne_ = table_.device->velodyne;
  std::vector<Laser> lasers_;
  double head_ = 0, turned_ = 0;
  bool is_dual_ = false;
};

}  // namespace

std::unique_ptr<DeviceReader> make_velodyne_reader(const BeamTable& table) {
  return std::make_unique<VelodyneReader>(table);
}

std::unique_ptr<DeviceReader> make_device_reader(const BeamTable& table) {
  return table.device->format == PacketFormat::ouster ? make_ouster_reader(table) : make_velodyne_reader(table);
}

}  // namespace simvis
