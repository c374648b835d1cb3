#include "sensors/camera/point_flow.h"

#include <numeric>
#include <unordered_map>

#include <simvis/pose.h>

namespace simvis {
namespace {

// The weights of a triangle's corners at a point of its plane.
glm::dvec3 weights_at(const glm::dvec3& point, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 across = glm::cross(b - a, c - a);
  const double square = glm::dot(across, across);
  if (square == 0) return {1, 0, 0};
  const double of_b = glm::dot(glm::cross(point - a, c - a), across) / square;
  const double of_c = glm::dot(glm::cross(b - a, point - a), across) / square;
  return {1 - of_b - of_c, of_b, of_c};
}

bool same_triangles(const Mesh& a, const Mesh& b) {
  return a.topology == Topology::triangles && b.topology == Topology::triangles &&
         a.positions.size() == b.positions.size() && a.indices == b.indices && !a.surface && !b.surface;
}

}  // namespace

PointFlow::PointFlow(const CameraLayout& layout, const CameraMoment& from, const CameraMoment& to)
    : layout_(layout), from_(from), to_(to) {
  match();
  const DrawList &list = from.scene->list, &other = to.scene->list;
  deforms_.resize(other_.size());
  for (std::uint32_t item = 0; item < other_.size(); ++item) {
    if (other_[item] == kNoItem) continue;
    const auto &mesh = list.meshes[list.items[item].mesh], &then = other.meshes[other.items[other_[item]].mesh];
    if (mesh == then || !same_triangles(*mesh, *then) || mesh->positions == then->positions) continue;
    deforms_[item] = 1;
    any_deforms_ |= list.items[item].visible;
  }
}

// Items are the same in both scenes if their shapes are.
void PointFlow::match() {
  const std::vector<std::uint32_t>&shape = from_.scene->shape, &then = to_.scene->shape;
  other_.resize(shape.size());
  if (shape == then) {
    std::iota(other_.begin(), other_.end(), 0u);
    return;
  }
  std::unordered_map<std::uint32_t, std::uint32_t> item_of;
  for (std::uint32_t i = 0; i < then.size(); ++i) item_of.emplace(then[i], i);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const auto found = item_of.find(shape[i]);
    other_[i] = found == item_of.end() ? kNoItem : found->second;
  }
}

FollowedPoint PointFlow::follow(const ImagePoint& point) {
  FollowedPoint followed;
  if (point.item != kNoItem) {
    followed.item = other_[point.item];
    followed.exists = followed.item != kNoItem;
  }
  RowSearch search(to_, point.rows);
  do {
    followed.rows = search.rows();
    followed.point = in_rows(point, followed.rows);
    followed.pixel = layout_.pixel(glm::dvec3(followed.point));
    if (!followed.pixel) return followed;
  } while (search.next(followed.pixel->y));
  followed.in_rows = search.is_met();
  return followed;
}

std::optional<glm::dvec2> PointFlow::place(const ImagePoint& point) {
  if (to_.rows.size() > 1 || !layout_.rays.empty()) return follow(point).pixel;
  const glm::dvec4 seen = in_rows(point, 0);
  if (seen.z <= 0) return std::nullopt;
  const Pinhole& p = layout_.pinhole;
  const double per_depth = 1 / seen.z;
  return glm::dvec2(p.cx_px + p.fx_px * seen.x * per_depth, p.cy_px + p.fy_px * seen.y * per_depth);
}

glm::dvec4 PointFlow::in_rows(const ImagePoint& point, std::size_t to_rows) {
  if (point.item == kNoItem || !deforms(point.item)) return way(point, to_rows) * point.point;
  const glm::dvec4 in_mesh = glm::inverse(from_.world_from_mesh(point.rows, point.item)) *
                             (from_.rows[point.rows].world_from_view * point.point);
  return rigid_inverse(to_.rows[to_rows].world_from_view) *
         (to_.world_from_mesh(to_rows, other_[point.item]) * deformed(point.item, point.primitive, in_mesh));
}

// From the view of the point's rows to that of the other rows.
const glm::dmat4& PointFlow::way(const ImagePoint& point, std::size_t to_rows) {
  const bool kept = way_.item == point.item && way_.from_rows == point.rows && way_.to_rows == to_rows;
  if (kept) return way_.matrix;
  way_ = {.item = point.item, .from_rows = point.rows, .to_rows = to_rows};
  way_.matrix = rigid_inverse(to_.rows[to_rows].world_from_view) * other_place(point.item, point.rows, to_rows) *
                from_.rows[point.rows].world_from_view;
  return way_.matrix;
}

// From where the matter of an item is in the world to where it is in the other image.
glm::dmat4 PointFlow::other_place(std::uint32_t item, std::size_t from_rows, std::size_t to_rows) const {
  if (item == kNoItem || other_[item] == kNoItem) return glm::dmat4(1.0);
  const glm::dmat4 place = from_.world_from_mesh(from_rows, item), then = to_.world_from_mesh(to_rows, other_[item]);
  return place == then ? glm::dmat4(1.0) : then * glm::inverse(place);
}

// The same point of the triangle in the other shape: mesh frame.
glm::dvec4 PointFlow::deformed(std::uint32_t item, std::uint32_t primitive, const glm::dvec4& point) const {
  const DrawList &list = from_.scene->list, &other = to_.scene->list;
  const Mesh &mesh = *list.meshes[list.items[item].mesh], &then = *other.meshes[other.items[other_[item]].mesh];
  const std::uint32_t* const corner = &mesh.indices[3 * std::size_t{primitive}];
  const auto at = [&](const Mesh& of, int k) { return glm::dvec3(of.positions[corner[k]]); };
  const glm::dvec3 weights = weights_at(glm::dvec3(point), at(mesh, 0), at(mesh, 1), at(mesh, 2));
  return {weights.x * at(then, 0) + weights.y * at(then, 1) + weights.z * at(then, 2), 1};
}

glm::dvec3 PointFlow::way_m(const ImagePoint& point) {
  const glm::dvec4 world = from_.rows[point.rows].world_from_view * point.point;
  const std::uint32_t other = other_[point.item];
  if (other == kNoItem) return glm::dvec3(0);
  if (!deforms(point.item)) return glm::dvec3(other_place(point.item, point.rows, point.rows) * world - world);
  const glm::dvec4 in_mesh = glm::inverse(from_.world_from_mesh(point.rows, point.item)) * world;
  return glm::dvec3(to_.world_from_mesh(point.rows, other) * deformed(point.item, point.primitive, in_mesh) - world);
}

}  // namespace simvis
