// Many simulations of one scene that are stepped together: environments of a policy that learns, or draws of a study.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/export.h>
#include <simvis/simulation.h>
#include <simvis/simulation_desc.h>
#include <simvis/vector_output.h>

namespace simvis {

struct VectorSimulationImpl;

/// Copies of one scene, called environments, which are stepped together. Environment i is a Simulation whose seed is
/// SimulationDesc::seed + i, modulo 2^64: it measures the same bytes as one that was loaded alone with that seed, and
/// got the same calls, whatever the numbers of environments and of threads are.
///
/// Sharing   the environments share what none of them changes, as all simulations of a process do: meshes, textures,
///           pictures of the sky, trees for rays, pipelines and the device. Each has its own scene graph, parameters,
///           bodies and sensors.
/// Work      SimulationDesc::threads threads take one environment after the other, and each works alone on its
///           environment. With fewer environments than threads, they share the work within one too.
/// Errors    as Simulation. An error of an environment ends with "(environment 7)"; those of environment 0 in load()
///           are errors of the scene, and do not. If environments fail in a step, all others make their frame first,
///           and failed() lists those that did not: their frame counts as not made, each of their sensors holds a
///           complete measurement, its last one or that of this frame, and they can be stepped again alone, restored or
///           reloaded. After an OutletError of an environment its frame counts as made; a step throws one only if all
///           frames are made. Other functions change nothing if they throw, except where they say otherwise.
/// Lifetime  returned references are valid as long as the vector, also after it is moved. A vector that was moved from
///           may only be assigned to or destroyed; other calls throw InputError.
/// Threads   one thread at a time, which may be any thread.
class SIMVIS_API VectorSimulation {
 public:
  /// Loads a scene file `environments` times, on all threads. `desc.progress` gets the number of environments that are
  /// there, the last time all of them, and is called by this thread alone. Throws InputError as Simulation::load(), and
  /// for 0 or more than 65536 environments.
  static VectorSimulation load(const std::filesystem::path& scene, std::size_t environments,
                               const SimulationDesc& desc = {});
  /// As load(), from text, with the further parameters of Simulation::from_string().
  static VectorSimulation from_string(std::string_view xml, std::size_t environments, const SimulationDesc& desc = {},
                                      const std::filesystem::path& folder = ".", const std::string& name = "<string>");

  VectorSimulation(VectorSimulation&&) noexcept;             ///< takes over the other's environments
  VectorSimulation& operator=(VectorSimulation&&) noexcept;  ///< takes over the other's environments; these end
  ~VectorSimulation();                                       ///< ends the environments that no one else holds

  /// The number of environments, at least 1.
  std::size_t size() const;

  /// One environment. All its functions may be called between the functions of the vector, step() too. If it is
  /// reloaded, another one takes its place in the vector. Throws InputError if there is no such environment.
  std::shared_ptr<Simulation> environment(std::size_t index) const;

  /// Sets a parameter in each environment, as Simulation::set(): to values[i] in environment i, or, if there is one
  /// value, to this one in all. Throws InputError, and sets none, for another number of values and for a value that is
  /// refused.
  void set(std::string_view element, std::string_view parameter, std::span<const double> values);
  /// The values of a parameter, by environment. Throws as Simulation::get().
  std::vector<double> get(std::string_view element, std::string_view parameter) const;

  /// An output of a sensor: any array of a Measurement whose shape never varies, or "rgb", the 8-bit sRGB codes of the
  /// sensor's first colour image; colours have three channels here. The first call collects what the environments have
  /// measured last, and from then on each step does so. Throws InputError: no such sensor or output, the number of
  /// its rows varies, or an environment whose scene was changed gives another shape. A step throws the last one too:
  /// the row of this environment is then NaN or 0. Its frame is not made, unless a request of a client changed the
  /// scene at the start of this frame.
  const VectorOutput& output(std::string_view sensor, std::string_view output);

  /// Makes one frame of each environment, as Simulation::step().
  void step();
  /// As Simulation::step(dt).
  void step(std::chrono::nanoseconds dt);
  /// Makes one frame of these environments alone. Throws InputError also if one is not there or comes twice.
  void step(std::span<const std::size_t> environments);
  /// The environments whose frame was to be made in the last step and was not, ascending.
  std::span<const std::size_t> failed() const;

  /// Keeps the state of each environment, see Simulation::save_state(), in place of the one that was kept before.
  void save_states();
  /// Takes these environments back to their kept states, as Simulation::restore_state(). Outputs change at the next
  /// step. Throws InputError, and restores none, if there is no such environment or if one has no kept state: it is
  /// new, or was reloaded. Throws as Simulation::restore_state(), such as for an environment whose scene was changed:
  /// this one stays as it is, and all others are restored.
  void restore_states(std::span<const std::size_t> environments);

  /// Loads these environments again, each with its own seed, on all threads. The same sensors are on as before.
  /// Throws InputError for another number of seeds, for an environment that is not there or comes twice, and as
  /// load(), if the files have changed: such an environment stays as it is.
  void reload(std::span<const std::size_t> environments, std::span<const std::uint64_t> seeds);

 private:
  explicit VectorSimulation(std::unique_ptr<VectorSimulationImpl> impl);
  VectorSimulationImpl& impl() const;
  std::unique_ptr<VectorSimulationImpl> impl_;
};

}  // namespace simvis
