#include "program/report/cost_run.h"

#include <cstdlib>
#include <ctime>
#include <limits>
#include <utility>

#include <simvis/trajectory.h>
#include "program/report/report_table.h"

namespace simvis {

namespace {

double load_of_last_minute() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::string cost_title(const std::string& sensor, std::uint64_t frames, double load) {
  const std::string number = report_number({NumberFormat::Style::fixed, 2}, load);
  return sensor + ", " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") + " of each, load " + number +
         " at the start\n";
}

CostRun::CostRun(Simulation simulation, const CostDesc& desc, std::optional<std::chrono::nanoseconds> apart)
    : simulation_(std::move(simulation)),
      desc_(desc),
      apart_(apart),
      clock_(desc.rate_hz),
      load_(load_of_last_minute()) {
  for (const SensorInfo& sensor : simulation_.sensors()) simulation_.enable(sensor.name, false);
}

std::string CostRun::variant_name(const std::string& sensor, std::size_t number) {
  return sensor + "." + std::to_string(number);
}

void CostRun::add(const std::string& sensor, const Command& command, const std::string& name, std::uint64_t frames) {
  simulation_.add_variant(sensor, command);
  simulation_.enable(name, false);
  all_frames_ += frames;
}

FrameTimes CostRun::time(const std::string& variant, const std::string& what, std::uint64_t frame) {
  simulation_.enable(variant, true);
  step(frame - 1);
  return time_alone(variant, what, frame);
}

FrameTimes CostRun::time_alone(const std::string& variant, const std::string& what, std::uint64_t frame) {
  simulation_.enable(variant, true);
  const FrameTimes times = step(frame);
  if (simulation_.measured().empty()) throw InputError(what + " cannot be priced: its part is switched off");
  simulation_.enable(variant, false);
  return times;
}

FrameTimes CostRun::step(std::uint64_t frame) {
  using SteadyClock = std::chrono::steady_clock;
  if (desc_.trajectory != nullptr) {
    desc_.trajectory->apply(static_cast<double>(clock_.frame(frame).time_ns) / 1e9, simulation_.parameters());
  }
  const SteadyClock::time_point start = SteadyClock::now();
  const std::clock_t processor_start = std::clock();
  if (apart_) {
    simulation_.step(*apart_);
  } else {
    simulation_.step();
  }
  const FrameTimes times{std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count(),
                         1e3 * static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC};
  ++frames_done_;
  if (desc_.on_frame) desc_.on_frame(frames_done_, all_frames_);
  return times;
}

}  // namespace simvis
