#include "program/report/explain.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace simvis {

namespace {

std::string ms_text(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f ms", static_cast<double>(ns) / 1e6);
  return text;
}

/// The tree of one frame; each function writes one branch.
class Explanation {
 public:
  Explanation(const FramePlan& plan, const ExplainedFrame& frame) : plan_(plan), frame_(frame) {}

  std::string text() {
    for (const PlannedSensor& sensor : frame_.sensors) explain(sensor);
    const std::size_t passes = frame_.sensors.empty() ? 0 : last_pass_, casts = frame_.sensors.empty() ? 0 : last_cast_;
    for (std::size_t i = passes; i < plan_.passes.size(); ++i) explain_pass(i, "");
    for (std::size_t i = casts; i < plan_.casts.size(); ++i) explain_cast(i, "");
    explain_memory();
    explain_counters();
    return out_.str();
  }

 private:
  void explain(const PlannedSensor& sensor) {
    out_ << "sensor " << sensor.name << ", " << sensor.type << ": " << why(sensor);
    for (const std::string& output : sensor.outputs)
      out_ << (&output == &sensor.outputs.front() ? "; " : ", ") << output;
    out_ << '\n';
    for (const PlannedEffect& effect : plan_.effects) {
      if (effect.sensor == sensor.name) out_ << "  effect " << effect.effect << ": " << effect.reason << '\n';
    }
    for (std::size_t i = sensor.first_pass; i < sensor.end_pass; ++i) explain_pass(i, "  ");
    for (std::size_t i = sensor.first_cast; i < sensor.end_cast; ++i) explain_cast(i, "  ");
    last_pass_ = std::max(last_pass_, sensor.end_pass);
    last_cast_ = std::max(last_cast_, sensor.end_cast);
    const auto cost = std::ranges::find(frame_.sensor_costs, sensor.name, &SensorCost::sensor);
    if (cost == frame_.sensor_costs.end()) return;
    out_ << "  cost on the host: " << ms_text(cost->collected_ns - cost->start_ns) << " to take results";
    if (cost->rays > 0) {
      out_ << ", " << ms_text(cost->end_ns - cost->collected_ns) << " to cast " << cost->rays
           << " rays: " << cost->item_tests << " tests of items, " << cost->triangle_tests << " of triangles";
    }
    out_ << '\n';
  }

  static std::string why(const PlannedSensor& sensor) {
    std::ostringstream text;
    switch (sensor.due_state) {
      case DueState::due:
        text << "due, ";
        break;
      case DueState::off:
        return "not due, it is turned off";
      case DueState::waiting:
        text << "not due in this frame, ";
        break;
      case DueState::hidden:
        return "not due, it stands in a part that is switched off";
    }
    if (sensor.rate_hz > 0) {
      text << "at " << sensor.rate_hz << " Hz";
    } else {
      text << "in every frame";
    }
    return text.str();
  }

  void explain_pass(std::size_t index, const std::string& indent) {
    const Pass& pass = plan_.passes[index];
    out_ << indent << "pass " << pass.name << ": " << pass.width_px << " x " << pass.height_px << ',';
    if (pass.color) out_ << " colour";
    if (pass.color && pass.depth) out_ << " and";
    if (pass.depth) out_ << " depth";
    if (pass.items) out_ << " and items";
    if (pass.shadow_maps) out_ << " shadow maps";
    if (pass.samples() > 1) {
      out_ << ", the mean of " << pass.samples() << " samples a pixel: " << pass.supersampling << " x "
           << pass.supersampling << " of msaa " << pass.msaa;
    }
    out_ << '\n';
    const PassCost* const cost =
        frame_.device && !frame_.device->passes.empty() ? &frame_.device->passes[index] : nullptr;
    if (cost != nullptr) {
      out_ << indent << "  cost";
      if (frame_.device->timed) {
        out_ << ' ' << ms_text(cost->time.length_ns()) << ", readback " << ms_text(cost->readback.length_ns());
      }
      out_ << ", " << cost->bytes_read_back << " bytes read back\n";
    }
    for (std::size_t i = 0; i < pass.views.size(); ++i) {
      explain(pass.views[i], cost != nullptr ? &cost->views[i] : nullptr, indent + "  ");
    }
    explain(pass.pipelines, indent + "  ");
  }

