#include "sensors/camera/pixel_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <simvis/pose.h>
#include "sensors/camera/camera_outputs.h"

namespace simvis {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN(),
                 kFarAway = std::numeric_limits<double>::infinity();

constexpr double kFloatRounding = 0x1p-24;  // relative error of a depth that is stored as float32

// One output of each view.
struct TruthOutput {
  const char *name, *unit, *frame, *meaning;
  bool TruthDesc::*wanted;
  std::uint32_t channels;
  ValueType type;
  double nothing;
};

constexpr TruthOutput kTruthOutputs[] = {
    {"instance", "", "", "id of the item at the pixel's centre, as in instances.csv", &TruthDesc::instance, 1,
     ValueType::u32, 0},
    {"semantic", "", "", "id of its class, as elements of type label say; 0: none", &TruthDesc::semantic, 1,
     ValueType::u32, 0},
    {"range", "m", "", "range along the ray through the pixel's centre", &TruthDesc::range, 1, ValueType::f32,
     kFarAway},
    {"normal", "", "optical", "normal of the triangle, unit length, towards the camera", &TruthDesc::normal, 3,
     ValueType::f32, kNoNumber},
    {"object_coordinates", "m", "mesh", "the point in the frame of the item's mesh", &TruthDesc::coordinates, 3,
     ValueType::f32, kNoNumber},
    {"depth_error_bound", "m", "", "largest error of the pixel's depth; inf: it has no bound", &TruthDesc::bound, 1,
     ValueType::f32, kFarAway},
};

template <typename T>
void fill(SharedArray<T>& image, std::size_t count, T value) {
  image.overwrite().assign(count, value);
}

// From the frame of a view to that of the item's mesh, for pixel after pixel.
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
    mesh_from_view_ = glm::inverse(world_from_mesh) * world_from_view_;
    return mesh_from_view_;
  }

 private:
  const DrawList& list_;
  glm::dmat4 world_from_view_, mesh_from_view_{1.0};
  std::span<const ItemPlace> places_;
  std::uint32_t item_ = kNoItem;
};

// Of the depth that is stored for a surface that a ray has met.
double depth_bound(const SeenSurface& surface, const glm::dvec3& direction) {
  return std::abs(direction.z) * (surface.error_bound_m + kFloatRounding * surface.range_m);
}

// A bound stays one when it is stored.
float rounded_up(double bound) {
  const auto rounded = static_cast<float>(bound);
  return static_cast<double>(rounded) < bound ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                              : rounded;
}

void put(std::vector<float>& image, std::size_t pixel, const glm::dvec3& value) {
  for (int c = 0; c < 3; ++c) image[3 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(value[c]);
}

}  // namespace

