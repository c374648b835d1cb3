// Decodes the data packets of a real laser scanner.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "exchange/packets/beam_recording.h"
#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// Collects the beams of packets. Directions and origins are those of the device's beam table, at the angles of the
/// head that the packets say.
class DeviceReader {
 public:
  virtual ~DeviceReader() = default;

  /// Appends the beams of a packet to the recording. False: the datagram is none of the device's data packets, as those
  /// of its clock and of its motion are. `datagram` may have any bytes. Throws InputError, without a place, for a data
  /// packet of another device or in a form that is not supported.
  virtual bool add(std::string_view datagram, BeamRecording& recording) = 0;

  /// The number of bytes of a data packet.
  virtual std::size_t packet_bytes() const = 0;
};

/// For the device that `table` has, see BeamTable::device.
std::unique_ptr<DeviceReader> make_device_reader(const BeamTable& table);

/// Those of each maker.
std::unique_ptr<DeviceReader> make_velodyne_reader(const BeamTable& table);
std::unique_ptr<DeviceReader> make_ouster_reader(const BeamTable& table);

}  // namespace simvis
