// The last measurement of a sensor as a list of arrays: what consumers of frames loop over, so that none of them has a
// list of outputs of its own.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <simvis/scan.h>
#include "simvis/scene_builder.h"

namespace simvis {

/// One array of a measurement. The name is that of the sensor's OutputSpec; of a scan, the columns that follow from the
/// layout of the beams are left out, and `azimuth_rad` and `elevation_rad` say the layout.
///
/// Lifetime  valid until the sensor's next measurement. A copy of `image` keeps its numbers.
struct MeasuredOutput {
  std::string name;
  std::string_view unit;
  OutputKind kind = OutputKind::scalar;
  OutputShape shape{};
  std::variant<const float*, const double*> numbers{};  ///< of the first place
  std::size_t stride = 1;                               ///< from one place to the next, in numbers
  const Image* image = nullptr;                         ///< null: the output is no image

  std::size_t count() const { return std::size_t{shape.rows} * shape.columns * shape.channels; }
};

/// All arrays of the last measurement, in the order of the type's outputs. Before the first measurement arrays are
/// empty and numbers are NaN.
std::vector<MeasuredOutput> measured_outputs(const BuiltSensor& sensor);

/// The output of this name among those that a command promises; names with `*` stand for many. Null: there is none.
const OutputSpec* find_output(std::span<const OutputSpec> outputs, std::string_view name);

}  // namespace simvis
