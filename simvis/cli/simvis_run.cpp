// simvis-run: the program that turns a scene file into images and scans. Only this file and the tests catch exceptions,
// and only this file prints.
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <simvis/plugin.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "engine/base/now_ns.h"
#include "engine/base/thread_pool.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "simvis/cli/loading_bar.h"
#include "simvis/cli/progress_bar.h"
#include "simvis/cli/warning_printer.h"
#include "simvis/clock.h"
#include "simvis/output/atomic_file.h"
#include "simvis/output/output_writer.h"
#include "simvis/report/explain.h"
#include "simvis/report/price.h"
#include "simvis/report/price_report.h"
#include "simvis/report/profile.h"
#include "simvis/report/run_report.h"
#include "simvis/report/shard.h"
#include "simvis/report/summary.h"
#include "simvis/report/type_reference.h"
#include "simvis/timeline.h"

namespace simvis {
namespace {

constexpr int kExitDone = 0, kExitFailed = 1, kExitWrongInput = 2;

struct Options {
  std::string scene, out = "out", trajectory, method, max_error_m, device, profile, describe, shard;
  std::vector<std::string> set, sensors, plugins;
  std::uint64_t frames = 1, seed = 0;
  unsigned threads = 0;
  std::string rate = format_number(SimulationDesc{}.rate_hz);
  double rate_hz = SimulationDesc{}.rate_hz;
  bool frames_when_due = false, frames_given = false, strict = false;
  bool list_devices = false, explain = false, quiet = false;
  bool price = false, summary = false, names_out = false, markdown = false;
};

/// Checks that `text` is a whole number. CLI11 itself would read -3 as 2^64 - 3, and larger numbers as the largest one.
std::string whole_number(const std::string& text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return rest == end && error == std::errc() ? "" : "\"" + text + "\" is not a whole number from 0 to 2^64 - 1";
}

std::string not_empty(const std::string& text) { return text.empty() ? "it is empty" : ""; }

void declare_options(CLI::App& app, Options& options) {
  app.add_option("SCENE.xml", options.scene, "the scene to run");
  app.add_option("-o,--out", options.out, "where results go")->type_name("DIR")->capture_default_str();
  app.add_option("--frames", options.frames, "how many frames; with a trajectory by default all until its end")
      ->type_name("N")
      ->check(whole_number)
      ->capture_default_str();
  app.add_option("--rate", options.rate, "frames per simulated second; auto: a frame exactly when a sensor is due")
      ->type_name("HZ|auto")
      ->capture_default_str();
  app.add_option("--set", options.set, "a parameter, from the first frame on (repeatable)")
      ->type_name("ELEMENT.PARAM=VALUE")
      ->allow_extra_args(false);
  app.add_option("--trajectory", options.trajectory,
                 "parameters over time: first column time_s, further columns ELEMENT.PARAM; linear between rows, "
                 "angles the short way")
      ->type_name("FILE.csv");
  app.add_option("--sensor", options.sensors, "only this sensor (repeatable)")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option("--method", options.method, "for every laser scanner, over the scene's own")
      ->type_name("M")
      ->check(not_empty);
  app.add_option("--max-error", options.max_error_m,
                 "bound on the error of every laser scanner's ranges, in metres; by method hybrid unless --method says "
                 "auto")
      ->type_name("M")
      ->check(not_empty);
  app.add_option("--seed", options.seed, "of all random numbers")
      ->type_name("N")
      ->check(whole_number)
      ->capture_default_str();
  app.add_option("--device", options.device, "the Vulkan device to use: part of its name, or its index")
      ->type_name("NAME|INDEX");
  app.add_option(
         "--threads", options.threads,
         "on how many threads SimVis casts rays, culls views and prepares meshes, up to 1024; 0: as many as the "
         "machine has. Pictures are encoded on up to 8 more of low priority, none for 1. Results do not depend "
         "on it. The Vulkan driver has threads of its own")
      ->type_name("N")
      ->check(whole_number)
      ->capture_default_str();
  app.add_option("--plugin", options.plugins, "a library with more elements and sensors (repeatable)")
      ->type_name("FILE.so")
      ->allow_extra_args(false);
  app.add_option("--profile", options.profile,
                 "write what each frame spent its time on, on the host and on the device, in Chrome's trace format")
      ->type_name("FILE.json");
  app.add_option("--shard", options.shard,
                 "only the frames k with k mod N = K; files are those of the whole run, tables and run.json have "
                 "-K-of-N in their names")
      ->type_name("K/N")
      ->check(not_empty);
  app.add_flag("--explain", options.explain, "print what the last frame renders, why, and what it cost");
  app.add_flag("--strict", options.strict, "warnings are errors");
  app.add_flag("--quiet", options.quiet, "print errors and warnings only");
  app.add_flag("--price", options.price,
               "print what each method of each laser scanner costs and is worth in this scene; --frames of each (" +
                   std::to_string(PriceDesc().frames) +
                   "), along the trajectory if there is one; also as DIR/price.csv "
                   "where --out is given")
      ->excludes("--method")
      ->excludes("--profile")
      ->excludes("--shard")
      ->excludes("--explain");
  app.add_flag(
         "--summary", options.summary,
         "after the run, print the speed of the laser scanners, the share of a frame that the other sensors take, "
         "what each method costs the first scanner and how large its error is, and which files to open first")
      ->excludes("--price")
      ->excludes("--shard")
      ->excludes("--quiet");
  CLI::Option* const describe =
      app.add_option("--describe", options.describe,
                     "print what an element, sensor or effect does and its attributes, and exit; all: of every one")
          ->type_name("TYPE");
  app.add_flag("--markdown", options.markdown, "with --describe: as Markdown")->needs(describe);
  app.add_flag("--list-devices", options.list_devices, "print the Vulkan devices of this machine, and exit");
  app.set_version_flag("--version", "simvis-run " + std::string(version()), "print the version, and exit");
  app.set_help_flag("-h,--help", "print this help, and exit");
  app.footer(
      "Results: DIR/CAMERA/000000.png and .exr, DIR/SCANNER.csv, DIR/run.json.\n"
      "Exit status: 0 done; 1 it could not be done; 2 the command line or the scene is wrong.");
}

volatile std::sig_atomic_t received_signal = 0;

/// After this call, a signal to stop ends the run between two frames, so that no temporary file remains. A second
/// signal ends it at once. A file beyond the size limit and a closed pipe become errors of the write.
void handle_signals() {
  struct sigaction action {};
  action.sa_handler = [](int number) { received_signal = number; };
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(number, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
}

void stop_if_asked_to() {
  const int number = received_signal;
  if (number != 0) throw MachineError(std::string("stopped by a signal (") + ::strsignal(number) + ")");
}

/// Runs `action`; its errors name this option of the command line.
template <typename Action>
void in_option(const std::string& option, const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    throw InputError(option + ": " + error.what());
  }
}

void print_devices() {
  const std::vector<DeviceInfo> devices = list_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& device = devices[i];
    std::cout << i << ": " << device.name << ", " << device.type << ", driver " << device.driver << ", Vulkan "
              << device.api_version << ", "
              << (device.unusable.empty() ? std::string("usable") : "not usable: " + device.unusable) << '\n';
  }
}

void print_description(const Options& options) {
  in_option("--describe", [&] {
    std::cout << type_reference(options.describe, options.markdown ? ReferenceFormat::markdown : ReferenceFormat::text);
  });
}

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

std::vector<AttributeOverride> scanner_overrides(const Options& options) {
  std::vector<AttributeOverride> overrides;
  const auto set = [&](const char* attribute, std::optional<std::string> value, const char* origin) {
    overrides.push_back({"laser_scanner", attribute, std::move(value), origin});
  };
  const std::optional<ScanMethod> method = find_scan_method(options.method);
  const bool takes_none = method && !takes_tolerance(*method);
  if (!options.method.empty()) set("method", options.method, "--method");
  if (!options.max_error_m.empty()) {
    if (takes_none) {
      throw InputError("--max-error: --method " + options.method +
                       " ignores a tolerance, expected --method auto, --method hybrid or no --method");
    }
    if (options.method.empty()) set("method", {}, "--max-error");  // a tolerance without a method selects hybrid
    set("max_error_m", options.max_error_m, "--max-error");
    set("max_error_rel", {}, "--max-error");
  } else if (takes_none) {  // the scene's tolerances belong to the methods that --method replaces
    set("max_error_m", {}, "--method");
    set("max_error_rel", {}, "--method");
  }
  return overrides;
}

void read_rate(Options& options) {
  options.frames_when_due = options.rate == "auto";
  if (options.frames_when_due || parse_number(options.rate, options.rate_hz)) return;
  throw InputError("--rate: " + in_quotes(options.rate) + " is not allowed, expected a number (Hz) or auto");
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

bool shows_progress(const Options& options) { return ::isatty(STDERR_FILENO) == 1 && !options.quiet; }

/// `loading` shows the progress of loading until it is reset.
Simulation load(const Options& options, std::optional<LoadingBar>& loading) {
  if (options.scene.empty()) throw InputError("SCENE.xml is missing, expected a scene to run; see --help");
  in_option("--frames", [&] {
    if (options.frames == 0) throw InputError("0 frames, expected 1 or more");
  });
  in_option("--rate", [&] { Clock(options.rate_hz).frame(options.frames - 1); });
  in_option("--threads", [&] { shared_thread_pool(options.threads); });
  SimulationDesc desc;
  desc.rate_hz = options.rate_hz;
  desc.frames_when_due = options.frames_when_due;
  desc.strict = options.strict;
  desc.seed = options.seed;
  desc.threads = options.threads;
  desc.device.select = options.device;
  desc.device.instrumented = options.explain || !options.profile.empty();
  desc.overrides = scanner_overrides(options);
  desc.progress = [&loading](const Progress& progress) {
    if (loading) loading->update(progress);
  };
  Simulation simulation = Simulation::load(options.scene, desc);
  set_parameters(simulation, options.set);
  if (!options.sensors.empty()) {
    for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
    for (const std::string& name : options.sensors) {
      in_option("--sensor", [&] { simulation.enable(name, true); });
    }
  }
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

/// The number of frames until the end of the trajectory.
std::uint64_t frames_of(const Trajectory& trajectory, const Options& options, const Simulation& simulation) {
  std::vector<double> rates;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled && sensor.rate_hz > 0) rates.push_back(sensor.rate_hz);
  }
  const Timeline timeline(options.rate_hz, options.frames_when_due);
  return timeline.frames_until(std::llround(std::min(trajectory.end_s() * 1e9, 9e18)), rates);
}

void write_results(const Simulation& simulation, const FrameTime& time, OutputWriter& writer) {
  for (const std::string& sensor : simulation.measured()) simulation.write(sensor, writer.sink(sensor, time));
}

void print_explanation(const Simulation& simulation) {
  std::cout << explain(simulation.diagnostics().frame_plan(),
                       {simulation.diagnostics().counters(), simulation.diagnostics().frame_costs(),
                        simulation.diagnostics().sensor_costs()});
  for (const SensorInfo& sensor : simulation.sensors()) std::cout << sensor.report.explanation;
  const FramePlan* const visualization = simulation.diagnostics().visualization_plan();
  if (visualization == nullptr) return;
  std::cout << "visualization, drawn apart:\n"
            << explain(*visualization,
                       {*simulation.diagnostics().visualization_counters(),
                        simulation.diagnostics().visualization_costs(), simulation.diagnostics().sensor_costs()});
}

void add_frame(Profile& profile, std::uint64_t frame, const Simulation& simulation) {
  profile.add({.index = frame,
               .stages = simulation.diagnostics().stages(),
               .written_ns = now_ns(),
               .sensors = simulation.diagnostics().sensor_costs(),
               .counters = simulation.diagnostics().counters(),
               .device_memory_bytes = simulation.diagnostics().device_memory_bytes()});
  profile.add(simulation.diagnostics().frame_plan(), *simulation.diagnostics().frame_costs());
  if (const FramePlan* const plan = simulation.diagnostics().visualization_plan())
    profile.add(*plan, *simulation.diagnostics().visualization_costs());
}

/// Empty without --shard.
std::optional<Shard> wanted_shard(const Options& options, const Simulation& simulation) {
  std::optional<Shard> shard;
  if (options.shard.empty()) return shard;
  in_option("--shard", [&] {
    shard = parse_shard(options.shard);
    if (shard->share_of(options.frames) == 0) {
      throw InputError(options.shard + " has no frame of " + std::to_string(options.frames) +
                       ", expected K below --frames");
    }
    if (shard->count > 1) simulation.require_skippable();
  });
  return shard;
}

/// Computes and writes all frames and fills in the times of the report. Resets `loading` after the first frame.
void run_frames(const Options& options, Simulation& simulation, const std::optional<Trajectory>& trajectory,
                OutputWriter& writer, RunReport& report, std::optional<Profile>& profile,
                std::optional<LoadingBar>& loading, WarningPrinter& warnings) {
  const Shard shard = report.shard.value_or(Shard{});
  ProgressBar progress(std::cerr, shows_progress(options), shard.share_of(options.frames),
                       std::chrono::steady_clock::now());
  for (std::uint64_t frame = 0; frame < options.frames; ++frame) {
    const FrameTime time = simulation.next_frame();
    if (trajectory) trajectory->apply(static_cast<double>(time.time_ns) / 1e9, simulation.parameters());
    if (!shard.has(frame)) {
      simulation.skip_frame();
      continue;
    }
    const std::int64_t start_ns = now_ns();
    simulation.step();
    const std::int64_t measured_ns = now_ns();
    loading.reset();
    warnings.print_new(simulation);
    stop_if_asked_to();
    report.frame_ms.push_back(static_cast<double>(measured_ns - start_ns) / 1e6);
    write_results(simulation, time, writer);
    stop_if_asked_to();
    if (profile) add_frame(*profile, frame, simulation);
    progress.update(report.frame_ms.size(), std::chrono::steady_clock::now());
  }
}

std::filesystem::path report_file(const Options& options, const RunReport& report) {
  return std::filesystem::path(options.out) / ("run" + (report.shard ? report.shard->suffix() : "") + ".json");
}

void print_closing(const Options& options, const OutputWriter& writer, const RunReport& report) {
  std::cout << "wrote ";
  for (const std::string& result : writer.results()) std::cout << result << ", ";
  std::cout << report_file(options, report).string() << '\n' << speed_line(report) << '\n';
}

void print_summary(const Options& options, Simulation simulation, const std::optional<Trajectory>& trajectory,
                   const RunReport& report) {
  std::cout << to_text(summarize(std::move(simulation), {.rate_hz = options.rate_hz,
                                                         .frame_ms = percentile(report.frame_ms, 50),
                                                         .out = options.out,
                                                         .trajectory = trajectory ? &*trajectory : nullptr,
                                                         .on_frame = stop_if_asked_to}));
}

void run_scene(Options options, std::int64_t start_ns) {
  std::optional<LoadingBar> loading;
  loading.emplace(std::cerr, shows_progress(options));
  Simulation simulation = load(options, loading);
  loading->clear_line();
  WarningPrinter warnings(std::cerr);
  warnings.print_new(simulation);
  const std::optional<Trajectory> trajectory = read_trajectory(options, simulation);
  warnings.print_new(simulation);
  if (trajectory && !options.frames_given) options.frames = frames_of(*trajectory, options, simulation);
  std::vector<std::string> writing;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled) writing.push_back(sensor.name);
  }
  RunReport report;
  report.shard = wanted_shard(options, simulation);
  handle_signals();
  OutputWriter writer(options.out, writing, report.shard ? report.shard->suffix() : "", options.threads);
  report.scene = options.scene;
  report.device = simulation.diagnostics().device();
  report.seed = options.seed;
  report.rate_hz = options.rate_hz;
  report.frames_when_due = options.frames_when_due;
  std::optional<Profile> profile;
  if (!options.profile.empty()) profile.emplace(options.profile, simulation.diagnostics().device().name);
  run_frames(options, simulation, trajectory, writer, report, profile, loading, warnings);
  if (options.explain) print_explanation(simulation);
  writer.finish();
  if (profile) profile->commit();
  report.sensors = with_bounds(simulation);
  report.warnings = simulation.warnings();
  report.simulated_s = static_cast<double>(simulation.next_frame().time_ns) / 1e9 *
                       static_cast<double>(report.frame_ms.size()) / static_cast<double>(options.frames);
  report.wall_s = static_cast<double>(now_ns() - start_ns) / 1e9;
  write_file(report_file(options, report), to_json(report));
  if (!options.quiet) print_closing(options, writer, report);
  if (options.summary) print_summary(options, std::move(simulation), trajectory, report);
}

