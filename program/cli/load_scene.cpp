#include "program/cli/load_scene.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <system_error>

#include <simvis/attributes.h>
#include "engine/base/input_file.h"
#include "engine/base/thread_pool.h"
#include "program/cli/signals.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "simvis/built_scene.h"
#include "simvis/ros/node_name.h"
#include "simvis/time/clock.h"

namespace simvis {
namespace {

void set_parameter(Simulation& simulation, const std::string& assignment) {
  in_option("--set " + assignment, [&] {
    const std::size_t equals = assignment.find('=');
    const std::size_t dot = assignment.rfind('.', equals);
    double value = 0;
    if (equals == std::string::npos || dot == std::string::npos) throw InputError("expected ELEMENT.PARAM=VALUE");
    const std::string number = assignment.substr(equals + 1);
    if (!parse_number(number, value)) throw InputError("\"" + number + "\" is not a finite number");
    simulation.set(assignment.substr(0, dot), assignment.substr(dot + 1, equals - dot - 1), value);
  });
}

void set_parameters(Simulation& simulation, const std::vector<std::string>& assignments) {
  std::vector<std::string> names;
  for (const std::string& assignment : assignments) {
    set_parameter(simulation, assignment);
    const std::string name = assignment.substr(0, assignment.find('='));
    if (std::ranges::find(names, name) != names.end()) {
      simulation.warn("--set " + name + ": is given more than once, and the last value applies; expected once");
    }
    names.push_back(name);
  }
}

/// Overrides an attribute of all sensor types that cast beams, as far as they have it and `with`.
void override_scanners(const std::string& attribute, const std::optional<std::string>& value, const char* origin,
                       const std::string& with, std::vector<AttributeOverride>& overrides) {
  for (const SensorType* type : sensor_types()) {
    const auto has = [&](const std::string& name) {
      return std::ranges::count(type->attributes, name, &AttributeSpec::name) > 0;
    };
    if ((type->capabilities & kCastsBeams) == 0 || !has(attribute) || !has(with)) continue;
    overrides.push_back({std::string(type->name), attribute, value, origin});
  }
}

std::vector<PackageFolder> given_packages(const Options& options) {
  std::vector<PackageFolder> packages;
  for (const std::string& text : options.packages) {
    in_option("--package " + text, [&] {
      const std::size_t equals = text.find('=');
      std::error_code error;
      if (equals == std::string::npos || equals == 0) throw InputError("expected NAME=DIR");
      packages.push_back({text.substr(0, equals), text.substr(equals + 1)});
      if (!std::filesystem::is_directory(packages.back().folder, error)) throw InputError("there is no such folder");
    });
  }
  return packages;
}

/// --restore-state.
void restore_state(Simulation& simulation, const std::string& file) {
  if (file.empty()) return;
  in_option("--restore-state " + file, [&] {
    const Bytes bytes = read_whole_file(file);
    simulation.restore_state({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  });
}

std::vector<AttributeOverride> scanner_overrides(const Options& options) {
  std::vector<AttributeOverride> overrides;
  const auto set = [&](const char* attribute, const std::optional<std::string>& value, const char* origin,
                       const char* with = "method") { override_scanners(attribute, value, origin, with, overrides); };
  const std::optional<ScanMethod> method = find_scan_method(options.method);
  const bool takes_none = method && !takes_tolerance(*method);
  if (!options.method.empty()) set("method", options.method, "--method");
  if (!options.max_error_m.empty()) {
    if (takes_none) {
      throw InputError("--max-error: --method " + options.method +
                       " ignores a tolerance, expected --method auto, --method hybrid or no --method");
    }
    // A tolerance without a method selects hybrid.
    if (options.method.empty()) set("method", {}, "--max-error", "max_error_m");
    set("max_error_m", options.max_error_m, "--max-error", "max_error_m");
    set("max_error_rel", {}, "--max-error", "max_error_m");
  } else if (takes_none) {  // the scene's tolerances belong to the methods that --method replaces
    set("max_error_m", {}, "--method");
    set("max_error_rel", {}, "--method");
  }
  return overrides;
}

}  // namespace

std::vector<std::filesystem::path> request_folders(const Options& options) {
  if (!options.allow.empty()) return {options.allow.begin(), options.allow.end()};
  if (options.scene.empty()) return {};
  return {std::filesystem::absolute(options.scene).parent_path()};
}

SimulationDesc scene_desc(const Options& options) {
  SimulationDesc desc = options.simulation;
  desc.device.instrumented = options.explain || !options.profile.empty();
  desc.overrides = scanner_overrides(options);
  desc.packages = given_packages(options);
  desc.sensors = options.sensors;
  return desc;
}

ServeDesc serve_desc(const Options& options) {
  return {.name = options.serve,
          .folders = request_folders(options),
          .lockstep = options.lockstep,
          .group = options.serve_group,
          .lockstep_timeout_s = options.lockstep_timeout_s};
}

std::optional<std::uint32_t> dds_domain(const std::string& text) {
  constexpr double kMax = 232;  // of the ports that the protocol has for domains
  if (text.empty()) return std::nullopt;
  double number = 0;
  if (parse_number(text, number) && number >= 0 && number <= kMax && number == std::floor(number)) {
    return static_cast<std::uint32_t>(number);
  }
  throw InputError(in_quotes(text) + " is no domain, expected a whole number from 0 to 232 or none");
}

DdsDesc dds_desc(const Options& options) {
  std::optional<std::uint32_t> domain;
  in_option("--dds-domain", [&] { domain = dds_domain(options.dds_domain); });
  in_option("--dds-node", [&] { full_node_name(options.dds_node); });
  return {.domain = domain,
          .topics = options.dds_topics,
          .reliable = options.dds_qos == "reliable",
          .requests = options.dds_requests,
          .folders = request_folders(options),
          .node = options.dds_node};
}

bool shows_progress(const Options& options) { return ::isatty(STDERR_FILENO) == 1 && !options.quiet; }

Simulation load(const Options& options, std::optional<LoadingBar>& loading) {
  if (options.scene.empty()) throw InputError("SCENE.xml is missing, expected a scene to run; see --help");
  in_option("--frames", [&] {
    if (options.frames == 0) throw InputError("0 frames, expected 1 or more");
  });
  in_option("--rate", [&] { Clock(options.simulation.rate_hz).frame(options.frames - 1); });
  in_option("--threads", [&] { shared_thread_pool(options.simulation.threads); });
  SimulationDesc desc = scene_desc(options);
  desc.progress = [&loading](const Progress& progress) {
    stop_if_asked_to();
    if (loading) loading->update(progress);
  };
  Simulation simulation = Simulation::load(options.scene, desc);
  restore_state(simulation, options.restore_state);
  set_parameters(simulation, options.set);
  return simulation;
}

std::optional<Trajectory> read_trajectory(const Options& options, Simulation& simulation) {
  if (options.trajectory.empty()) return std::nullopt;
  Trajectory trajectory(options.trajectory, simulation.parameters());
  for (const std::string& warning : trajectory.warnings()) simulation.warn(warning);
  for (const std::size_t index : trajectory.parameters()) {
    const std::string name = simulation.parameters().name(index);
    const auto sets = [&](const std::string& assignment) { return assignment.starts_with(name + "="); };
    if (std::ranges::none_of(options.set, sets)) continue;
    simulation.warn("--set " + name + ": the trajectory sets it too, and the trajectory's values apply");
  }
  return trajectory;
}

std::uint64_t frames_of(const Trajectory& trajectory, const Simulation& simulation) {
  return frames_until(simulation, std::llround(trajectory.end_s() * 1e9));
}

}  // namespace simvis
