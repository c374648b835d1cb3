#include "sensors/event_camera/pixel_light.h"

#include <algorithm>
#include <cmath>

#include "engine/draw/canonical_order.h"
#include "engine/draw/surface_alpha.h"
#include "sensors/event_camera/smooth_neighbours.h"
#include "sensors/event_camera/surface_light.h"

namespace simvis {
namespace {

// Ways are followed in so many steps. A turn is at most half a circle, so one step is at most 180 / 16 degrees of an
// arc, which leaves its chord by 0.025 of the chord.
constexpr std::size_t kWaySteps = 16;
constexpr double kArcOverChord = 0.05;
// With a lens, sides of the tiles that triangles are sorted into.
constexpr std::uint32_t kTileSide_px = 8;
// A cone around a triangle that is wider than this may be anywhere.
constexpr double kMaxCone_rad = 1.4;
// What projects farther away than this is not in an image.
constexpr double kFar_px = 1e9;

bool covers_as_a_whole(const Material& material) {
  if (material.opacity < kMinDepthVisibleAlpha) return false;
  return material.alpha_mode == AlphaMode::opaque ||
         material.base_color.a * material.opacity >=
             (material.alpha_mode == AlphaMode::mask ? material.alpha_cutoff : kMinDepthVisibleAlpha);
}

// Whether corners run clockwise for the eye.
bool shows_back(const std::array<glm::dvec3, 3>& corners_m) {
  return glm::dot(glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]), corners_m[0]) > 0;
}

// An image of one pixel.
Pinhole pinhole_of(const PixelSquare& square) {
  return {.fx_px = square.focal_px, .fy_px = square.focal_px, .cx_px = 0.5, .cy_px = 0.5};
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace

PixelLight::PixelLight(const PixelOptics& optics, double near_m)
    : pinhole_(optics.layout().pinhole),
      width_px_(optics.layout().width_px),
      height_px_(optics.layout().height_px),
      near_m_(near_m) {
  if (!optics.has_lens()) return;
  for (std::uint32_t pixel = 0; pixel < optics.pixels(); ++pixel) squares_.push_back(optics.square(pixel));
  for (std::uint32_t y = 0; y < height_px_; y += kTileSide_px) {
    for (std::uint32_t x = 0; x < width_px_; x += kTileSide_px) {
      add_tile({x, y, std::min(x + kTileSide_px, width_px_), std::min(y + kTileSide_px, height_px_)});
    }
  }
}

void PixelLight::add_tile(const Rect& pixels) {
  std::vector<glm::dvec3> corners;
  glm::dvec3 sum(0);
  for (std::uint32_t y = pixels.y_begin; y < pixels.y_end; ++y) {
    for (std::uint32_t x = pixels.x_begin; x < pixels.x_end; ++x) {
      const std::size_t pixel = std::size_t{y} * width_px_ + x;
      if (is_blind(pixel)) continue;
      const PixelSquare& square = squares_[pixel];
      const glm::dmat3 view_from_square = glm::inverse(square.square_from_view);
      for (const double right : {-0.5, 0.5}) {
        for (const double down : {-0.5, 0.5}) {
          corners.push_back(
              glm::normalize(view_from_square * glm::dvec3(right / square.focal_px, down / square.focal_px, 1)));
          sum += corners.back();
        }
      }
    }
  }
  if (corners.empty()) return;
  Tile tile{.pixels = pixels, .axis = glm::normalize(sum)};
  for (const glm::dvec3& corner : corners) tile.angle_rad = std::max(tile.angle_rad, angle_between(tile.axis, corner));
  tiles_.push_back(tile);
}

void PixelLight::set(const SceneOverTime& scene, bool all_pixels) {
  scene_ = &scene;
  background_ = background_light(scene.list());
  triangles_.clear();
  rects_.clear();
  ways_.clear();
  in_motion_.assign(std::size_t{width_px_} * height_px_, 0);
  if (!all_pixels && !scene.any_moves()) return sort_in(false);
  for (KeptNeighbours& kept : neighbours_) kept.is_used = false;
  for (const std::uint32_t item : item_order(scene.list())) add_item(item);
  std::erase_if(neighbours_, [](const KeptNeighbours& kept) { return !kept.is_used; });
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (!triangles_[i].moves) continue;
    for (std::uint32_t y = rects_[i].y_begin; y < rects_[i].y_end; ++y) {
      std::fill_n(in_motion_.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * width_px_ + rects_[i].x_begin),
                  rects_[i].x_end - rects_[i].x_begin, std::uint8_t{1});
    }
  }
  for (std::size_t pixel = 0; pixel < squares_.size(); ++pixel) {
    if (is_blind(pixel)) in_motion_[pixel] = 0;
  }
  sort_in(all_pixels);
}

