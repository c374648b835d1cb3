// All results of sensors, to the bit.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include <simvis/simulation.h>
#include "sensors/measured_table.h"

namespace simvis {

/// FNV-1a, 64 bits, of the results of sensors: images, then the table.
class SensorBytes {
 public:
  void add(const Measurement& measurement) {
    for (const MeasuredArray& each : measurement.arrays) {
      const std::optional<Image> image = to_image(each);
      if (!image) continue;
      for (const float value : image->pixels) add(std::bit_cast<std::uint32_t>(value));
    }
    for (const double value : measured_table(measurement).values) add(std::bit_cast<std::uint64_t>(value));
  }
  std::uint64_t hash() const { return hash_; }

 private:
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }

  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Of all sensors that measured in the last step.
inline std::uint64_t measured_hash(const Simulation& simulation) {
  SensorBytes bytes;
  for (const std::string& name : simulation.measured()) bytes.add(simulation.measurement(name));
  return bytes.hash();
}

}  // namespace simvis
