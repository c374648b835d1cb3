// The data packets of a laser scanner, sent by UDP as the device would.
#pragma once

#include <sys/socket.h>

#include <string_view>

#include <simvis/simulation_desc.h>
#include "simvis/sharing/device_scanner.h"
#include "simvis/sharing/frame_outlet.h"

namespace simvis {

/// Packets go out when their frame is complete, all at once. Nothing is received.
class PacketStream : public FrameOutlet {
 public:
  /// Throws InputError of DeviceScanner, and if the address names no host; MachineError without a socket, and if
  /// the resolver does not answer.
  PacketStream(const PacketStreamDesc& desc, const BuiltScene& scene);
  ~PacketStream() override;

  std::string_view name() const override { return "packets by UDP"; }
  std::string_view stage() const override { return "send"; }
  /// Throws MachineError if the system cannot send. It does not say whether anyone receives.
  void frame(const Frame& frame) override;
  PacketReport finish();

 private:
  DeviceScanner scanner_;
  sockaddr_storage to_{};
  socklen_t to_bytes_ = 0;
  int socket_ = -1;
  std::uint64_t packets_ = 0, bytes_ = 0;
};

}  // namespace simvis
