#include "engine/raycast/packet_caster.h"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "engine/base/assert.h"
#include "engine/raycast/packet_cast.h"
#include "engine/raycast/packet_finish.h"

namespace simvis {

namespace {

// A piece takes several times as long as waking a thread. One thread therefore casts a whole planar scan.
constexpr std::size_t kPiece = 16 * std::size_t{RayPacket::kMax};

// No packet has rays of two groups.
void cast_bundles(RayView& view, const WideBvh& tree, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                  std::span<const double> t_min_m, std::size_t group) {
  for (std::size_t first = 0; first < directions.size();) {
    const std::size_t left = std::min(group - first % group, directions.size() - first);
    RayPacket packet(directions.subspan(first, left), part_of(t_min_m, first, left));
    traverse_packet(view, tree, packet);
    finish_packet(view, packet, hits.data() + first);
    first += packet.count;
  }
}

std::vector<RayOrigin> origins_of(const RayView& view, const glm::dmat4& world_from_sensor,
                                  std::span<const glm::dvec3> origins_m) {
  const glm::dmat3 turn = glm::transpose(glm::dmat3(world_from_sensor));
  const glm::dvec3 sensor_m(view.world_from_sensor()[3]);
  std::vector<RayOrigin> origins(origins_m.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (i > 0 && origins_m[i] == origins_m[i - 1]) {
      origins[i] = origins[i - 1];
      continue;
    }
    origins[i].world_m = glm::dvec3(glm::translate(world_from_sensor, origins_m[i])[3]);
    origins[i].sensor_m = turn * (origins[i].world_m - sensor_m);
    origins[i].distance_m = glm::length(origins[i].world_m);
  }
  return origins;
}

// Casts rays that form no bundle with their neighbours. They wait until a packet is full of rays of one side.
class ScatteredRays {
 public:
  ScatteredRays(RayView& view, const WideBvh& tree, std::span<RayHit> hits) : view_(view), tree_(tree), hits_(hits) {}

  void add(std::size_t ray, const RayOrigin& origin, const glm::dvec3& direction, double t_min_m) {
    Waiting& waiting = sides_[RayPacket::side_of(direction)];
    waiting.rays[waiting.count] = ray;
    waiting.origins[waiting.count] = origin;
    waiting.directions[waiting.count] = direction;
    waiting.t_min_m[waiting.count] = t_min_m;
    if (++waiting.count == RayPacket::kMax) cast(waiting);
  }

  void cast_rest() {
    for (Waiting& waiting : sides_) {
      if (waiting.count > 0) cast(waiting);
    }
  }

 private:
  struct Waiting {
    std::size_t count = 0;
    std::array<std::size_t, RayPacket::kMax> rays;  // as indices of hits_
    std::array<RayOrigin, RayPacket::kMax> origins;
    std::array<glm::dvec3, RayPacket::kMax> directions;
    std::array<double, RayPacket::kMax> t_min_m;
  };

  void cast(Waiting& waiting) {
    const std::size_t count = std::exchange(waiting.count, 0);
    RayPacket packet(std::span(waiting.directions).first(count), std::span(waiting.t_min_m).first(count),
                     std::span(waiting.origins).first(count), RayPacket::Kind::scattered);
    SIMVIS_ASSERT(packet.count == count);
    traverse_from_origins(view_, tree_, packet);
    std::array<RayHit, RayPacket::kMax> hits;
    finish_packet(view_, packet, hits.data());
    for (std::size_t i = 0; i < count; ++i) hits_[waiting.rays[i]] = hits[i];
  }

