#include "effects/scanner/moved_items.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/solid_cloud.h"
#include "engine/draw/splat_item.h"
#include "scenegraph/motion_path.h"

namespace simvis {
namespace {

constexpr std::size_t kNotSeen = ~std::size_t{0};

// Roundings of a moved ray in u = 2^-53 for each displacement of a path. Of its direction: the turn (10, see
// scenegraph/motion.h), its matrix (8), its product with the direction (4), and the products with the sensor's rotation
// (12). Of its origin, as a share of the distances from the item's origin and of the lengths that round in the path:
// the same, and three sums.
constexpr double kMovedError = 38 * 0x1p-53;

// The path of an item as a sensor sees it: about the item's origin, with the axes of the sensor.
class SeenPath {
 public:
  SeenPath(const MotionPath& path, const glm::dmat4& world_from_mesh, const glm::dmat4& world_from_sensor)
      : path_(path),
        world_from_axes_(world_from_sensor),
        axes_from_world_(glm::transpose(world_from_axes_)),
        world_origin_m_(world_from_mesh[3]),
        origin_m_(axes_from_world_ * (world_origin_m_ - glm::dvec3(world_from_sensor[3]))),
        error_rad_(kMovedError * static_cast<double>(displacements(path))) {
    look_back(0);
  }

  /// The item's origin, sensor frame.
  const glm::dvec3& origin_m() const { return origin_m_; }

  MovedItems::Seen seen_by(const BeamRay& ray) {
    if (ray.back != back_) look_back(ray.back);
    const glm::dmat3 back = glm::transpose(then_.turn);
    const glm::dvec3 from_origin = ray.origin_m - origin_m_;
    MovedItems::Seen seen{.ray = ray, .ray_from_seen = then_.turn};
    seen.ray.origin_m = origin_m_ + back * (from_origin - then_.way_m);
    seen.ray.direction = glm::normalize(back * ray.direction);
    seen.ray.origin_error_m += parts_ * (error_m_ + error_rad_ * glm::length(from_origin));
    seen.ray.error_rad += parts_ * error_rad_;
    return seen;
  }

 private:
  // Rays that left together stand side by side.
  void look_back(double back) {
    back_ = back;
    parts_ = extrapolation(path_, -back);
    error_m_ = kMovedError * (rounded_length_m(path_, world_origin_m_, parts_) + glm::length(origin_m_));
    const Displacement world = displacement(path_, -back, world_origin_m_);
    then_ = {axes_from_world_ * world.turn * world_from_axes_, axes_from_world_ * world.way_m};
  }

  const MotionPath& path_;
  glm::dmat3 world_from_axes_, axes_from_world_;
  glm::dvec3 world_origin_m_, origin_m_;
  double error_rad_;
  // These are set by look_back(), for the time of its rays.
  double back_ = 0, parts_ = 1, error_m_ = 0;
  Displacement then_{};
};

// A ball around an item, in the frame of the sensor.
struct Ball {
  glm::dvec3 center_m;
  double radius_m;
};
Ball ball_around(const Mesh& mesh, const glm::dmat4& sensor_from_mesh) {
  const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
  Ball ball{glm::dvec3(sensor_from_mesh * glm::dvec4((low + high) / 2.0, 1)), 0};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                        (corner & 4) != 0 ? high.z : low.z);
    ball.radius_m =
        std::max(ball.radius_m, glm::distance(ball.center_m, glm::dvec3(sensor_from_mesh * glm::dvec4(at, 1))));
  }
  // Far above the rounding of what follows.
  ball.radius_m += 1e-9 * (ball.radius_m + glm::length(ball.center_m));
  return ball;
}
bool comes_near(const BeamRay& ray, const Ball& ball) {
  const glm::dvec3 way = ball.center_m - ray.origin_m;
  const double along = glm::dot(way, ray.direction), outside = glm::dot(way, way) - ball.radius_m * ball.radius_m;
  return outside <= 0 || (along > 0 && glm::length(way - along * ray.direction) <= ball.radius_m);
}

}  // namespace

// A world with one item, and a caster that keeps its tree.
struct MovedItems::OneMesh {
  OneMesh(const std::shared_ptr<const Mesh>& mesh, unsigned threads) : caster(make_host_ray_caster({}, threads)) {
    list.items = {DrawItem{}};
    list.world_from_node.resize(1);
    list.meshes = {mesh};
    list.materials.resize(1);
    list.material_revision.resize(1);
  }

  DrawList list;
  std::unique_ptr<RayCaster> caster;
};

MovedItems::MovedItems() = default;
MovedItems::~MovedItems() = default;

const MovedItems::Seen* MovedItems::seen(std::size_t ray) const {
  return seen_of_ray_[ray] == kNotSeen ? nullptr : &seen_[seen_of_ray_[ray]];
}