  void explain(const View& view, const ViewCost* cost, const std::string& indent) {
    out_ << indent << "view " << view.name << ": " << view.width_px << " x " << view.height_px << " at " << view.x_px
         << ' ' << view.y_px << ", near " << view.near_m << " m: " << view.reason << '\n';
    if (cost != nullptr) {
      out_ << indent << "  cost";
      if (frame_.device->timed) out_ << ' ' << ms_text(cost->time.length_ns());
      if (frame_.device->counted) {
        const PipelineStatistics& counts = cost->statistics;
        out_ << (frame_.device->timed ? ", " : " ") << counts.vertex_invocations << " vertex";
        if (view.shades()) out_ << " and " << counts.fragment_invocations << " fragment";
        out_ << " shader runs, " << counts.primitives_clipped << " triangles into clipping and "
             << counts.primitives_drawn << " out of it";
      }
      out_ << '\n';
    }
    explain(view.pipelines, indent + "  ");
    explain(view.levels, indent + "  ");
  }

  void explain(std::span<const DrawnLevel> levels, const std::string& indent) {
    for (const DrawnLevel& level : levels) {
      out_ << indent << "level " << level.level << ": " << level.items << " items of " << level.exact_triangles
           << " triangles drawn with " << level.triangles << ", displaced by at most " << level.error_px << " px\n";
    }
  }

  void explain(std::span<const PlannedPipeline> pipelines, const std::string& indent) {
    for (const PlannedPipeline& pipeline : pipelines) {
      out_ << indent << "pipeline " << pipeline.variant << ": " << pipeline.reason;
      if (pipeline.draws > 0) out_ << "; " << pipeline.draws << " draws, " << pipeline.triangles << " triangles";
      out_ << (pipeline.made ? "; made in this frame\n" : "\n");
    }
  }

  void explain_cast(std::size_t index, const std::string& indent) {
    const RayCast& cast = plan_.casts[index];
    out_ << indent << "cast " << cast.name << ": up to " << cast.max_rays << " rays by " << cast.engine << ": "
         << cast.reason << '\n';
  }

  void explain_memory() {
    std::uint64_t bytes = 0;
    for (const PlannedMemory& memory : plan_.memory) bytes += memory.bytes;
    if (!plan_.memory.empty()) out_ << "memory on the device: " << bytes << " bytes\n";
    for (const PlannedMemory& memory : plan_.memory) {
      out_ << "  " << memory.name << ": " << memory.bytes << " bytes";
      if (memory.uploaded > 0) out_ << ", " << memory.uploaded << " uploaded";
      out_ << ": " << memory.reason << '\n';
    }
  }

  void explain_counters() {
    const FrameCounters& counters = frame_.counters;
    if (frame_.device != nullptr && !frame_.device->timed) out_ << "this device has no clock: no times\n";
    if (frame_.device != nullptr && !frame_.device->counted) {
      out_ << "this device has no pipeline statistics: no counts of shader runs\n";
    }
    out_ << counters.passes << " passes, " << counters.views << " views, " << counters.draws << " draws, "
         << counters.triangles << " triangles, " << counters.pipelines_bound << " pipelines bound, "
         << counters.pipelines_made << " made, " << counters.dispatches << " dispatches, " << counters.items_culled
         << " items culled, " << counters.bytes_uploaded << " bytes uploaded, " << counters.bytes_read_back
         << " bytes read back, " << counters.meshes_held << " meshes of " << counters.mesh_bytes << " bytes and "
         << counters.textures_held << " textures of " << counters.texture_bytes << " bytes held\n";
  }

  const FramePlan& plan_;
  const ExplainedFrame& frame_;
  std::ostringstream out_;
  std::size_t last_pass_ = 0, last_cast_ = 0;
};

}  // namespace

std::string explain(const FramePlan& plan, const ExplainedFrame& frame) { return Explanation(plan, frame).text(); }

}  // namespace simvis
