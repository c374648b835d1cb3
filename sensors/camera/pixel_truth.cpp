#include "sensors/camera/pixel_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numeric>

#include <simvis/pose.h>
#include "sensors/camera/camera_outputs.h"

namespace simvis {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN(),
                 kFarAway = std::numeric_limits<double>::infinity();

constexpr double kFloatRounding = 0x1p-24;  // relative error of a depth that is stored as float32

const glm::dvec3 kNoNormal(kNoNumber);

MeasuredNumbers numbers_of_type(ValueType type) {
  switch (type) {
    case ValueType::f64:
      return SharedArray<double>();
    case ValueType::u8:
      return SharedArray<std::uint8_t>();
    case ValueType::u32:
      return SharedArray<std::uint32_t>();
    case ValueType::i32:
      return SharedArray<std::int32_t>();
    default:
      return SharedArray<float>();
  }
}

void put(MeasuredNumbers& numbers, std::size_t first, std::span<const double> values) {
  std::visit(
      [&]<typename T>(SharedArray<T>& all) {
        std::ranges::transform(values, all.edit().begin() + static_cast<std::ptrdiff_t>(first),
                               [](double value) { return static_cast<T>(value); });
      },
      numbers);
}

// From the frame of a view to that of the item's mesh in metres, for pixel after pixel.
class MeshFrames {
 public:
  MeshFrames(const DrawList& list, const glm::dmat4& world_from_view, std::span<const ItemPlace> places)
      : list_(list), world_from_view_(world_from_view), places_(places) {}

  const glm::dmat4& mesh_from_view(std::uint32_t item) {
    if (item == item_) return mesh_from_view_;
    item_ = item;
    const auto place = std::ranges::lower_bound(places_, item, {}, &ItemPlace::item);
    const bool moved = place != places_.end() && place->item == item;
    const glm::dmat4& world_from_mesh =
        moved ? place->world_from_mesh : list_.world_from_node[list_.items[item].transform];
    const glm::dmat3 axes(world_from_mesh);
    const glm::dvec3 unit_m(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
    mesh_from_view_ = glm::scale(glm::dmat4(1), unit_m) * glm::inverse(world_from_mesh) * world_from_view_;
    return mesh_from_view_;
  }

 private:
  const DrawList& list_;
  glm::dmat4 world_from_view_, mesh_from_view_{1.0};
  std::span<const ItemPlace> places_;
  std::uint32_t item_ = kNoItem;
};

}  // namespace

TruthDesc truth_desc(const AttributeValues& attributes, bool measures_depth) {
  TruthDesc desc;
  for (const SurfaceOutputType* type : surface_outputs()) {
    if (!attributes.flag("outputs", type->name)) continue;
    desc.surfaces.push_back(type);
    if ((type->needs & kSurfaceDepthBound) == 0 || attributes.flag("outputs", "depth")) continue;
    fail_at(attributes.where("outputs"),
            "attribute \"outputs\": " + std::string(type->name) + " needs depth, expected both");
  }
  desc.boxes = attributes.flag("outputs", "boxes");
  desc.silhouettes = attributes.flag("outputs", "silhouettes");
  if (desc.silhouettes && !desc.boxes) {
    fail_at(attributes.where("outputs"), "attribute \"outputs\": silhouettes needs boxes, expected both");
  }
  desc.flow = flow_desc(attributes);
  desc.layers = wanted_layers(attributes);
  desc.layer = surface_layer(attributes, measures_depth || desc.of_surfaces() || desc.flow.any());
  return desc;
}

std::vector<OutputSpec> truth_outputs(const std::string& prefix, const AttributeValues& attributes) {
  std::vector<OutputSpec> outputs;
  for (const SurfaceOutputType* type : surface_outputs()) {
    const std::string name(type->name);
    outputs.push_back({.name = prefix + name,
                       .kind = OutputKind::image,
                       .value_type = type->value_type,
                       .shape = image_shape(attributes, type->channels),
                       .unit = std::string(type->unit),
                       .frame = std::string(type->frame),
                       .meaning = std::string(type->meaning),
                       .nothing = type->nothing,
                       .when = name + " among outputs",
                       .given = attributes.flag("outputs", name)});
  }
  return outputs;
}

PixelTruth::PixelTruth(const TruthDesc& desc, std::uint32_t width_px, std::uint32_t height_px)
    : desc_(desc), width_px_(width_px), height_px_(height_px) {
  for (const SurfaceOutputType* type : desc.surfaces) outputs_.push_back({type, numbers_of_type(type->value_type)});
}

void PixelTruth::begin() {
  const std::size_t pixels = std::size_t{width_px_} * height_px_;
  for (Output& output : outputs_) {
    std::visit(
        [&]<typename T>(SharedArray<T>& all) {
          all.overwrite().assign(pixels * output.type->channels, static_cast<T>(output.type->nothing));
        },
        output.numbers);
  }
  if (!desc_.boxes) return;
  items_.width_px = width_px_;
  items_.item.assign(pixels, kNoItem);
  items_.range_m.assign(pixels, std::numeric_limits<float>::infinity());
}

void PixelTruth::set(std::size_t pixel, const PixelSurface& surface) {
  std::array<double, kMaxSurfaceChannels> values{};
  for (Output& output : outputs_) {
    const std::span<double> own = std::span(values).first(output.type->channels);
    output.type->fill(surface, own);
    put(output.numbers, pixel * output.type->channels, own);
  }
}

// The pixel sees nothing.
void PixelTruth::forget(std::size_t pixel) {
  std::array<double, kMaxSurfaceChannels> values{};
  for (Output& output : outputs_) {
    values.fill(output.type->nothing);
    put(output.numbers, pixel * output.type->channels, std::span(values).first(output.type->channels));
  }
  if (desc_.boxes) items_.item[pixel] = kNoItem;
}

void PixelTruth::read(const Pass& pass, const View& view, const PassResult& result, const IdentifiedList& world,
                      std::uint32_t first_row, std::span<const double> depth_bounds_m) {
  MeshFrames frames(world.list, rigid_inverse(view.view_from_world), view.places);
  const bool needs_items = desc_.needs_items(), needs_mesh = desc_.needs(kSurfaceMesh);
  const Pinhole& p = view.pinhole;
  PixelSurface surface{.list = world.list, .ids = world.ids, .normal = kNoNormal, .depth_bound_m = kFarAway};
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const std::size_t from = std::size_t{view.y_px + row} * pass.width_px + view.x_px,
                      to = std::size_t{first_row + row} * width_px_;
    const double ty = (row + 0.5 - p.cy_px) / p.fy_px;
    for (std::uint32_t column = 0; column < view.width_px; ++column) {
      const float d = result.depth[from + column];
      if (!(d > 0)) continue;
      const std::size_t pixel = to + column;
      const double z = view.near_m / static_cast<double>(d), tx = (column + 0.5 - p.cx_px) / p.fx_px;
      surface.range_m = z * std::sqrt(1 + tx * tx + ty * ty);
      surface.point_m = {tx * z, ty * z, z};
      if (needs_items) surface.item = result.item_of(from + column);
      if (needs_mesh) surface.mesh_from_view = &frames.mesh_from_view(surface.item);
      if (!depth_bounds_m.empty()) surface.depth_bound_m = depth_bounds_m[std::size_t{row} * width_px_ + column];
      set(pixel, surface);
      if (!desc_.boxes) continue;
      items_.item[pixel] = surface.item;
      items_.range_m[pixel] = static_cast<float>(surface.range_m);
    }
  }
}

