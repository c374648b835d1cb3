#include "python/core/running_vector.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <unistd.h>

#include <optional>
#include <utility>
#include <variant>

#include "python/core/arguments.h"
#include "python/core/errors.h"
#include "python/core/free_work.h"
#include "python/core/running_simulation.h"
#include "simvis/vector_simulation_impl.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::vector<std::size_t> shape_of(const VectorOutput& output) {
  const OutputShape& shape = output.output.shape;
  if (output.output.kind == OutputKind::scalar) return {output.environments};
  if (shape.channels == 1) return {output.environments, shape.rows, shape.columns};
  return {output.environments, shape.rows, shape.columns, shape.channels};
}

// A view of numbers that it keeps.
nb::object to_array(const VectorOutput& output) {
  const std::vector<std::size_t> shape = shape_of(output);
  return std::visit(
      [&]<typename Number>(const SharedArray<Number>& numbers) {
        auto kept = std::make_unique<SharedNumbers<Number>>(numbers);
        const Number* const data = kept->data();
        const nb::capsule owner(kept.get(),
                                [](void* held) noexcept { delete static_cast<SharedNumbers<Number>*>(held); });
        static_cast<void>(kept.release());
        return nb::cast(nb::ndarray<nb::numpy, const Number>(data, shape.size(), shape.data(), owner),
                        nb::rv_policy::reference);
      },
      output.numbers);
}

std::vector<double> parameter(const RunningVector& running, const std::string& element, const std::string& parameter) {
  return running.idle().get(element, parameter);
}

void bind_frames(BoundClass<RunningVector>& core) {
  core.def(
          "__init__",
          [](RunningVector* self, std::size_t environments, const SimulationDesc& settings, nb::handle scene,
             const std::string& xml, nb::handle folder,
             const std::string& name) { RunningVector::load(self, environments, settings, scene, xml, folder, name); },
          "environments"_a, "settings"_a, "scene"_a = nb::none(), "xml"_a = "", "folder"_a = ".", "name"_a = "<string>",
          nb::sig("def __init__(self, environments: int, settings: Settings, scene: str | None = None, xml: str = '', "
                  "folder: str | os.PathLike[str] = '.', name: str = '<string>') -> None"))
      .def("close", &RunningVector::close,
           "Ends the environments. Arrays stay, and so does each environment that is held. Every other call then "
           "raises.")
      .def_prop_ro("_closed", &RunningVector::is_closed)
      .def(
          "step",
          [](RunningVector& self, nb::handle dt_s) {
            if (dt_s.is_none()) return self.work([](VectorSimulation& vector) { vector.step(); });
            self.work([dt = length_of(dt_s)](VectorSimulation& vector) { vector.step(dt); });
          },
          nb::kw_only(), "dt_s"_a = nb::none(), nb::sig("def step(self, *, dt_s: float | None = None) -> None"),
          "Makes one frame of each environment. With `dt_s` it is taken so many seconds after the one before.")
      .def(
          "_step_some",
          [](RunningVector& self, const std::vector<std::size_t>& which) {
            self.work([&](VectorSimulation& all) { all.step(which); });
          },
          nb::sig("def _step_some(self, environments: list[int]) -> None"))
      .def_prop_ro(
          "failed",
          [](const RunningVector& self) {
            const std::span<const std::size_t> all = self.idle().failed();
            return std::vector<std::size_t>(all.begin(), all.end());
          },
          "The environments whose frame was to be made in the last step and was not.")
      .def(
          "save_states", [](RunningVector& self) { self.work([](VectorSimulation& all) { all.save_states(); }); },
          "Keeps the state of each environment for restore_states(), in place of the one kept before.")
      .def(
          "_restore_states",
          [](RunningVector& self, const std::vector<std::size_t>& which) {
            self.work([&](VectorSimulation& all) { all.restore_states(which); });
          },
          nb::sig("def _restore_states(self, environments: list[int]) -> None"))
      .def(
          "_reload",
          [](RunningVector& self, const std::vector<std::size_t>& which, const std::vector<std::uint64_t>& seeds) {
            self.work([&](VectorSimulation& all) { all.reload(which, seeds); });
          },
          nb::sig("def _reload(self, environments: list[int], seeds: list[int]) -> None"));
}

void bind_values(BoundClass<RunningVector>& core) {
  core.def("__len__", [](const RunningVector& self) { return self.idle().size(); })
      .def("_output", &RunningVector::output,
           nb::sig("def _output(self, sensor: str, output: str) -> numpy.typing.NDArray[typing.Any]"))
      .def("_get", &parameter)
      .def("_set",
           [](RunningVector& self, const std::string& element, const std::string& parameter, const Numbers& values) {
             self.idle().set(element, parameter, {values.data(), values.size()});
           });
}

}  // namespace

// simvis.VectorSimulation inherits from the class. What begins with _ is for the package alone.
void bind_vector(nb::module_& module) {
  call_environments_by(call_and_raise_kept);
  BoundClass<RunningVector> core(module, "VectorCore", "Environments, below simvis.VectorSimulation.");
  bind_frames(core);
  bind_values(core);
}

RunningVector::RunningVector(VectorSimulation vector, const SimulationDesc& desc)
    : vector_(std::make_unique<VectorSimulation>(std::move(vector))), desc_(desc), process_(::getpid()) {}

void RunningVector::load(RunningVector* self, std::size_t environments, const SimulationDesc& desc, nb::handle scene,
                         const std::string& xml, nb::handle folder, const std::string& name) {
  check_process();
  const std::string path = scene.is_none() ? path_of("folder", folder) : path_of("scene", scene);
  forget_kept();
  VectorSimulation loaded = [&] {
    const FreeWork free;
    return scene.is_none() ? VectorSimulation::from_string(xml, environments, desc, path, name)
                           : VectorSimulation::load(path, environments, desc);
  }();
  rethrow_kept();
  new (self) RunningVector(std::move(loaded), desc);
}

RunningVector::~RunningVector() {
  if (process_ != ::getpid()) {  // a forked process can neither end the threads of another nor remove its files
    static_cast<void>(vector_.release());
    return;
  }
  std::optional<FreeWork> free;  // none in a thread that may lose the lock for good
  if (InsideModule::may_enter()) free.emplace();
  vector_.reset();
}

void RunningVector::close() {
  if (is_closed()) return;
  idle();
  std::unique_ptr<VectorSimulation> ended = std::move(vector_);
  const FreeWork free;
  ended.reset();
}

VectorSimulation& RunningVector::idle() const {
  if (process_ != ::getpid()) check_process();
  if (working_) throw InputError("these environments are in use by another thread, expected one call at a time");
  if (vector_ == nullptr) throw InputError("these environments are closed, expected ones that are open");
  return *vector_;
}

void RunningVector::work(const std::function<void(VectorSimulation&)>& function) {
  VectorSimulation& vector = idle();
  struct Working {
    explicit Working(bool& flag) : flag(flag) { flag = true; }
    ~Working() { flag = false; }
    bool& flag;
  };
  const Working working(working_);
  const FreeWork free;
  function(vector);
}

nb::object RunningVector::output(const std::string& sensor, const std::string& output) {
  const VectorOutput* found = nullptr;
  work([&](VectorSimulation& vector) { found = &vector.output(sensor, output); });
  return to_array(*found);
}

}  // namespace simvis::python
