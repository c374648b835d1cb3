// The state of a vector of simulations, and the threads that work on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/vector_output.h>
#include "engine/base/process_use.h"
#include "engine/base/program_api.h"
#include "engine/base/thread_pool.h"
#include "simvis/unbuilt_scene.h"

namespace simvis {

/// Calls `work` once, in the thread that calls it.
using EnvironmentCall = std::function<void(const std::function<void()>& work)>;

/// From now on, all work on one environment is called by `call`, in any thread: of all vectors of the process. The
/// Python module thus gets what Python code has raised in a thread that it does not know. Call it before there are
/// vectors.
SIMVIS_PROGRAM_API void call_environments_by(EnvironmentCall call);

struct VectorSimulationImpl {
  using Environments = std::span<const std::size_t>;
  /// By environment; null: it has not failed.
  using Failures = std::vector<std::exception_ptr>;

  /// Throws InputError for a number of environments that is not allowed, and as Simulation::load().
  VectorSimulationImpl(UnbuiltScene scene, std::size_t count, const SimulationDesc& desc);

  std::unique_ptr<Simulation> load(std::uint64_t seed) const;
  Simulation& at(std::size_t index) const;
  /// Throws InputError for one that is not there or comes twice.
  void check(Environments environments) const;
  /// Calls `work(i)` for each of these environments, on all threads, and returns which calls have failed. Calls
  /// `after`, if given, after each that has not, in its thread; an exception that it throws ends the work, and is
  /// thrown.
  Failures for_each(Environments environments, const std::function<void(std::size_t)>& work,
                    const std::function<void()>& after = {}) const;
  /// Throws the first failure, and says which environments have failed. Those whose number in `preferred` is not 0 come
  /// before the others; empty: all are alike.
  static void throw_any(const Failures& failures, const std::vector<std::uint8_t>& preferred = {});
  /// Calls `work`, which is about one environment; the message of its error says which.
  static void call_named(std::size_t environment, const std::function<void()>& work);

  /// Calls `make_frame` for these environments, and collects the outputs of all. An environment that does not give an
  /// output in its shape makes no frame, or has made it if the scene was changed within the frame. Its row there shows
  /// nothing. Throws a failure of a frame that was not made; if there is none, one of an environment that was stepped;
  /// and else one of the others.
  void step(Environments stepped, const std::function<void(Simulation&)>& make_frame);
  const VectorOutput& output(std::string_view sensor, std::string_view output);
  /// Throws InputError if an environment, whose scene may have been changed, does not give the output in its shape.
  void check_output(std::size_t environment, const VectorOutput& output) const;
  /// What check_output() throws; null: nothing.
  std::exception_ptr misfit_of(std::size_t environment, const VectorOutput& output) const;
  /// Writes the rows of one environment, and returns the first misfit.
  std::exception_ptr collect_outputs(std::size_t environment);
  /// Writes the row of one environment, which fits.
  void collect(std::size_t environment, VectorOutput& output) const;

  ProcessUse process;
  SimulationDesc desc;  // of environment 0; the threads are those of each environment
  UnbuiltScene scene;
  std::shared_ptr<ThreadPool> pool;
  std::vector<std::size_t> all;  // the indices of all environments
  std::vector<std::shared_ptr<Simulation>> environments;
  std::list<VectorOutput> outputs;  // in a list, because callers hold references
  std::vector<std::size_t> failed;  // whose frame of the last step is not made
  std::vector<std::string> states;  // that are kept; empty: none
};

}  // namespace simvis
