#include "sensors/camera/pixel_rays.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/raycast/item_shape.h"

namespace simvis {
namespace {

// A packet of rays is a tile of the image: its rays stay close together.
constexpr std::uint32_t kTileWidth = 8, kTileHeight = RayCaster::kPacketSize / kTileWidth;

// The triangles of one item in a view, at one time.
class ItemFaces {
 public:
  ItemFaces(const DrawList& list, const glm::dmat4& world_from_view)
      : list_(list), world_from_view_(world_from_view), view_from_world_(glm::transpose(glm::dmat3(world_from_view))) {}

  /// The outward normal of the triangle or the exact shape that a ray along `direction` has met: V, unit length.
  glm::dvec3 normal(const RayHit& hit, const glm::dvec3& direction) {
    const DrawItem& item = list_.items[hit.item];
    if (hit.item != item_) {
      item_ = hit.item;
      view_from_mesh_ = view_from_world_ * glm::dmat3(list_.world_from_node[item.transform]);
      mirrored_ = glm::determinant(view_from_mesh_) < 0;
      shape_ = shape_of_item(list_, hit.item, world_from_view_);
    }
    if (shape_) return shape_point(*shape_, direction, {hit.range_m, hit.error_bound_m, hit.primitive}).normal;
    const Mesh& mesh = *list_.meshes[item.mesh];
    const auto corner = [&](std::size_t k) {
      return glm::dvec3(mesh.positions[mesh.indices[3 * std::size_t{hit.primitive} + k]]);
    };
    const glm::dvec3 a = corner(0);
    const glm::dvec3 across = glm::cross(view_from_mesh_ * (corner(1) - a), view_from_mesh_ * (corner(2) - a));
    return glm::normalize(mirrored_ ? -across : across);
  }

  bool is_single_sided(const RayHit& hit) const {
    return !list_.materials[list_.items[hit.item].material]->double_sided;
  }

 private:
  const DrawList& list_;
  glm::dmat4 world_from_view_;
  std::optional<SeenShape> shape_;  // of item_
  glm::dmat3 view_from_world_, view_from_mesh_{1.0};
  std::uint32_t item_ = kNoItem;
  bool mirrored_ = false;
};

}  // namespace

PixelRays::PixelRays(const CameraLayout& layout, const CameraViews& views, double near_m)
    : width_px_(layout.width_px), directions_(layout.rays) {
  const std::size_t pixels = std::size_t{layout.width_px} * layout.height_px;
  near_range_m_.resize(pixels);
  if (!directions_.empty()) {
    for (std::size_t i = 0; i < pixels; ++i) {
      if (views.taps[i].view == PixelTap::kNone) continue;
      near_range_m_[i] = near_m / (views.views[views.taps[i].view].face_from_view * directions_[i]).z;
    }
    return;
  }
  directions_.reserve(pixels);
  const Pinhole& p = layout.pinhole;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double x = static_cast<double>(i % layout.width_px) + 0.5, y = static_cast<double>(i / layout.width_px) + 0.5;
    directions_.push_back(glm::normalize(glm::dvec3((x - p.cx_px) / p.fx_px, (y - p.cy_px) / p.fy_px, 1)));
    near_range_m_[i] = near_m / directions_[i].z;
  }
}

PixelRays::PixelRays(std::vector<glm::dvec3> directions, std::vector<double> near_range_m)
    : width_px_(static_cast<std::uint32_t>(directions.size())),
      directions_(std::move(directions)),
      near_range_m_(std::move(near_range_m)) {}

void PixelRays::cast(RayCaster& caster, const DrawList& list, const PixelRows& rows, std::span<SeenSurface> seen) {
  const DrawList* world = &list;
  RayCaster* used = &caster;
  if (!rows.places.empty()) {
    world = &move(list, rows.places);
    used = moved_caster_.get();
  }
  choose_pixels(rows);
  while (!chosen_.empty()) {
    cast_chosen(*used, rows.world_from_view);
    read_hits(*world, rows.world_from_view, seen);
  }
}

// The list with these items elsewhere, which is the world of moved_caster_.
const DrawList& PixelRays::move(const DrawList& list, std::span<const ItemPlace> places) {
  if (moved_caster_ == nullptr) moved_caster_ = make_host_ray_caster();
  moved_list_ = list;
  for (const ItemPlace& place : places) {
    moved_list_.items[place.item].transform = static_cast<std::uint32_t>(moved_list_.world_from_node.size());
    moved_list_.world_from_node.push_back(place.world_from_mesh);
  }
  moved_caster_->set_world(moved_list_);
  return moved_list_;
}

// All pixels of the rows that see something, tile by tile.
void PixelRays::choose_pixels(const PixelRows& rows) {
  chosen_.clear();
  behind_m_.clear();
  for (std::uint32_t top = rows.first; top < rows.first + rows.count; top += kTileHeight) {
    const std::uint32_t bottom = std::min(top + kTileHeight, rows.first + rows.count);
    for (std::uint32_t left = 0; left < width_px_; left += kTileWidth) {
      const std::uint32_t right = std::min(left + kTileWidth, width_px_);
      for (std::uint32_t y = top; y < bottom; ++y) {
        for (std::uint32_t x = left; x < right; ++x) {
          const std::uint32_t pixel = y * width_px_ + x;
          if (directions_[pixel] == glm::dvec3(0)) continue;
          chosen_.push_back(pixel);
          behind_m_.push_back(near_range_m_[pixel]);
        }
      }
    }
  }
}

void PixelRays::cast_chosen(RayCaster& caster, const glm::dmat4& world_from_view) {
  cast_directions_.clear();
  for (const std::uint32_t pixel : chosen_) cast_directions_.push_back(directions_[pixel]);
  hits_.resize(chosen_.size());
  caster.cast(world_from_view, cast_directions_, hits_, behind_m_);
  rays_cast_ += chosen_.size();
}

// Afterwards those pixels are chosen whose rays have met the back of a single-sided surface.
void PixelRays::read_hits(const DrawList& list, const glm::dmat4& world_from_view, std::span<SeenSurface> seen) {
  ItemFaces faces(list, world_from_view);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const RayHit& hit = hits_[i];
    const std::uint32_t pixel = chosen_[i];
    if (std::isinf(hit.range_m)) continue;
    const glm::dvec3 normal = faces.normal(hit, directions_[pixel]);
    const bool from_behind = glm::dot(normal, directions_[pixel]) > 0;
    if (from_behind && faces.is_single_sided(hit)) {
      chosen_[kept] = pixel;
      behind_m_[kept] = hit.range_m;
      ++kept;
      continue;
    }
    seen[pixel] = {hit.item, hit.range_m, hit.error_bound_m, from_behind ? -normal : normal};
  }
  chosen_.resize(kept);
  behind_m_.resize(kept);
}

}  // namespace simvis
