#include "program/cli/follow_link.h"

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis_client/connection.h>
#include "program/cli/load_scene.h"
#include "simvis/sharing/network_host.h"

namespace simvis {
namespace {

template <typename Number>
MeasuredNumbers copied(const simvis_view& view, const simvis_output& output) {
  std::vector<Number> numbers(std::size_t{output.rows} * output.columns * output.channels);
  if (!numbers.empty()) {
    std::memcpy(numbers.data(), reinterpret_cast<const char*>(view.slot) + output.offset,
                numbers.size() * sizeof(Number));
  }
  return SharedArray<Number>(std::move(numbers));
}

/// `output` is of simvis_copy_output(), so it has one of these types, and its numbers lie in the slot.
MeasuredNumbers copied(const simvis_view& view, const simvis_output& output) {
  switch (output.type) {
    case SIMVIS_FLOAT32:
      return copied<float>(view, output);
    case SIMVIS_FLOAT64:
      return copied<double>(view, output);
    case SIMVIS_UINT8:
      return copied<std::uint8_t>(view, output);
    case SIMVIS_UINT32:
      return copied<std::uint32_t>(view, output);
    default:
      return copied<std::int32_t>(view, output);
  }
}

/// Empty if the host has begun to write over it.
std::optional<Measurement> copy_of(const client::Measurement& shared) {
  const simvis_view view = shared.view();
  Measurement measurement{.time_ns = shared.slot().time_ns};
  for (int i = 0; i < 16; ++i) measurement.world_from_sensor[i / 4][i % 4] = shared.slot().world_from_sensor[i];
  const char* const slot = reinterpret_cast<const char*>(view.slot);
  for (std::uint32_t i = 0; simvis_output_at(&view, i) != nullptr; ++i) {
    simvis_output output{};
    if (simvis_copy_output(&view, i, &output) != 0) return std::nullopt;
    measurement.arrays.push_back({{.name = {slot + output.name_offset, output.name_size},
                                   .shape = {output.rows, output.columns, output.channels},
                                   .unit = {slot + output.unit_offset, output.unit_size}},
                                  copied(view, output)});
  }
  if (!shared.whole()) return std::nullopt;
  return measurement;
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
      is_torn_ = false;
    } catch (const client::Error& error) {
      if (!simvis_is_missing()) throw MachineError(error.what());
    }
    return connection_.has_value();
  }

  std::string missing() const override {
    return "no process on this machine serves " + in_quotes(name_) + ", expected simvis-run --serve " + name_;
  }

  Waited wait(std::uint64_t frames, int timeout_ms) override {
    if (is_torn_ && !connection_->alive()) return Waited::host_ended;
    const int waited = simvis_wait_frame(host(), frames, timeout_ms);
    return waited < 0 ? Waited::host_ended : waited == 1 ? Waited::frame : Waited::time_over;
  }

  Frame read(std::vector<double>& values) override {
    values.resize(simvis_parameter_count(host()));
    simvis_frame_info frame{};
    is_torn_ = simvis_applied_frame(host(), 0, values.data(), values.size(), &frame) != 0;
    if (is_torn_) return {};
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

  std::optional<HostMeasurement> measurement(const std::string& sensor, std::uint64_t known) override {
    const std::int64_t id = simvis_find_sensor(host(), sensor.c_str());
    const std::optional<client::Measurement> latest = id < 0 ? std::nullopt : connection_->latest(id);
    if (!latest || latest->view().sequence == known) return {};
    std::optional<Measurement> copy = copy_of(*latest);
    if (!copy) return {};
    return HostMeasurement{latest->view().sequence, *std::move(copy)};
  }

 private:
  simvis_client* host() const { return connection_->get(); }

  std::string name_;
  std::optional<client::Connection> connection_;
  bool is_torn_ = false;  // the last frame could not be read whole: the host writes it, or was killed while it wrote
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
