#include "program/report/profile.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/base/assert.h"

namespace simvis {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kProcess = 1, kHost = 1, kDevice = 2;

Json track_name(int track, const std::string& name) {
  return {{"name", "thread_name"}, {"ph", "M"}, {"pid", kProcess}, {"tid", track}, {"args", {{"name", name}}}};
}

/// Names from the user may contain any bytes: invalid UTF-8 is replaced.
std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

double microseconds(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

}  // namespace

Profile::Profile(std::filesystem::path path, const std::string& device) : lock_(path), file_(std::move(path)) {
  file_.write("{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n");
  write_line(dump(track_name(kHost, "host")));
  write_line(dump(track_name(kDevice, device)));
}

void Profile::write_line(const std::string& event) { file_.write(std::exchange(any_, true) ? ",\n" + event : event); }

void Profile::write_span(const Span& span) {
  Json arguments{{"frame", frame_}};
  for (const auto& [name, count] : span.counts) arguments[name] = count;
  if (!span.reason.empty()) arguments["reason"] = span.reason;
  write_line(dump({{"name", span.name},
                   {"cat", span.category},
                   {"ph", "X"},
                   {"pid", kProcess},
                   {"tid", span.track},
                   {"ts", microseconds(span.start_ns - first_ns_)},
                   {"dur", microseconds(span.end_ns - span.start_ns)},
                   {"args", std::move(arguments)}}));
}

void Profile::add(const ProfiledFrame& frame) {
  SIMVIS_ASSERT(!frame.stages.empty());
  frame_ = frame.index;
  const std::int64_t start_ns = frame.stages.front().start_ns, step_ns = frame.stages.back().end_ns;
  if (first_ns_ < 0) first_ns_ = start_ns;
  write_span({"frame", "frame", kHost, start_ns, std::max(step_ns, frame.written_ns)});
  for (const StageTime& stage : frame.stages) {
    write_span({std::string(stage.name), "stage", kHost, stage.start_ns, stage.end_ns});
  }
  if (frame.written_ns != 0) write_span({"write", "stage", kHost, step_ns, frame.written_ns});
  for (const SensorCost& sensor : frame.sensors) {
    write_span({sensor.sensor, "sensor", kHost, sensor.start_ns, sensor.end_ns});
    if (sensor.rays == 0) continue;
    write_span({"cast",
                "sensor",
                kHost,
                sensor.collected_ns,
                sensor.end_ns,
                {{"rays", sensor.rays}, {"item_tests", sensor.item_tests}, {"triangle_tests", sensor.triangle_tests}}});
  }
  write_counters(frame, start_ns);
}

void Profile::write_counters(const ProfiledFrame& frame, std::int64_t time_ns) {
  const std::pair<const char*, std::uint64_t> counters[] = {{"draws", frame.counters.draws},
                                                            {"triangles", frame.counters.triangles},
                                                            {"pipelines made", frame.counters.pipelines_made},
                                                            {"bytes uploaded", frame.counters.bytes_uploaded},
                                                            {"bytes read back", frame.counters.bytes_read_back},
                                                            {"bytes on the device", frame.device_memory_bytes}};
  for (const auto& [name, value] : counters) {
    write_line(dump({{"name", name},
                     {"ph", "C"},
                     {"pid", kProcess},
                     {"ts", microseconds(time_ns - first_ns_)},
                     {"args", {{"value", value}}}}));
  }
}

void Profile::add(const FramePlan& plan, const FrameCosts& costs) {
  if (!costs.timed || costs.passes.empty()) return;
  const auto span = [&](const std::string& name, const GpuSpan& time) {
    return Span{name, "device", kDevice, costs.submitted_ns + time.start_ns, costs.submitted_ns + time.end_ns};
  };
  write_span(span("uploads", costs.uploads));
  for (std::size_t p = 0; p < costs.passes.size(); ++p) {
    const Pass& pass = plan.passes[p];
    const PassCost& cost = costs.passes[p];
    write_span(span("pass " + pass.name, cost.time));
    for (std::size_t v = 0; v < cost.views.size(); ++v) {
      const PipelineStatistics& counts = cost.views[v].statistics;
      Span view = span("view " + pass.views[v].name, cost.views[v].time);
      view.reason = pass.views[v].reason;
      if (costs.counted) {
        view.counts = {{"vertex_invocations", counts.vertex_invocations},
                       {"primitives_clipped", counts.primitives_clipped},
                       {"primitives_drawn", counts.primitives_drawn}};
        if (pass.views[v].shades()) view.counts.emplace_back("fragment_invocations", counts.fragment_invocations);
      }
      write_span(view);
    }
  }
  for (std::size_t p = 0; p < costs.passes.size(); ++p) {
    Span readback = span("readback " + plan.passes[p].name, costs.passes[p].readback);
    readback.counts = {{"bytes", costs.passes[p].bytes_read_back}};
    write_span(readback);
  }
}

void Profile::commit() {
  file_.write("\n]}\n");
  file_.commit();
}

}  // namespace simvis
