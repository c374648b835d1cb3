// Reads the messages of an MCAP file, as SimVis, ROS 2 and Foxglove write it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace simvis::ros {

/// A message of a file. The texts are valid during the call that gets them.
struct RecordedMessage {
  std::string_view topic, type;  ///< "sensor_msgs/msg/PointCloud2"
  std::string_view encoding;     ///< "cdr"
  std::string_view bytes;
};

/// Calls `action` for each message, in the order of the file, until it returns false. Reads the data section alone, so
/// that a file without an end, as a kill leaves it, is read to its last whole record. Chunks may be compressed with
/// zstd or not at all.
///
/// Errors   InputError naming the file: it cannot be read, is no MCAP file, is compressed in another way, or
///          is damaged.
void read_mcap(const std::filesystem::path& file, const std::function<bool(const RecordedMessage&)>& action);

}  // namespace simvis::ros
