// Recordings of real laser scanners: captures with the packets of each device, and MCAP files.
#include "exchange/fidelity/recordings.h"
#include "sensors/beam_tables/device_tables.h"
#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {
namespace {

constexpr std::uint32_t kScans = 2;

// The first byte chooses the device.
void read_capture_file(Input input) {
  static const std::vector<BeamTable> tables = [] {
    std::vector<BeamTable> all;
    for (const char* const name : {"velodyne_vlp16", "velodyne_vls128", "ouster_os1_32"}) {
      const DeviceTable* const found = find_device_table(name);
      all.push_back(found->make(found->index));
    }
    return all;
  }();
  InputBytes bytes(input);
  const BeamTable& table = tables[bytes.byte() % tables.size()];
  read_capture(input_file("recording.pcap", bytes.rest()), table, kScans);
}

void read_mcap_file(Input input) {
  Scan nominal(1, 4);
  nominal.set_angles({0, 1, 2, 3}, {0});
  nominal.edit_ranges();
  read_cloud_messages(input_file("recording.mcap", input), {}, nominal, kScans);
}

const TargetRegistration kCapture("capture", read_capture_file), kRecording("recording", read_mcap_file);

}  // namespace
}  // namespace simvis::fuzz
