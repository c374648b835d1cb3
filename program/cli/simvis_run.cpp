// simvis-run: the program that turns a scene file into images and scans. Only this file and the tests catch exceptions
// for good, and only the files of this folder print.
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <simvis/device.h>
#include <simvis/plugin.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "engine/base/now_ns.h"
#include "engine/base/result_lock.h"
#include "program/cli/compare_run.h"
#include "program/cli/listing.h"
#include "program/cli/load_scene.h"
#include "program/cli/loading_bar.h"
#include "program/cli/memory_reserve.h"
#include "program/cli/progress_bar.h"
#include "program/cli/run_scene.h"
#include "program/cli/signals.h"
#include "program/cli/warning_printer.h"
#include "program/options/command_line.h"
#include "program/options/completion.h"
#include "program/options/man_page.h"
#include "program/output/atomic_file.h"
#include "program/report/camera_costs.h"
#include "program/report/cost_report.h"
#include "program/report/light_costs.h"
#include "program/report/scanner_costs.h"
#include "program/report/scene_schema.h"
#include "program/report/type_reference.h"

namespace simvis {
namespace {

constexpr int kExitDone = 0, kExitFailed = 1, kExitWrongInput = 2;

void print_devices() {
  const std::vector<DeviceInfo> devices = list_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& device = devices[i];
    std::cout << i << ": " << device.name << ", " << device.type << ", driver " << device.driver << ", Vulkan "
              << device.api_version << ", "
              << (device.unusable.empty() ? std::string("usable") : "not usable: " + device.unusable) << '\n';
  }
}

ReferenceFormat reference_format(const Options& options) {
  if (options.markdown) return ReferenceFormat::markdown;
  return options.list.json ? ReferenceFormat::json : ReferenceFormat::text;
}

void print_description(const Options& options) {
  if (options.xsd) {
    if (options.describe != "all") {
      throw InputError("--xsd: the schema has all types, expected --describe all in place of --describe " +
                       options.describe);
    }
    std::cout << scene_schema();
    return;
  }
  in_option("--describe", [&] { std::cout << type_reference(options.describe, reference_format(options)); });
}

bool has_scanner(const Simulation& simulation) {
  return std::ranges::any_of(simulation.sensors(), [](const SensorInfo& sensor) {
    return sensor.enabled && (sensor.capabilities & kCastsBeams) != 0;
  });
}

/// Throws if --sensor names a sensor without such a list, or if there is none.
void check_costed(const Options& options, const Simulation& simulation) {
  const std::vector<std::string> cameras = costed_cameras(simulation), lights = costed_lights(simulation);
  for (const SensorInfo& sensor : simulation.sensors()) {
    const bool scanner = sensor.enabled && (sensor.capabilities & kCastsBeams) != 0;
    if (options.sensors.empty() || !sensor.enabled || scanner || std::ranges::count(cameras, sensor.name) ||
        std::ranges::count(lights, sensor.name)) {
      continue;
    }
    throw InputError("--sensor " + sensor.name +
                     ": --price lists laser scanners and cameras with colour, and this is of type " + sensor.type);
  }
  if (!has_scanner(simulation) && cameras.empty() && lights.empty()) {
    throw InputError("--price: there is no enabled laser scanner and no camera with colour, expected at least one");
  }
}

/// A list of costs as a file, which is there once it is written whole. It is opened first, so that a folder that cannot
/// be written costs no time.
class CostFile {
 public:
  CostFile(const Options& options, const char* name, bool wanted) {
    if (!options.names_out || !wanted) return;
    const std::filesystem::path file = std::filesystem::path(options.out) / name;
    lock_.emplace(file);
    file_.emplace(file);
  }
  void write(const std::string& text) {
    if (!file_) return;
    file_->write(text);
    file_->commit();
  }
  void say() const {
    if (file_) std::cout << "wrote " << file_->path().string() << '\n';
  }

