// Data packets of Ouster sensors in the profile RNG19_RFL8_SIG16_NIR16, and the metadata that their readers need.
//
// Layout   32 bytes of header (type 1, frame, serial number); sixteen columns, each of 12 bytes of header (time in ns,
//          measurement, status) and 12 bytes for each pixel (range 19 bits in mm, reflectivity 8 bits from bit 32,
//          signal 16 bits from bit 48, near infrared 16 bits from bit 64); 32 bytes of footer, the last 8 of which are
//          a CRC. Little-endian. Ouster Software User Manual, "Configurable Data Packet Format"; ouster-sdk,
//          parsing.cpp.
// Range    from the lidar's origin as devices measure it: that along the beam and the distance of the beam's origin.
// Signal   the scan's intensity in units of kSignalUnit; near infrared is 0, for no light of the scene is simulated
//          there.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "exchange/packets/device_packet.h"
#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// The layout of a data packet: columns, and the bytes of its parts. The maximum is the largest range of a pixel.
inline constexpr std::uint32_t kOusterColumns = 16;
inline constexpr std::size_t kOusterHeaderBytes = 32, kOusterColumnHeaderBytes = 12, kOusterPixelBytes = 12,
                             kOusterFooterBytes = 32;
inline constexpr std::uint32_t kOusterMaxRange_mm = (1u << 19) - 1;

/// The packets of a scan that has the beams of `table`, which is that of an Ouster device. `frame` counts scans.
std::vector<DevicePacket> ouster_packets(const Scan& scan, const BeamTable& table, std::uint32_t frame);

/// What an inertial measurement unit measures, in the sensor's frame.
struct InertialNumbers {
  std::array<double, 3> specific_force_m_s2{}, angular_velocity_rad_s{};
};

/// The packet of the sensor's own inertial measurement unit at this time of the simulation, in the profile LEGACY:
/// three times in ns, and as float32 the specific force in units of standard gravity and the angular velocity in
/// degrees per second.
DevicePacket ouster_imu_packet(const InertialNumbers& measured, std::int64_t time_ns);

/// The metadata of the device, as JSON in the form of firmware 3.
std::string ouster_metadata(const BeamTable& table);

}  // namespace simvis
