#include "engine/render/draw_runs.h"

#include <limits>

namespace simvis {
namespace {

using Surface = PipelineKey::Surface;
using Kind = VisibleDraw::Kind;

// The group of a run that no other instance may join.
constexpr std::uint32_t kNoGroup = std::numeric_limits<std::uint32_t>::max();

PipelineKey key_in_view(const ViewContext& context, const Drawable& d) {
  PipelineKey key = d.key;
  key.shadowed = key.lights.any() && !context.view.shadows.empty();
  key.fog = key.color && context.list.medium.extinction_per_m > 0;
  if (key.topology != Topology::triangles) return key;
  key.cull_back = context.culls_backs(d);
  key.mirrored = d.mirrored && (key.cull_back || key.lights.any());
  return key;
}

MeshRange range_of(const VisibleDraw& draw) {
  const MeshRange& mesh = *draw.candidate->range;
  if (draw.kind == Kind::mesh) return mesh;
  return {.first_index = draw.first,
          .index_count = draw.count,
          .vertex_offset =
              draw.kind == Kind::copied_triangles ? static_cast<std::int32_t>(draw.first_vertex) : mesh.vertex_offset,
          .bounds_min = mesh.bounds_min,
          .bounds_max = mesh.bounds_max};
}

}  // namespace

void DrawRuns::clear() {
  runs_.clear();
  instances_.clear();
  items_.clear();
  cpu_selected_.clear();
}

void DrawRuns::record(const ViewContext& context, std::span<const VisibleDraw> visible) {
  std::uint32_t group = kNoGroup;
  const DrawCandidate* last = nullptr;
  for (const VisibleDraw& draw : visible) {
    const DrawCandidate& candidate = *draw.candidate;
    const Drawable& d = *candidate.drawable;
    // Several draws of one candidate, its clusters, share its instance.
    if (&candidate != last) add_instance(context, candidate);
    last = &candidate;
    if (draw.kind == Kind::mesh && d.group == group && candidate.range->first_index == runs_.back().range.first_index) {
      ++runs_.back().instance_count;
      continue;
    }
    group = draw.kind == Kind::mesh ? d.group : kNoGroup;
    runs_.push_back({.key = key_in_view(context, d),
                     .texture = d.texture,
                     .range = range_of(draw),
                     .first_instance = static_cast<std::uint32_t>(instances_.size() - 1),
                     .instance_count = 1,
                     .depth_visible = d.depth_visible,
                     .point_m = d.point_m,
                     .own_indices = draw.kind == Kind::triangles || draw.kind == Kind::copied_triangles,
                     .copied = draw.kind == Kind::copied_triangles || draw.kind == Kind::points});
  }
}

void DrawRuns::add_instance(const ViewContext& context, const DrawCandidate& candidate) {
  shader::Instance& instance = instances_.emplace_back();
  write_clip_rows(context.projection, *candidate.world_from_mesh, instance);
  instance.material = candidate.drawable->material;
  instance.error_m = candidate.error_m;
  if (context.pass.items) items_.push_back(candidate.drawable->item);
}

void DrawRuns::record_strip(const ViewContext& context, std::span<const StripTriangle> triangles,
                            std::span<const DrawCandidate> candidates) {
  if (triangles.empty()) return;
  const auto first = static_cast<std::uint32_t>(cpu_selected_.size());
  shader::CpuSelectedVertex vertex{};
  const DrawCandidate* owner = nullptr;
  for (const StripTriangle& triangle : triangles) {
    if (owner != &candidates[triangle.owner]) {
      owner = &candidates[triangle.owner];
      shader::Instance instance{};
      write_clip_rows(context.projection, *owner->world_from_mesh, instance);
      vertex.clip_x = instance.clip_x;
      vertex.clip_y = instance.clip_y;
      vertex.clip_w = instance.clip_w;
    }
    for (const std::uint32_t corner : triangle.corners) {
      const glm::vec3& p = owner->range->positions[corner];
      vertex.x = p.x;
      vertex.y = p.y;
      vertex.z = p.z;
      cpu_selected_.push_back(vertex);
    }
  }
  PipelineKey key = key_in_view(context, *owner->drawable);
  key.cpu_selected = true;
  runs_.push_back(
      {.key = key,
       .range = {.first_index = first, .index_count = static_cast<std::uint32_t>(cpu_selected_.size()) - first},
       .instance_count = 1});
}

void DrawRuns::repeat_for_depth(std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; ++i) {
    DrawRun run = runs_[i];
    if (!run.depth_visible) continue;
    const PipelineKey layer = run.key;
    run.key = {.color = true,
               .topology = layer.topology,
               .surface = Surface::masked,
               .textured = layer.textured,
               .cull_back = layer.cull_back,
               .mirrored = layer.mirrored && layer.cull_back};
    runs_.push_back(run);
  }
}

void DrawRuns::finish(const ViewContext& context) {
  ViewCounts& counts = context.draws.counts;
  for (DrawRun& run : runs_) {
    run.key.shadow_map = context.pass.shadow_maps;
    run.key.orthographic = context.view.orthographic;
    run.key.items = context.pass.items && (run.key.depth_only || !run.key.blends());
    counts.triangles += run.triangles();
    if (run.key.surface == Surface::masked) counts.masked_triangles += run.triangles();
  }
  counts.draws = runs_.size();
}

}  // namespace simvis
