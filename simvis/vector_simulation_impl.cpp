#include "simvis/vector_simulation_impl.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <thread>
#include <type_traits>
#include <utility>
#include <variant>

#include <simvis/location.h>
#include "engine/base/assert.h"
#include "engine/base/srgb.h"
#include "simvis/simulation_use.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxEnvironments = 65536;
constexpr std::string_view kRgb = "rgb";  // the output that no sensor gives itself
constexpr std::uint32_t kColors = 3;      // channels of colour without alpha, which is always 1

EnvironmentCall& environment_call() {
  static EnvironmentCall call = [](const std::function<void()>& work) { work(); };
  return call;
}

std::string names_of(std::span<const std::size_t> environments) {
  std::string names;
  for (const std::size_t each : environments) names += (names.empty() ? "" : ", ") + std::to_string(each);
  return names;
}

template <typename Number>
constexpr Number kNothing = std::is_floating_point_v<Number> ? std::numeric_limits<Number>::quiet_NaN() : Number{0};

/// The array of a measurement that an output shows; null: there is none.
const MeasuredArray* array_of(const Measurement& measurement, std::string_view output) {
  if (output != kRgb) return measurement.find(output);
  const auto color = std::ranges::find(measurement.arrays, ImageContent::color, &MeasuredArray::content);
  return color == measurement.arrays.end() ? nullptr : &*color;
}

[[noreturn]] void refuse_output(const std::string& sensor, const std::string& output, const Measurement& measurement) {
  std::vector<std::string_view> known;
  std::string list;
  for (const MeasuredArray& each : measurement.arrays) {
    known.push_back(each.name);
    list += (list.empty() ? "" : ", ") + each.name;
  }
  if (array_of(measurement, kRgb) != nullptr) list += ", " + std::string(kRgb);
  throw InputError("sensor " + in_quotes(sensor) + " has no output " + in_quotes(output) + suggestion(output, known) +
                   (list.empty() ? "" : " (expected one of: " + list + ")"));
}

std::size_t numbers_of(const OutputShape& shape) { return size_product({shape.rows, shape.columns, shape.channels}); }

/// An array and the shape in which arrays of all environments show it.
struct ShownArray {
  const MeasuredArray& array;
  OutputShape shape;
};

/// Throws InputError if there is no such output, or none whose shape never varies.
ShownArray find_shown(SimulationImpl& simulation, const std::string& sensor, const std::string& output) {
  const std::size_t index = simulation.sensors.index(sensor);
  const Measurement& measurement = simulation.sensors.measurement(index);
  const MeasuredArray* const array = array_of(measurement, output);
  if (array == nullptr) refuse_output(sensor, output, measurement);
  const OutputSpec* const promised = find_output(simulation.scene.built.sensors[index].outputs, array->name);
  OutputShape shape = promised == nullptr ? array->shape : promised->shape;
  if (array->kind == OutputKind::table_column || numbers_of(shape) == 0) {
    throw InputError("output " + in_quotes(output) + " of sensor " + in_quotes(sensor) + " has the shape " +
                     to_string(shape) + ", expected an output whose shape never varies");
  }
  if (array->content == ImageContent::color) shape.channels = kColors;
  return {*array, shape};
}

/// Without numbers.
VectorOutput describe_output(SimulationImpl& simulation, std::size_t environments, const std::string& sensor,
                             const std::string& output) {
  const ShownArray shown = find_shown(simulation, sensor, output);
  VectorOutput described{.sensor = sensor, .output = shown.array, .environments = environments};
  described.output.shape = shown.shape;
  if (output != kRgb) {
    described.numbers =
        std::visit([]<typename Number>(const SharedArray<Number>&) -> MeasuredNumbers { return SharedArray<Number>(); },
                   shown.array.numbers);
    return described;
  }
  described.output.name = kRgb;
  described.output.value_type = ValueType::u8;
  described.output.content = ImageContent::numbers;
  described.output.meaning = "sRGB codes";
  described.output.unit.clear();
  described.numbers = SharedArray<std::uint8_t>();
  return described;
}

/// Throws a failure again; the message of one of SimVis ends with `which`.
[[noreturn]] void throw_named(const std::exception_ptr& failure, const std::string& which) {
  try {
    std::rethrow_exception(failure);
  } catch (const InputError& error) {
    throw InputError(error.what() + which);
  } catch (const OutletError& error) {
    throw OutletError(error.what() + which);
  } catch (const MachineError& error) {
    throw MachineError(error.what() + which);
  }
}

/// Whether the frame was made, and a consumer of it has failed.
bool is_of_consumer(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const OutletError&) {
    return true;
  } catch (...) {
    return false;
  }
}

