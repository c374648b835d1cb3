// A Simulation as Python uses it: with the interpreter's lock free while it works, and with its rules enforced.
#pragma once

#include <nanobind/nanobind.h>

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "program/live/page_recording.h"
#include "python/core/errors.h"
#include "python/core/free_work.h"
#include "python/core/live_window.h"
#include "python/core/measurements.h"

namespace simvis::python {

/// Errors   InputError also if the simulation was closed, if another thread or a callback of its own step is using it,
///          and in a process that was forked from the one that loaded it.
/// Threads  every call comes with the interpreter's lock; calls that work release it.
class RunningSimulation {
 public:
  /// Makes one at `self`, which is memory without an object.
  static void load(RunningSimulation* self, nanobind::handle scene, const SimulationDesc& desc);
  static void from_string(RunningSimulation* self, const std::string& xml, const SimulationDesc& desc,
                          nanobind::handle folder, const std::string& name);
  /// `simulation` is one of several that somebody else steps too, with settings `desc`.
  RunningSimulation(std::shared_ptr<Simulation> simulation, const SimulationDesc& desc);
  ~RunningSimulation();
  RunningSimulation(const RunningSimulation&) = delete;
  RunningSimulation& operator=(const RunningSimulation&) = delete;

  void close();
  bool is_closed() const { return simulation_ == nullptr; }

  /// The simulation, for a call that is over at once.
  Simulation& idle();
  const Simulation& idle() const { return const_cast<RunningSimulation*>(this)->idle(); }

  /// Calls `function(simulation)` without the interpreter's lock, and then raises what Python code raised in it.
  template <typename Function>
  auto work(const Function& function);

  /// `dt_s`: seconds after the last frame; None: as long as the rate says.
  void step(nanobind::handle dt_s);
  void step_async();
  /// Also while a frame is under way.
  std::vector<std::string> sensor_names() const;
  void finish();
  void skip_frame();
  std::string save_state();
  void restore_state(std::string_view state);
  double time_s() const;

  KeptScan scan(const std::string& sensor);
  KeptMeasurement measurement(const std::string& sensor);
  KeptImage image(const std::string& sensor, const std::string& name);
  std::vector<std::string> images(const std::string& sensor) const;

  /// Opens the live page, which then shows each frame, and returns its address; one that is open is closed first.
  std::string open_window(std::uint16_t port);
  void close_window();
  /// Carries out what the page asks for, for so long, and shows the last frame.
  void update_window(double seconds);

  /// The frames from the next one on become a page, until finish_page(). One that is begun is thrown away.
  void record_page(nanobind::handle file);
  void finish_page();

  std::string explain() const;
  std::string tree() const;
  nanobind::list price(const std::vector<std::string>& sensors, std::uint64_t frames);

 private:
  [[noreturn]] void fail_unmeasured(const std::string& sensor) const;
  void show_in_window();
  /// Shows the frame that is finished, and adds it to the page.
  void show_frame();
  /// Marks the simulation as in use while the interpreter's lock is free.
  class Working {
   public:
    explicit Working(RunningSimulation& running) : running_(running) { running_.working_ = true; }
    ~Working() { running_.working_ = false; }
    Working(const Working&) = delete;
    Working& operator=(const Working&) = delete;

   private:
    RunningSimulation& running_;
  };

  std::shared_ptr<Simulation> simulation_;
  SimulationDesc desc_;
  bool under_way_ = false;                    // a frame that step_async() began is not finished
  std::vector<std::string> names_under_way_;  // of the sensors, while a frame is
  std::unique_ptr<LiveWindow> window_;        // ends before the simulation
  std::unique_ptr<live::PageRecording> page_;
  bool working_ = false;
  pid_t process_;
};

/// Refuses to work in a forked process, in which the library's threads and the driver are missing.
void check_process();

template <typename Function>
auto RunningSimulation::work(const Function& function) {
  Simulation& simulation = idle();
  const Working working(*this);
  forget_kept();
  const auto call = [&] {
    const FreeWork free;
    return function(simulation);
  };
  if constexpr (std::is_void_v<decltype(call())>) {
    call();
    rethrow_kept();
  } else {
    auto result = call();
    rethrow_kept();
    return result;
  }
}

void bind_simulation(nanobind::module_& module);

}  // namespace simvis::python
