// The laser scanner of a scene whose data packets are recorded or sent.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "exchange/packets/device_packet.h"
#include "exchange/packets/pcap.h"
#include "exchange/packets/velodyne_packets.h"
#include "sensors/beam_tables/beam_table.h"
#include "simvis/frame.h"

namespace simvis {

class DeviceScanner {
 public:
  /// `sensor` empty: the scene's only laser scanner. Throws InputError if there is no such scanner, more than one for
  /// an empty name, or if its beams are not those of a device with packets.
  DeviceScanner(const std::string& sensor, const BuiltScene& scene);

  /// The packets of its measurement in this frame; none if it has not measured or is gone.
  std::vector<DevicePacket> packets(const Frame& frame);

  /// The UDP port that such devices send to.
  std::uint16_t port() const;
  const BeamTable& table() const { return *table_; }
  const std::string& sensor() const { return sensor_; }

 private:
  std::string sensor_;
  std::shared_ptr<const BeamTable> table_;
  VelodyneReturn reported_ = VelodyneReturn::strongest;
  std::uint32_t scans_ = 0;
};

}  // namespace simvis
