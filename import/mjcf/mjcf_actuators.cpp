#include "import/mjcf/mjcf_actuators.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace simvis {
namespace {

// force = gain * control + bias[0] + bias[1] * length + bias[2] * speed, where length and speed are those of the joint
// times the gear.
struct Affine {
  double gain = 1;
  std::array<double, 3> bias{};
};

Affine affine_of_general(const MjcfElement& actuator) {
  Affine affine;
  const std::vector<double> gain = actuator.numbers("gainprm", 1, 10), bias = actuator.numbers("biasprm", 1, 10);
  if (!gain.empty()) affine.gain = gain[0];
  if (actuator.text("biastype", "none") == "affine") {
    for (std::size_t i = 0; i < std::min<std::size_t>(bias.size(), 3); ++i) affine.bias[i] = bias[i];
  }
  return affine;
}

// Empty: an actuator of another kind, which is reported.
std::optional<Affine> affine_of(const MjcfElement& actuator, ImportReport& report) {
  const std::string_view tag = actuator.tag();
  if (tag == "motor") return Affine{};
  if (tag == "position") {
    const double kp = actuator.number("kp", 1), kv = actuator.number("kv", 0);
    if (actuator.find("dampratio")) report.leave_out("\"dampratio\" of an actuator", actuator.at());
    return Affine{.gain = kp, .bias = {0, -kp, -kv}};
  }
  if (tag == "velocity") {
    const double kv = actuator.number("kv", 1);
    return Affine{.gain = kv, .bias = {0, 0, -kv}};
  }
  const std::string gain = actuator.text("gaintype", "fixed"), bias = actuator.text("biastype", "none");
  if (tag == "general" && gain == "fixed" && (bias == "none" || bias == "affine")) return affine_of_general(actuator);
  report.leave_out("actuator <" + std::string(tag) + ">" + (tag == "general" ? " with a gain or bias of its own" : ""),
                   actuator.at());
  return std::nullopt;
}

}  // namespace

std::optional<std::array<double, 2>> mjcf_limits(const MjcfElement& element, const char* range, const char* limited) {
  const std::vector<double> limits = element.numbers(range, 2, 2);
  const std::string flag = element.text(limited, "auto");
  if (limits.empty() || flag == "false" || (flag == "auto" && !element.model().autolimits)) return std::nullopt;
  if (!(limits[0] < limits[1])) element.fail("has a " + std::string(range) + " that does not rise");
  return std::array{limits[0], limits[1]};
}

namespace {

// A force that depends on the position is a drive by position, one that depends on the speed alone a drive by speed.
ModelDrive drive_of(const Affine& affine, double gear) {
  const auto& [constant, of_length, of_speed] = affine.bias;
  if (of_length != 0) {
    return {.kind = ModelDrive::Kind::position, .gain = -of_length * gear * gear, .damping = -of_speed * gear * gear};
  }
  if (of_speed != 0) return {.kind = ModelDrive::Kind::velocity, .gain = -of_speed * gear * gear};
  return {.kind = ModelDrive::Kind::effort, .gain = 1};
}

// The target at the joint for a control value.
double target_of(const Affine& affine, double gear, double control) {
  const double force = affine.gain * control + affine.bias[0];
  if (affine.bias[1] != 0) return force / (-affine.bias[1] * gear);
  if (affine.bias[2] != 0) return force / (-affine.bias[2] * gear);
  return force * gear;
}

ModelDrive read_drive(const MjcfElement& actuator, const Affine& affine, double gear) {
  ModelDrive drive = drive_of(affine, gear);
  double control = 0;  // as MuJoCo starts
  if (const auto range = mjcf_limits(actuator, "ctrlrange", "ctrllimited")) {
    const double a = target_of(affine, gear, (*range)[0]), b = target_of(affine, gear, (*range)[1]);
    drive.lower = std::min(a, b);
    drive.upper = std::max(a, b);
    control = std::clamp(control, (*range)[0], (*range)[1]);
  }
  drive.start = target_of(affine, gear, control);
  if (const auto range = mjcf_limits(actuator, "forcerange", "forcelimited")) {
    drive.min_effort = std::min((*range)[0] * gear, (*range)[1] * gear);
    drive.max_effort = std::max((*range)[0] * gear, (*range)[1] * gear);
  }
  return drive;
}

}  // namespace

std::map<std::string, ModelDrive> read_mjcf_drives(const MjcfTree& tree, ImportReport& report) {
  std::map<std::string, ModelDrive> drives;
  for (const auto& [section, prefix] : tree.sections("actuator")) {
    for (const MjcfElement& actuator : section.children()) {
      const std::optional<Affine> affine = affine_of(actuator, report);
      if (!affine) continue;
      const std::string joint = actuator.text("joint", actuator.text("jointinparent"));
      if (joint.empty()) {
        report.leave_out("actuator of something else than a joint", actuator.at());
        continue;
      }
      if (actuator.text("dyntype", "none") != "none" || actuator.number("timeconst", 0) > 0) {
        report.leave_out("activation of an actuator, which acts at once,", actuator.at());
      }
      const std::vector<double> gears = actuator.numbers("gear", 1, 6);
      const double gear = gears.empty() ? 1 : gears[0];
      if (gear == 0) actuator.fail("has a gear of 0, expected another number");
      const bool is_first = drives.emplace(prefix + joint, read_drive(actuator, *affine, gear)).second;
      if (!is_first) report.leave_out("second actuator of a joint", actuator.at());
    }
  }
  return drives;
}

}  // namespace simvis