/// Gives the output memory that no copy holds.
void begin_rows(VectorOutput& output) {
  const std::size_t count = size_product({output.environments, numbers_of(output.output.shape)});
  std::visit([&](auto& numbers) { numbers.overwrite().resize(count); }, output.numbers);
}

/// The row of one environment, after begin_rows().
template <typename Number>
std::span<Number> row_of(SharedArray<Number>& numbers, const OutputShape& shape, std::size_t environment) {
  const std::size_t count = numbers_of(shape);
  return {numbers.edit().data() + environment * count, count};
}

/// Whether an array of the shape `given` has the numbers of `shown`, which may have fewer channels.
bool has_numbers_of(const OutputShape& given, const OutputShape& shown) {
  return given.rows == shown.rows && given.columns == shown.columns && given.channels >= shown.channels;
}

/// Writes the row of an environment that does not give the output in its shape.
void write_nothing(VectorOutput& output, std::size_t environment) {
  std::visit(
      [&]<typename Number>(SharedArray<Number>& numbers) {
        std::ranges::fill(row_of(numbers, output.output.shape, environment), kNothing<Number>);
      },
      output.numbers);
}

template <typename Number>
void write_row(const MeasuredArray& array, std::span<Number> row, std::uint32_t shown_channels) {
  const auto* const numbers = std::get_if<SharedArray<Number>>(&array.numbers);
  if (numbers == nullptr) {
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<Number>(array.number(i));
    return;
  }
  const Number* const from = numbers->data() + array.first;
  if (array.stride == 1 && shown_channels == array.shape.channels) {
    std::copy_n(from, row.size(), row.data());
    return;
  }
  const std::size_t pixel = array.shape.channels * array.stride;
  for (std::size_t i = 0; i < row.size(); ++i) {
    row[i] = from[i / shown_channels * pixel + i % shown_channels * array.stride];
  }
}

}  // namespace

void call_environments_by(EnvironmentCall call) { environment_call() = std::move(call); }

VectorSimulationImpl::VectorSimulationImpl(UnbuiltScene unbuilt, std::size_t count, const SimulationDesc& given)
    : desc(given), scene(std::move(unbuilt)), pool(shared_thread_pool(given.threads)) {
  if (count < 1 || count > kMaxEnvironments) {
    throw InputError(std::to_string(count) + " environments are not possible, expected 1 to " +
                     std::to_string(kMaxEnvironments));
  }
  desc.progress = {};
  if (count >= pool->size()) desc.threads = 1;
  all.resize(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  environments.resize(count);
  environments[0] = load(desc.seed);  // alone: its errors are those of the scene, and the others find its caches
  std::atomic<std::size_t> loaded{1};
  const std::thread::id caller = std::this_thread::get_id();
  const auto report = [&](std::size_t done) {
    if (given.progress) given.progress({"loading environments", done, count});
  };
  const auto count_one = [&] {
    const std::size_t done = ++loaded;
    if (done < count && std::this_thread::get_id() == caller) report(done);
  };
  throw_any(for_each(
      Environments(all).subspan(1), [&](std::size_t i) { environments[i] = load(desc.seed + i); }, count_one));
  report(count);
}

std::unique_ptr<Simulation> VectorSimulationImpl::load(std::uint64_t seed) const {
  SimulationDesc own = desc;
  own.seed = seed;
  return std::make_unique<Simulation>(Simulation(scene.build(own)));
}

Simulation& VectorSimulationImpl::at(std::size_t index) const {
  if (index < environments.size()) return *environments[index];
  throw InputError("there is no environment " + std::to_string(index) + ", expected one below " +
                   std::to_string(environments.size()));
}

void VectorSimulationImpl::check(Environments indices) const {
  std::vector<bool> seen(environments.size());
  for (const std::size_t index : indices) {
    at(index);
    if (seen[index]) throw InputError("environment " + std::to_string(index) + " comes twice, expected it once");
    seen[index] = true;
  }
}

VectorSimulationImpl::Failures VectorSimulationImpl::for_each(Environments indices,
                                                              const std::function<void(std::size_t)>& work,
                                                              const std::function<void()>& after) const {
  Failures failures(environments.size());
  pool->parallel_for(indices.size(), 1, [&](std::size_t, std::size_t first, std::size_t count) {
    for (const std::size_t index : indices.subspan(first, count)) {
      try {
        environment_call()([&] { work(index); });
      } catch (...) {
        failures[index] = std::current_exception();
      }
      if (after && !failures[index]) after();
    }
  });
  return failures;
}

void VectorSimulationImpl::throw_any(const Failures& failures, const std::vector<std::uint8_t>& preferred) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < failures.size(); ++i) {
    if (failures[i]) indices.push_back(i);
  }
  if (indices.empty()) return;
  if (!preferred.empty()) {
    const auto first = std::ranges::find_if(indices, [&](std::size_t i) { return preferred[i] != 0; });
    if (first != indices.end()) std::rotate(indices.begin(), first, first + 1);
  }
  std::string which = " (environment " + std::to_string(indices[0]);
  if (indices.size() > 1) which += "; these have failed too: " + names_of(std::span(indices).subspan(1));
  throw_named(failures[indices[0]], which + ")");
}

