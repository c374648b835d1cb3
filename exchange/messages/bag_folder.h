// A recording as the folder that `ros2 bag record` makes: NAME/NAME_0.mcap and NAME/metadata.yaml.
//
// Format   version 5 of the metadata, of ROS 2 Humble, which later ones read too.
// Killed   the data are whole, as McapWriter says, and there is no metadata.yaml; `ros2 bag reindex` makes it.
// Source   rosbag2_storage/src/rosbag2_storage/metadata_io.cpp and include/rosbag2_storage/yaml.hpp of ros2/rosbag2.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "exchange/messages/recorder.h"

namespace simvis::ros {

/// Whether a path means such a folder: it ends with a slash and has a name.
bool is_bag_folder(const std::filesystem::path& path);

/// The MCAP file of the folder.
std::filesystem::path bag_data(const std::filesystem::path& folder);
std::filesystem::path bag_metadata(const std::filesystem::path& folder);

/// The text of metadata.yaml, about a data file of this name.
std::string metadata_yaml(const McapContent& content, std::string_view data_file);

class BagFolder : public MessageFile {
 public:
  /// The folder exists. Its data are created or replaced, and its metadata are removed until finish().
  explicit BagFolder(const std::filesystem::path& folder);
  void finish() override;

 private:
  std::filesystem::path folder_;
};

}  // namespace simvis::ros
