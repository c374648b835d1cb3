#include "sensors/camera/pixel_layers.h"

#include <limits>

#include <simvis/surface_point.h>
#include "engine/base/assert.h"
#include "sensors/camera/camera_outputs.h"
#include "sensors/camera/surface_layer.h"

namespace simvis {
namespace {

struct LayerOutput {
  const char *name, *unit, *meaning;
  ValueType type;
  double nothing;
};

constexpr LayerOutput kLayerOutputs[] = {
    {"layer_range", "m", "range of each layer along the ray through the pixel's centre, the nearest first",
     ValueType::f32, std::numeric_limits<double>::infinity()},
    {"layer_instance", "", "id of the object of each layer, as in objects.csv", ValueType::u32, 0},
    {"layer_transmission", "", "share of the layer's light that the layers before it let pass", ValueType::f32, 0}};

constexpr const char* kLayers = "layers";

template <typename T>
void start_layers(SharedArray<T>& image, std::size_t count, T value) {
  image.overwrite().assign(count, value);
}

}  // namespace

std::uint32_t wanted_layers(const AttributeValues& attributes) {
  return attributes.flag("outputs", kLayers) ? static_cast<std::uint32_t>(attributes.integer(kMaxLayersAttribute.name))
                                             : 0;
}

std::vector<OutputSpec> layer_outputs(const std::string& prefix, const AttributeValues& attributes) {
  std::vector<OutputSpec> outputs;
  for (const LayerOutput& output : kLayerOutputs) {
    outputs.push_back(
        {.name = prefix + output.name,
         .kind = OutputKind::image,
         .value_type = output.type,
         .shape = image_shape(attributes, static_cast<std::uint32_t>(attributes.integer(kMaxLayersAttribute.name))),
         .unit = output.unit,
         .meaning = output.meaning,
         .nothing = output.nothing,
         .when = std::string(kLayers) + " among outputs",
         .given = attributes.flag("outputs", kLayers)});
  }
  return outputs;
}

PixelLayers::PixelLayers(std::uint32_t layers, std::uint32_t width_px, std::uint32_t height_px)
    : layers_(layers), width_px_(width_px), height_px_(height_px) {}

void PixelLayers::begin(const DrawList& list, std::span<const std::uint32_t> instance) {
  list_ = &list;
  instance_ = instance;
  world_.set(first_.follow(list));
  const std::size_t count = std::size_t{width_px_} * height_px_ * layers_;
  start_layers(range_, count, std::numeric_limits<float>::infinity());
  start_layers(instances_, count, std::uint32_t{0});
  start_layers(transmission_, count, 0.0f);
}

void PixelLayers::cast(const PixelRows& rows, const PixelRays& rays, unsigned threads) {
  SIMVIS_ASSERT(list_ != nullptr);
  passing_.clear();
  for_tiled_pixels(rows.first, rows.count, width_px_, [&](std::uint32_t pixel) {
    if (rays.directions()[pixel] != glm::dvec3(0)) passing_.push_back({pixel, rays.near_range_m(pixel)});
  });
  const DrawList& first = world_.place(rows.places, threads);
  for (std::uint32_t layer = 0; layer < layers_ && !passing_.empty(); ++layer) {
    cast_layer(layer, first, rows.world_from_view, rays);
  }
}

// Afterwards those rays are left that go on behind this layer.
void PixelLayers::cast_layer(std::uint32_t layer, const DrawList& first, const glm::dmat4& world_from_view,
                             const PixelRays& rays) {
  directions_.clear();
  behind_m_.clear();
  for (const Passing& each : passing_) {
    directions_.push_back(rays.directions()[each.pixel]);
    behind_m_.push_back(each.behind_m);
  }
  met_.resize(passing_.size());
  surface_rays_.cast(world_.caster(), first, world_from_view, directions_, behind_m_, met_);
  std::vector<float>&ranges = range_.edit(), &transmissions = transmission_.edit();
  std::vector<std::uint32_t>& instances = instances_.edit();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < passing_.size(); ++i) {
    const SeenSurface& met = met_[i];
    if (met.item == kNoItem) continue;
    Passing ray = passing_[i];
    const std::size_t place = std::size_t{ray.pixel} * layers_ + layer;
    ranges[place] = static_cast<float>(met.range_m);
    instances[place] = instance_[met.item];
    transmissions[place] = ray.transmission;
    const double share = covered(first, met, world_from_view, directions_[i]);
    if (share > 1 - kAlphaHalfStep) continue;
    ray.transmission *= static_cast<float>(1 - share);
    // Faces that coincide have ranges that differ by their rounding, each by at most its bound.
    ray.behind_m = met.range_m + 2 * met.error_bound_m;
    passing_[kept++] = ray;
  }
  passing_.resize(kept);
}

// The share of what lies behind it that a surface covers.
double PixelLayers::covered(const DrawList& first, const SeenSurface& surface, const glm::dmat4& world_from_view,
                            const glm::dvec3& direction) const {
  const Material& material = *list_->materials[list_->items[surface.item].material];
  if (material.alpha_mode != AlphaMode::blend) return material.opacity;
  const RayHit hit{surface.range_m, surface.error_bound_m, surface.item, surface.primitive};
  const double alpha = surface_point(first, world_from_view, direction, hit).base_color.a;
  return alpha * material.opacity;
}

void PixelLayers::add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const {
  const MeasuredNumbers numbers[] = {range_, instances_, transmission_};
  for (std::size_t i = 0; i < std::size(kLayerOutputs); ++i) {
    const LayerOutput& output = kLayerOutputs[i];
    measurement.arrays.push_back(
        {{.name = prefix + output.name,
          .kind = OutputKind::image,
          .value_type = output.type,
          .shape = range_.empty() ? OutputShape{0, 0, layers_} : OutputShape{height_px_, width_px_, layers_},
          .unit = output.unit,
          .view = view},
         numbers[i]});
  }
}

}  // namespace simvis