  RayView& view_;
  const WideBvh& tree_;
  std::span<RayHit> hits_;
  std::array<Waiting, RayPacket::kSides> sides_;
};

// Returns whether the first kMinBundle rays are close enough to each other for a packet. Rays that are far apart test
// fewer boxes one by one.
bool begins_bundle(std::span<const glm::dvec3> directions, std::span<const RayOrigin> origins) {
  constexpr std::size_t kMinBundle = 8;
  if (directions.size() < kMinBundle) return false;
  for (std::size_t i = 1; i < kMinBundle; ++i) {
    const glm::dvec3 apart_m = origins[i].sensor_m - origins[0].sensor_m;
    if (glm::dot(directions[i], directions[0]) < RayPacket::kMinCosine) return false;
    if (glm::dot(apart_m, apart_m) > RayPacket::kMaxSpread_m * RayPacket::kMaxSpread_m) return false;
    if (RayPacket::side_of(directions[i]) != RayPacket::side_of(directions[0])) return false;
  }
  return true;
}

void cast_packets_from(RayView& view, const WideBvh& tree, std::span<const RayOrigin> origins,
                       std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                       std::span<const double> t_min_m) {
  ScatteredRays scattered(view, tree, hits);
  for (std::size_t first = 0; first < directions.size();) {
    const std::size_t left =
        std::min(std::size_t{RayPacket::kMax} - first % RayPacket::kMax, directions.size() - first);
    if (!begins_bundle(directions.subspan(first, left), origins.subspan(first, left))) {
      scattered.add(first, origins[first], directions[first], t_min_m.empty() ? 0 : t_min_m[first]);
      ++first;
      continue;
    }
    RayPacket packet(directions.subspan(first, left), part_of(t_min_m, first, left), origins.subspan(first, left));
    traverse_from_origins(view, tree, packet);
    finish_packet(view, packet, hits.data() + first);
    first += packet.count;
  }
  scattered.cast_rest();
}

}  // namespace

void PacketCaster::cast(const RayWorld& world, const glm::dmat4& world_from_sensor,
                        std::span<const glm::dvec3> directions, std::span<RayHit> hits, std::span<const double> t_min_m,
                        const HitsReady& there) {
  // Callers order many rays so that each group of kPacketSize rays holds neighbours (see RayCaster::kPacketSize). For
  // fewer rays, a longer group gives fewer packets.
  const std::size_t group = directions.size() > kPiece ? RayCaster::kPacketSize : kPiece;
  share(world, world_from_sensor, directions.size(), [&](RayView& view, std::size_t first, std::size_t count) {
    cast_bundles(view, world.tree, directions.subspan(first, count), hits.subspan(first, count),
                 part_of(t_min_m, first, count), group);
    if (there) there(first, count);
  });
}

void PacketCaster::cast_from(const RayWorld& world, const glm::dmat4& world_from_sensor,
                             std::span<const glm::dvec3> origins_m, std::span<const glm::dvec3> directions,
                             std::span<RayHit> hits, std::span<const double> t_min_m) {
  // One view of the world serves all rays. It stands at the first of them, because rounding grows with the distance.
  if (origins_m.empty()) return;
  share(world, glm::translate(world_from_sensor, origins_m[0]), directions.size(),
        [&](RayView& view, std::size_t first, std::size_t count) {
          cast_packets_from(view, world.tree, origins_of(view, world_from_sensor, origins_m.subspan(first, count)),
                            directions.subspan(first, count), hits.subspan(first, count),
                            part_of(t_min_m, first, count));
        });
}

void PacketCaster::share(const RayWorld& world, const glm::dmat4& world_from_sensor, std::size_t rays,
                         const Work& work) {
  for (RayView& view : views_) view.begin(world.list, world.items, world_from_sensor, world.sides);
  share(rays, work);
}

void PacketCaster::share(std::size_t rays, const Work& work) {
  pool_->parallel_for(
      rays, kPiece, [&](std::size_t slot, std::size_t first, std::size_t count) { work(views_[slot], first, count); });
}

void PacketCaster::count(RayCounters& counters) const {
  for (const RayView& view : views_) {
    counters.item_tests += view.item_tests;
    counters.triangle_tests += view.triangle_tests;
    counters.single_rays += view.single_rays;
  }
}

}  // namespace simvis
