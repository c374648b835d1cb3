// A scene whose elements move, without a device: nothing is drawn or measured.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "elements/dynamics/world/world.h"
#include "simvis/element_motion.h"
#include "simvis/ros/command_inputs.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"

namespace simvis::test {

inline constexpr double kGravity_m_s2 = 9.80665;  // what the element physics has
inline constexpr double kStep_s = 1e-3;           // the same
inline const std::string kPhysics = "<element type='physics' name='PHYSICS' insert_at='ROOT'/>\n";

class MovingScene {
 public:
  /// Frame 0 is made.
  explicit MovingScene(const std::string& commands, const std::filesystem::path& folder = "", std::uint64_t seed = 0)
      : built_(build_scene(parse_commands(commands, "s.xml", folder), {}, seed)) {
    go_to(0);
  }
  /// One frame at this time.
  void go_to(double time_s) {
    const std::int64_t time_ns = std::llround(time_s * 1e9);
    follow_commands(sources_.of(built_), built_, time_ns_, time_ns);
    advance_elements(built_, {.time_ns = time_ns});
    time_ns_ = time_ns;
  }
  /// A message that counts from the next frame on.
  void command(const CommandInput& input, std::string_view bytes) {
    apply_command(sources_.of(built_), built_.parameters, input, bytes, time_ns_);
  }
  /// Frames of `period_s` until this time.
  void run(double from_s, double to_s, double period_s) {
    for (int i = 1; from_s + i * period_s <= to_s * (1 + 1e-12); ++i) go_to(from_s + i * period_s);
  }
  void set(std::string_view element, std::string_view parameter, double value) {
    built_.parameters.set(built_.parameters.index(element, parameter), value);
  }
  double get(std::string_view element, std::string_view parameter) const {
    return built_.parameters.values()[built_.parameters.index(element, parameter)];
  }
  std::vector<double> values() const { return {built_.parameters.values().begin(), built_.parameters.values().end()}; }
  glm::dmat4 pose(std::string_view part) const { return built_.scene.world_from_point(part).value(); }
  glm::dvec3 position(std::string_view part) const { return glm::dvec3(pose(part)[3]); }
  BuiltScene& operator*() { return built_; }

 private:
  BuiltScene built_;
  CommandSources sources_;
  std::int64_t time_ns_ = 0;
};

inline std::string physics(const std::string& attributes) {
  return "<element type='physics' name='PHYSICS' insert_at='ROOT' " + attributes + "/>\n";
}

/// A part with a body of the same name and _BODY behind it.
inline std::string body(const std::string& name, const std::string& part, const std::string& attributes) {
  return "<part name='" + name + "' insert_at='ROOT' " + part + "/>\n<element type='body' name='" + name +
         "_BODY' insert_at='" + name + "' " + attributes + "/>\n";
}

/// A floor whose upper side is z = 0.
inline std::string ground(const std::string& attributes = "") {
  return body("GROUND", "shape='box' size='100 100 2' pose_offset='0 0 -1 0 0 0'",
              "kind='static' shape='box' " + attributes);
}

}  // namespace simvis::test
