#include "engine/renderer.h"

#include <algorithm>

#include "engine/assert.h"
#include "engine/device.h"
#include "engine/draw_table.h"
#include "engine/error.h"
#include "engine/frame_buffers.h"
#include "engine/frame_commands.h"
#include "engine/frame_draws.h"
#include "engine/frame_recorder.h"
#include "engine/geometry_pool.h"
#include "engine/pipelines.h"
#include "engine/render_targets.h"
#include "engine/sample_average.h"
#include "engine/texture_store.h"
#include "engine/transparent_layers.h"
#include "engine/uploads.h"

namespace simvis {
namespace {

void check_view(const View& view, const Pass& pass) {
  SIMVIS_ASSERT(view.width_px > 0 && view.height_px > 0);
  SIMVIS_ASSERT(std::uint64_t{view.x_px} + view.width_px <= pass.width_px);
  SIMVIS_ASSERT(std::uint64_t{view.y_px} + view.height_px <= pass.height_px);
  SIMVIS_ASSERT(view.near_m > 0 && view.pinhole.fx_px != 0 && view.pinhole.fy_px != 0);
}

void check_pass(const Pass& pass, const TargetLimits& limits) {
  SIMVIS_ASSERT(pass.width_px > 0 && pass.height_px > 0);
  SIMVIS_ASSERT(pass.color || pass.depth);
  SIMVIS_ASSERT(pass.grid == 1 || pass.grid == 2 || pass.grid == 4);
  SIMVIS_ASSERT(pass.samples() == 1 || (pass.color && !pass.depth));
  const std::uint32_t width = limits.width_px / pass.grid, height = limits.height_px / pass.grid;
  if (pass.width_px > width || pass.height_px > height) {
    throw InputError("pass \"" + pass.name + "\" has " + std::to_string(pass.width_px) + " x " +
                     std::to_string(pass.height_px) + " pixels" +
                     (pass.grid > 1 ? " of " + std::to_string(pass.grid * pass.grid) + " samples" : "") +
                     "; this device allows " + std::to_string(width) + " x " + std::to_string(height));
  }
  if (std::ranges::find(limits.msaa, pass.msaa) == limits.msaa.end()) {
    throw InputError("pass \"" + pass.name + "\" asks for msaa " + std::to_string(pass.msaa) +
                     "; this device allows up to " + std::to_string(limits.msaa.back()));
  }
  for (const View& view : pass.views) check_view(view, pass);
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(Device::Impl& d)
      : device(d),
        commands(d),
        uploads(d),
        pipelines(d),
        geometry(d),
        textures(d, pipelines.texture_set_layout()),
        buffers(d, pipelines.frame_set_layout()),
        average(d),
        layers(d, pipelines),
        targets(d, pipelines, average) {}

  void draw_frame(const DrawList& list, const FramePlan& plan);
  void prepare(const DrawList& list, const FramePlan& plan);
  void record(VkCommandBuffer commands, const DrawList& list, const FramePlan& plan);
  void collect(const FramePlan& plan);
  void forget();

  Device::Impl& device;
  FrameCommands commands;
  Uploads uploads;
  Pipelines pipelines;
  GeometryPool geometry;
  TextureStore textures;
  FrameBuffers buffers;
  SampleAverage average;
  TransparentLayers layers;
  RenderTargets targets;
  DrawTable table;
  FrameDraws draws;
  std::vector<RenderTarget*> pass_targets;
  std::vector<PassResult> results;
  std::vector<ViewCounts> view_counts;  // of all passes' views, in order
  FrameCounters counters;
};

Renderer::Renderer(Device& device) : impl_(std::make_unique<Impl>(device.impl())) {}
Renderer::~Renderer() = default;
const FrameCounters& Renderer::counters() const { return impl_->counters; }

std::span<const PassResult> Renderer::render(const DrawList& list, const FramePlan& plan) {
  Impl& r = *impl_;
  for (const Pass& pass : plan.passes) check_pass(pass, r.device.physical.targets);
  r.counters = {};
  r.results.clear();
  if (plan.passes.empty()) return {};
  try {
    do {
      r.draw_frame(list, plan);
    } while (r.layers.grow());
  } catch (...) {
    r.forget();
    throw;
  }
  r.collect(plan);
  return r.results;
}

void Renderer::Impl::draw_frame(const DrawList& list, const FramePlan& plan) {
  const VkCommandBuffer recorded = commands.begin();
  uploads.begin(recorded);
  prepare(list, plan);
  uploads.finish();
  record(recorded, list, plan);
  commands.submit_and_wait();
  uploads.release();
  counters.bytes_uploaded += uploads.bytes();
  counters.layers = layers.found();
  counters.layer_bytes = layers.bytes();
  geometry.count(counters.meshes_held, counters.mesh_bytes);
  textures.count(counters.textures_held, counters.texture_bytes);
}

void Renderer::Impl::prepare(const DrawList& list, const FramePlan& plan) {
  const bool color = std::any_of(plan.passes.begin(), plan.passes.end(), [](const Pass& p) { return p.color; });
  table.update(list, color, geometry, textures, uploads);
  buffers.write_materials(list, table.materials_read(), uploads);
  draws.clear();
  for (const Pass& pass : plan.passes) {
    for (const View& view : pass.views) draws.add(view, pass, list, table, counters);
  }
  buffers.write_instances(draws.instances(), uploads);
  buffers.write_indices(draws.indices(), uploads);
  buffers.write_lights(draws.lights(), uploads);
}

void Renderer::Impl::record(VkCommandBuffer recorded, const DrawList& list, const FramePlan& plan) {
  targets.begin_frame();
  pass_targets.clear();
  for (const Pass& pass : plan.passes) pass_targets.push_back(&targets.acquire(pass));

  std::vector<const Pass*> layered;
  std::size_t first_view = 0;
  for (const Pass& pass : plan.passes) {
    if (shows_layers(draws.views().subspan(first_view, pass.views.size()))) layered.push_back(&pass);
    first_view += pass.views.size();
  }
  layers.begin_frame(layered);

  const FrameContext frame{.device = device,
                           .commands = recorded,
                           .pipelines = pipelines,
                           .average = average,
                           .layers = layers,
                           .geometry = geometry,
                           .frame_set = buffers.set(),
                           .instances = buffers.instances(),
                           .frame_indices = buffers.indices(),
                           .draws = draws,
                           .list = list,
                           .counters = counters};
  record_bindings(frame);
  first_view = 0;
  for (std::size_t i = 0; i < plan.passes.size(); ++i) {
    const std::size_t count = plan.passes[i].views.size();
    record_pass(frame, plan.passes[i], *pass_targets[i], draws.views().subspan(first_view, count));
    first_view += count;
  }
  for (std::size_t i = 0; i < plan.passes.size(); ++i) record_readback(frame, plan.passes[i], *pass_targets[i]);
  record_end(frame);
}

void Renderer::Impl::collect(const FramePlan& plan) {
  view_counts.clear();
  for (const ViewDraws& view : draws.views()) view_counts.push_back(view.counts);
  std::size_t first_view = 0;
  for (std::size_t i = 0; i < plan.passes.size(); ++i) {
    const Pass& pass = plan.passes[i];
    const RenderTarget& target = *pass_targets[i];
    const std::size_t pixels = std::size_t{pass.width_px} * pass.height_px;
    PassResult& result = results.emplace_back();
    if (pass.depth) result.depth = {reinterpret_cast<const float*>(target.depth_readback.mapped()), pixels};
    if (pass.color) result.color = {reinterpret_cast<const glm::vec4*>(target.color_readback.mapped()), pixels};
    result.snap_px = device.physical.snap_px;
    result.depth_snap_px = device.physical.depth_snap_px;
    result.views = std::span(view_counts).subspan(first_view, pass.views.size());
    first_view += pass.views.size();
  }
}

// What was recorded never ran: nothing of it counts as uploaded.
void Renderer::Impl::forget() {
  commands.abandon();
  uploads.release();
  table.clear();
  geometry.clear();
  textures.clear();
  buffers.clear();
}

}  // namespace simvis
