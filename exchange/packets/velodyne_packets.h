// Data packets of Velodyne scanners: VLP-16, HDL-32E and VLS-128.
//
// Layout   twelve blocks of a bank's flag, the azimuth of the head in hundredths of a degree and 32 lasers (16 bits of
//          distance, 8 bits of reflectivity); microseconds past the hour; return mode; model. All numbers are
//          little-endian. VLP-16 User Manual, 63-9243, ch. 9; HDL-32E, 63-9277; VLS-128 User Manual, ch. 9.
// Blocks   of a VLP-16 hold two firing cycles of 16 lasers, of an HDL-32E one of 32; four blocks of a VLS-128 hold one
//          of 128. The azimuth is that of the head when the block's first cycle begins. With two returns each block
//          comes as a pair: the last return, and the strongest one, or the second strongest if the strongest is the
//          last; both are the same for a beam with one return (section 9.3.2).
// Time     of the first laser of a packet; of a VLS-128 of its fourth group of eight lasers (manual, p. 61).
#pragma once

#include <vector>

#include "exchange/packets/device_packet.h"
#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// The layout of a data packet; the flags are those of the banks, from the first on.
inline constexpr std::size_t kVelodyneBytes = 1206;
inline constexpr std::uint32_t kVelodyneBlocks = 12, kVelodyneBlockLasers = 32;
inline constexpr std::uint16_t kVelodyneFlags[] = {0xeeff, 0xddff, 0xccff, 0xbbff};

/// The return that a device reports; the values are those of the packets.
enum class VelodyneReturn : std::uint8_t { strongest = 0x37, last = 0x38, dual = 0x39 };

/// Whether packets with two returns are written for the device: not for a VLS-128, in which they have another layout.
bool has_dual_packets(const ScannerDevice& device);

/// The packets of a scan that has the beams of `table`, which is that of a Velodyne device. With two returns the scan
/// has the channels of the effect `dual_return`, and has_dual_packets() holds.
std::vector<DevicePacket> velodyne_packets(const Scan& scan, const BeamTable& table, VelodyneReturn reported);

}  // namespace simvis
