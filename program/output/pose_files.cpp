#include "program/output/pose_files.h"

#include <charconv>
#include <fstream>
#include <limits>
#include <optional>

#include <simvis/error.h>
#include "program/output/atomic_file.h"
#include "program/output/pose_text.h"

namespace simvis {

namespace {

/// The number at the beginning of a line; empty in headings.
std::optional<std::uint64_t> frame_of(std::string_view line) {
  std::uint64_t frame = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), frame);
  if (error != std::errc() || end == line.data() + line.size() || *end != ',') return std::nullopt;
  return frame;
}

/// A table of an earlier run, which has written a regular file: another one may have no end, or be of somebody else.
std::ifstream open_table(const std::filesystem::path& file) {
  const std::filesystem::file_type type = std::filesystem::symlink_status(file).type();
  if (type != std::filesystem::file_type::regular && type != std::filesystem::file_type::not_found) {
    throw InputError(file.string() + ": error: is no regular file, expected a table that simvis-run wrote");
  }
  return std::ifstream(file, std::ios::binary);
}

/// The bytes of the first `lines` lines of a table of the TUM format, which is created if it is missing.
std::uintmax_t bytes_of_lines(const std::filesystem::path& file, std::uintmax_t lines) {
  if (!std::filesystem::exists(file)) write_file(file, kTumHeading);
  std::ifstream stream = open_table(file);
  std::string line;
  std::uintmax_t bytes = 0;
  for (; lines > 0 && std::getline(stream, line) && !stream.eof(); --lines) bytes += line.size() + 1;
  return bytes;
}

}  // namespace

std::filesystem::path pose_csv(const std::filesystem::path& stem) { return stem.string() + ".csv"; }
std::filesystem::path pose_tum(const std::filesystem::path& stem) { return stem.string() + ".tum"; }

TableStart table_start(const std::filesystem::path& csv, std::uint64_t frame) {
  std::ifstream stream = open_table(csv);
  if (!stream) throw MachineError(csv.string() + ": error: cannot be read");
  TableStart start;
  for (std::string line; std::getline(stream, line) && !stream.eof(); ++start.lines) {
    const std::optional<std::uint64_t> own = frame_of(line);
    if (own && *own >= frame) break;
    start.bytes += line.size() + 1;
  }
  return start;
}

std::vector<std::uint64_t> frames_of(const std::filesystem::path& csv) {
  std::vector<std::uint64_t> frames;
  std::ifstream stream = open_table(csv);
  const bool is_unreadable = !stream && std::filesystem::exists(csv);
  for (std::string line; std::getline(stream, line) && !stream.eof();) {
    if (const std::optional<std::uint64_t> frame = frame_of(line)) frames.push_back(*frame);
  }
  if (is_unreadable || stream.bad()) throw MachineError(csv.string() + ": error: cannot be read");
  return frames;
}

PoseFiles::PoseFiles(const std::filesystem::path& stem)
    : csv_(pose_csv(stem), kPoseHeading), tum_(pose_tum(stem), kTumHeading) {}

// A run that was killed may have left one line more in the first table than in the second, or only the first.
PoseFiles::PoseFiles(const std::filesystem::path& stem, std::uint64_t frame)
    : csv_(pose_csv(stem), table_start(pose_csv(stem), frame).bytes),
      tum_(pose_tum(stem), bytes_of_lines(pose_tum(stem), table_start(pose_csv(stem), frame).lines)) {}

void PoseFiles::append(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  csv_.append(pose_line(time, world_from_sensor));
  tum_.append(tum_line(time, world_from_sensor));
}

void PoseFiles::finish() {
  csv_.finish();
  tum_.finish();
}

}  // namespace simvis
