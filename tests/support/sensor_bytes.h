// All results of sensors, to the bit.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/simulation.h>

namespace simvis {

/// FNV-1a, 64 bits, of the results of sensors.
class SensorBytes : public OutputSink {
 public:
  void picture(const std::string&, const Image* color, const Image* depth) override {
    if (color != nullptr) add(color->pixels);
    if (depth != nullptr) add(depth->pixels);
  }
  void plane(const std::string&, const std::string&, const Image& plane) override { add(plane.pixels); }
  void text(const std::string&, const std::string&, std::string_view) override {}
  void rows(std::span<const TableColumn>, std::span<const double> values) override {
    for (const double value : values) add(std::bit_cast<std::uint64_t>(value));
  }
  std::uint64_t hash() const { return hash_; }

 private:
  void add(const std::vector<float>& values) {
    for (const float value : values) add(std::bit_cast<std::uint32_t>(value));
  }
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }

  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Of all sensors that measured in the last step.
inline std::uint64_t measured_hash(const Simulation& simulation) {
  SensorBytes bytes;
  for (const std::string& name : simulation.measured()) simulation.write(name, bytes);
  return bytes.hash();
}

}  // namespace simvis
