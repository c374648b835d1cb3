// Writes the measurements of sensors to the files of a run.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>
#include "simvis/output/encoding_queue.h"

namespace simvis {

/// Work     images and rows are copied and then encoded in the background (see EncodingQueue). The caller's thread
///          writes the files in order, during later calls.
/// Files    FOLDER/SENSOR/000000.png and 000000.exr per frame for images (FOLDER/SENSOR_STEM/ for a sensor with
///          several), FOLDER/SENSOR.csv for tables, with the columns `frame` and `time_s` in front, and
///          FOLDER/SENSOR_STEM.EXTENSION for texts. Frame numbers have six digits, or more if necessary. Every file
///          appears complete or not at all; tables appear with finish().
/// Errors   MachineError with the path and the reason from the operating system; InputError for a sensor name that is
///          not a valid file name, and for two sensors with the same files ("EYES" with a stem "left", and
///          "EYES_left").
class OutputWriter {
 public:
  /// Creates the folder if it does not exist and checks that files can be created in it. `sensors` are all sensors that
  /// will write. `suffix` is appended to the names of tables: "-3-of-8" if other processes write to the same folder.
  /// `threads` as in SimulationDesc::threads.
  OutputWriter(std::filesystem::path folder, std::span<const std::string> sensors, std::string suffix = "",
               unsigned threads = 0);
  ~OutputWriter();

  /// The sink for the measurements of one sensor in one frame. Valid until the next call.
  OutputSink& sink(std::string_view sensor, const FrameTime& time);

  /// Waits for all encoding, writes the files and gives the tables their final names. Do not write afterwards.
  void finish();

  /// The files written, in the order of their first appearance: "out/CAMERA/*.png", "out/SCANNER.csv".
  const std::vector<std::string>& results() const { return run_.results.names; }

 private:
  class SensorSink;
  struct Results {
    std::vector<std::string> names;
    std::map<std::string, std::string> sensor;  // the sensor of each name
  };
  struct Run {
    std::filesystem::path folder;
    std::string suffix;
    Results results{};
    EncodingQueue queue;
  };
  std::map<std::string, std::unique_ptr<SensorSink>, std::less<>> sinks_;
  Run run_;  // destroyed before the sinks, because its queue writes to them
};

}  // namespace simvis
