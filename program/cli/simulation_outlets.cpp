#include "program/cli/simulation_outlets.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

#include "program/cli/load_scene.h"
#include "program/maps/map_files.h"
#include "program/output/atomic_file.h"

namespace simvis {
namespace {

/// Frames that a resumed run makes again come before begin(), and are left out.
template <typename Report>
class SimulationOutlet : public RunOutlet {
 public:
  /// Without `start`, the simulation has the outlet already.
  SimulationOutlet(Simulation& simulation, std::function<void()> start, Report (Simulation::*stop)(),
                   std::optional<Report>& report)
      : simulation_(simulation), start_(std::move(start)), stop_(stop), report_(report), is_started_(!start_) {}

  void begin() override {
    if (!start_) return;
    start_();
    is_started_ = true;
  }
  void frame(const FrameTime& /*time*/) override {}  // the simulation's step has offered it the frame
  void finish() override {
    if (std::exchange(is_started_, false)) report_ = (simulation_.*stop_)();
  }
  // Its lock may lie in the folder of results, which goes if it is empty.
  void fail() override {
    if (std::exchange(is_started_, false)) (simulation_.*stop_)();
  }
  bool can_go_back() const override { return std::is_same_v<Report, DdsReport>; }  // the others are files and devices

 private:
  Simulation& simulation_;
  std::function<void()> start_;
  Report (Simulation::*stop_)();
  std::optional<Report>& report_;
  bool is_started_;
};

// "SENSOR=REST" or "REST". A path with '=' is written with its folder: ./a=b.pcap.
std::pair<std::string, std::string> sensor_and_rest(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || text.find('/') < equals) return {"", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::filesystem::path with_folder(const std::filesystem::path& file) {
  if (file.has_parent_path()) make_folder(file.parent_path());
  return file;
}

}  // namespace

void require_replaceable(const Options& options) {
  if (!options.no_replace) return;
  const auto require = [](const char* option, const std::filesystem::path& file) {
    std::error_code error;  // of a link that leads to itself, below which nothing can be
    if (file.empty() || !std::filesystem::exists(file, error)) return;
    in_option(option,
              [&] { throw InputError(file.string() + " exists, and --no-replace is given, expected another file"); });
  };
  for (const std::string& each : options.record_pcap) require("--record-pcap", sensor_and_rest(each).second);
  require("--record", options.record);
  require("--export", options.export_file);
  if (const std::optional<MapFormat> format = map_format_of(options.export_file)) {
    for (const std::filesystem::path& each : files_of_map(options.export_file, *format)) require("--export", each);
  }
  require("--page", options.page);
  require("--save-state", options.save_state);
  require("--profile", options.profile);
}

std::vector<std::unique_ptr<RunOutlet>> simulation_outlets(const Options& options, Simulation& simulation,
                                                           RunReport& report) {
  std::vector<std::unique_ptr<RunOutlet>> outlets;
  const auto add = [&]<typename Report>(const char* option, std::function<void()> start, Report (Simulation::*stop)(),
                                        std::optional<Report>& result) {
    std::function<void()> named;
    if (start) named = [option, start = std::move(start)] { in_option(option, start); };
    outlets.push_back(std::make_unique<SimulationOutlet<Report>>(simulation, std::move(named), stop, result));
  };
  report.packets.resize(options.record_pcap.size());
  for (std::size_t i = 0; i < options.record_pcap.size(); ++i) {
    const auto start = [&, i] {
      const auto [sensor, file] = sensor_and_rest(options.record_pcap[i]);
      simulation.record_packets({.file = with_folder(file), .sensor = sensor});
    };
    add("--record-pcap", start, &Simulation::finish_packet_recording, report.packets[i]);
  }
  if (!options.udp.empty()) {
    const auto start = [&] {
      const auto [sensor, address] = sensor_and_rest(options.udp);
      simulation.send_packets({.address = address, .sensor = sensor});
    };
    add("--udp", start, &Simulation::stop_packets, report.sent_packets);
  }
  if (!options.record.empty()) {
    const auto start = [&] {
      simulation.record({.file = with_folder(options.record),
                         .topics = options.record_topics,
                         .drop = options.record_policy == "drop"});
    };
    add("--record", start, &Simulation::finish_recording, report.recording);
  }
  if (options.dds) add("--dds", {}, &Simulation::leave_dds, report.dds);
  return outlets;
}

}  // namespace simvis
