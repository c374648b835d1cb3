// Scans and images as Python sees them: read-only arrays over the memory in which the sensor measured.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/image.h>
#include <simvis/scan.h>

namespace simvis::python {

using Lease = std::shared_ptr<const void>;  // of Simulation::keep()

/// One scan. Its numbers neither move nor change while it lives.
struct KeptScan {
  KeptScan(const Scan& scan, Lease lease);

  struct Channel {
    std::string name;
    const double* values;
  };
  std::string sensor;
  std::size_t rings, beams;
  std::vector<double> azimuth_rad, elevation_rad;
  const float *range_m, *error_bound_m;
  std::vector<Channel> channels;
  std::int64_t time_ns;
  glm::dmat4 world_from_sensor;
  Lease lease;
};

/// One image. Its numbers neither move nor change while it lives.
struct KeptImage {
  KeptImage(const Image& image, Lease lease);

  std::string sensor, name;
  std::size_t width, height, channels;
  const float* pixels;
  Lease lease;
};

/// A matrix of 4 x 4 numbers, row by row, with memory of its own.
nanobind::object to_array(const glm::dmat4& matrix);

/// Rows of so many numbers, copied to memory of their own.
nanobind::object to_array(std::span<const double> numbers, std::size_t rows, std::size_t columns);

void bind_measurements(nanobind::module_& module);

}  // namespace simvis::python
