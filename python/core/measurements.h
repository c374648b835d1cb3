// Measurements as Python sees them: read-only arrays over the memory in which the sensor measured.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <span>
#include <string>

#include <simvis/measurement.h>
#include <simvis/scan.h>

namespace simvis::python {

/// One scan. Its numbers neither move nor change while it lives.
struct KeptScan : Scan {
  std::string sensor;
};

/// One image. Its numbers neither move nor change while it lives.
struct KeptImage : MeasuredArray {
  std::string sensor;
};

/// All outputs of one measurement. Their numbers neither move nor change while it lives.
struct KeptMeasurement : Measurement {
  std::string sensor;
};

/// A matrix of 4 x 4 numbers, row by row, with memory of its own.
nanobind::object to_array(const glm::dmat4& matrix);

/// What a scanner's beams hit or a depth camera's pixels see: (points, 3), in "sensor" or "world". `out` is filled if
/// it is not None. Throws InputError for another frame, and for a camera whose lens is not known.
nanobind::object points_of(const KeptScan& scan, const std::string& frame, const nanobind::object& out);
nanobind::object points_of(const KeptMeasurement& camera, const std::string& frame, const nanobind::object& out);

/// Rows of so many numbers, copied to memory of their own.
nanobind::object to_array(std::span<const double> numbers, std::size_t rows, std::size_t columns);

void bind_measurements(nanobind::module_& module);

}  // namespace simvis::python