void PixelTruth::read(const PixelRows& rows, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
                      const IdentifiedList& world) {
  std::vector<std::uint32_t> pixels(std::size_t{rows.count} * width_px_);
  std::iota(pixels.begin(), pixels.end(), rows.first * width_px_);
  read(rows, pixels, directions, seen, world);
}

void PixelTruth::read(const PixelRows& rows, std::span<const std::uint32_t> pixels,
                      std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
                      const IdentifiedList& world) {
  MeshFrames frames(world.list, rows.world_from_view, rows.places);
  const bool needs_mesh = desc_.needs(kSurfaceMesh);
  for (const std::uint32_t pixel : pixels) {
    const SeenSurface& met = seen[pixel];
    if (met.item == kNoItem) {
      forget(pixel);
      continue;
    }
    set(pixel, {.list = world.list,
                .ids = world.ids,
                .item = met.item,
                .range_m = met.range_m,
                .point_m = met.range_m * directions[pixel],
                .normal = met.normal,
                .depth_bound_m = cast_depth_bound(met, directions[pixel]),
                .mesh_from_view = needs_mesh ? &frames.mesh_from_view(met.item) : nullptr});
    if (!desc_.boxes) continue;
    items_.item[pixel] = met.item;
    items_.range_m[pixel] = static_cast<float>(met.range_m);
  }
}

// A splat has no surface of a mesh, and is no object of the table.
void PixelTruth::cover(std::uint32_t pixel, std::uint32_t item, double range_m, const glm::dvec3& direction,
                       const IdentifiedList& world) {
  forget(pixel);
  set(pixel, {.list = world.list,
              .ids = world.ids,
              .item = item,
              .range_m = range_m,
              .point_m = range_m * direction,
              .normal = kNoNormal,
              .depth_bound_m = kFarAway});
}

void PixelTruth::add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const {
  for (const Output& output : outputs_) {
    const SurfaceOutputType& type = *output.type;
    const bool measured = std::visit([](const auto& all) { return !all.empty(); }, output.numbers);
    measurement.arrays.push_back(
        {{.name = prefix + std::string(type.name),
          .kind = OutputKind::image,
          .value_type = type.value_type,
          .shape = measured ? OutputShape{height_px_, width_px_, type.channels} : OutputShape{0, 0, type.channels},
          .unit = std::string(type.unit),
          .view = view},
         output.numbers});
  }
}

double cast_depth_bound(const SeenSurface& surface, const glm::dvec3& direction) {
  return std::abs(direction.z) * (surface.error_bound_m + kFloatRounding * surface.range_m);
}

double cast_depth(const PixelRows& rows, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen,
                  std::uint32_t width_px, std::vector<float>& depth) {
  double bound_m = 0;
  const std::size_t end = std::size_t{rows.first + rows.count} * width_px;
  for (std::size_t pixel = std::size_t{rows.first} * width_px; pixel < end; ++pixel) {
    const SeenSurface& surface = seen[pixel];
    depth[pixel] = std::numeric_limits<float>::infinity();
    if (surface.item == kNoItem) continue;
    depth[pixel] = static_cast<float>(surface.range_m * directions[pixel].z);
    bound_m = std::max(bound_m, cast_depth_bound(surface, directions[pixel]));
  }
  return bound_m;
}

}  // namespace simvis
