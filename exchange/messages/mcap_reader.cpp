#include "exchange/messages/mcap_reader.h"

#include <zstd.h>

#include <map>
#include <optional>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/input_file.h"
#include "exchange/messages/mcap_records.h"
#include "exchange/messages/record_file.h"

namespace simvis::ros {

namespace {

constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMaxOpenedBytes = std::uint64_t{1} << 28;  // far above the chunks of any writer
constexpr std::size_t kRecordHead = 1 + sizeof(std::uint64_t);

/// Numbers and texts from the front of a record. Its errors have no place.
class RecordFields {
 public:
  explicit RecordFields(std::string_view bytes) : left_(bytes) {}

  std::string_view take(std::uint64_t size) {
    if (size > left_.size()) throw InputError("has a record that ends too early");
    const std::string_view front = left_.substr(0, size);
    left_.remove_prefix(size);
    return front;
  }
  template <typename T>
  T number() {
    return binary_at<T>(take(sizeof(T)), 0);
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view rest() { return take(left_.size()); }
  bool empty() const { return left_.empty(); }

 private:
  std::string_view left_;
};

class McapFileReader {
 public:
  McapFileReader(const std::filesystem::path& file, const std::function<bool(const RecordedMessage&)>& action)
      : file_(file), action_(action) {}

  void read() {
    if (text(bytes_at(0, std::min<std::size_t>(file_.size(), kMcapMagic.size()))) != kMcapMagic) {
      throw InputError("is no MCAP file");
    }
    for (std::size_t at = kMcapMagic.size(); file_.size() - at >= kRecordHead;) {
      RecordFields head(text(bytes_at(at, kRecordHead)));
      const auto opcode = static_cast<McapOpcode>(head.number<std::uint8_t>());
      const auto size = head.number<std::uint64_t>();
      at += kRecordHead;
      if (size > file_.size() - at) return;  // the program that wrote it was killed
      if (opcode == McapOpcode::data_end) return;
      if (size > kMaxRecordBytes) throw InputError("has a record of more than 1 GiB");
      if (is_read(opcode) && !record(opcode, text(bytes_at(at, size)))) return;
      at += size;
    }
  }

 private:
  struct McapChannel {
    std::string topic, type, encoding;
  };

  static bool is_read(McapOpcode opcode) {
    return opcode == McapOpcode::schema || opcode == McapOpcode::channel || opcode == McapOpcode::message ||
           opcode == McapOpcode::chunk;
  }

  const Bytes& bytes_at(std::size_t first, std::size_t count) { return bytes_ = file_.read(first, count); }
  static std::string_view text(const Bytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  // False: nothing more is wanted.
  bool record(McapOpcode opcode, std::string_view content) {
    RecordFields fields(content);
    switch (opcode) {
      case McapOpcode::schema: {
        const auto id = fields.number<std::uint16_t>();
        types_[id] = fields.text();
        return true;
      }
      case McapOpcode::channel: {
        const auto id = fields.number<std::uint16_t>(), schema = fields.number<std::uint16_t>();
        const std::string topic(fields.text());
        channels_[id] = {topic, types_[schema], std::string(fields.text())};
        return true;
      }
      case McapOpcode::message:
        return message(fields);
      case McapOpcode::chunk:
        return chunk(fields);
      default:
        return true;
    }
  }

  bool message(RecordFields& fields) {
    const auto found = channels_.find(fields.number<std::uint16_t>());
    if (found == channels_.end()) throw InputError("has a message of a channel that it does not describe");
    fields.take(sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t));  // sequence, times
    const McapChannel& channel = found->second;
    return action_({channel.topic, channel.type, channel.encoding, fields.rest()});
  }

  bool chunk(RecordFields& fields) {
    fields.take(2 * sizeof(std::uint64_t));  // times
    const auto size = fields.number<std::uint64_t>();
    const auto checksum = fields.number<std::uint32_t>();  // of what is opened; 0: none
    const std::string compression(fields.text());
    const std::string_view stored = fields.take(fields.number<std::uint64_t>());
    const auto checked = [checksum](std::string_view bytes) {
      if (checksum != 0 && mcap_crc(bytes) != checksum) throw InputError("has a damaged chunk: its checksum differs");
      return bytes;
    };
    if (compression.empty()) return records(checked(stored));
    if (compression != "zstd") {
      throw InputError("is compressed with " + compression +
                       ", expected zstd or none: mcap compress --compression zstd");
    }
    if (size > kMaxOpenedBytes) throw InputError("has a chunk that is opened to more than 256 MiB");
    std::string opened(size, '\0');
    if (ZSTD_decompress(opened.data(), opened.size(), stored.data(), stored.size()) != size) {
      throw InputError("has a damaged chunk");
    }
    return records(checked(opened));
  }

  bool records(std::string_view bytes) {
    for (RecordFields left(bytes); !left.empty();) {
      const auto opcode = static_cast<McapOpcode>(left.number<std::uint8_t>());
      const std::string_view content = left.take(left.number<std::uint64_t>());
      if (opcode == McapOpcode::chunk) throw InputError("has a chunk within a chunk");
      if (is_read(opcode) && !record(opcode, content)) return false;
    }
    return true;
  }

  InputFile file_;
  const std::function<bool(const RecordedMessage&)>& action_;
  Bytes bytes_;
  std::map<std::uint16_t, std::string> types_;
  std::map<std::uint16_t, McapChannel> channels_;
};

}  // namespace

void read_mcap(const std::filesystem::path& file, const std::function<bool(const RecordedMessage&)>& action) {
  McapFileReader reader(file, action);
  try {
    reader.read();
  } catch (const InputError& error) {
    const std::string what = error.what(), name = file.string();
    throw InputError(what.starts_with(name) ? what : name + ": error: " + what);
  }
}

}  // namespace simvis::ros
