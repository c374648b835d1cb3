#include "exchange/messages/mcap_writer.h"

#include <zstd.h>

#include <algorithm>
#include <utility>

#include <simvis/error.h>
#include <simvis/version.h>
#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "exchange/messages/mcap_records.h"

namespace simvis::ros {

namespace {

// The fastest of zstd's usual levels: it keeps up with a stream of pictures.
constexpr int kCompressionLevel = 1;

// Readers take a chunk that begins at 0 for one without messages (rosbags before 0.10), and a channel 0 for none.
constexpr std::uint64_t kFirstLogged_ns = 1;

// As rosbag2 of ROS 2 Humble writes it and later ones read it: history keep last, reliable, and no deadlines.
std::string qos_of(Durability durability) {
  const std::string none = "\n    sec: 9223372036\n    nsec: 854775807\n";
  return "- history: 1\n  depth: 10\n  reliability: 1\n  durability: " +
         std::string(durability == Durability::latched ? "1" : "2") + "\n  deadline:" + none + "  lifespan:" + none +
         "  liveliness: 1\n  liveliness_lease_duration:" + none + "  avoid_ros_namespace_conventions: false";
}

std::string start_bytes() {
  return std::string(kMcapMagic) +
         McapRecord(McapOpcode::header).text("ros2").text("simvis " + std::string(version())).bytes();
}

/// From this record rosbag2 takes the form in which channels state their quality of service.
std::string rosbag_record() {
  const std::map<std::string, std::string> texts = {{"ROS_DISTRO", "jazzy"}};
  return McapRecord(McapOpcode::metadata).text("rosbag2").map(texts).bytes();
}

}  // namespace

struct McapWriter::Compressor {
  Compressor() : context(ZSTD_createCCtx(), &ZSTD_freeCCtx) {}

