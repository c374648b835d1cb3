// The pose of one sensor or part in each frame: NAME_poses.csv and NAME_poses.tum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include <simvis/frame_time.h>
#include "program/output/growing_file.h"

namespace simvis {

/// Appends one line per frame to both tables.
class PoseFiles {
 public:
  /// Creates FOLDER/NAME_poses.csv and .tum with their headings.
  explicit PoseFiles(const std::filesystem::path& stem);
  /// Continues the tables; frames from `frame` on are cut off.
  PoseFiles(const std::filesystem::path& stem, std::uint64_t frame);

  void append(const FrameTime& time, const glm::dmat4& world_from_sensor);
  void finish();  ///< as that of GrowingFile

 private:
  GrowingFile csv_, tum_;
};

std::filesystem::path pose_csv(const std::filesystem::path& stem);
std::filesystem::path pose_tum(const std::filesystem::path& stem);

/// The bytes of a CSV table before the first line whose frame is `frame` or later, and the number of lines among them,
/// the heading included. An incomplete line at the end does not count. Throws MachineError if the file cannot be read.
struct TableStart {
  std::uintmax_t bytes = 0, lines = 0;
};
TableStart table_start(const std::filesystem::path& csv, std::uint64_t frame);

/// The frames of a table that begins with kPoseHeading, in order; empty if there is no such file. Throws MachineError
/// if it cannot be read.
std::vector<std::uint64_t> frames_of(const std::filesystem::path& csv);

}  // namespace simvis
