#include "program/cli/result_files.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "program/output/atomic_file.h"

namespace simvis {
namespace {

std::vector<std::string> enabled_sensors(const RunReport& report) {
  std::vector<std::string> names;
  for (const SensorInfo& sensor : report.sensors) {
    if (sensor.enabled) names.push_back(sensor.name);
  }
  return names;
}

}  // namespace

ResultFiles::ResultFiles(const Options& options, const Simulation& simulation, RunReport& report,
                         std::function<void()> update)
    : options_(options),
      simulation_(simulation),
      report_(report),
      update_(std::move(update)),
      folder_(options, report) {
  const std::vector<std::string> names = enabled_sensors(report);
  written_.start({names.begin(), names.end()}, simulation);
}

void ResultFiles::open() {
  if (writer_) return;
  folder_.replace();
  write_report();
  writer_.emplace(output_desc());
}

OutputDesc ResultFiles::output_desc() {
  OutputDesc desc{.folder = options_.out,
                  .sensors = enabled_sensors(report_),
                  .parts = options_.poses,
                  .suffix = report_.shard ? report_.shard->suffix() : "",
                  .threads = options_.simulation.threads,
                  .formats = report_.record.formats,
                  .on_new_file = [this](const RunFiles& files) { add_files(files); }};
  if (folder_.resumes()) desc.resume_at = folder_.first_frame();
  return desc;
}

void ResultFiles::add_files(const RunFiles& files) {
  if (!folder_.resumes()) report_.files.clear();
  for (const auto& [name, own] : files) {
    std::vector<std::string>& all = report_.files[name];
    std::ranges::copy_if(own, std::back_inserter(all),
                         [&](const std::string& file) { return std::ranges::find(all, file) == all.end(); });
  }
  write_report();
}

void ResultFiles::write_report() {
  update_();
  write_file(folder_.report_file(), to_json(report_));
}

// The sensors of a host that is followed do not measure here.
void ResultFiles::frame(const FrameTime& time) {
  open();
  if (options_.follow.empty()) written_.follow(simulation_);
  write_results(options_.poses, simulation_, written_, time, *writer_);
}

void ResultFiles::finish() {
  close_sensors();
  writer_->finish();
}

/// The report names the sensors of the scene file, also those that were removed during the run. Their error bounds are
/// computed while the last pictures are encoded.
void ResultFiles::close_sensors() {
  const std::vector<SensorInfo> now = with_bounds(simulation_);
  for (SensorInfo& sensor : report_.sensors) {
    const auto found = std::ranges::find(now, sensor.name, &SensorInfo::name);
    if (written_.contains(sensor.name) && found != now.end()) sensor = *found;
    if (sensor.enabled) sensor.frames = writer_->frames(sensor.name);
  }
}

void ResultFiles::fail() {
  if (!writer_) return;
  try {
    writer_->finish();
  } catch (const std::exception&) {  // the report says that the run failed, also if the last files are missing
  }
  report_.status = "failed";
  write_report();  // not on a full disk: the report then says "running", as after a kill
}

}  // namespace simvis