/// Throws if --sensor names a sensor without a price list, such as a camera.
void check_priced(const Options& options, const Simulation& simulation) {
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (options.sensors.empty() || !sensor.enabled || sensor.type == "laser_scanner") continue;
    throw InputError("--sensor " + sensor.name + ": --price lists laser scanners, and this is a " + sensor.type);
  }
  in_option("--price", [&] { scanners_to_price(simulation); });
}

void price_scene(const Options& options) {
  if (options.quiet && !options.names_out) {
    throw InputError("--price: --quiet leaves nothing to print, expected --out DIR with it");
  }
  if (options.frames_when_due) throw InputError("--price: frames come at a fixed rate, expected no --rate auto");
  std::optional<LoadingBar> loading;
  loading.emplace(std::cerr, shows_progress(options));
  Simulation simulation = load(options, loading);
  loading->clear_line();
  check_priced(options, simulation);
  WarningPrinter warnings(std::cerr);
  warnings.print_new(simulation);
  const std::optional<Trajectory> trajectory = read_trajectory(options, simulation);
  warnings.print_new(simulation);
  const std::string device = simulation.diagnostics().device().name;
  handle_signals();
  std::optional<AtomicFile> csv;
  std::optional<ProgressBar> progress;
  PriceDesc desc{.frames = options.frames, .rate_hz = options.rate_hz};
  if (trajectory) desc.trajectory = &*trajectory;
  desc.on_frame = [&, start = std::chrono::steady_clock::now()](std::uint64_t done, std::uint64_t all) {
    stop_if_asked_to();
    loading.reset();
    if (!progress) progress.emplace(std::cerr, shows_progress(options), all, start);
    progress->update(done, std::chrono::steady_clock::now());
  };
  if (options.names_out) {
    make_folder(options.out);
    csv.emplace(std::filesystem::path(options.out) / "price.csv");
  }
  const std::vector<ScannerPrice> prices = price_scanners(std::move(simulation), desc);
  loading.reset();
  progress.reset();
  if (csv) {
    csv->write(to_csv(prices));
    csv->commit();
  }
  if (options.quiet) return;
  std::cout << "on " << device << (trajectory ? "" : "; the scene stands still: --trajectory prices what moves")
            << "\n\n";
  for (const ScannerPrice& price : prices) std::cout << to_table(price) << '\n';
  std::cout << price_legend();
  if (csv) std::cout << "wrote " << csv->path().string() << '\n';
}

