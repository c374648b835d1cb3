#include "engine/render/renderer.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include <simvis/device.h>
#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/now_ns.h"
#include "engine/render/draw_cache.h"
#include "engine/render/frame_buffers.h"
#include "engine/render/frame_draw_lists.h"
#include "engine/render/frame_recorder.h"
#include "engine/render/geometry_pool.h"
#include "engine/render/gpu_queries.h"
#include "engine/render/level_store.h"
#include "engine/render/oit_buffer.h"
#include "engine/render/pipelines.h"
#include "engine/render/planned_pipeline.h"
#include "engine/render/render_targets.h"
#include "engine/render/resolve_pass.h"
#include "engine/render/sky_backdrop.h"
#include "engine/render/texture_store.h"
#include "engine/vulkan/frame_commands.h"
#include "engine/vulkan/uploads.h"

namespace simvis {
namespace {

void check_view(const View& view, const Pass& pass) {
  SIMVIS_ASSERT(view.width_px > 0 && view.height_px > 0);
  SIMVIS_ASSERT(std::uint64_t{view.x_px} + view.width_px <= pass.width_px);
  SIMVIS_ASSERT(std::uint64_t{view.y_px} + view.height_px <= pass.height_px);
  SIMVIS_ASSERT(view.orthographic ? view.far_m > view.near_m : view.near_m > 0);
  SIMVIS_ASSERT(view.pinhole.fx_px != 0 && view.pinhole.fy_px != 0);
}

void check_pass(const Pass& pass, const TargetLimits& limits) {
  SIMVIS_ASSERT(pass.width_px > 0 && pass.height_px > 0);
  SIMVIS_ASSERT(pass.shadow_maps ? !pass.color && !pass.depth : pass.color || pass.depth);
  SIMVIS_ASSERT(!pass.items || pass.depth);
  static_assert(kInstance0 == SIMVIS_INSTANCE_0);
  SIMVIS_ASSERT(pass.supersampling == 1 || pass.supersampling == 2 || pass.supersampling == 4);
  SIMVIS_ASSERT(pass.samples() == 1 || (pass.color && !pass.depth));
  const std::uint32_t width = limits.width_px / pass.supersampling, height = limits.height_px / pass.supersampling;
  if (pass.width_px > width || pass.height_px > height) {
    throw InputError(
        "pass \"" + pass.name + "\" has " + std::to_string(pass.width_px) + " x " + std::to_string(pass.height_px) +
        " pixels" +
        (pass.supersampling > 1 ? " of " + std::to_string(pass.supersampling * pass.supersampling) + " samples" : "") +
        ", expected at most " + std::to_string(width) + " x " + std::to_string(height) + " on this device");
  }
  if (std::ranges::find(limits.msaa, pass.msaa) == limits.msaa.end()) {
    throw InputError("pass \"" + pass.name + "\" has msaa " + std::to_string(pass.msaa) + ", expected at most " +
                     std::to_string(limits.msaa.back()) + " on this device");
  }
  for (const View& view : pass.views) check_view(view, pass);
}

// Returns true if the view is drawn as a part of its pass's strip, for which the host selects all opaque triangles.
bool joins_strip(const View& view, const Pass& pass) { return !pass.color && !pass.items && cpu_selects_opaque(view); }

// The mesh data of opaque triangles that the plan needs.
MeshUse opaque_use(const FramePlan& plan) {
  if (std::ranges::any_of(plan.passes, &Pass::color)) return MeshUse::attributes;
  const bool cpu_selected = std::ranges::all_of(plan.passes, [](const Pass& pass) {
    return std::ranges::all_of(pass.views, [&pass](const View& view) { return joins_strip(view, pass); });
  });
  return cpu_selected ? MeshUse::clusters : MeshUse::positions;
}

// Whether a view of the plan needs device copies of large clouds on a CPU device.
bool draws_whole_clouds(const FramePlan& plan) {
  return std::ranges::any_of(plan.passes, [](const Pass& pass) {
    return std::ranges::any_of(pass.views, [&pass](const View& view) {
      return view.sees_lines_and_points && !cpu_selects_points(view, pass);
    });
  });
}

bool draws_levels(const FramePlan& plan) {
  return std::ranges::any_of(plan.passes, [](const Pass& pass) {
    return pass.color && std::ranges::any_of(pass.views, [](const View& view) { return view.max_error_px > 0; });
  });
}

// Returns true if the plan draws large meshes from the device, also on a CPU device: a view does not select triangles,
// or coarser levels are drawn, which are made there.
bool draws_whole_meshes(const FramePlan& plan) {
  return draws_levels(plan) || std::ranges::any_of(plan.passes, [](const Pass& pass) {
           return std::ranges::any_of(pass.views, [&pass](const View& view) {
             return !joins_strip(view, pass) && !cpu_selects_triangles(view, pass);
           });
         });
}

// In fog, only the air is visible at infinite distance.
bool shows_sky(const DrawList& list) { return list.sky.picture != nullptr && list.medium.extinction_per_m == 0; }

RasterTraits raster_traits(const PhysicalDevice& device) {
  return {.snap_px = device.snap_px,
          .points = {.max_px = device.max_point_px, .step_px = device.point_step_px},
          .selects_primitives = device.is_cpu()};
}

// Null if the plan has no shadow maps.
const Pass* find_shadow_maps(const FramePlan& plan) {
  const auto found = std::ranges::find(plan.passes, true, &Pass::shadow_maps);
  return found == plan.passes.end() ? nullptr : &*found;
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(DeviceImpl& d)
      : device(d),
        pipelines(shared_pipelines(d)),
        commands(d, "the drawing of a frame"),
        uploads(d),
        geometry(d),
        levels(d),
        textures(d, pipelines->texture_set_layout()),
        buffers(d, pipelines->frame_set_layout()),
        average(d),
        layers(d, *pipelines),
        targets(d, *pipelines, average),
        draws(raster_traits(d.physical), d.threads) {
    if (d.instrumented) queries.emplace(d);
  }

  void start_frame(const DrawList& list, const FramePlan& plan);
  void finish_frame(const FramePlan& plan);
  void prepare(const DrawList& list, const FramePlan& plan);
  void record(VkCommandBuffer commands, const DrawList& list, const FramePlan& plan);
  void read_results(const FramePlan& plan);
  void name_pipelines(FramePlan& plan) const;
  void name_memory(FramePlan& plan) const;
  void forget();

  DeviceImpl& device;
  std::shared_ptr<Pipelines> pipelines;  // outlives the commands, which wait for the last frame
  std::unordered_map<std::uint64_t, VkPipeline> known_pipelines;  // what is counted is not what other renderers made
  FrameCommands commands;
  Uploads uploads;
  GeometryPool geometry;
  LevelStore levels;
  TextureStore textures;
  FrameBuffers buffers;
  ResolvePass average;
  OitBuffer layers;
  RenderTargets targets;
  std::optional<ShadowMaps> shadows;  // set when a plan first has shadows
  ShadowMapCache shadow_cache;
  std::optional<SkyBackdrop> sky;            // set when a plan first shows a picture of the sky
  bool content_written = false;              // meshes, materials or textures, since shadow_cache was last updated
  const DrawList* submitted_list = nullptr;  // the list in flight, or null
  const FramePlan* submitted_plan = nullptr;
  DrawCache table;
  FrameDrawLists draws;
  std::vector<RenderTarget*> pass_targets;
  std::vector<PassResult> results;
  std::vector<ViewCounts> view_counts;  // of the views of all passes, in order
  FrameCounters counters;
  MadePipelines made;  // in this frame
  std::optional<GpuQueries> queries;
  FrameCosts costs;
};

Renderer::Renderer(Device& device) : impl_(std::make_unique<Impl>(device.impl())) {}
Renderer::~Renderer() = default;
const FrameCounters& Renderer::counters() const { return impl_->counters; }

void Renderer::submit(const DrawList& list, const FramePlan& plan) {
  Impl& r = *impl_;
  SIMVIS_ASSERT(r.submitted_plan == nullptr);
  for (const Pass& pass : plan.passes) check_pass(pass, r.device.physical.targets);
  r.counters = {};
  r.costs = {};
  r.results.clear();
  r.pass_targets.clear();
  r.draws.clear();
  r.made = {};
  r.uploads.begin(VK_NULL_HANDLE);  // nothing has been uploaded yet
  if (plan.passes.empty()) return;
  try {
    r.start_frame(list, plan);
  } catch (...) {
    r.forget();
    throw;
  }
  r.submitted_list = &list;
  r.submitted_plan = &plan;
}

std::span<const PassResult> Renderer::collect() {
  Impl& r = *impl_;
  const FramePlan* const plan = std::exchange(r.submitted_plan, nullptr);
  if (plan == nullptr) return {};
  try {
    r.finish_frame(*plan);
    while (r.layers.grow()) {
      r.start_frame(*r.submitted_list, *plan);
      r.finish_frame(*plan);
    }
  } catch (...) {
    r.forget();
    throw;
  }
  r.read_results(*plan);
  return r.results;
}

void Renderer::Impl::start_frame(const DrawList& list, const FramePlan& plan) {
  const VkCommandBuffer recorded = commands.begin();
  if (queries) queries->begin(recorded, plan);
  uploads.begin(recorded);
  prepare(list, plan);
  uploads.finish();
  if (queries) queries->stamp(recorded);
  record(recorded, list, plan);
  costs.submitted_ns = now_ns();
  commands.submit();
  counters.bytes_uploaded += uploads.bytes();
  counters.layer_bytes = layers.bytes();
  geometry.count(counters.meshes_held, counters.mesh_bytes);
  counters.levels_held = table.levels_held();
  textures.count(counters.textures_held, counters.texture_bytes);
}

void Renderer::Impl::finish_frame(const FramePlan& plan) {
  commands.wait();
  uploads.release();
  counters.layers = layers.found();
  if (!queries) return;
  const std::int64_t submitted_ns = costs.submitted_ns, finished_ns = now_ns();
  costs = queries->costs(plan);
  costs.submitted_ns = submitted_ns;
  costs.finished_ns = finished_ns;
}

void Renderer::Impl::prepare(const DrawList& list, const FramePlan& plan) {
  const bool color = std::ranges::any_of(plan.passes, &Pass::color);
  const bool cpu = device.physical.is_cpu();
  DrawCache::Uses uses{.triangles = opaque_use(plan),
                       .clouds_on_device = !cpu || draws_whole_clouds(plan),
                       .large_on_device = !cpu || draws_whole_meshes(plan),
                       .coarser = draws_levels(plan)};
  table.update(list, uses, geometry, levels, textures, uploads);
  buffers.write_materials(list, table.materials_read(), uploads);
  buffers.write_map_places(list, table.textures_shown(), uploads);
  draws.update(plan, list, table);
  if (draws.triangle_copies() > table.max_copies()) {
    uses.large_on_device = true;
    table.update(list, uses, geometry, levels, textures, uploads);
    draws.update(plan, list, table);
    buffers.release_copies();
  }
  while (!draws.lacking().empty()) {  // until what is seen behind a coarser shape is there too
    table.add_levels(draws.lacking(), list, geometry, levels, textures, uploads);
    draws.update(plan, list, table);
  }
  content_written |= uploads.bytes() > 0;
  counters.items_culled += draws.items_culled();
  buffers.write_instances(draws.instances(), uploads);
  if (std::ranges::any_of(plan.passes, &Pass::has_item_target)) buffers.write_items(draws.items(), uploads);
  buffers.write_indices(draws.indices(), uploads);
  buffers.write_cpu_selected(draws.cpu_selected(), uploads);
  buffers.write_copies(draws.copies(), uploads);
  if (color) buffers.write_lights(draws.lights(), uploads);
  if (color && shows_sky(list)) {
    if (!sky) sky.emplace(device, *pipelines);
    sky->show(list.sky.picture, uploads);
  } else if (list.sky.picture == nullptr) {
    sky.reset();
  }
  if (const Pass* const maps = find_shadow_maps(plan)) {
    if (!shadows) shadows.emplace(device, pipelines->shadows().set_layout);
    shadows->write(plan, *maps, uploads);
  }
}

void Renderer::Impl::record(VkCommandBuffer recorded, const DrawList& list, const FramePlan& plan) {
  targets.begin_frame();
  pass_targets.clear();
  for (const Pass& pass : plan.passes) pass_targets.push_back(&targets.acquire(pass));
  const Pass* const maps = find_shadow_maps(plan);
  if (maps) {
    const DrawnPass first = drawing_order(plan).front();
    const RenderTarget& atlas = *pass_targets[first.pass];
    shadows->show(atlas.depth);
    shadow_cache.update(atlas.number, *maps, draws.views().subspan(first.first_view, maps->views.size()), draws.runs(),
                        draws.instances(), std::exchange(content_written, false));
  }

  std::vector<const Pass*> layered;
  for (const DrawnPass& drawn : drawing_order(plan)) {
    const Pass& pass = plan.passes[drawn.pass];
    if (shows_layers(draws.views().subspan(drawn.first_view, pass.views.size()))) layered.push_back(&pass);
  }
  layers.begin_frame(layered);

  const FrameContext frame{.device = device,
                           .commands = recorded,
                           .pipelines = *pipelines,
                           .known_pipelines = known_pipelines,
                           .average = average,
                           .layers = layers,
                           .geometry = geometry,
                           .frame_set = buffers.set(),
                           .shadows = maps ? &*shadows : nullptr,
                           .sky = shows_sky(list) && sky ? &*sky : nullptr,
                           .instances = buffers.instances(),
                           .items = buffers.items(),
                           .frame_indices = buffers.indices(),
                           .cpu_selected = buffers.cpu_selected(),
                           .copied_positions = buffers.copied_positions(),
                           .copied_attributes = buffers.copied_attributes(),
                           .draws = draws,
                           .list = list,
                           .counters = counters,
                           .made = made,
                           .queries = queries ? &*queries : nullptr};
  record_bindings(frame);
  for (const DrawnPass& drawn : drawing_order(plan)) {
    const Pass& pass = plan.passes[drawn.pass];
    const auto views = draws.views().subspan(drawn.first_view, pass.views.size());
    if (&pass == maps) {
      record_shadow_maps(frame, pass, *pass_targets[drawn.pass], views, shadow_cache);
    } else {
      record_pass(frame, pass, *pass_targets[drawn.pass], views);
    }
  }
  for (std::size_t i = 0; i < plan.passes.size(); ++i) record_readback(frame, plan.passes[i], *pass_targets[i]);
  record_end(frame);
}

void Renderer::Impl::read_results(const FramePlan& plan) {
  view_counts.clear();
  for (const ViewDraws& view : draws.views()) view_counts.push_back(view.counts);
  std::size_t first_view = 0;
  for (std::size_t i = 0; i < plan.passes.size(); ++i) {
    const Pass& pass = plan.passes[i];
    const RenderTarget& target = *pass_targets[i];
    const std::size_t pixels = std::size_t{pass.width_px} * pass.height_px;
    PassResult& result = results.emplace_back();
    if (pass.depth) result.depth = {reinterpret_cast<const float*>(target.depth_readback.mapped()), pixels};
    if (pass.color) {
      const std::byte* const color = target.color.pixels() ? target.color.pixels() : target.color_readback.mapped();
      result.color = {reinterpret_cast<const glm::vec4*>(color), pixels};
    }
    if (pass.items && pass.color) result.instance_items = draws.items();
    if (pass.has_item_target()) {
      const std::byte* const items = target.items.pixels() ? target.items.pixels() : target.items_readback.mapped();
      result.items = {reinterpret_cast<const std::uint32_t*>(items), pixels};
    }
    result.snap_px = device.physical.snap_px;
    result.depth_snap_px = device.physical.depth_snap_px;
    result.views = std::span(view_counts).subspan(first_view, pass.views.size());
    first_view += pass.views.size();
  }
}

void Renderer::complete(FramePlan& plan) const {
  impl_->name_pipelines(plan);
  impl_->name_memory(plan);
}

const FrameCosts* Renderer::costs() const { return impl_->queries ? &impl_->costs : nullptr; }

void Renderer::Impl::name_pipelines(FramePlan& plan) const {
  MadePipelines unnamed = made;
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < pass_targets.size(); ++i) {
    Pass& pass = plan.passes[i];
    pass.pipelines.clear();
    if (pass.samples() > 1) pass.pipelines.push_back(describe_resolve(pass, unnamed.means));
    for (View& view : pass.views) {
      const ViewDraws& draw = draws.views()[drawn++];
      const auto runs = draws.runs().subspan(draw.first_run, draw.end_run - draw.first_run);
      view.pipelines = describe_pipelines(runs, pass, unnamed.meshes);
      view.levels = draw.levels;
    }
  }
}

void Renderer::Impl::name_memory(FramePlan& plan) const {
  buffers.name_memory(uploads, plan.memory);
  geometry.name_memory(uploads, plan.memory);
  const auto sampled = [this](VkDescriptorSet set) {
    return static_cast<std::uint64_t>(std::ranges::count(draws.runs(), set, &DrawRun::texture));
  };
  textures.name_memory(uploads, sampled, plan.memory);
  const auto user = [&](const RenderTarget& target) -> const Pass* {
    const auto found = std::ranges::find(pass_targets, &target);
    return found == pass_targets.end() ? nullptr : &plan.passes[static_cast<std::size_t>(found - pass_targets.begin())];
  };
  targets.name_memory(user, plan.memory);
  layers.name_memory(uploads, plan.memory);
  if (shadows) shadows->name_memory(uploads, plan.memory);
  if (sky) sky->name_memory(uploads, plan.memory);
}

// Discards the recorded commands. They never ran, so none of their data counts as uploaded.
void Renderer::Impl::forget() {
  commands.abandon();
  uploads.release();
  pass_targets.clear();
  draws.clear();
  table.clear();
  geometry.clear();
  textures.clear();
  buffers.clear();
  shadow_cache.clear();
  sky.reset();
}

}  // namespace simvis
