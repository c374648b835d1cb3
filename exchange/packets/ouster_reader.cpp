// Decodes data packets of Ouster sensors, see exchange/packets/ouster_packets.h for their layout.
#include <cmath>
#include <optional>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "exchange/packets/device_reader.h"
#include "exchange/packets/ouster_packets.h"

namespace simvis {
namespace {

constexpr std::uint64_t kLidarPacket = 1;

class OusterPacketReader : public DeviceReader {
 public:
  explicit OusterPacketReader(const BeamTable& table)
      : table_(table), reach_m_(std::hypot(ouster_.beam_radius_mm, ouster_.beam_z_mm) / 1000) {}

  std::size_t packet_bytes() const override {
    return kOusterHeaderBytes + kOusterColumns * (kOusterColumnHeaderBytes + table_.rings * kOusterPixelBytes) +
           kOusterFooterBytes;
  }

  bool add(std::string_view datagram, BeamRecording& recording) override {
    if (datagram.size() != packet_bytes() || binary_at<std::uint16_t>(datagram, 0) != kLidarPacket) return false;
    const std::uint64_t frame = binary_at<std::uint16_t>(datagram, 2);
    if (frame != frame_) ++recording.scans;
    frame_ = frame;
    for (std::uint32_t column = 0; column < kOusterColumns; ++column) {
      const std::size_t at =
          kOusterHeaderBytes + column * (kOusterColumnHeaderBytes + table_.rings * kOusterPixelBytes);
      const bool measured = (binary_at<std::uint16_t>(datagram, at + 10) & 1) != 0;
      if (measured) add_column(datagram, at, recording);
    }
    return true;
  }

 private:
  void add_column(std::string_view datagram, std::size_t at, BeamRecording& recording) const {
    const std::uint64_t measurement = binary_at<std::uint16_t>(datagram, at + 8);
    if (measurement >= ouster_.columns) {
      throw InputError("holds a packet with column " + std::to_string(measurement) + ", expected one below " +
                       std::to_string(ouster_.columns) + " as the metadata say");
    }
    const std::uint64_t beam = (measurement + ouster_.columns - ouster_.first_column) % ouster_.columns;
    if (beam >= table_.beams) return;
    for (std::uint32_t ring = 0; ring < table_.rings; ++ring) {
      const std::size_t i = std::size_t{ring} * table_.beams + beam,
                        pixel = at + kOusterColumnHeaderBytes + ring * kOusterPixelBytes;
      RecordedBeam recorded{.ring = ring,
                            .scan = recording.scans - 1,
                            .azimuth_rad = glm::radians(table_.azimuth_deg[i]),
                            .elevation_rad = glm::radians(table_.elevation_deg[i]),
                            .origin_m = table_.origin_m[i]};
      const std::uint64_t range_mm = binary_at<std::uint32_t>(datagram, pixel) & kOusterMaxRange_mm;
      if (range_mm > 0) {
        recorded.range_m = static_cast<double>(range_mm) / 1000 - reach_m_;
        recorded.intensity = static_cast<double>(binary_at<std::uint8_t>(datagram, pixel + 4));
      }
      recording.beams.push_back(recorded);
    }
  }

  BeamTable table_;
  const OusterPackets& ouster_ = table_.device->ouster;
  double reach_m_;
  std::optional<std::uint64_t> frame_;
};

}  // namespace

std::unique_ptr<DeviceReader> make_ouster_reader(const BeamTable& table) {
  return std::make_unique<OusterPacketReader>(table);
}

}  // namespace simvis
