#include "program/report/run_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "engine/base/assert.h"
#include "scenegraph/language/json_text.h"
#include "sensors/camera/depth_error_bound.h"

namespace simvis {

namespace {

using Json = nlohmann::ordered_json;

/// Names and paths from the user may contain any bytes.
Json in_utf8(const Json& json) {
  if (json.is_string()) return to_json_text(json.get_ref<const std::string&>());
  if (!json.is_structured()) return json;
  Json all = json.is_object() ? Json::object() : Json::array();
  for (const auto& [name, value] : json.items()) {
    if (json.is_object()) {
      all[to_json_text(name)] = in_utf8(value);
    } else {
      all.push_back(in_utf8(value));
    }
  }
  return all;
}

void add_texts(const std::map<std::string, NamedTexts>& all, const std::string& sensor, Json& json) {
  json = Json::object();
  const auto found = all.find(sensor);
  if (found == all.end()) return;
  for (const auto& [name, value] : found->second) json[name] = value;
}

void add_record(const RunRecord& record, Json& json) {
  json["command"] = record.command;
  json["set"] = record.set;
  if (!record.trajectory.empty()) {
    const auto hash = record.inputs.find(record.trajectory);
    json["trajectory"] = {{"file", record.trajectory},
                          {"sha256", hash == record.inputs.end() ? Json(nullptr) : Json(hash->second)}};
  }
  json["inputs"] = record.inputs;
  json["environment"] = Json::object();
  for (const auto& [name, value] : record.environment) json["environment"][name] = value ? Json(*value) : Json(nullptr);
  json["host"] = {{"name", record.host.name},
                  {"system", record.host.system},
                  {"processor", record.host.processor},
                  {"threads", record.host.threads}};
  const OutputFormats& formats = record.formats;
  json["formats"] = {{"color", formats.color},
                     {"depth", formats.depth},
                     {"scan", formats.scan},
                     {"color_beside_depth", formats.color_beside_depth},
                     {"depth_unit_m", formats.depth_unit_m}};
  json["poses"] = record.poses;
}

Json served_of(const ServeDesc& served) {
  Json folders = Json::array();
  for (const std::filesystem::path& folder : served.folders) folders.push_back(folder.string());
  Json json = {{"name", served.name}, {"allow", folders}};
  if (served.lockstep.empty()) return json;
  json["lockstep"] = served.lockstep;
  json["lockstep_timeout_s"] = served.lockstep_timeout_s;
  return json;
}

}  // namespace

double percentile(std::span<const double> values, double p) {
  SIMVIS_ASSERT(p > 0 && p <= 100);
  if (values.empty()) return 0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(p / 100 * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(rank) - 1];
}

std::vector<SensorInfo> with_bounds(const Simulation& simulation) {
  std::vector<SensorInfo> sensors = simulation.sensors();
  for (SensorInfo& sensor : sensors) {
    sensor.depth_error_bound_m = simulation.find_value(sensor.name, kDepthErrorBound);
  }
  return sensors;
}

std::string to_json(const RunReport& report) {
  Json sensors = Json::object();
  for (const SensorInfo& sensor : report.sensors) {
    sensors[sensor.name] = {{"type", sensor.type},
                            {"method", sensor.method},
                            {"frames", sensor.frames},
                            {"enabled", sensor.enabled},
                            {"effects", sensor.effects}};
    add_texts(report.record.attributes, sensor.name, sensors[sensor.name]["attributes"]);
    add_texts(report.record.defaults, sensor.name, sensors[sensor.name]["defaults"]);
    if (sensor.depth_error_bound_m) {
      // JSON has no infinity.
      const bool finite = std::isfinite(*sensor.depth_error_bound_m);
      sensors[sensor.name][kDepthErrorBound] = finite ? Json(*sensor.depth_error_bound_m) : Json(nullptr);
    }
    for (const SensorNote& note : sensor.report.notes) {
      std::visit([&](const auto& value) { sensors[sensor.name][note.name] = value; }, note.value);
    }
  }
  const auto of_device = [&](std::string DeviceInfo::*member) {
    return report.device ? Json((*report.device).*member) : Json(nullptr);
  };
  Json json = {
      {"scene", report.scene},
      {"device", of_device(&DeviceInfo::name)},
      {"driver", of_device(&DeviceInfo::driver)},
      {"versions", {{"simvis", std::string(version())}, {"vulkan", of_device(&DeviceInfo::api_version)}}},
      {"seed", report.seed},
      {"wall_s", report.wall_s},
      {"status", report.status},
      {"frames", report.shard.value_or(Shard{}).share_of(report.next_frame)},
      {"frames_wanted", report.endless ? Json(nullptr) : Json(report.frames_wanted)},
      {"next_frame", report.next_frame},
      {"rate_hz", report.frames_when_due ? Json("auto") : Json(report.rate_hz)},
      {"frame_ms",
       {{"median", percentile(report.frame_ms.values(), 50)}, {"p99", percentile(report.frame_ms.values(), 99)}}},
      {"sensors", sensors}};
  add_record(report.record, json);
  json["warnings"] = report.warnings;
  const auto packets_json = [](const PacketReport& packets) {
    return Json{{"sensor", packets.sensor}, {"packets", packets.packets}, {"bytes", packets.bytes}};
  };
  for (const std::optional<PacketReport>& packets : report.packets) {
    if (packets) json["packets"].push_back(packets_json(*packets));
  }
  if (report.sent_packets) json["sent_packets"] = packets_json(*report.sent_packets);
  if (report.recording) {
    json["recording"] = {{"file", report.recording->file.string()},
                         {"messages", report.recording->messages},
                         {"dropped", report.recording->dropped},
                         {"bytes", report.recording->bytes}};
  }
  if (report.dds) {
    json["dds"] = {{"messages", report.dds->messages},
                   {"dropped", report.dds->dropped},
                   {"bytes", report.dds->bytes},
                   {"received", report.dds->received},
                   {"refused", report.dds->refused}};
  }
  json["files"] = report.files;
  if (report.served) json["served"] = served_of(*report.served);
  if (!report.followed.empty()) json["followed"] = report.followed;
  if (report.real_time) {
    json["real_time"] = {{"factor", report.real_time->factor},
                         {"late_frames", report.real_time->punctuality.late_frames},
                         {"largest_lag_s", report.real_time->punctuality.largest_lag_s}};
  }
  if (report.shard) json["shard"] = {{"index", report.shard->index}, {"count", report.shard->count}};
  return in_utf8(json).dump(2) + "\n";
}

std::string speed_line(const RunReport& report) {
  const double median_ms = percentile(report.frame_ms.values(), 50);
  const double speed_hz = 1000 / std::max(median_ms, 1e-6);
  const std::size_t frames = report.frame_ms.added(), warnings = report.warnings.size();
  const double rate_hz = report.frames_when_due ? static_cast<double>(frames) / report.simulated_s : report.rate_hz;
  char text[240];
  std::snprintf(text, sizeof text,
                "%zu frame%s, %.2f ms a frame: %.1f Hz, %.2f x real time at %g Hz; %.2f s with loading and files: "
                "%.2f x real time; %zu warning%s",
                frames, frames == 1 ? "" : "s", median_ms, speed_hz, speed_hz / rate_hz, rate_hz, report.wall_s,
                report.simulated_s / std::max(report.wall_s, 1e-6), warnings, warnings == 1 ? "" : "s");
  return text;
}

}  // namespace simvis
