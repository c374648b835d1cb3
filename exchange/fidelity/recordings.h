// Reads the recording of a real laser scanner: its data packets, or the messages of its driver.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <simvis/scan.h>
#include "exchange/packets/beam_recording.h"
#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// The data packets of the device that `table` has, from a capture file, of the first `scans` turns. A turn that the
/// file has in part counts.
///
/// Errors   InputError naming the file, if it is none that read_pcap() reads, holds no data packet of the device,
///          packets of another one, or a turn with eight times the beams of the table.
BeamRecording read_capture(const std::filesystem::path& file, const BeamTable& table, std::uint32_t scans);

/// The first `scans` messages PointCloud2 or LaserScan of a topic of an MCAP file; `topic` empty: of the only one.
///
/// Clouds   that have as many points as `nominal` has beams have these beams, in its order, and points without a number
///          are lost beams. All others have beams from the sensor's origin to their points; lost ones are not known
///          then. Fields x, y and z, and if they are there `ring` (or `channel`) and `intensity` (or `reflectivity`).
/// Errors   InputError naming the file, if it is none that read_mcap() reads, has no such topic or several, or has a
///          message that is damaged or holds more than 4,194,304 points.
BeamRecording read_cloud_messages(const std::filesystem::path& file, const std::string& topic, const Scan& nominal,
                                  std::uint32_t scans);

}  // namespace simvis
