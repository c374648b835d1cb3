// The check of what a sensor measured against what its type lists. It is made once, where a measurement enters a
// simulation or comes from a host that is followed; consumers rely on it.
#pragma once

#include <span>
#include <string>

#include <simvis/measurement.h>
#include "engine/base/program_api.h"

namespace simvis {

class Sensor;

/// How an array differs from what is said of its output: form, unit, type of the numbers, their places, shape, content.
/// "numbers of f32, expected f64"; empty: it does not. The numbers of images and of beams begin at the front and have
/// no gaps; those of a table may stand between those of other columns.
/// An array that differs from itself contradicts itself.
SIMVIS_PROGRAM_API std::string output_difference(const MeasuredArray& array, const OutputSpec& spec);

/// Gives an array all that is listed of its output; its name, shape, format and view stay.
SIMVIS_PROGRAM_API void describe(MeasuredArray& array, const OutputSpec& spec);
/// The same for all arrays of a measurement whose outputs are listed.
void describe(Measurement& measurement, std::span<const OutputSpec> outputs);

/// How a sensor's measurement differs from what its command promises: `output "NAME": ` and output_difference() of the
/// first array that does, an array that is not promised, or arrays that do not belong together: beams and columns of a
/// table of different lengths, colour and depth of a view of different sizes, a disparity without the right view's
/// calibration, and a scan() or reading() that is not that of the measurement. Empty: nothing. Only numbers of one
/// array and whole rows of others are looked at as long as the sensor has not measured. A type that lists no outputs
/// promises whatever the arrays say of themselves.
std::string measurement_difference(const Sensor& sensor, const Measurement& measurement,
                                   std::span<const OutputSpec> outputs, bool has_measured);

}  // namespace simvis
