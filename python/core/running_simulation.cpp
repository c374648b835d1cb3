#include "python/core/running_simulation.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "program/report/cost_report.h"
#include "program/report/explain.h"
#include "program/report/scan_variant.h"
#include "program/report/scanner_costs.h"
#include "program/report/scene_list.h"
#include "python/core/arguments.h"
#include "simvis/built_scene.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

pid_t first_process = 0;  // that loaded a simulation

// Between two looks for signals while a page is served.
constexpr std::chrono::milliseconds kWindowPeriod{50};

nb::object to_object(const ReportValue& value) {
  const auto* const number = std::get_if<double>(&value);
  if (number != nullptr && std::isnan(*number)) return nb::none();
  return std::visit([](const auto& each) { return nb::cast(each); }, value);
}

nb::dict to_dict(const CostRow& row) {
  nb::dict dict;
  dict["sensor"] = row.costs.scanner;
  dict["attributes"] = attributes_of(row.variant.variant);
  for (const ReportColumn<CostRow>& column : cost_columns()) dict[column.name] = to_object(column.get(row));
  return dict;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

// All values of one simulation in another of the same scene.
void copy_values(const Parameters& from, Parameters& to) {
  for (const ElementDescriptor& element : from.elements()) {
    if (element.removed) continue;
    for (std::size_t i = 0; i < element.parameters.size(); ++i) {
      to.set(to.index(element.name, element.parameters[i].name), from.values()[element.first_value + i]);
    }
  }
}

}  // namespace

void check_process() {
  if (first_process == 0) first_process = ::getpid();
  if (first_process == ::getpid()) return;
  throw InputError(
      "this process was forked from process " + std::to_string(first_process) +
      ", which uses SimVis, and has neither its threads nor its Vulkan driver; expected processes that are "
      "started by multiprocessing.get_context(\"spawn\"), or simvis.map()");
}

RunningSimulation::RunningSimulation(std::shared_ptr<Simulation> simulation, const SimulationDesc& desc)
    : simulation_(std::move(simulation)), desc_(desc), process_(::getpid()) {}

void RunningSimulation::load(RunningSimulation* self, nb::handle scene, const SimulationDesc& desc) {
  check_process();
  const std::string file = path_of("scene", scene);
  forget_kept();
  auto loaded = [&] {
    const FreeWork free;
    return std::make_shared<Simulation>(Simulation::load(file, desc));
  }();
  rethrow_kept();
  new (self) RunningSimulation(std::move(loaded), desc);
}

void RunningSimulation::from_string(RunningSimulation* self, const std::string& xml, const SimulationDesc& desc,
                                    nb::handle folder, const std::string& name) {
  check_process();
  const std::string start = path_of("folder", folder);
  forget_kept();
  auto loaded = [&] {
    const FreeWork free;
    return std::make_shared<Simulation>(Simulation::from_string(xml, desc, start, name));
  }();
  rethrow_kept();
  new (self) RunningSimulation(std::move(loaded), desc);
}

RunningSimulation::~RunningSimulation() {
  if (process_ != ::getpid()) {  // a forked process can neither end the threads of another nor remove its files
    static_cast<void>(page_.release());
    static_cast<void>(window_.release());
    new std::shared_ptr(std::move(simulation_));
    return;
  }
  std::optional<FreeWork> free;  // none in a thread that may lose the lock for good
  if (InsideModule::may_enter()) free.emplace();
  window_.reset();
  simulation_.reset();
}

void RunningSimulation::close() {
  if (is_closed()) return;
  idle();
  const Working working(*this);
  const FreeWork free;
  window_.reset();
  simulation_.reset();
}

Simulation& RunningSimulation::idle() {
  if (process_ != ::getpid()) check_process();
  if (working_) {
    throw InputError(
        "this simulation is in use by another thread, or by the step that called this code; expected one call at a "
        "time");
  }
  if (!simulation_) throw InputError("this simulation is closed, expected one that is open");
  return *simulation_;
}