/// The message for an option that does not exist. CLI11 itself would blame the argument behind it, which it takes for
/// the scene.
std::optional<std::string> unknown_option(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string& argument : app.remaining()) {
    if (!argument.starts_with("-")) continue;
    const std::string option = argument.substr(0, argument.find('='));
    return "there is no option " + option + suggestion(option, known);
  }
  return std::nullopt;
}

int main_or_throw(int argc, char** argv) {
  const std::int64_t start_ns = now_ns();
  Options options;
  CLI::App app("Simulates what a robot's optical sensors see.", "simvis-run");
  declare_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {
    return app.exit(wish);
  } catch (const CLI::ParseError& error) {
    throw InputError(unknown_option(app).value_or(error.what()) + "; see --help");
  }
  options.frames_given = app.count("--frames") > 0;
  read_rate(options);
  for (const std::string& plugin : options.plugins) load_plugin(plugin);
  if (options.list_devices) {
    print_devices();
  } else if (!options.describe.empty()) {
    print_description(options);
  } else if (options.price) {
    options.names_out = app.count("--out") > 0;
    if (!options.frames_given) options.frames = PriceDesc().frames;
    price_scene(options);
  } else {
    run_scene(options, start_ns);
  }
  if (!std::cout.flush()) throw MachineError("standard output cannot be written");
  return kExitDone;
}

/// Errors with a location in a file are printed in the format of compilers; other errors start with the program's name.
void print_error(const std::exception& error) {
  const std::string text = error.what();
  if (text.starts_with("--")) {
    std::cerr << "simvis-run: " << text << '\n';
  } else if (text.find(": error: ") != std::string::npos) {
    std::cerr << text << '\n';
  } else {
    std::cerr << "simvis-run: error: " << text << '\n';
  }
}

}  // namespace
}  // namespace simvis

int main(int argc, char** argv) {
  try {
    return simvis::main_or_throw(argc, argv);
  } catch (const simvis::InputError& error) {
    simvis::print_error(error);
    return simvis::kExitWrongInput;
  } catch (const std::exception& error) {
    simvis::print_error(error);
    return simvis::kExitFailed;
  }
}
