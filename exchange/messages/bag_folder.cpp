#include "exchange/messages/bag_folder.h"

#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

#include "engine/base/file_writing.h"
#include "engine/base/output_target.h"
#include "engine/base/temporary_file.h"
#include "scenegraph/language/json_text.h"

namespace simvis::ros {
namespace {

// A text of JSON is one of YAML too.
std::string yaml_text(std::string_view text) { return nlohmann::json(to_json_text(text)).dump(); }

std::string times(const McapContent& content, const std::string& indent) {
  return indent + "duration:\n" + indent + "  nanoseconds: " + std::to_string(content.last_ns - content.first_ns) +
         "\n" + indent + "starting_time:\n" + indent +
         "  nanoseconds_since_epoch: " + std::to_string(content.first_ns) + "\n" + indent +
         "message_count: " + std::to_string(content.messages) + "\n";
}

std::string folder_name(const std::filesystem::path& folder) {
  return std::filesystem::absolute(folder / "").lexically_normal().parent_path().filename().string();
}

// First the metadata go: a killed program must not leave those of other data. A link stays for finish().
std::filesystem::path data_without_metadata(const std::filesystem::path& folder) {
  const std::filesystem::path metadata = bag_metadata(folder);
  std::error_code error;
  std::filesystem::remove(regular_target(metadata), error);
  if (error) throw_file_error(metadata, "cannot be removed", error.value());
  return bag_data(folder);
}

}  // namespace

bool is_bag_folder(const std::filesystem::path& path) { return path.has_relative_path() && !path.has_filename(); }

std::filesystem::path bag_data(const std::filesystem::path& folder) {
  return folder / (folder_name(folder) + "_0.mcap");
}

std::filesystem::path bag_metadata(const std::filesystem::path& folder) { return folder / "metadata.yaml"; }

std::string metadata_yaml(const McapContent& content, std::string_view data_file) {
  std::string yaml = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n" + times(content, "  ") +
                     "  topics_with_message_count:" + (content.topics.empty() ? " []\n" : "\n");
  for (const McapContent::Topic& topic : content.topics) {
    yaml += "    - topic_metadata:\n        name: " + yaml_text(topic.name) +
            "\n        type: " + yaml_text(topic.type) +
            "\n        serialization_format: cdr\n        offered_qos_profiles: " + yaml_text(topic.qos) +
            "\n      message_count: " + std::to_string(topic.messages) + "\n";
  }
  return yaml + "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - " +
         yaml_text(data_file) + "\n  files:\n    - path: " + yaml_text(data_file) + "\n" + times(content, "      ");
}

BagFolder::BagFolder(const std::filesystem::path& folder)
    : MessageFile(data_without_metadata(folder)), folder_(folder) {}

void BagFolder::finish() {
  MessageFile::finish();
  const std::filesystem::path metadata = bag_metadata(folder_);
  replace_file(regular_target(metadata), metadata, metadata_yaml(content(), bag_data(folder_).filename().string()));
}

}  // namespace simvis::ros