void RunningSimulation::step(nb::handle dt_s) {
  idle();
  if (under_way_) finish();
  if (window_) work([&](Simulation&) { window_->carry_out(); });
  if (dt_s.is_none()) {
    work([](Simulation& simulation) { simulation.step(); });
  } else {
    work([dt = length_of(dt_s)](Simulation& simulation) { simulation.step(dt); });
  }
  show_frame();
}

void RunningSimulation::step_async() {
  finish();
  if (window_) work([&](Simulation&) { window_->carry_out(); });
  names_under_way_ = sensor_names();
  work([](Simulation& simulation) { simulation.step_async(); });
  under_way_ = true;
}

std::vector<std::string> RunningSimulation::sensor_names() const {
  const Simulation& simulation = idle();
  if (under_way_) return names_under_way_;
  std::vector<std::string> names;
  for (const BuiltSensor& sensor : built_scene(simulation).sensors) names.push_back(sensor.name);
  return names;
}

void RunningSimulation::finish() {
  const bool was_under_way = std::exchange(under_way_, false);
  work([](Simulation& simulation) { simulation.finish(); });
  if (was_under_way) show_frame();
}

void RunningSimulation::skip_frame() {
  work([](Simulation& simulation) { simulation.skip_frame(); });
}

std::string RunningSimulation::save_state() {
  finish();
  return work([](Simulation& simulation) { return simulation.save_state(); });
}

void RunningSimulation::restore_state(std::string_view state) {
  finish();
  work([&](Simulation& simulation) { simulation.restore_state(state); });
}

double RunningSimulation::time_s() const {
  const std::optional<FrameTime> last = idle().last_frame();
  return last ? static_cast<double>(last->time_ns) / 1e9 : std::numeric_limits<double>::quiet_NaN();
}

void RunningSimulation::fail_unmeasured(const std::string& sensor) const {
  if (!under_way_) {
    const std::vector<SensorInfo> sensors = idle().sensors();
    const auto found = std::ranges::find(sensors, sensor, &SensorInfo::name);
    if (found != sensors.end() && !found->enabled) {
      throw InputError("sensor " + in_quotes(sensor) +
                       " is switched off, as only() does with all others; expected enabled = True and then step()");
    }
  }
  throw InputError("sensor " + in_quotes(sensor) + " has not measured yet, expected step() before");
}

KeptScan RunningSimulation::scan(const std::string& sensor) {
  Simulation& simulation = idle();
  const Scan& scan = simulation.scan(sensor);
  if (scan.range_m.empty()) fail_unmeasured(sensor);
  return {scan, sensor};
}

KeptMeasurement RunningSimulation::measurement(const std::string& sensor) {
  KeptMeasurement measurement{idle().measurement(sensor), sensor};
  const bool is_empty = std::ranges::any_of(measurement.arrays, [](const MeasuredArray& each) {
    return each.kind != OutputKind::table_column && each.count() == 0;
  });
  if (is_empty) fail_unmeasured(sensor);
  return measurement;
}

// The name of a content stands for the first image that has it: "color" of a stereo camera is "left".
KeptImage RunningSimulation::image(const std::string& sensor, const std::string& name) {
  const Measurement measurement = idle().measurement(sensor);
  const MeasuredArray* found = measurement.find(name);
  for (const auto& [content, of] : {std::pair("color", ImageContent::color), {"depth", ImageContent::depth}}) {
    if (found != nullptr || name != content) continue;
    const auto first = std::ranges::find(measurement.arrays, of, &MeasuredArray::content);
    if (first != measurement.arrays.end()) found = &*first;
  }
  if (found == nullptr || found->kind != OutputKind::image) {
    std::string known;
    for (const std::string& each : images(sensor)) known += (known.empty() ? "" : ", ") + each;
    throw InputError("sensor " + in_quotes(sensor) + " has no image " + in_quotes(name) +
                     (known.empty() ? "" : ", expected one of " + known));
  }
  if (found->count() == 0) fail_unmeasured(sensor);
  return {*found, sensor};
}

