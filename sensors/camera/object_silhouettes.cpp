#include "sensors/camera/object_silhouettes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_set>

#include "engine/draw/solid_cloud.h"

namespace simvis {
namespace {

// By how much a box is larger than its mesh, as a share of the distances that are rounded: those of the camera from the
// box and of the box from its frame.
constexpr double kBoxRounding = 1e-12;

// By how much what a pixel shows must be behind a box to be certainly behind it, as a share of its range. Drawn depths
// and the vertices that are drawn are float32, wrong by 2^-24 of the distance each, which a slanted surface multiplies:
// this covers slants to 85 degrees. A pixel that is nearer to the box takes a ray.
constexpr double kDrawnRounding = 2e-6;

/// A mesh's box in the mesh frame, as the pixels of a view see it.
class SeenBox {
 public:
  SeenBox(const Mesh& mesh, const glm::dmat4& mesh_from_view)
      : eye_(mesh_from_view[3]), mesh_from_view_(mesh_from_view) {
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    const double pad = kBoxRounding * (glm::length(eye_) + std::max(glm::length(low), glm::length(high)));
    low_ = low - pad - eye_;
    high_ = high + pad - eye_;
    const glm::dmat4 view_from_mesh = glm::inverse(mesh_from_view);
    centre_ = glm::dvec3(view_from_mesh * glm::dvec4((low + high) / 2.0, 1));
    for (std::size_t corner = 0; corner < corners_.size(); ++corner) {
      const glm::dvec3 at((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                          (corner & 4) != 0 ? high.z : low.z);
      corners_[corner] = glm::dvec3(view_from_mesh * glm::dvec4(at, 1));
      radius_ = std::max(radius_, glm::length(corners_[corner] - centre_));
    }
  }

  /// Its corners: V.
  const std::array<glm::dvec3, 8>& corners() const { return corners_; }
  /// No point of it is farther from the camera.
  double ends_at_m() const { return (glm::length(centre_) + radius_) * (1 + kBoxRounding); }

  /// Whether a direction of the cone may meet the box.
  bool may_be_in(const PixelCanvas::Tile& tile) const {
    const double distance = glm::length(centre_);
    if (distance <= radius_ * (1 + kBoxRounding)) return true;
    const double half_angle = std::asin(radius_ / distance),
                 between = std::acos(std::clamp(glm::dot(centre_, tile.axis) / distance, -1.0, 1.0));
    return between <= half_angle + tile.angle_rad + kAngleRounding_rad;
  }

  /// The range at which a ray leaves the box; empty: it does not meet it.
  std::optional<double> leaves_at_m(const glm::dvec3& direction) const {
    const glm::dvec3 along = glm::dmat3(mesh_from_view_) * direction;
    double first = 0, last = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (along[axis] == 0) {
        if (low_[axis] > 0 || high_[axis] < 0) return std::nullopt;
        continue;
      }
      const double a = low_[axis] / along[axis], b = high_[axis] / along[axis];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
    return first <= last * (1 + kBoxRounding) ? std::optional(last) : std::nullopt;
  }

 private:
  static constexpr double kAngleRounding_rad = 1e-7;  // acos loses half of a double's digits near 0
  glm::dvec3 eye_, low_{0}, high_{0}, centre_{0};     // low and high from the eye
  std::array<glm::dvec3, 8> corners_{};
  glm::dmat4 mesh_from_view_;
  double radius_ = 0;
};

}  // namespace

void PixelSet::add(int x, int y) {
  if (pixels++ == 0) {
    rect = {x, y, x + 1, y + 1};
    return;
  }
  rect = {std::min(rect.x_begin, x), std::min(rect.y_begin, y), std::max(rect.x_end, x + 1),
          std::max(rect.y_end, y + 1)};
}

void PixelSet::add_run(int x_begin, int x_end, int y) {
  const CanvasRect run{x_begin, y, x_end, y + 1};
  rect = pixels == 0 ? run
                     : CanvasRect{std::min(rect.x_begin, run.x_begin), std::min(rect.y_begin, run.y_begin),
                                  std::max(rect.x_end, run.x_end), std::max(rect.y_end, run.y_end)};
  pixels += static_cast<std::uint64_t>(x_end - x_begin);
}

void ObjectSilhouettes::begin(const DrawList& list, unsigned threads) {
  threads_ = threads;
  if (list.meshes == meshes_) return;
  meshes_ = list.meshes;
  std::unordered_set<const Mesh*> there;
  for (const std::shared_ptr<const Mesh>& mesh : meshes_) there.insert(mesh.get());
  std::erase_if(alone_, [&](const auto& each) {
    const bool is_gone = !there.contains(each.first);
    if (is_gone) dropped_meshes_built_ += each.second.caster->counters().meshes_built;
    return is_gone;
  });
}

std::uint64_t ObjectSilhouettes::meshes_built() const {
  std::uint64_t built = dropped_meshes_built_;
  for (const auto& [mesh, alone] : alone_) built += alone.caster->counters().meshes_built;
  return built;
}

Silhouette ObjectSilhouettes::find(const DrawList& list, std::uint32_t object, std::span<const std::uint32_t> items,
                                   const Shown& shown, const PixelSet& visible, std::span<std::uint8_t> mask) {
  Silhouette silhouette{visible, visible, visible};
  const CanvasRect canvas = canvas_.canvas();
  if (items.size() > 1) is_found_.resize(place(canvas.x_end - 1, canvas.y_end - 1) + 1);
  for (std::size_t i = 0; i < items.size(); ++i) {
    notes_found_ = i + 1 < items.size();
    find_item(list, items[i], object, shown, silhouette, mask);
  }
  for (const std::size_t pixel : found_) is_found_[pixel] = false;
  found_.clear();
  return silhouette;
}

// Adds the pixels that would show the item, without those that the object has already.
void ObjectSilhouettes::find_item(const DrawList& list, std::uint32_t item, std::uint32_t object, const Shown& shown,
                                  Silhouette& silhouette, std::span<std::uint8_t> mask) {
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  if (!(mesh.topology == Topology::triangles || is_solid_cloud(mesh)) || mesh.indices.empty()) return;
  for (const PixelRows& each : shown.rows) {
    const auto place = std::ranges::find(each.places, item, &ItemPlace::item);
    const glm::dmat4& world_from_mesh =
        place != each.places.end() ? place->world_from_mesh : list.world_from_node[list.items[item].transform];
    const bool is_first = &each == &shown.rows.front(), is_last = &each == &shown.rows.back();
    const Rows rows{is_first ? canvas_.canvas().y_begin : static_cast<int>(each.first),
                    is_last ? canvas_.canvas().y_end : static_cast<int>(each.first + each.count)};
    choose(mesh, glm::inverse(world_from_mesh) * each.world_from_view, rows, object, shown);
    if (chosen_.empty()) continue;
    cast(list, item, world_from_mesh, each.world_from_view);
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      if (seen_[i].item != kNoItem) add(chosen_[i], silhouette, mask);
    }
  }
}

std::size_t ObjectSilhouettes::place(int x, int y) const {
  const CanvasRect canvas = canvas_.canvas();
  return static_cast<std::size_t>(y - canvas.y_begin) * static_cast<std::size_t>(canvas.x_end - canvas.x_begin) +
         static_cast<std::size_t>(x - canvas.x_begin);
}

void ObjectSilhouettes::add(const Pixel& pixel, Silhouette& silhouette, std::span<std::uint8_t> mask) {
  if (notes_found_) {
    found_.push_back(place(pixel.x, pixel.y));
    is_found_[found_.back()] = true;
  }
  silhouette.full.add(pixel.x, pixel.y);
  const CanvasRect picture = canvas_.picture();
  if (!picture.has(pixel.x, pixel.y)) return;
  silhouette.picture.add(pixel.x, pixel.y);
  if (mask.empty()) return;
  mask[static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(picture.x_end) +
       static_cast<std::size_t>(pixel.x)] = 1;
}

// The pixels of these rows whose rays meet the box, without those that have the object already or show what is behind
// the box.
void ObjectSilhouettes::choose(const Mesh& mesh, const glm::dmat4& mesh_from_view, const Rows& rows,
                               std::uint32_t object, const Shown& shown) {
  chosen_.clear();
  directions_.clear();
  near_range_m_.clear();
  const SeenBox box(mesh, mesh_from_view);
  const CanvasRect picture = canvas_.picture(), around = canvas_.around(box.corners());
  const double ends_at_m = box.ends_at_m();
  for (const PixelCanvas::Tile& tile : canvas_.tiles()) {
    const int top = std::max({tile.pixels.y_begin, rows.first, around.y_begin}),
              bottom = std::min({tile.pixels.y_end, rows.end, around.y_end}),
              left = std::max(tile.pixels.x_begin, around.x_begin), right = std::min(tile.pixels.x_end, around.x_end);
    if (top >= bottom || left >= right || !box.may_be_in(tile)) continue;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        double shown_m = 0;  // of what the pixel shows; beyond the picture nothing is known
        if (picture.has(x, y)) {
          const auto pixel =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.x_end) + static_cast<std::size_t>(x);
          if (shown.objects[pixel] == object) continue;
          shown_m = shown.range_m[pixel] * (1 - kDrawnRounding);
          if (shown_m > ends_at_m) continue;
        }
        if (!found_.empty() && is_found_[place(x, y)]) continue;
        const glm::dvec3 direction = canvas_.direction(x, y);
        if (direction == glm::dvec3(0)) continue;
        const std::optional<double> leaves_at_m = box.leaves_at_m(direction);
        if (!leaves_at_m || shown_m > *leaves_at_m) continue;
        chosen_.push_back({x, y});
        directions_.push_back(direction);
        near_range_m_.push_back(canvas_.near_range_m(x, y, direction));
      }
    }
  }
}

void ObjectSilhouettes::cast(const DrawList& list, std::uint32_t item, const glm::dmat4& world_from_mesh,
                             const glm::dmat4& world_from_view) {
  const DrawItem& whole = list.items[item];
  const std::shared_ptr<const Mesh>& mesh = list.meshes[whole.mesh];
  Alone& alone = alone_[mesh.get()];
  if (alone.caster == nullptr) alone.caster = make_host_ray_caster({}, threads_);
  alone.list.items = {{.mesh = 0, .material = 0, .transform = 1}};
  alone.list.meshes = {mesh};
  alone.list.materials = {list.materials[whole.material]};
  alone.list.material_revision = {list.material_revision[whole.material]};
  alone.list.world_from_node = {glm::dmat4(1), world_from_mesh};
  alone.caster->set_world(alone.list);
  seen_.assign(chosen_.size(), {});
  rays_.cast(*alone.caster, alone.list, world_from_view, directions_, near_range_m_, seen_);
}

}  // namespace simvis
