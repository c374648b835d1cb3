// The inertial measurement unit inside of an Ouster sensor, whose packets are recorded beside those of the scanner.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "exchange/packets/device_packet.h"
#include "simvis/frame.h"

namespace simvis {

/// The sensor of type `imu` with the scanner's name and _IMU behind it. Without one there are no packets.
class DeviceImu {
 public:
  /// Throws InputError if the sensor is no imu, or stands elsewhere than the scanner.
  DeviceImu(const std::string& scanner, const BuiltScene& scene);

  /// Keeps the packet of its measurement in this frame, if it has measured.
  void measure(const Frame& frame);
  /// Takes the packets up to a time of the device's clock: those of a turn come when the turn is complete.
  std::vector<DevicePacket> until(std::int64_t time_ns);

  /// The UDP port that such devices send to.
  std::uint16_t port() const;

 private:
  std::string sensor_;
  std::vector<DevicePacket> kept_;
};

}  // namespace simvis
