#include "engine/render/planned_pipeline.h"

#include <algorithm>
#include <bit>
#include <string>
#include <string_view>

#include "engine/draw/topology_name.h"
#include "engine/render/resolve_pass.h"

namespace simvis {
namespace {

using Surface = PipelineKey::Surface;

std::string_view to_string(Surface surface) {
  constexpr std::string_view kNames[] = {"opaque", "masked", "blended", "faded"};
  return kNames[static_cast<std::size_t>(surface)];
}

std::string_view what_is_drawn(Surface surface) {
  switch (surface) {
    case Surface::opaque:
      return "surfaces without holes";
    case Surface::masked:
      return "alpha decides which samples are covered";
    case Surface::blended:
      return "transparent surfaces, composited by depth";
    case Surface::faded:
      return "transparent surfaces with holes, composited by depth";
  }
  return "";
}

std::string lights_text(std::uint32_t lights) { return std::to_string(lights) + (lights == 1 ? " light" : " lights"); }

std::string variant_of(const PipelineKey& key) {
  std::string text = key.depth_only ? "depth" : "colour";
  if (key.depth_only && key.color) text += " only, in a pass of colour";
  text += ", " + std::string(name_of(key.topology)) + ", " + std::string(to_string(key.surface));
  if (key.textured) text += ", textured";
  if (key.unlit) text += ", unlit";
  if (key.lights.any()) text += ", " + lights_text(key.lights.all());
  if (key.glossy) text += key.metallic ? ", metallic" : ", glossy";
  if (key.maps != 0) text += ", " + std::to_string(std::popcount(key.maps)) + " maps";
  if (key.shadowed) text += ", shadowed";
  if (key.shadow_map) text += key.orthographic ? ", for an orthographic shadow map" : ", for a shadow map";
  if (key.fog) text += ", in fog";
  if (key.cull_back) text += ", back faces culled";
  if (key.mirrored) text += ", mirrored";
  if (key.items) text += ", with items";
  if (key.cpu_selected) text += ", selected on the CPU";
  if (key.samples > 1) text += ", msaa " + std::to_string(key.samples);
  return text;
}

std::string reason_for(const PipelineKey& key) {
  std::string text(what_is_drawn(key.surface));
  if (key.items) return text + ": the pixel's item is written";
  if (key.depth_only) return text + (key.shades() ? "" : ": no fragment shader");
  if (key.unlit) return text + ", unlit";
  return text + (key.lights.any() ? ", lit by " + lights_text(key.lights.all()) : ", in ambient light");
}

}  // namespace

std::vector<PlannedPipeline> describe_pipelines(std::span<const DrawRun> runs, const Pass& pass,
                                                std::vector<std::uint64_t>& made) {
  std::vector<PlannedPipeline> planned;
  std::vector<std::uint64_t> known;  // planned[i] has the key known[i]
  for (const DrawRun& run : runs) {
    PipelineKey key = run.key;
    key.samples = static_cast<std::uint8_t>(pass.msaa);
    const auto place = static_cast<std::size_t>(std::ranges::find(known, key.bits()) - known.begin());
    if (place == known.size()) {
      known.push_back(key.bits());
      planned.push_back({.variant = variant_of(key),
                         .reason = reason_for(key),
                         .shades = key.shades(),
                         .made = std::erase(made, key.bits()) > 0});
    }
    ++planned[place].draws;
    planned[place].triangles += run.triangles();
  }
  return planned;
}

PlannedPipeline describe_resolve(const Pass& pass, std::vector<std::uint32_t>& made) {
  return {
      .variant = "resolve, supersampling " + std::to_string(pass.supersampling) + ", msaa " + std::to_string(pass.msaa),
      .reason = std::to_string(pass.samples()) + " samples of each pixel",
      .made = std::erase(made, ResolvePass::pipeline_key(pass)) > 0};
}

}  // namespace simvis
