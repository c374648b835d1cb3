// Writes an MCAP file (https://mcap.dev/spec) with ROS 2 messages while they come.
//
// File     chunks of about kChunkBytes, compressed by zstd, each followed by the index of its messages; at the end a
//          summary with schemas, channels, statistics and the index of the chunks. All checksums are set. The same
//          calls give the same bytes.
// Killed   every chunk that was written is whole, and the file ends behind it, or within the next one. A file without
//          its end has no summary; readers then take the chunks in order.
// Errors   MachineError with the path and the reason from the operating system. The file is then cut back to as many of
//          its chunks as leave room for a summary, and has one.
// Threads  one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/description.h"
#include "exchange/messages/message_outlet.h"
#include "exchange/messages/record_file.h"

namespace simvis::ros {

/// What a file holds.
struct McapContent {
  struct Topic {
    std::string name;
    std::string_view type;  ///< "sensor_msgs/msg/LaserScan"
    std::string qos;        ///< its quality of service as rosbag2 writes it: YAML without an end of line
    std::uint64_t messages = 0;
  };
  std::vector<Topic> topics;
  std::uint64_t messages = 0;
  std::uint64_t first_ns = 0, last_ns = 0;  ///< times of messages; 0: there is none
};

class McapWriter {
 public:
  using Channel = std::uint16_t;  ///< from 1
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

  /// Creates or replaces the file.
  explicit McapWriter(const std::filesystem::path& file);
  /// Without finish(), the file has its chunks and no summary.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// `type` must live as long as the writer.
  Channel add_channel(const std::string& topic, const TypeDescription& type, Durability durability);
  /// `time_ns` is not negative, and the time of publication; the time of the log is 1 if it is 0. `message` is in CDR.
  void write(Channel channel, std::int64_t time_ns, std::string_view message);
  /// Writes the last chunk and the summary. Do not write afterwards.
  void finish();

  std::uint64_t messages() const { return messages_; }  ///< written so far
  std::uint64_t bytes() const { return file_.size(); }  ///< of the file so far
  McapContent content() const;                          ///< of the chunks that are in the file

 private:
  struct ChannelInfo {
    std::string topic;
    std::uint16_t schema;
    Durability durability;
    std::uint32_t next = 0;  // sequence number
  };
  struct IndexEntry {
    std::uint64_t time_ns, offset;
  };
  struct ChunkInfo {
    std::uint64_t first_ns, last_ns, offset, bytes, index_bytes, compressed, uncompressed;
    std::map<Channel, std::uint64_t> index_offsets, counts;
    std::size_t schemas, channels;  // known at its end
    std::uint32_t crc_before;       // of the file up to its beginning
  };
  struct Compressor;

  void write_chunk();
  void write_end();
  void recover();
  std::string schema_record(std::size_t schema) const;
  std::string channel_record(Channel channel) const;
  std::string summary(std::uint64_t start) const;

  RecordFile file_;
  std::vector<const TypeDescription*> schemas_;
  std::vector<ChannelInfo> channels_;
  std::vector<ChunkInfo> chunks_;
  std::string records_;  // of the chunk that is being filled
  std::map<Channel, std::vector<IndexEntry>> index_;
  std::uint64_t messages_ = 0;
  std::unique_ptr<Compressor> compressor_;
};

}  // namespace simvis::ros
