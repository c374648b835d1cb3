// A VectorSimulation as Python uses it: with the interpreter's lock free while it works, and with its rules enforced.
#pragma once

#include <nanobind/nanobind.h>

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <simvis/vector_simulation.h>

namespace simvis::python {

/// Errors, threads  as RunningSimulation.
class RunningVector {
 public:
  /// Makes one at `self`, which is memory without an object: of a file, or, if `scene` is None, of a text.
  static void load(RunningVector* self, std::size_t environments, const SimulationDesc& desc, nanobind::handle scene,
                   const std::string& xml, nanobind::handle folder, const std::string& name);
  ~RunningVector();
  RunningVector(const RunningVector&) = delete;
  RunningVector& operator=(const RunningVector&) = delete;

  void close();
  bool is_closed() const { return vector_ == nullptr; }

  /// The vector, for a call that is over at once.
  VectorSimulation& idle() const;
  /// Calls `function` without the interpreter's lock.
  void work(const std::function<void(VectorSimulation&)>& function);

  /// (environments, ...): a read-only array that keeps its numbers.
  nanobind::object output(const std::string& sensor, const std::string& output);

  const SimulationDesc& desc() const { return desc_; }

 private:
  RunningVector(VectorSimulation vector, const SimulationDesc& desc);

  std::unique_ptr<VectorSimulation> vector_;
  SimulationDesc desc_;
  bool working_ = false;
  pid_t process_;
};

void bind_vector(nanobind::module_& module);

}  // namespace simvis::python