std::vector<std::string> RunningSimulation::images(const std::string& sensor) const {
  std::vector<std::string> names;
  for (const MeasuredArray& each : idle().measurement(sensor).arrays) {
    if (each.kind == OutputKind::image) names.push_back(each.name);
  }
  return names;
}

std::string RunningSimulation::open_window(std::uint16_t port) {
  idle();
  if (under_way_) finish();
  work([&](Simulation& simulation) {
    window_.reset();
    window_ = std::make_unique<LiveWindow>(simulation, port);
  });
  return window_->url();
}

void RunningSimulation::close_window() {
  if (is_closed()) return;
  work([&](Simulation&) { window_.reset(); });
}

void RunningSimulation::update_window(double seconds) {
  idle();
  if (!window_) throw InputError("this viewer is closed, expected one that is open");
  if (under_way_) finish();
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  do {
    work([&](Simulation&) { window_->carry_out_next(kWindowPeriod); });
    show_in_window();
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  } while (std::chrono::steady_clock::now() < until);
}

void RunningSimulation::record_page(nb::handle file) {
  idle();
  if (under_way_) finish();
  page_ = std::make_unique<live::PageRecording>(path_of("file", file));
}

void RunningSimulation::finish_page() {
  idle();
  if (under_way_) finish();
  const std::unique_ptr<live::PageRecording> page = std::move(page_);
  if (!page) throw InputError("there is no page, expected record_page() before");
  if (!page->has_frames()) throw InputError("the page has no frames, expected a step() after record_page()");
  work([&](Simulation&) { page->finish(); });
}

void RunningSimulation::show_frame() {
  show_in_window();
  const std::optional<FrameTime> frame = idle().last_frame();
  if (!page_ || !frame) return;
  std::unique_ptr<live::PageRecording> page = std::move(page_);  // none after an error
  work([&](Simulation& simulation) { page->add(simulation, *frame); });
  page_ = std::move(page);
}

void RunningSimulation::show_in_window() {
  const std::optional<FrameTime> frame = idle().last_frame();
  if (!window_ || !frame) return;
  work([&](Simulation&) { window_->show(*frame); });
}

std::string RunningSimulation::explain() const {
  const Simulation& simulation = idle();
  const Diagnostics diagnostics = simulation.diagnostics();
  std::string text = simvis::explain(diagnostics.frame_plan(), {diagnostics.counters(), diagnostics.planned_sensors(),
                                                                diagnostics.frame_costs(), diagnostics.sensor_costs()});
  for (const SensorInfo& sensor : simulation.sensors()) text += sensor.report.explanation;
  return text;
}

std::string RunningSimulation::tree() const {
  static_cast<void>(idle().items());  // whose shapes are then read: the tree has them
  return to_text(list_scene(built_scene(idle())));
}

// The measurement consumes a simulation and adds its own sensors, so it works on another one of the same scene.
nb::list RunningSimulation::price(const std::vector<std::string>& sensors, std::uint64_t frames) {
  if (frames == 0) throw InputError("frames is 0, expected at least 1");
  const Simulation& own = idle();
  own.diagnostics().counters();  // refuses while a frame is under way
  const SimulationDesc& desc = desc_;
  const std::vector<ScannerCosts> all_costs = work([&](Simulation& simulation) {
    Simulation copy = Simulation::from_string(joined(simulation.parameters().changes()), desc);
    copy_values(simulation.parameters(), copy.parameters());
    for (const std::string& name : sensors) copy.scan(name);  // throws
    for (const SensorInfo& each : copy.sensors()) {
      copy.enable(each.name, std::ranges::find(sensors, each.name) != sensors.end());
    }
    CostDesc costs{.frames = frames, .rate_hz = desc.rate_hz};
    costs.on_frame = [](std::uint64_t, std::uint64_t) {
      const nb::gil_scoped_acquire locked;
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    };
    return scanner_costs(std::move(copy), costs);
  });
  nb::list rows;
  for (const CostRow& row : cost_rows(all_costs)) rows.append(to_dict(row));
  return rows;
}

}  // namespace simvis::python
