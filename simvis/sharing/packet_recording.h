// A recording of the data packets of a laser scanner: a capture file.
#pragma once

#include <optional>
#include <string_view>

#include <simvis/simulation_desc.h>
#include "engine/base/result_lock.h"
#include "exchange/packets/capture_file.h"
#include "simvis/sharing/device_imu.h"
#include "simvis/sharing/device_scanner.h"
#include "simvis/sharing/frame_outlet.h"

namespace simvis {

/// Beside the capture file of an Ouster device stands its metadata, in FILE.json.
class PacketRecording : public FrameOutlet {
 public:
  /// Throws InputError of DeviceScanner and DeviceImu, and if a file is there that is no capture file or no metadata of
  /// one or cannot be read; MachineError of the machine and of ResultLock.
  PacketRecording(const PacketRecordDesc& desc, const BuiltScene& scene);

  std::string_view name() const override { return "recording of packets"; }
  std::string_view stage() const override { return "record"; }
  /// Creates the files with the first frame. Throws MachineError of the file.
  void frame(const Frame& frame) override;
  /// Throws MachineError.
  PacketReport finish();

 private:
  bool writes_metadata() const;
  void check_metadata(bool has_capture) const;
  void write_metadata() const;
  void create();
  void append(std::uint16_t port, const DevicePacket& packet, std::string& records);

  PacketRecordDesc desc_;
  DeviceScanner scanner_;
  std::optional<DeviceImu> imu_;  // of an Ouster
  ResultLock lock_;               // of the metadata too
  std::optional<CaptureFile> file_;
  std::uint64_t packets_ = 0;
};

}  // namespace simvis
