// Writes the measurements of sensors to the files of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/frame_time.h>
#include <simvis/measurement.h>
#include <simvis/scan.h>
#include "program/output/encoding_queue.h"
#include "program/output/formats.h"
#include "program/output/growing_file.h"
#include "program/output/scene_table.h"

namespace simvis {

/// The files of a run, relative to its folder, by the sensor or the part that they belong to. "CAMERA/*.png" stands for
/// one file for each frame in which the sensor measured: the frames of its table of poses.
using RunFiles = std::map<std::string, std::vector<std::string>>;

/// What an OutputWriter writes, and how.
struct OutputDesc {
  std::filesystem::path folder;
  std::vector<std::string> sensors{};  ///< all that will write
  std::vector<std::string> parts{};    ///< whose poses will be written
  std::string suffix{};  ///< of the names of tables: "-3-of-8" if other processes write to the same folder
  unsigned threads = 0;  ///< as SimulationDesc::threads
  OutputFormats formats{};
  /// Continues the files of an earlier run of the same scene: its tables keep the frames before this one.
  std::optional<std::uint64_t> resume_at{};
  /// Called before the first file of a new name is written.
  std::function<void(const RunFiles&)> on_new_file{};
};

/// Work     images and rows are encoded in the background (see EncodingQueue), which shares their numbers. The caller's
///          thread writes the files in order, during later calls.
/// Files    FOLDER/SENSOR/000000.png and so on per frame for colour and EXR depth (FOLDER/SENSOR_VIEW/ for a sensor
/// with
///          several views), FOLDER/SENSOR_OUTPUT/ for any other image, FOLDER/SENSOR.csv for tables, with the columns
///          `frame` and `time_s` in front, FOLDER/SENSOR.yaml or FOLDER/SENSOR_VIEW.yaml for calibrations, and
///          FOLDER/SENSOR_poses.csv and .tum. Frame numbers have six digits, or more if necessary.
///          Every file is whole at any time; tables grow by whole frames. The pose of a frame is written before its
///          other files, so that the tables of poses name every frame of which there may be a file.
/// Errors   MachineError with the path and the reason from the operating system; InputError for a sensor name that is
///          not a valid file name, for two sensors with the same files ("EYES" with a view "left", and "EYES_left"),
///          and for a file that exists, unless the run is resumed.
class OutputWriter {
 public:
  /// Creates the folder if it does not exist.
  explicit OutputWriter(OutputDesc desc);
  ~OutputWriter();

  /// Writes what one sensor measured in one frame, and where it stood.
  void write(std::string_view sensor, const FrameTime& time, const glm::dmat4& world_from_sensor,
             const Measurement& measurement);

  /// Writes the pose of one of the parts in this frame.
  void part_pose(std::string_view part, const FrameTime& time, const glm::dmat4& world_from_part);

  /// Writes the lines of a table of the scene in this frame, such as FOLDER/objects.csv, if they are not those of the
  /// last call for it.
  void scene_table(const SceneTable& table, const FrameTime& time, std::vector<std::string> lines);

  /// Appends lines, each of which begins with the number of the frame, to the table FOLDER/randomized.csv: what was
  /// drawn.
  void drawn(std::string lines);

  /// Waits for all encoding and writes the files. Do not write afterwards.
  void finish();

  /// The measurements written, in the order of their first appearance: "out/CAMERA/*.png", "out/SCANNER.csv".
  const std::vector<std::string>& results() const { return run_.results; }

  /// The number of frames of a sensor, with those before resume_at.
  std::uint64_t frames(std::string_view sensor) const;

 private:
  class SensorFiles;
  struct Run {
    OutputDesc desc;
    EncodingQueue queue;
    std::vector<std::string> results{};
    RunFiles files{};
    std::map<std::string, std::string> owner{};  // the sensor or part of each file
    bool new_file = false;                       // since on_new_file was called

    bool claim(const std::filesystem::path& file, const std::string& name, bool is_result);
    void before_write();
    void check_new(const std::filesystem::path& file) const;
  };
  SensorFiles& find(std::string_view name) const;
  SceneTableFile& open_table(const SceneTable& table, const std::filesystem::path& file);
  GrowingFile& open_drawn(const std::filesystem::path& file);

  std::map<std::string, std::unique_ptr<SensorFiles>, std::less<>> files_of_;  // by sensor or part
  std::map<std::string_view, SceneTableFile> scene_tables_;                    // by SceneTable::stem
  std::optional<GrowingFile> drawn_;
  Run run_;  // destroyed before files_of_, because its queue writes to them
};

/// "000012": how files of a frame are named.
std::string frame_name(std::uint64_t frame);

}  // namespace simvis