 private:
  std::optional<ResultLock> lock_;
  std::optional<AtomicFile> file_;
};

void list_costs(const Options& options) {
  if (options.quiet && !options.names_out) {
    throw InputError("--price: --quiet leaves nothing to print, expected --out DIR with it");
  }
  if (options.simulation.frames_when_due)
    throw InputError("--price: frames come at a fixed rate, expected no --rate auto");
  std::optional<LoadingBar> loading;
  loading.emplace(std::cerr, shows_progress(options));
  Simulation simulation = load(options, loading);
  loading->clear_line();
  check_costed(options, simulation);
  WarningPrinter warnings(std::cerr);
  warnings.print_new(simulation);
  const std::optional<Trajectory> trajectory = read_trajectory(options, simulation);
  const Device device(options.simulation.device);
  defer_signals();
  std::optional<ProgressBar> progress;
  CostDesc desc{.frames = options.frames, .rate_hz = options.simulation.rate_hz};
  if (trajectory) desc.trajectory = &*trajectory;
  desc.on_frame = [&, start = std::chrono::steady_clock::now()](std::uint64_t done, std::uint64_t all) {
    stop_if_asked_to();
    loading.reset();
    if (!progress) progress.emplace(std::cerr, shows_progress(options), all, start);
    progress->update(done, std::chrono::steady_clock::now());
  };
  if (options.names_out) make_folder(options.out);
  const bool cameras = !costed_cameras(simulation).empty(), lights = !costed_lights(simulation).empty(),
             scanners = has_scanner(simulation);
  CostFile csv(options, "price.csv", scanners), camera_csv(options, "camera_price.csv", cameras),
      light_csv(options, "light_price.csv", lights);
  // A measurement consumes its simulation: the next one loads the scene again.
  auto take = [&, loaded = std::optional(std::move(simulation))]() mutable {
    std::optional<Simulation> next = std::exchange(loaded, std::nullopt);
    return next ? *std::move(next) : load(options, loading);
  };
  std::vector<CameraCosts> all_camera_costs;
  if (cameras) {
    all_camera_costs = camera_costs(take(), desc);
    progress.reset();
  }
  std::vector<LightCosts> all_light_costs;
  if (lights) {
    all_light_costs = light_costs(take(), desc);
    progress.reset();
  }
  std::vector<ScannerCosts> all_costs;
  if (scanners) all_costs = scanner_costs(take(), desc);
  loading.reset();
  progress.reset();
  if (scanners) csv.write(to_csv(all_costs));
  if (cameras) camera_csv.write(to_csv(all_camera_costs));
  if (lights) light_csv.write(to_csv(all_light_costs));
  if (options.quiet) return;
  std::cout << "on " << device.info().name
            << (trajectory ? "" : "; no parameter is set: --trajectory prices what moves") << "\n\n";
  for (const ScannerCosts& costs : all_costs) std::cout << to_table(costs) << '\n';
  if (scanners) std::cout << cost_legend();
  for (const CameraCosts& costs : all_camera_costs) std::cout << (scanners ? "\n" : "") << to_table(costs) << '\n';
  if (cameras) std::cout << camera_cost_legend();
  for (const LightCosts& costs : all_light_costs) {
    std::cout << (scanners || cameras ? "\n" : "") << to_table(costs) << '\n';
  }
  if (lights) std::cout << light_cost_legend();
  csv.say();
  camera_csv.say();
  light_csv.say();
}

/// Rasterisers on the CPU allocate and free megabytes for each draw. By default glibc returns such memory to the
/// system, and the next draw faults it in again page by page, which takes a tenth to a fifth of a frame of large
/// meshes. Only a program may choose this: a library would change it for its host.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMiB);  // the largest value that glibc takes
  mallopt(M_TRIM_THRESHOLD, 256 * kMiB);
#endif
}

/// True for a pipe or socket whose reader has closed it, as `head` does when it has its lines. A run does not fail for
/// this: its results are files.
bool reader_is_gone(int descriptor) {
  pollfd output{.fd = descriptor, .events = POLLOUT, .revents = 0};
  return ::poll(&output, 1, 0) == 1 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

int main_or_throw(const std::vector<std::string>& arguments) {
  const std::int64_t start_ns = now_ns();
  handle_signals();
  ParsedOptions parsed = parse_options(arguments);
  if (parsed.exit_status) return *parsed.exit_status;
  Options& options = parsed.options;
  for (const std::string& warning : parsed.warnings) std::cerr << "warning: " << warning << '\n';
  if (!options.again.empty() || (options.resume && options.scene.empty())) {
    RecordedOptions recorded = recorded_options(options);
    options = std::move(recorded.options);
    for (const std::string& warning : recorded.warnings) std::cerr << "warning: " << warning << '\n';
  }
  for (const std::string& plugin : options.plugins) load_plugin(plugin);
  int status = kExitDone;
  if (options.list_devices) {
    print_devices();
  } else if (!options.describe.empty()) {
    print_description(options);
  } else if (!options.completion.empty()) {
    std::cout << completion_script(options.completion);
  } else if (options.man) {
    std::cout << man_page();
  } else if (options.list.types) {
    std::cout << type_list();
  } else if (options.list.scene) {
    std::cout << scene_listing(options.scene, scene_desc(options), options.list.json);
  } else if (options.list.check) {
    const SceneCheck check = scene_check(options.scene, scene_desc(options));
    for (const std::string& warning : check.warnings) std::cerr << "warning: " << warning << '\n';
    std::cout << check.text;
    if (check.has_problems) status = kExitFailed;
  } else if (!options.compare.empty()) {
    compare_with_recording(options);
  } else if (options.price) {
    if (!options.names_frames) options.frames = CostDesc().frames;
    list_costs(options);
  } else {
    status = run_scene(options, start_ns);
  }
  if (!std::cout.flush() && !reader_is_gone(STDOUT_FILENO)) throw MachineError("standard output cannot be written");
  return status;
}

/// Errors with a location in a file are printed in the format of compilers; other errors start with the program's name.
void print_error(const std::exception& error) {
  // Without a copy of the text: there may be no memory.
  const bool lacks_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  const std::string_view text = lacks_memory ? "there is not enough memory" : error.what();
  if (text.starts_with("--")) {
    std::cerr << "simvis-run: " << text << '\n';
  } else if (text.find(": error: ") != std::string_view::npos) {
    std::cerr << text << '\n';
  } else {
    std::cerr << "simvis-run: error: " << text << '\n';
  }
}

// The types of the library register themselves before main(), and allocate. The linker calls this before that.
[[gnu::section(".preinit_array"), gnu::used]] void (*const kBeforeAll)() = set_memory_aside;

}  // namespace
}  // namespace simvis

int main(int argc, char** argv) {
  simvis::keep_freed_memory();
  try {
    return simvis::main_or_throw({argv + 1, argv + argc});
  } catch (const simvis::InputError& error) {
    simvis::print_error(error);
    return simvis::kExitWrongInput;
  } catch (const simvis::Stopped& stopped) {
    simvis::print_error(stopped);
    return simvis::kExitStopped;
  } catch (const std::exception& error) {
    simvis::print_error(error);
    return simvis::kExitFailed;
  }
}