void VectorSimulationImpl::call_named(std::size_t environment, const std::function<void()>& work) {
  try {
    work();
  } catch (...) {
    throw_named(std::current_exception(), " (environment " + std::to_string(environment) + ")");
  }
}

void VectorSimulationImpl::step(Environments stepped, const std::function<void(Simulation&)>& make_frame) {
  check(stepped);
  // Bytes, because several threads write them. By environment.
  std::vector<std::uint8_t> steps(environments.size()), misfits(environments.size()), unmade(environments.size());
  for (const std::size_t i : stepped) steps[i] = 1;
  for (VectorOutput& each : outputs) begin_rows(each);
  const Failures failures = for_each(all, [&](std::size_t i) {
    std::exception_ptr failure;
    try {
      for (const VectorOutput& each : outputs) check_output(i, each);
      if (steps[i] != 0) make_frame(*environments[i]);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::exception_ptr misfit = collect_outputs(i);
    if (failure) std::rethrow_exception(failure);
    misfits[i] = misfit ? 1 : 0;
    if (misfit) std::rethrow_exception(misfit);
  });
  failed.clear();
  for (const std::size_t i : all) {
    const bool has_failed = steps[i] != 0 && failures[i] && misfits[i] == 0 && !is_of_consumer(failures[i]);
    unmade[i] = has_failed ? 1 : 0;
    if (has_failed) failed.push_back(i);
  }
  throw_any(failures, failed.empty() ? steps : unmade);
}

const VectorOutput& VectorSimulationImpl::output(std::string_view sensor, std::string_view output) {
  for (const VectorOutput& each : outputs) {
    if (each.sensor == sensor && each.output.name == output) return each;
  }
  VectorOutput made =
      describe_output(*environments[0]->impl(), environments.size(), std::string(sensor), std::string(output));
  begin_rows(made);
  throw_any(for_each(all, [&](std::size_t i) {
    check_output(i, made);
    collect(i, made);
  }));
  outputs.push_back(std::move(made));
  return outputs.back();
}

void VectorSimulationImpl::check_output(std::size_t environment, const VectorOutput& output) const {
  const SimulationUse use = environments[environment]->impl();
  const OutputShape shape = find_shown(*use, output.sensor, output.output.name).shape;
  if (shape == output.output.shape) return;
  throw InputError("output " + in_quotes(output.output.name) + " of sensor " + in_quotes(output.sensor) +
                   " has the shape " + to_string(shape) + ", expected that of the other environments, " +
                   to_string(output.output.shape));
}

std::exception_ptr VectorSimulationImpl::misfit_of(std::size_t environment, const VectorOutput& output) const {
  try {
    check_output(environment, output);
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

// After the frame too, because clients may change the scene at its start.
std::exception_ptr VectorSimulationImpl::collect_outputs(std::size_t environment) {
  std::exception_ptr first;
  for (VectorOutput& each : outputs) {
    const std::exception_ptr found = misfit_of(environment, each);
    if (found) {
      write_nothing(each, environment);
    } else {
      collect(environment, each);
    }
    if (!first) first = found;
  }
  return first;
}

void VectorSimulationImpl::collect(std::size_t environment, VectorOutput& output) const {
  const SimulationUse use = environments[environment]->impl();
  const MeasuredArray& array = *array_of(use->sensors.measurement(output.sensor), output.output.name);
  const OutputShape& shape = output.output.shape;
  SIMVIS_ASSERT(array.count() == 0 || has_numbers_of(array.shape, shape));
  std::visit(
      [&]<typename Number>(SharedArray<Number>& numbers) {
        const std::span<Number> row = row_of(numbers, shape, environment);
        if (array.count() == 0) {
          std::ranges::fill(row, kNothing<Number>);
        } else if constexpr (std::is_same_v<Number, std::uint8_t>) {
          if (output.output.name == kRgb) return srgb_codes(std::get<SharedArray<float>>(array.numbers), row);
          write_row(array, row, shape.channels);
        } else {
          write_row(array, row, shape.channels);
        }
      },
      output.numbers);
}

}  // namespace simvis
