#include "simvis/sharing/packet_recording.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/output_target.h"
#include "packets/ouster_packets.h"
#include "packets/pcap.h"

namespace simvis {
namespace {

// The beginning of a capture file is the same in all of them, up to the version.
constexpr std::size_t kCaptureStart = 8;

bool is_replaceable_capture(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  if (!stream && std::filesystem::exists(file, error)) return false;  // what cannot be read is not replaced
  if (error) return false;
  std::string start(kCaptureStart, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  return stream.gcount() == 0 || start == pcap_header().substr(0, kCaptureStart);
}

std::filesystem::path metadata_file(const std::filesystem::path& file) { return file.string() + ".json"; }

}  // namespace

PacketRecording::PacketRecording(const PacketRecordDesc& desc, const BuiltScene& scene)
    : desc_(desc), scanner_(desc.sensor, scene) {
  const OutputTarget target = output_target(desc.file);
  if (!target.is_stream && !is_replaceable_capture(target.file)) {
    throw InputError(desc.file.string() +
                     ": error: exists and is no capture file, expected a new file or one to replace");
  }
  // The metadata of an earlier capture stand beside it; a file of this name without a capture is something else.
  const std::filesystem::path metadata = metadata_file(desc.file);
  if (writes_metadata() && std::filesystem::exists(metadata) && !std::filesystem::exists(target.file)) {
    throw InputError(metadata.string() + ": error: exists without its capture file, expected another name for " +
                     desc.file.string());
  }
}

bool PacketRecording::writes_metadata() const {
  return scanner_.table().device->format == PacketFormat::ouster && !output_target(desc_.file).is_stream;
}

void PacketRecording::create() {
  file_.emplace(desc_.file, pcap_header());
  if (writes_metadata()) CaptureFile(metadata_file(desc_.file), ouster_metadata(scanner_.table())).close();
}

void PacketRecording::frame(const Frame& frame) {
  if (!file_) create();
  std::string records;
  for (const DevicePacket& packet : scanner_.packets(frame)) {
    records +=
        pcap_datagram({.port = scanner_.port()}, packet.time_ns, static_cast<std::uint16_t>(packets_++), packet.bytes);
  }
  file_->append(records);
}

PacketReport PacketRecording::finish() {
  if (!file_) return {.sensor = scanner_.sensor()};
  file_->close();
  return {.sensor = scanner_.sensor(), .packets = packets_, .bytes = file_->size()};
}

}  // namespace simvis
