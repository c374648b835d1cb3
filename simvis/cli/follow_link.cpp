#include "simvis/cli/follow_link.h"

#include <unistd.h>

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis_client/connection.h>
#include "simvis/cli/load_scene.h"
#include "simvis/sharing/network_host.h"

namespace simvis {
namespace {

template <typename Number>
std::vector<Number> numbers(const client::Measurement& measurement, const char* output) {
  const std::span<const Number> shared = measurement.output<Number>(output);
  return {shared.begin(), shared.end()};
}

/// Empty if the host has begun to write over it.
std::optional<Scan> copy_of(const client::Measurement& measurement) {
  const simvis_output* shape = nullptr;
  const simvis_view view = measurement.view();
  if (simvis_output_data(&view, "range_m", &shape) == nullptr) return {};
  Scan scan{.rings = shape->rows,
            .beams = shape->columns,
            .azimuth_rad = numbers<double>(measurement, "azimuth_rad"),
            .elevation_rad = numbers<double>(measurement, "elevation_rad"),
            .range_m = numbers<float>(measurement, "range_m"),
            .error_bound_m = numbers<float>(measurement, "error_bound_m"),
            .channels = {},
            .time_ns = measurement.slot().time_ns,
            .world_from_sensor = glm::dmat4(1),
            .origin_m = numbers<double>(measurement, "origin_m")};
  for (int i = 0; i < 16; ++i) scan.world_from_sensor[i / 4][i % 4] = measurement.slot().world_from_sensor[i];
  const std::size_t beams = scan.range_m.size();
  const bool grid = scan.azimuth_rad.size() == scan.beams && scan.elevation_rad.size() == scan.rings;
  const bool table = scan.azimuth_rad.size() == beams && scan.elevation_rad.size() == beams;
  const bool fits = beams == std::size_t{scan.rings} * scan.beams && (grid || table) &&
                    (scan.origin_m.empty() || scan.origin_m.size() == 3 * beams);
  if (!fits || !measurement.whole()) return {};
  return scan;
}

/// A host on this machine.
class SharedMemoryHost : public FollowedHost {
 public:
  explicit SharedMemoryHost(std::string name) : name_(std::move(name)) {}

  bool connect(int timeout_ms) override {
    if (connection_ && connection_->alive()) return true;
    connection_.reset();
    try {
      connection_.emplace(name_, "follower-" + std::to_string(::getpid()), timeout_ms);
    } catch (const client::Error& error) {
      if (!simvis_is_missing()) throw MachineError(error.what());
    }
    return connection_.has_value();
  }

  std::string missing() const override {
    return "nobody on this machine serves " + in_quotes(name_) + ", expected simvis-run --serve " + name_;
  }

  Waited wait(std::uint64_t frames, int timeout_ms) override {
    const int waited = simvis_wait_frame(host(), frames, timeout_ms);
    return waited < 0 ? Waited::host_ended : waited == 1 ? Waited::frame : Waited::time_over;
  }

  Frame read(std::vector<double>& values) override {
    values.resize(simvis_parameter_count(host()));
    simvis_frame_info frame{};
    if (simvis_applied_frame(host(), 0, values.data(), values.size(), &frame) != 0) return {};
    return {.frames = frame.frames, .next_frame = frame.next_frame, .time_ns = frame.time_ns};
  }

  std::optional<Change> next_change(std::uint64_t& position) override {
    for (;;) {
      const std::optional<client::LogEntry> entry = connection_->next_log(position);
      if (!entry) return {};
      if (entry->kind == SIMVIS_CHANGE) return Change{entry->frame, entry->text};
    }
  }

  void set(std::size_t parameter, const std::string&, double value) override {
    simvis_set(host(), static_cast<std::int64_t>(parameter), value);
  }

  void request(const std::string& xml) override {
    if (simvis_send(host(), xml.c_str()) == 0)
      throw InputError(name_ + ": takes no request now: " + simvis_client_error());
  }

  std::optional<HostScan> scan(const std::string& sensor, std::uint64_t known) override {
    const std::int64_t id = simvis_find_sensor(host(), sensor.c_str());
    const std::optional<client::Measurement> latest = id < 0 ? std::nullopt : connection_->latest(id);
    if (!latest || latest->view().sequence == known) return {};
    std::optional<Scan> copy = copy_of(*latest);
    if (!copy) return {};
    return HostScan{latest->view().sequence, std::move(*copy)};
  }

 private:
  simvis_client* host() const { return connection_->get(); }

  std::string name_;
  std::optional<client::Connection> connection_;
};

}  // namespace

std::unique_ptr<FollowedHost> followed_host(const std::string& follow) {
  constexpr std::string_view kDds = "dds:";
  if (!follow.starts_with(kDds)) return std::make_unique<SharedMemoryHost>(follow);
  const std::size_t slash = follow.find('/');
  const std::string domain = slash == std::string::npos ? "" : follow.substr(kDds.size(), slash - kDds.size());
  if (slash != std::string::npos && domain.empty()) throw InputError("the domain is missing, expected dds:DOMAIN/NAME");
  const std::string name = follow.substr(slash == std::string::npos ? kDds.size() : slash + 1);
  return host_by_dds(name, dds_domain(domain));
}

}  // namespace simvis