  std::string_view compress(std::string_view bytes) {
    buffer.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t size = context ? ZSTD_compressCCtx(context.get(), buffer.data(), buffer.size(), bytes.data(),
                                                         bytes.size(), kCompressionLevel)
                                     : 0;
    if (!context || ZSTD_isError(size) != 0) throw MachineError("out of memory while messages were compressed");
    return {buffer.data(), size};
  }

  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context;
  std::string buffer;
};

McapWriter::McapWriter(const std::filesystem::path& file)
    : file_(file, start_bytes() + rosbag_record()), compressor_(std::make_unique<Compressor>()) {}

McapWriter::~McapWriter() = default;

McapWriter::Channel McapWriter::add_channel(const std::string& topic, const TypeDescription& type,
                                            Durability durability) {
  std::size_t schema = static_cast<std::size_t>(std::ranges::find(schemas_, &type) - schemas_.begin());
  if (schema == schemas_.size()) {
    schemas_.push_back(&type);
    records_ += schema_record(schema);
  }
  SIMVIS_ASSERT(channels_.size() < UINT16_MAX);
  channels_.push_back({topic, static_cast<std::uint16_t>(schema + 1), durability});
  const auto channel = static_cast<Channel>(channels_.size());
  records_ += channel_record(channel);
  return channel;
}

// In MCAP, schema id 0 means "no schema".
std::string McapWriter::schema_record(std::size_t schema) const {
  const TypeDescription& type = *schemas_[schema];
  return McapRecord(McapOpcode::schema)
      .number(static_cast<std::uint16_t>(schema + 1))
      .text(type.name)
      .text("ros2msg")
      .text(msg_text(type))
      .bytes();
}

std::string McapWriter::channel_record(Channel channel) const {
  const ChannelInfo& info = channels_[channel - 1u];
  return McapRecord(McapOpcode::channel)
      .number(channel)
      .number(info.schema)
      .text(info.topic)
      .text("cdr")
      .map({{"offered_qos_profiles", qos_of(info.durability)},
            {"topic_type_hash", type_hash(*schemas_[info.schema - 1u])}})
      .bytes();
}

void McapWriter::write(Channel channel, std::int64_t time_ns, std::string_view message) {
  SIMVIS_ASSERT(channel > 0 && channel <= channels_.size() && time_ns >= 0);
  const auto published = static_cast<std::uint64_t>(time_ns);
  const std::uint64_t logged = std::max(published, kFirstLogged_ns);
  index_[channel].push_back({logged, records_.size()});
  constexpr std::size_t kNumbers = sizeof(Channel) + sizeof(std::uint32_t) + sizeof logged + sizeof published;
  records_ += mcap_record_head(McapOpcode::message, kNumbers + message.size());
  const std::uint32_t sequence = channels_[channel - 1u].next++;
  append_binary(records_, channel);
  append_binary(records_, sequence);
  append_binary(records_, logged);
  append_binary(records_, published);
  records_ += message;
  ++messages_;
  if (records_.size() < kChunkBytes) return;
  try {
    write_chunk();
  } catch (...) {
    recover();
    throw;
  }
}

void McapWriter::write_chunk() {
  if (records_.empty()) return;
  ChunkInfo chunk{.first_ns = index_.empty() ? 0 : UINT64_MAX,
                  .last_ns = 0,
                  .offset = file_.size(),
                  .bytes = 0,
                  .index_bytes = 0,
                  .compressed = 0,
                  .uncompressed = records_.size(),
                  .index_offsets = {},
                  .counts = {},
                  .schemas = schemas_.size(),
                  .channels = channels_.size(),
                  .crc_before = file_.crc()};
  for (const auto& [channel, entries] : index_) {
    for (const IndexEntry& entry : entries) {
      chunk.first_ns = std::min(chunk.first_ns, entry.time_ns);
      chunk.last_ns = std::max(chunk.last_ns, entry.time_ns);
    }
  }
  const std::string_view compressed = compressor_->compress(records_);
  chunk.compressed = compressed.size();
  std::string bytes = McapRecord(McapOpcode::chunk)
                          .number(chunk.first_ns)
                          .number(chunk.last_ns)
                          .number(chunk.uncompressed)
                          .number(mcap_crc(records_))
                          .text("zstd")
                          .number(chunk.compressed)
                          .raw(compressed)
                          .bytes();
  chunk.bytes = bytes.size();
  for (const auto& [channel, entries] : index_) {
    chunk.index_offsets[channel] = chunk.offset + bytes.size();
    chunk.counts[channel] = entries.size();
    McapRecord index(McapOpcode::message_index);
    index.number(channel).number(static_cast<std::uint32_t>(entries.size() * sizeof(IndexEntry)));
    for (const IndexEntry& entry : entries) index.number(entry.time_ns).number(entry.offset);
    bytes += index.bytes();
  }
  chunk.index_bytes = bytes.size() - chunk.bytes;
  chunks_.push_back(std::move(chunk));
  try {
    file_.append(std::move(bytes));
  } catch (...) {
    chunks_.pop_back();
    throw;
  }
  records_.clear();
  index_.clear();
}

void McapWriter::finish() {
  try {
    write_chunk();
    write_end();
  } catch (...) {
    recover();
    throw;
  }
}

void McapWriter::write_end() {
  const std::string data_end = McapRecord(McapOpcode::data_end).number(file_.crc()).bytes();
  file_.finish(data_end + summary(file_.size() + data_end.size()));
}

// A full disk, a file that may not grow, or no memory: each chunk that goes makes room for the summary of the others.
// Without any room the file keeps an end without a summary.
void McapWriter::recover() {
  if (!file_.is_open()) return;  // the disk has failed when the file was closed
  for (;;) {
    try {
      return write_end();
    } catch (const MachineError&) {
      if (chunks_.empty()) return;
    }
    file_.cut(chunks_.back().offset, chunks_.back().crc_before);
    chunks_.pop_back();
  }
}

McapContent McapWriter::content() const {
  McapContent content;
  const std::size_t channel_count = chunks_.empty() ? 0 : chunks_.back().channels;
  for (std::size_t i = 0; i < channel_count; ++i) {
    const ChannelInfo& channel = channels_[i];
    content.topics.push_back({channel.topic, schemas_[channel.schema - 1u]->name, qos_of(channel.durability)});
  }
  std::uint64_t first_ns = UINT64_MAX;
  for (const ChunkInfo& chunk : chunks_) {
    for (const auto& [channel, count] : chunk.counts) {
      content.topics[channel - 1u].messages += count;
      content.messages += count;
    }
    if (chunk.counts.empty()) continue;
    first_ns = std::min(first_ns, chunk.first_ns);
    content.last_ns = std::max(content.last_ns, chunk.last_ns);
  }
  if (content.messages > 0) content.first_ns = first_ns;
  return content;
}

std::string McapWriter::summary(std::uint64_t start) const {
  std::string bytes, offsets;
  const auto group = [&](McapOpcode opcode, const std::string& records) {
    if (records.empty()) return;
    offsets += McapRecord(McapOpcode::summary_offset)
                   .number(static_cast<std::uint8_t>(opcode))
                   .number(start + bytes.size())
                   .number(std::uint64_t{records.size()})
                   .bytes();
    bytes += records;
  };
  const std::size_t schema_count = chunks_.empty() ? 0 : chunks_.back().schemas;
  const std::size_t channel_count = chunks_.empty() ? 0 : chunks_.back().channels;
  std::string schemas, channels, chunk_indexes;
  for (std::size_t i = 0; i < schema_count; ++i) schemas += schema_record(i);
  for (std::size_t i = 0; i < channel_count; ++i) channels += channel_record(static_cast<Channel>(i + 1));
  const McapContent all = content();
  std::map<Channel, std::uint64_t> counts;
  for (std::size_t i = 0; i < channel_count; ++i) {
    if (all.topics[i].messages > 0) counts[static_cast<Channel>(i + 1)] = all.topics[i].messages;
  }
  for (const ChunkInfo& chunk : chunks_) {
    chunk_indexes += McapRecord(McapOpcode::chunk_index)
                         .number(chunk.first_ns)
                         .number(chunk.last_ns)
                         .number(chunk.offset)
                         .number(chunk.bytes)
                         .map(chunk.index_offsets)
                         .number(chunk.index_bytes)
                         .text("zstd")
                         .number(chunk.compressed)
                         .number(chunk.uncompressed)
                         .bytes();
  }
  group(McapOpcode::schema, schemas);
  group(McapOpcode::channel, channels);
  group(McapOpcode::statistics, McapRecord(McapOpcode::statistics)
                                    .number(all.messages)
                                    .number(static_cast<std::uint16_t>(schema_count))
                                    .number(static_cast<std::uint32_t>(channel_count))
                                    .number(std::uint32_t{0})  // attachments
                                    .number(std::uint32_t{1})  // metadata
                                    .number(static_cast<std::uint32_t>(chunks_.size()))
                                    .number(all.first_ns)
                                    .number(all.last_ns)
                                    .map(counts)
                                    .bytes());
  group(McapOpcode::chunk_index, chunk_indexes);
  group(McapOpcode::metadata_index, McapRecord(McapOpcode::metadata_index)
                                        .number(std::uint64_t{start_bytes().size()})
                                        .number(std::uint64_t{rosbag_record().size()})
                                        .text("rosbag2")
                                        .bytes());
  const std::uint64_t offsets_start = start + bytes.size();
  bytes += offsets;
  constexpr std::uint64_t kFooterBytes = 2 * sizeof(std::uint64_t) + sizeof(std::uint32_t);
  bytes += mcap_record_head(McapOpcode::footer, kFooterBytes);
  for (const std::uint64_t value : {start, offsets_start}) append_binary(bytes, value);
  const std::uint32_t crc = mcap_crc(bytes);
  append_binary(bytes, crc);
  return bytes + std::string(kMcapMagic);
}

}  // namespace simvis::ros