void PixelLight::add_item(std::uint32_t item) {
  const DrawList& list = scene_->list();
  const DrawItem& drawn = list.items[item];
  const Mesh& mesh = *list.meshes[drawn.mesh];
  const Material& material = *list.materials[drawn.material];
  if (!drawn.visible || mesh.topology != Topology::triangles || !covers_as_a_whole(material)) return;
  const bool moves = scene_->moves(item);
  std::vector<glm::dmat4> places;
  for (std::size_t step = 0; step <= (moves ? kWaySteps : 0); ++step) {
    places.push_back(scene_->view_from_mesh(item, static_cast<double>(step) / kWaySteps));
  }
  if (moves) {
    Way way;
    for (std::size_t step = 0; step <= kSurfaceSteps; ++step) {
      way.view_from_mesh[step] = places[step * kWaySteps / kSurfaceSteps];
    }
    way.mesh_from_half_way = glm::inverse(way.view_from_mesh[kSurfaceSteps / 2]);
    way.neighbours = neighbours_of(list.meshes[drawn.mesh]);
    ways_.push_back(way);
  }
  std::vector<Corners> way(places.size());
  const bool is_mirrored = glm::determinant(glm::dmat3(places[0])) < 0;
  const std::size_t first_triangle = triangles_.size();
  std::vector<Facing> facing(moves ? mesh.indices.size() / 3 : 0);
  const auto primitives = static_cast<std::uint32_t>(mesh.indices.size() / 3);
  for (std::uint32_t primitive = 0; primitive < primitives; ++primitive) {
    for (std::size_t step = 0; step < places.size(); ++step) {
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3& position = mesh.positions[mesh.indices[3 * std::size_t{primitive} + k]];
        way[step][k] = glm::dvec3(places[step] * glm::dvec4(glm::dvec3(position), 1));
      }
    }
    for (const Corners& at : moves ? std::span<const Corners>(way) : std::span<const Corners>()) {
      (shows_back(at) != is_mirrored ? facing[primitive].back : facing[primitive].front) = true;
    }
    const std::optional<Rect> rect = swept(way);
    if (!rect) continue;
    triangles_.push_back({.item = item,
                          .primitive = primitive,
                          .both_sides = material.double_sided,
                          .moves = moves,
                          .mirrored = is_mirrored,
                          .way = moves ? static_cast<std::uint32_t>(ways_.size() - 1) : 0,
                          .corners_m = way[0]});
    rects_.push_back(*rect);
  }
  if (moves) find_outlines(item, first_triangle, facing);
}

std::shared_ptr<const PixelLight::Neighbours> PixelLight::neighbours_of(const std::shared_ptr<const Mesh>& mesh) {
  auto kept = std::ranges::find(neighbours_, mesh, &KeptNeighbours::mesh);
  if (kept == neighbours_.end()) {
    kept = neighbours_.insert(kept, {mesh, std::make_shared<const Neighbours>(smooth_neighbours(*mesh))});
  }
  kept->is_used = true;
  return kept->neighbours;
}

// Marks the edges at which the light of an item may jump, in its triangles from `first_triangle` on. A triangle that is
// seen from its front only and shows its back has no marks: the triangle beyond the edge has the same edge.
void PixelLight::find_outlines(std::uint32_t item, std::size_t first_triangle, const std::vector<Facing>& facing) {
  const DrawList& list = scene_->list();
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  const Neighbours& neighbours = *ways_.back().neighbours;
  for (std::size_t i = first_triangle; i < triangles_.size(); ++i) {
    Triangle& triangle = triangles_[i];
    const Facing& own = facing[triangle.primitive];
    if (!own.front && !triangle.both_sides) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t beyond = neighbours[triangle.primitive][k];
      const bool turns = own.front == own.back;
      if (beyond != kNoNeighbour && !turns && own == facing[beyond]) continue;
      (beyond == kNoNeighbour ? triangle.outlines : triangle.folds) |= static_cast<std::uint8_t>(1u << k);
      for (const std::size_t end : {k, (k + 1) % 3}) {
        const glm::dvec3 place(mesh.positions[mesh.indices[3 * std::size_t{triangle.primitive} + end]]);
        triangle.acceleration_m = std::max(triangle.acceleration_m, scene_->acceleration_m(item, place));
      }
    }
  }
}