TruthDesc truth_desc(const AttributeValues& attributes, bool measures_depth) {
  TruthDesc desc;
  for (const TruthOutput& output : kTruthOutputs) desc.*output.wanted = attributes.flag("outputs", output.name);
  if (desc.bound && !attributes.flag("outputs", "depth")) {
    fail_at(attributes.where("outputs"), "attribute \"outputs\": depth_error_bound needs depth, expected both");
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
  for (const TruthOutput& output : kTruthOutputs) {
    outputs.push_back({.name = prefix + output.name,
                       .kind = OutputKind::image,
                       .value_type = output.type,
                       .shape = image_shape(attributes, output.channels),
                       .unit = output.unit,
                       .frame = output.frame,
                       .meaning = output.meaning,
                       .nothing = output.nothing,
                       .when = std::string(output.name) + " among outputs",
                       .given = attributes.flag("outputs", output.name)});
  }
  return outputs;
}

PixelTruth::PixelTruth(const TruthDesc& desc, std::uint32_t width_px, std::uint32_t height_px)
    : desc_(desc), width_px_(width_px), height_px_(height_px) {}

void PixelTruth::begin() {
  const std::size_t pixels = std::size_t{width_px_} * height_px_;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kFar = std::numeric_limits<float>::infinity();
  if (desc_.instance) fill(instance_, pixels, std::uint32_t{0});
  if (desc_.semantic) fill(semantic_, pixels, std::uint32_t{0});
  if (desc_.range) fill(range_, pixels, kFar);
  if (desc_.normal) fill(normal_, 3 * pixels, kNone);
  if (desc_.coordinates) fill(coordinates_, 3 * pixels, kNone);
  if (desc_.bound) fill(bound_, pixels, kFar);
  if (!desc_.boxes) return;
  items_.width_px = width_px_;
  items_.item.assign(pixels, kNoItem);
  items_.range_m.assign(pixels, kFar);
}

void PixelTruth::read(const Pass& pass, const View& view, const PassResult& result, const IdentifiedList& world,
                      std::uint32_t first_row) {
  MeshFrames frames(world.list, rigid_inverse(view.view_from_world), view.places);
  std::vector<std::uint32_t>&instances = instance_.edit(), &classes = semantic_.edit();
  std::vector<float>&ranges = range_.edit(), &coordinates = coordinates_.edit();
  const Pinhole& p = view.pinhole;
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const std::size_t from = std::size_t{view.y_px + row} * pass.width_px + view.x_px,
                      to = std::size_t{first_row + row} * width_px_;
    const double ty = (row + 0.5 - p.cy_px) / p.fy_px;
    for (std::uint32_t column = 0; column < view.width_px; ++column) {
      const float d = result.depth[from + column];
      if (!(d > 0)) continue;
      const std::size_t pixel = to + column;
      const double z = view.near_m / static_cast<double>(d), tx = (column + 0.5 - p.cx_px) / p.fx_px;
      const auto range_m = static_cast<float>(z * std::sqrt(1 + tx * tx + ty * ty));
      if (desc_.range) ranges[pixel] = range_m;
      if (!desc_.needs_items()) continue;
      const std::uint32_t item = result.item_of(from + column);
      if (desc_.boxes) {
        items_.item[pixel] = item;
        items_.range_m[pixel] = range_m;
      }
      if (desc_.instance) instances[pixel] = world.ids.instance[item];
      if (desc_.semantic) classes[pixel] = world.ids.semantic[item];
      if (desc_.coordinates) {
        put(coordinates, pixel, glm::dvec3(frames.mesh_from_view(item) * glm::dvec4(tx * z, ty * z, z, 1)));
      }
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
  std::vector<std::uint32_t>&instances = instance_.edit(), &classes = semantic_.edit();
  std::vector<float>&ranges = range_.edit(), &normals = normal_.edit(), &coordinates = coordinates_.edit(),
  &bounds = bound_.edit();
  for (const std::uint32_t pixel : pixels) {
    const SeenSurface& surface = seen[pixel];
    if (surface.item == kNoItem) {
      forget(pixel);
      continue;
    }
    if (desc_.instance) instances[pixel] = world.ids.instance[surface.item];
    if (desc_.semantic) classes[pixel] = world.ids.semantic[surface.item];
    if (desc_.range) ranges[pixel] = static_cast<float>(surface.range_m);
    if (desc_.boxes) {
      items_.item[pixel] = surface.item;
      items_.range_m[pixel] = static_cast<float>(surface.range_m);
    }
    if (desc_.normal) put(normals, pixel, surface.normal);
    const glm::dvec3 point_m = surface.range_m * directions[pixel];
    if (desc_.coordinates) {
      put(coordinates, pixel, glm::dvec3(frames.mesh_from_view(surface.item) * glm::dvec4(point_m, 1)));
    }
    if (desc_.bound) bounds[pixel] = rounded_up(depth_bound(surface, directions[pixel]));
  }
}

// The pixel sees nothing.
void PixelTruth::forget(std::size_t pixel) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const glm::dvec3 nothing(kNoNumber);
  if (desc_.instance) instance_.edit()[pixel] = 0;
  if (desc_.semantic) semantic_.edit()[pixel] = 0;
  if (desc_.range) range_.edit()[pixel] = kFar;
  if (desc_.normal) put(normal_.edit(), pixel, nothing);
  if (desc_.coordinates) put(coordinates_.edit(), pixel, nothing);
  if (desc_.bound) bound_.edit()[pixel] = kFar;
  if (desc_.boxes) items_.item[pixel] = kNoItem;
}

void PixelTruth::cover(std::uint32_t pixel, std::uint32_t item, double range_m, const IdentifiedList& world) {
  forget(pixel);
  if (desc_.instance) instance_.edit()[pixel] = world.ids.instance[item];
  if (desc_.semantic) semantic_.edit()[pixel] = world.ids.semantic[item];
  if (desc_.range) range_.edit()[pixel] = static_cast<float>(range_m);
}

void PixelTruth::read_bounds(const Image& depth, const DepthView& view, std::uint32_t first_row, std::uint32_t rows) {
  const auto first = depth.pixels.begin() + std::ptrdiff_t{first_row} * width_px_;
  const Image part{width_px_, rows, 1, std::vector(first, first + std::ptrdiff_t{rows} * width_px_)};
  std::vector<float>& bounds = bound_.edit();
  std::size_t pixel = std::size_t{first_row} * width_px_;
  for (const double bound_m : depth_error_bounds(part, view)) bounds[pixel++] = rounded_up(bound_m);
}

void PixelTruth::add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const {
  const MeasuredNumbers numbers[] = {instance_, semantic_, range_, normal_, coordinates_, bound_};
  for (std::size_t i = 0; i < std::size(kTruthOutputs); ++i) {
    const TruthOutput& output = kTruthOutputs[i];
    if (!(desc_.*output.wanted)) continue;
    const bool measured = std::visit([](const auto& all) { return !all.empty(); }, numbers[i]);
    measurement.arrays.push_back(
        {{.name = prefix + output.name,
          .kind = OutputKind::image,
          .value_type = output.type,
          .shape = measured ? OutputShape{height_px_, width_px_, output.channels} : OutputShape{0, 0, output.channels},
          .unit = output.unit,
          .view = view},
         numbers[i]});
  }
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
    bound_m = std::max(bound_m, depth_bound(surface, directions[pixel]));
  }
  return bound_m;
}

}  // namespace simvis
