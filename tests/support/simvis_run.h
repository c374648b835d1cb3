// Runs simvis-run as its users do, on scenes with one wall.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/support/run_process.h"

namespace simvis {

using Strings = std::vector<std::string>;

/// Path of the program.
const std::string& simvis_run();

// The wall stands square to the camera and the scanner, 4 m and 3 m away.
inline constexpr std::string_view kWallSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="64" height="48" hfov="60" outputs="color depth"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-60" max_angle="60" range_max="7"
        pose_offset="1 0 0 0 0 0"/>
<sensor type="camera" name="SLOW" insert_at="ROOT" width="8" height="8" rate="1"/>)";

ProcessResult run_simvis(Strings arguments, const Strings& environment = {});

/// Checks that simvis-run refuses a scene with exit code 2 before it writes anything. `commands` follow the wall in the
/// scene file; each text of `expected` must be in the message.
void check_refused(const Strings& options, const std::string& commands, const Strings& expected);

/// A CSV file: the cells of its first line, and those of each other line.
struct Table {
  Strings columns;
  std::vector<Strings> rows;
};

Table read_csv(const std::filesystem::path& file);

}  // namespace simvis