// A cone around the corners at all steps has the triangle in it, and the chords of their ways.
std::optional<PixelLight::Rect> PixelLight::swept_through_lens(const std::vector<Corners>& ways) const {
  const Rect whole{0, 0, width_px_, height_px_};
  glm::dvec3 sum(0);
  for (const Corners& at : ways) {
    for (const glm::dvec3& corner : at) sum += corner / std::max(glm::length(corner), near_m_);
  }
  if (glm::length(sum) == 0) return whole;
  const glm::dvec3 axis = glm::normalize(sum);
  double angle_rad = 0, chord_rad = 0;
  for (std::size_t step = 0; step < ways.size(); ++step) {
    for (std::size_t k = 0; k < 3; ++k) {
      angle_rad = std::max(angle_rad, angle_between(axis, ways[step][k]));
      if (step > 0) chord_rad = std::max(chord_rad, angle_between(ways[step - 1][k], ways[step][k]));
    }
  }
  angle_rad += kArcOverChord * chord_rad;
  if (!(angle_rad < kMaxCone_rad)) return whole;
  std::optional<Rect> rect;
  for (const Tile& tile : tiles_) {
    if (glm::dot(axis, tile.axis) < std::cos(angle_rad + tile.angle_rad)) continue;
    if (!rect) rect = tile.pixels;
    rect = Rect{std::min(rect->x_begin, tile.pixels.x_begin), std::min(rect->y_begin, tile.pixels.y_begin),
                std::max(rect->x_end, tile.pixels.x_end), std::max(rect->y_end, tile.pixels.y_end)};
  }
  return rect;
}

// Returns the pixels that the triangle may cross; empty if none.
std::optional<PixelLight::Rect> PixelLight::swept(const std::vector<Corners>& ways) const {
  if (!squares_.empty()) return swept_through_lens(ways);
  glm::dvec2 low(kFar_px), high(-kFar_px);
  bool is_before = true, is_behind = true;
  double chord_px = 0;
  for (std::size_t step = 0; step < ways.size(); ++step) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& corner = ways[step][k];
      is_before = is_before && corner.z >= near_m_;
      is_behind = is_behind && corner.z < near_m_;
      if (corner.z < near_m_) continue;
      const auto project = [&](const glm::dvec3& point) {
        return glm::dvec2(pinhole_.cx_px + pinhole_.fx_px * point.x / point.z,
                          pinhole_.cy_px + pinhole_.fy_px * point.y / point.z);
      };
      const glm::dvec2 seen = project(corner);
      low = glm::min(low, seen);
      high = glm::max(high, seen);
      if (step > 0 && ways[step - 1][k].z >= near_m_) {
        chord_px = std::max(chord_px, glm::length(seen - project(ways[step - 1][k])));
      }
    }
  }
  if (is_behind) return std::nullopt;
  if (!is_before) return Rect{0, 0, width_px_, height_px_};
  low -= kArcOverChord * chord_px;
  high += kArcOverChord * chord_px;
  if (!(high.x >= 0 && high.y >= 0 && low.x <= width_px_ && low.y <= height_px_)) return std::nullopt;
  const auto limit = [](double value, std::uint32_t end) {
    return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(end)));
  };
  return Rect{limit(std::floor(low.x), width_px_), limit(std::floor(low.y), height_px_),
              limit(std::floor(high.x) + 1, width_px_), limit(std::floor(high.y) + 1, height_px_)};
}

// Triangles that stand still are needed where something moves before or behind them, or everywhere.
void PixelLight::sort_in(bool all_pixels) {
  first_.assign(in_motion_.size() + 1, 0);
  const auto for_pixels = [&](const auto& action) {
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      for (std::uint32_t y = rects_[i].y_begin; y < rects_[i].y_end; ++y) {
        for (std::uint32_t x = rects_[i].x_begin; x < rects_[i].x_end; ++x) {
          const std::size_t pixel = std::size_t{y} * width_px_ + x;
          if (all_pixels || in_motion_[pixel] != 0) action(i, pixel);
        }
      }
    }
  };
  for_pixels([&](std::uint32_t, std::size_t pixel) { ++first_[pixel + 1]; });
  for (std::size_t pixel = 0; pixel + 1 < first_.size(); ++pixel) first_[pixel + 1] += first_[pixel];
  near_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_pixels([&](std::uint32_t triangle, std::size_t pixel) { near_[next[pixel]++] = triangle; });
}

void PixelWork::begin() {
  for (Places& places : places_) places.share = -1;
  samples_ = 0;
}

