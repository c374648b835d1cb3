#include <simvis/vector_simulation.h>

#include <algorithm>
#include <utility>

#include "engine/base/stack_limit.h"
#include "simvis/vector_simulation_impl.h"

namespace simvis {
namespace {

// A forked process has none of the threads that would have to end, so it leaves the environments as they are.
void end_vector(std::unique_ptr<VectorSimulationImpl> impl) {
  if (impl != nullptr && impl->process.forked()) static_cast<void>(impl.release());
}

}  // namespace

VectorSimulation::VectorSimulation(std::unique_ptr<VectorSimulationImpl> impl) : impl_(std::move(impl)) {}
VectorSimulation::VectorSimulation(VectorSimulation&&) noexcept = default;
VectorSimulation& VectorSimulation::operator=(VectorSimulation&& other) noexcept {
  end_vector(std::exchange(impl_, std::move(other.impl_)));
  return *this;
}

VectorSimulation::~VectorSimulation() { end_vector(std::move(impl_)); }

VectorSimulation VectorSimulation::load(const std::filesystem::path& scene, std::size_t environments,
                                        const SimulationDesc& desc) {
  const ProcessUse process;
  require_stack();
  return VectorSimulation(std::make_unique<VectorSimulationImpl>(UnbuiltScene::of_file(scene), environments, desc));
}

VectorSimulation VectorSimulation::from_string(std::string_view xml, std::size_t environments,
                                               const SimulationDesc& desc, const std::filesystem::path& folder,
                                               const std::string& name) {
  const ProcessUse process;
  require_stack();
  return VectorSimulation(
      std::make_unique<VectorSimulationImpl>(UnbuiltScene::of_text(xml, folder, name), environments, desc));
}

VectorSimulationImpl& VectorSimulation::impl() const {
  if (impl_ == nullptr) {
    throw InputError("this vector of simulations was moved from, expected one that was loaded or assigned to");
  }
  impl_->process.require_not_forked();
  return *impl_;
}

std::size_t VectorSimulation::size() const { return impl().environments.size(); }

std::shared_ptr<Simulation> VectorSimulation::environment(std::size_t index) const {
  impl().at(index);
  return impl().environments[index];
}

void VectorSimulation::set(std::string_view element, std::string_view parameter, std::span<const double> values) {
  if (values.size() != 1 && values.size() != size()) {
    throw InputError(std::string(element) + "." + std::string(parameter) + " has " + std::to_string(values.size()) +
                     " values, expected 1 or " + std::to_string(size()));
  }
  const auto each = [&](const auto& visit) {
    for (const std::size_t i : impl().all) {
      VectorSimulationImpl::call_named(i, [&] {
        Parameters& parameters = impl().environments[i]->parameters();
        visit(parameters, parameters.index(element, parameter), values[values.size() == 1 ? 0 : i]);
      });
    }
  };
  each([](const Parameters& parameters, std::size_t index, double value) {
    const std::string wrong = check_number(parameters.spec(index), value);
    if (!wrong.empty()) throw InputError(parameters.name(index) + ": " + wrong);
  });
  each([](Parameters& parameters, std::size_t index, double value) { parameters.set(index, value); });
}

std::vector<double> VectorSimulation::get(std::string_view element, std::string_view parameter) const {
  std::vector<double> values(size());
  for (const std::size_t i : impl().all) {
    VectorSimulationImpl::call_named(i, [&] { values[i] = impl().environments[i]->get(element, parameter); });
  }
  return values;
}

const VectorOutput& VectorSimulation::output(std::string_view sensor, std::string_view output) {
  return impl().output(sensor, output);
}

void VectorSimulation::step() {
  impl().step(impl().all, [](Simulation& environment) { environment.step(); });
}

void VectorSimulation::step(std::chrono::nanoseconds dt) {
  impl().step(impl().all, [dt](Simulation& environment) { environment.step(dt); });
}

void VectorSimulation::step(std::span<const std::size_t> environments) {
  impl().step(environments, [](Simulation& environment) { environment.step(); });
}

std::span<const std::size_t> VectorSimulation::failed() const { return impl().failed; }

void VectorSimulation::save_states() {
  std::vector<std::string> states(size());
  VectorSimulationImpl::throw_any(
      impl().for_each(impl().all, [&](std::size_t i) { states[i] = impl().environments[i]->save_state(); }));
  impl().states = std::move(states);
}

void VectorSimulation::restore_states(std::span<const std::size_t> environments) {
  impl().check(environments);
  for (const std::size_t i : environments) {
    if (!impl().states.empty() && !impl().states[i].empty()) continue;
    throw InputError("environment " + std::to_string(i) + " has no state to restore, expected save_states() before");
  }
  VectorSimulationImpl::throw_any(
      impl().for_each(environments, [&](std::size_t i) { impl().environments[i]->restore_state(impl().states[i]); }));
}

void VectorSimulation::reload(std::span<const std::size_t> environments, std::span<const std::uint64_t> seeds) {
  impl().check(environments);
  if (environments.size() != seeds.size()) {
    throw InputError("there are " + std::to_string(seeds.size()) + " seeds for " + std::to_string(environments.size()) +
                     " environments, expected one for each");
  }
  std::vector<std::uint64_t> seed_of(size());
  for (std::size_t k = 0; k < seeds.size(); ++k) seed_of[environments[k]] = seeds[k];
  VectorSimulationImpl::throw_any(impl().for_each(environments, [&](std::size_t i) {
    std::shared_ptr<Simulation> loaded = impl().load(seed_of[i]);
    for (const SensorInfo& sensor : impl().environments[i]->sensors()) {
      const auto is_same = [&](const SensorInfo& each) { return each.name == sensor.name; };
      if (std::ranges::any_of(loaded->sensors(), is_same)) loaded->enable(sensor.name, sensor.enabled);
    }
    impl().environments[i] = std::move(loaded);
    if (!impl().states.empty()) impl().states[i].clear();
  }));
}

}  // namespace simvis
