// Runs that are compared with what follows a restored state.
#pragma once

#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/version.h>
#include "engine/base/fnv1a.h"
#include "tests/support/moving_scene.h"
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

/// Where the content of a state begins: behind its hash.
inline std::size_t begin_of_content(const std::string& state) { return state.find(version()) + version().size() + 16; }

/// A state whose content was changed by someone who knows the format.
inline std::string with_right_hash(std::string state) {
  const std::size_t begin = begin_of_content(state);
  const std::uint64_t hash = fnv1a(std::string_view(state).substr(begin));
  std::memcpy(state.data() + begin - sizeof hash, &hash, sizeof hash);
  return state;
}

/// Bodies that are welded, that hang at a point, and of which two do not collide.
inline const std::string kEqualities = "<part name='M' insert_at='ROOT' file='m.xml'/>\n" + kPhysics + ground() +
                                       "<element type='models' name='BODIES' insert_at='M'/>"
                                       "<sensor type='imu' name='IMU' insert_at='carried'/>";
inline void write_equalities(const std::filesystem::path& folder) {
  const std::string box = "<freejoint/><geom type='box' size='0.1 0.1 0.1' mass='1'/></body>";
  std::ofstream(folder / "m.xml") << "<mujoco model='m'><worldbody><body name='hung' pos='0 0 2'>" + box +
                                         "<body name='welded' pos='3 0 2'>" + box +
                                         "<body name='carried' pos='3 0.3 2'>" + box +
                                         "<body name='loose' pos='3 0.2 3'>" + box +
                                         "</worldbody><equality><connect body1='hung' anchor='0.5 0 0'/>"
                                         "<weld body1='carried' body2='welded'/></equality>"
                                         "<contact><exclude body1='loose' body2='welded'/></contact></mujoco>";
}

}  // namespace simvis::test