const glm::dmat4& PixelLight::view_from_mesh(std::uint32_t item, double share, PixelWork& work) const {
  auto at = std::ranges::find(work.places_, share, &PixelWork::Places::share);
  if (at == work.places_.end()) {
    at = work.places_.begin() + static_cast<std::ptrdiff_t>(work.oldest_);
    work.oldest_ = (work.oldest_ + 1) % work.places_.size();
    at->share = share;
    at->of_items.clear();
  }
  const auto found = std::ranges::find(at->of_items, item, &std::pair<std::uint32_t, glm::dmat4>::first);
  if (found != at->of_items.end()) return found->second;
  return at->of_items.emplace_back(item, scene_->view_from_mesh(item, share)).second;
}

PixelLight::Corners PixelLight::corners(const Triangle& triangle, double share, PixelWork& work) const {
  return triangle.moves ? placed(triangle.item, triangle.primitive, share, work) : triangle.corners_m;
}

PixelLight::Corners PixelLight::placed(std::uint32_t item, std::uint32_t primitive, double share,
                                       PixelWork& work) const {
  const DrawList& list = scene_->list();
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  const glm::dmat4& place = view_from_mesh(item, share, work);
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3& position = mesh.positions[mesh.indices[3 * std::size_t{primitive} + k]];
    corners[k] = glm::dvec3(place * glm::dvec4(glm::dvec3(position), 1));
  }
  return corners;
}

double PixelLight::way_px(std::uint32_t pixel) const {
  double longest_px = 0;
  for (std::size_t i = first_[pixel]; i < first_[pixel + 1]; ++i) {
    if (triangles_[near_[i]].moves) longest_px = std::max(longest_px, way_px(triangles_[near_[i]], pixel));
  }
  return longest_px;
}

// The way of the point where the ray meets the triangle's plane at the middle of the time; of one as deep as its
// nearest or farthest corner if it meets the plane elsewhere.
double PixelLight::way_px(const Triangle& triangle, std::uint32_t pixel) const {
  const bool has_lens = !squares_.empty();
  const PixelSquare square = has_lens ? squares_[pixel] : PixelSquare{};
  const glm::dvec2 focal_px = has_lens ? glm::dvec2(square.focal_px) : glm::dvec2(pinhole_.fx_px, pinhole_.fy_px);
  const double near_m = has_lens ? square.near_m : near_m_;
  const std::uint32_t x = pixel % width_px_, y = pixel / width_px_;
  const glm::dvec3 ray =
      has_lens ? glm::dvec3(0, 0, 1)
               : glm::dvec3((x + 0.5 - pinhole_.cx_px) / focal_px.x, (y + 0.5 - pinhole_.cy_px) / focal_px.y, 1);
  const Way& way = ways_[triangle.way];
  const Mesh& mesh = *scene_->list().meshes[scene_->list().items[triangle.item].mesh];
  Corners at;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3& position = mesh.positions[mesh.indices[3 * std::size_t{triangle.primitive} + k]];
    at[k] = glm::dvec3(way.view_from_mesh[kSurfaceSteps / 2] * glm::dvec4(glm::dvec3(position), 1));
  }
  at = in_square(pixel, at);
  const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
  const double low = std::max(near_m, std::min({at[0].z, at[1].z, at[2].z})),
               high = std::max({low, at[0].z, at[1].z, at[2].z});
  double z = glm::dot(normal, at[0]) / glm::dot(normal, ray);
  if (!std::isfinite(z)) z = low;
  glm::dvec3 point_m = std::clamp(z, low, high) * ray;
  if (has_lens) point_m = glm::inverse(square.square_from_view) * point_m;
  const glm::dvec4 in_mesh = way.mesh_from_half_way * glm::dvec4(point_m, 1);
  double sum_px = 0;
  std::optional<glm::dvec2> before;
  for (const glm::dmat4& place : way.view_from_mesh) {
    glm::dvec3 seen(place * in_mesh);
    if (has_lens) seen = square.square_from_view * seen;
    if (seen.z < near_m) continue;
    const glm::dvec2 now(focal_px.x * seen.x / seen.z, focal_px.y * seen.y / seen.z);
    if (before) sum_px += glm::length(now - *before);
    before = now;
  }
  return sum_px;
}

