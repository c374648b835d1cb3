#include <simvis/error.h>
#include "engine/base/assert.h"
#include "exchange/fidelity/recordings.h"
#include "exchange/packets/device_reader.h"
#include "exchange/packets/pcap_reader.h"

namespace simvis {
namespace {

constexpr double kOusterUnit_m = 0.001, kMaxReflectivity = 255;

// A turn at a quarter of the table's rate, and twice as many again. More in one turn are those of a head that stands,
// or of packets that say so, and would fill the memory.
constexpr std::size_t kMaxTurns = 8;

// Throws InputError when a turn has more beams than a turn can have.
class TurnLimit {
 public:
  explicit TurnLimit(const BeamTable& table) : most_(kMaxTurns * table.size()) {}

  void check(const BeamRecording& recording) {
    if (recording.scans != scans_) {
      scans_ = recording.scans;
      first_ = recording.beams.size();
    }
    if (recording.beams.size() - first_ <= most_) return;
    throw InputError("has more than " + std::to_string(most_) + " beams in one turn, expected a " + recording.source +
                     " that turns");
  }

 private:
  std::size_t most_, first_ = 0;
  std::uint32_t scans_ = 0;
};

struct OtherDatagrams {
  std::uint64_t count = 0;
  std::size_t bytes = 0;  // of the first one
  std::uint16_t port = 0;
};

}  // namespace

BeamRecording read_capture(const std::filesystem::path& file, const BeamTable& table, std::uint32_t scans) {
  SIMVIS_ASSERT(table.device != nullptr && scans > 0);
  const std::unique_ptr<DeviceReader> reader = make_device_reader(table);
  BeamRecording recording{.source = table.device->name,
                          .rings = table.rings,
                          .range_unit_m = table.device->format == PacketFormat::ouster
                                              ? kOusterUnit_m
                                              : table.device->velodyne.distance_unit_m,
                          .max_intensity = kMaxReflectivity,
                          .intensity_unit = 1,
                          .has_lost_beams = true};
  OtherDatagrams others;
  TurnLimit limit(table);
  read_pcap(file, [&](const CapturedDatagram& datagram) {
    try {
      if (!reader->add(datagram.payload, recording) && others.count++ == 0) {
        others.bytes = datagram.payload.size();
        others.port = datagram.port;
      }
      limit.check(recording);
    } catch (const InputError& error) {
      throw InputError(file.string() + ": error: " + error.what());
    }
    return recording.scans <= scans;
  });
  // The packet that begins the next turn has ended the last one.
  std::erase_if(recording.beams, [&](const RecordedBeam& beam) { return beam.scan >= scans; });
  recording.scans = std::min(recording.scans, scans);
  if (!recording.beams.empty()) return recording;
  const std::string expected =
      "data packets of " + std::to_string(reader->packet_bytes()) + " bytes of a " + table.device->name;
  throw InputError(file.string() + ": error: " +
                   (others.count == 0
                        ? "holds no datagrams"
                        : "holds " + std::to_string(others.count) + " other datagrams, the first of " +
                              std::to_string(others.bytes) + " bytes to port " + std::to_string(others.port)) +
                   ", expected " + expected);
}

}  // namespace simvis
