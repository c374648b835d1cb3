// What the files of a run get from a sensor.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <simvis/export.h>
#include <simvis/image.h>
#include <simvis/scan.h>

namespace simvis {

/// Receives the output of a sensor after a frame. Implemented by the code that writes files.
///
/// Lifetime  arguments are valid during the call only.
/// Threads   called in the thread that calls Simulation::write().
class SIMVIS_API OutputSink {
 public:
  virtual ~OutputSink() = default;
  /// One image per frame. Either pointer may be null. `stem` is appended to the folder's name for sensors with several
  /// images ("left", "right"); empty for one image.
  virtual void picture(const std::string& stem, const Image* color, const Image* depth) = 0;
  /// One more image per frame, with a single channel of that name: "disparity".
  virtual void plane(const std::string& stem, const std::string& channel, const Image& plane) = 0;
  /// Gives the calibration of the camera whose images have this stem. It is called before picture() and plane().
  virtual void calibration(const std::string& /*stem*/, const CameraCalibration&) {}
  /// A text that stays the same throughout the run, with the extension of its file's name ("yaml"). The first call
  /// writes it, so a sensor may pass it after every frame.
  virtual void text(const std::string& stem, const std::string& extension, std::string_view text) = 0;
  /// Whole rows of a table that grows with each frame and always has the same columns. A column "time_s" replaces the
  /// column with the frame's time.
  virtual void rows(std::span<const TableColumn> columns, std::span<const double> values) = 0;
};

}  // namespace simvis