double PixelLight::light(std::uint32_t pixel, double share, PixelWork& work) const {
  ++work.samples_;
  if (is_blind(pixel)) return 0;
  const bool has_lens = !squares_.empty();
  glm::dmat3 view_from_square(1);
  if (has_lens) {
    work.faces_.begin(pinhole_of(squares_[pixel]), squares_[pixel].near_m, 0, 0);
    view_from_square = glm::inverse(squares_[pixel].square_from_view);
  } else {
    work.faces_.begin(pinhole_, near_m_, pixel % width_px_, pixel / width_px_);
  }
  for (std::size_t i = first_[pixel]; i < first_[pixel + 1]; ++i) {
    const Triangle& triangle = triangles_[near_[i]];
    Corners placed = in_square(pixel, corners(triangle, share, work));
    if (triangle.mirrored) std::swap(placed[1], placed[2]);
    work.faces_.add(near_[i], placed, triangle.both_sides);
  }
  double sum = 0, uncovered = 1;
  for (const VisibleFace& face : work.faces_.find()) {
    const Triangle& triangle = triangles_[face.triangle];
    const Corners placed = in_square(pixel, corners(triangle, share, work));
    glm::dvec3 direction = work.faces_.direction(face.centroid_px);
    // Weights of the corners of the point where the direction meets the plane.
    glm::dvec3 weights;
    for (std::size_t k = 0; k < 3; ++k) {
      weights[static_cast<glm::length_t>(k)] =
          glm::dot(direction, glm::cross(placed[(k + 1) % 3], placed[(k + 2) % 3]));
    }
    weights /= weights.x + weights.y + weights.z;
    if (has_lens) direction = view_from_square * direction;
    sum += face.area * surface_light(*scene_, share, triangle.item, triangle.primitive, weights, direction);
    uncovered -= face.area;
  }
  return sum + std::max(uncovered, 0.0) * background_;
}

bool PixelLight::find_edges(std::uint32_t pixel, double begin, double end, PixelWork& work) const {
  const EdgeTouch square = square_of(pixel);
  work.outlined_.clear();
  for (std::size_t i = first_[pixel]; i < first_[pixel + 1]; ++i) {
    const Triangle& triangle = triangles_[near_[i]];
    if ((triangle.outlines | triangle.folds) != 0) {
      work.outlined_.emplace_back(near_[i], in_square(pixel, corners(triangle, begin, work)));
    }
  }
  work.edges_.clear();
  for (const auto& [i, at_begin] : work.outlined_) {
    const Triangle& triangle = triangles_[i];
    const double sag_m = triangle.acceleration_m * (end - begin) * (end - begin) / 8;
    const Corners at_end = in_square(pixel, corners(triangle, end, work));
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (((triangle.outlines | triangle.folds) >> k & 1) == 0) continue;
      if (!square.stays_out(edge_of(at_begin, k), edge_of(at_end, k), sag_m)) work.edges_.emplace_back(i, k);
    }
  }
  std::erase_if(work.edges_, [&](const std::pair<std::uint32_t, std::uint32_t>& edge) {
    return (triangles_[edge.first].outlines >> edge.second & 1) == 0 &&
           !is_fold(triangles_[edge.first], edge.second, begin, end, work);
  });
  return !work.edges_.empty();
}

// Whether the triangle and the one beyond an edge do not show the same side at both times.
bool PixelLight::is_fold(const Triangle& triangle, std::uint32_t corner, double begin, double end,
                         PixelWork& work) const {
  const std::uint32_t beyond = (*ways_[triangle.way].neighbours)[triangle.primitive][corner];
  const bool side = shows_back(placed(triangle.item, triangle.primitive, begin, work));
  return side != shows_back(placed(triangle.item, beyond, begin, work)) ||
         side != shows_back(placed(triangle.item, triangle.primitive, end, work)) ||
         side != shows_back(placed(triangle.item, beyond, end, work));
}

void PixelLight::add_touches(std::uint32_t pixel, std::span<const double> looked_at, PixelWork& work,
                             std::vector<double>& shares) const {
  const EdgeTouch square = square_of(pixel);
  for (const auto& [i, k] : work.edges_) {
    const Triangle& triangle = triangles_[i];
    const auto ends = [&, k = k](double share) { return edge_of(in_square(pixel, corners(triangle, share, work)), k); };
    for (std::size_t at = 0; at + 1 < looked_at.size(); ++at) {
      const std::optional<double> share =
          square.deepest(ends, triangle.acceleration_m, looked_at[at], looked_at[at + 1]);
      if (share) shares.push_back(*share);
    }
  }
}

PixelLight::Corners PixelLight::in_square(std::uint32_t pixel, Corners corners) const {
  if (squares_.empty()) return corners;
  for (glm::dvec3& corner : corners) corner = squares_[pixel].square_from_view * corner;
  return corners;
}

EdgeTouch PixelLight::square_of(std::uint32_t pixel) const {
  if (!squares_.empty()) return {pinhole_of(squares_[pixel]), squares_[pixel].near_m, 0, 0};
  return {pinhole_, near_m_, pixel % width_px_, pixel / width_px_};
}

EdgeTouch::Ends PixelLight::edge_of(const Corners& corners, std::uint32_t corner) {
  return {corners[corner], corners[(corner + 1) % 3]};
}

}  // namespace simvis