void MovedItems::cast(const ScanContext& context, const DrawList& list, std::span<const BeamRay> rays,
                      RayCaster& caster, std::span<RayHit> hits) {
  rays_cast_ = 0;
  has_moved_.assign(list.items.size(), false);
  // Clouds of splats stand still.
  for (const ItemMove& move : context.moves) has_moved_[move.item] = !is_splat_item(list, move.item);
  seen_.clear();
  seen_of_ray_.assign(rays.size(), kNotSeen);
  std::erase_if(meshes_, [&](const auto& entry) {
    return std::ranges::none_of(context.moves, [&](const ItemMove& move) {
      return list.meshes[list.items[move.item].mesh].get() == entry.first;
    });
  });
  cast_behind_moved(context, rays, caster, hits);
  for (const ItemMove& move : context.moves) {
    const DrawItem& item = list.items[move.item];
    const Mesh& mesh = *list.meshes[item.mesh];
    const bool is_hit = mesh.topology == Topology::triangles || is_solid_cloud(mesh);
    if (item.visible && is_hit) meet(context, list, move, rays, caster.threads(), hits);
  }
}

void MovedItems::cast_behind_moved(const ScanContext& context, std::span<const BeamRay> rays, RayCaster& caster,
                                   std::span<RayHit> hits) {
  constexpr double kMinBehind_m = 1e-30;  // see RayCaster::cast()
  std::vector<std::size_t> again;
  std::vector<glm::dvec3> origins_m, directions;
  std::vector<double> behind_m;
  std::vector<RayHit> next;
  const auto is_moved = [&](std::size_t i) { return std::isfinite(hits[i].range_m) && has_moved_[hits[i].item]; };
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (is_moved(i)) again.push_back(i);
  }
  while (!again.empty()) {
    origins_m.clear();
    directions.clear();
    behind_m.clear();
    for (const std::size_t i : again) {
      origins_m.push_back(rays[i].origin_m);
      directions.push_back(rays[i].direction);
      behind_m.push_back(std::max(hits[i].range_m, kMinBehind_m));
    }
    next.assign(again.size(), {});
    caster.cast_from(context.world_from_sensor, origins_m, directions, next, behind_m);
    rays_cast_ += again.size();
    for (std::size_t k = 0; k < again.size(); ++k) hits[again[k]] = next[k];
    std::erase_if(again, [&](std::size_t i) { return !is_moved(i); });
  }
}

void MovedItems::meet(const ScanContext& context, const DrawList& list, const ItemMove& move,
                      std::span<const BeamRay> rays, unsigned threads, std::span<RayHit> hits) {
  const DrawItem& item = list.items[move.item];
  const std::shared_ptr<const Mesh>& mesh = list.meshes[item.mesh];
  const glm::dmat4& world_from_mesh = list.world_from_node[item.transform];
  glm::dmat4 sensor_from_mesh =
      glm::dmat4(glm::transpose(glm::dmat3(context.world_from_sensor)) * glm::dmat3(world_from_mesh));
  SeenPath path(*move.path, world_from_mesh, context.world_from_sensor);
  sensor_from_mesh[3] = glm::dvec4(path.origin_m(), 1);
  const Ball ball = ball_around(*mesh, sensor_from_mesh);
  std::vector<Seen> near;
  std::vector<std::size_t> ray_of;
  std::vector<glm::dvec3> origins_m, directions;
  std::vector<double> behind_m;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Seen seen = path.seen_by(rays[i]);
    if (!comes_near(seen.ray, ball)) continue;
    origins_m.push_back(seen.ray.origin_m);
    directions.push_back(seen.ray.direction);
    behind_m.push_back(seen.ray.t_min_m);
    near.push_back(seen);
    ray_of.push_back(i);
  }
  if (near.empty()) return;
  std::unique_ptr<OneMesh>& one = meshes_[mesh.get()];
  if (one == nullptr) one = std::make_unique<OneMesh>(mesh, threads);
  one->list.world_from_node[0] = world_from_mesh;
  one->list.materials[0] = list.materials[item.material];
  one->caster->set_world(one->list);
  std::vector<RayHit> met(near.size());
  one->caster->cast_from(context.world_from_sensor, origins_m, directions, met, behind_m);
  rays_cast_ += near.size();
  for (std::size_t k = 0; k < near.size(); ++k) {
    const std::size_t i = ray_of[k];
    if (!(met[k].range_m < hits[i].range_m)) continue;
    hits[i] = met[k];
    hits[i].item = move.item;
    seen_of_ray_[i] = seen_.size();
    seen_.push_back(near[k]);
  }
}

}  // namespace simvis
