// Turns what sensors measured into the files of a run.
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

/// Work     pictures and rows are copied, and encoded in the background (see EncodingQueue). The caller's thread writes
///          the files, in their order, when it comes by again.
/// Files    FOLDER/SENSOR/000000.png and 000000.exr per frame for pictures (FOLDER/SENSOR_STEM/ for a sensor with
///          several), FOLDER/SENSOR.csv for tables, with the columns `frame` and `time_s` put in front, and
///          FOLDER/SENSOR_STEM.EXTENSION for texts. Frame numbers have six digits, more when needed. Every file appears
///          whole or not at all; tables appear with finish().
/// Errors   MachineError with the path and the operating system's reason; InputError for a sensor's name that cannot
///          name a file, and for two sensors whose files are the same ("EYES" with a stem "left", and "EYES_left").
class OutputWriter {
 public:
  /// Makes the folder where it is missing and makes sure that files can be made in it. `sensors` are all that will
  /// write. `suffix` is put to the names of tables: "-3-of-8" where other processes write to the same folder.
  /// `threads` as SimulationDesc::threads.
  OutputWriter(std::filesystem::path folder, std::span<const std::string> sensors, std::string suffix = "",
               unsigned threads = 0);
  ~OutputWriter();

  /// Where one of the sensors writes what it measured in a frame. Valid until the next call.
  OutputSink& sink(std::string_view sensor, const FrameTime& time);

  /// Writes what is still being encoded, and gives the tables their names. Nothing can be written afterwards.
  void finish();

  /// What was written, in the order it came first: "out/CAMERA/*.png", "out/SCANNER.csv".
  const std::vector<std::string>& results() const { return run_.results.names; }

 private:
  class SensorSink;
  struct Results {
    std::vector<std::string> names;
    std::map<std::string, std::string> sensor;  // whose each is
  };
  struct Run {
    std::filesystem::path folder;
    std::string suffix;
    Results results{};
    EncodingQueue queue;
  };
  std::map<std::string, std::unique_ptr<SensorSink>, std::less<>> sinks_;
  Run run_;  // goes before the sinks, to which it puts
};

}  // namespace simvis
