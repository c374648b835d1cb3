#include "simvis/sharing/packet_recording.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/input_file.h"
#include "engine/base/output_target.h"
#include "engine/base/read_error.h"
#include "engine/base/temporary_file.h"
#include "exchange/packets/ouster_packets.h"
#include "exchange/packets/pcap.h"

namespace simvis {
namespace {

// The beginning of a capture file is the same in all of them, up to the version.
constexpr std::size_t kCaptureStart = 8;

// Bytes that every metadata file of SimVis begins with.
constexpr std::size_t kMetadataStart = 20;

/// The first bytes of a file; empty if there is none. Throws if it cannot be read: it is not replaced then.
std::string start_of(const std::filesystem::path& file, std::size_t bytes) {
  if (!is_there(file)) return {};
  const InputFile input(file);
  const Bytes start = input.read(0, std::min<std::uint64_t>(input.size(), bytes));
  return {reinterpret_cast<const char*>(start.data()), start.size()};
}

void remove_file(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::remove(file, error);
  if (error) throw MachineError(file.string() + ": error: cannot be removed: " + error.message());
}

[[noreturn]] void refuse_to_replace(const std::filesystem::path& file, const char* what) {
  throw InputError(file.string() + ": error: exists and is no " + what + ", expected a new file or one to replace");
}

std::filesystem::path metadata_file(const std::filesystem::path& file) { return file.string() + ".json"; }

}  // namespace

PacketRecording::PacketRecording(const PacketRecordDesc& desc, const BuiltScene& scene)
    : desc_(desc), scanner_(desc.sensor, scene), lock_(desc.file) {
  if (scanner_.table().device->format == PacketFormat::ouster) imu_.emplace(scanner_.sensor(), scene);
  const OutputTarget target = output_target(desc.file);
  if (target.is_stream) return;
  const std::string start = start_of(target.file, kCaptureStart);
  if (!start.empty() && start != pcap_header().substr(0, kCaptureStart)) refuse_to_replace(desc.file, "capture file");
  if (writes_metadata()) check_metadata(!start.empty());
}

/// The metadata of an earlier capture stand beside it. Without a capture, only those that this run writes may stand
/// there: a run that was killed has left them.
void PacketRecording::check_metadata(bool has_capture) const {
  const std::filesystem::path file = output_target(metadata_file(desc_.file)).file;
  remove_leftovers_of(file);
  const std::string written = ouster_metadata(scanner_.table()), found = start_of(file, written.size() + 1);
  if (found.empty() || found == written) return;
  if (!found.starts_with(std::string_view(written).substr(0, kMetadataStart))) {
    refuse_to_replace(metadata_file(desc_.file), "metadata of a capture");
  }
  if (has_capture) return;
  throw InputError(file.string() + ": error: exists without its capture file, expected another name for " +
                   desc_.file.string());
}

bool PacketRecording::writes_metadata() const {
  return scanner_.table().device->format == PacketFormat::ouster && !output_target(desc_.file).is_stream;
}

// A capture has its name after its metadata, and never stands beside those of another one, so that a run may be killed
// at any moment.
void PacketRecording::create() {
  file_.emplace(desc_.file, pcap_header(), [&] {
    if (writes_metadata()) write_metadata();
  });
}

void PacketRecording::write_metadata() const {
  const std::filesystem::path file = metadata_file(desc_.file);
  const std::string written = ouster_metadata(scanner_.table());
  if (start_of(file, written.size() + 1) == written) return;
  remove_file(output_target(file).file);
  remove_file(output_target(desc_.file).file);
  CaptureFile(file, written).close();
}

void PacketRecording::frame(const Frame& frame) {
  if (!file_) create();
  if (imu_) imu_->measure(frame);
  std::string records;
  for (const DevicePacket& packet : scanner_.packets(frame)) {
    if (imu_) {
      for (const DevicePacket& inertial : imu_->until(packet.time_ns)) append(imu_->port(), inertial, records);
    }
    append(scanner_.port(), packet, records);
  }
  file_->append(records);
}

void PacketRecording::append(std::uint16_t port, const DevicePacket& packet, std::string& records) {
  records += pcap_datagram({.port = port}, packet.time_ns, static_cast<std::uint16_t>(packets_++), packet.bytes);
}

PacketReport PacketRecording::finish() {
  if (!file_) return {.sensor = scanner_.sensor()};
  file_->close();
  return {.sensor = scanner_.sensor(), .packets = packets_, .bytes = file_->size()};
}

}  // namespace simvis
