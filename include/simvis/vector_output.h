// What the environments of a VectorSimulation measured, in one array.
#pragma once

#include <cstddef>
#include <string>

#include <simvis/measurement.h>
#include <simvis/output_spec.h>

namespace simvis {

/// One output of a sensor in all environments, in one array.
///
/// Shape    by environment, and then as MeasuredArray: number j of environment i is numbers[i * n + j], where
///          n = rows * columns * channels of `output.shape`, which is that of one environment.
/// Special  NaN, or 0 where the numbers are whole, of an environment whose sensor has not measured yet, or whose scene
///          was changed and does not give the output in this shape.
/// Memory   a copy keeps its numbers, as that of a Measurement.
struct VectorOutput {
  std::string sensor;          ///< the sensor's name
  OutputSpec output;           ///< of one environment
  std::size_t environments{};  ///< how many there are
  MeasuredNumbers numbers{};   ///< without gaps
};

}  // namespace simvis
