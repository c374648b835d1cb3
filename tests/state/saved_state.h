// Runs that are compared with what follows a restored state.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/sensor_bytes.h"

namespace simvis::test {

/// What a frame has given: the bytes of all sensors that measured, and all values of parameters.
struct MadeFrame {
  std::uint64_t measured = 0;
  std::vector<double> values{};
  bool operator==(const MadeFrame&) const = default;
};

/// Sets what a frame begins with, by its index.
using Control = std::function<void(Simulation&, std::uint64_t frame)>;

inline MadeFrame make_frame(Simulation& simulation, const Control& control) {
  control(simulation, simulation.next_frame().index);
  simulation.step();
  const std::span<const double> values = simulation.parameters().values();
  return {.measured = measured_hash(simulation), .values = {values.begin(), values.end()}};
}

inline std::vector<MadeFrame> make_frames(Simulation& simulation, const Control& control, int count) {
  std::vector<MadeFrame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(make_frame(simulation, control));
  return frames;
}

}  // namespace simvis::test
