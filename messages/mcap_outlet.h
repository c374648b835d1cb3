// Messages that go to an MCAP file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "messages/mcap_writer.h"
#include "messages/outlet.h"

namespace simvis::ros {

class McapOutlet : public MessageOutlet {
 public:
  /// Creates or replaces the file.
  explicit McapOutlet(const std::filesystem::path& file) : writer_(file) {}

  void finish() override { writer_.finish(); }
  std::uint64_t messages() const override { return writer_.messages(); }
  std::uint64_t bytes() const override { return writer_.bytes(); }

 private:
  void write_bytes(const std::string& topic, const TypeDescription& type, Durability durability, std::int64_t time_ns,
                   std::string_view message) override {
    auto found = channels_.find(topic);
    if (found == channels_.end()) {
      found = channels_.emplace(topic, writer_.add_channel(topic, type, durability)).first;
    }
    writer_.write(found->second, time_ns, message);
  }

  McapWriter writer_;
  std::map<std::string, McapWriter::Channel> channels_;
};

}  // namespace simvis::ros
