#include "engine/raycast/packet_caster.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

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

void cast_packets_from(RayView& view, const WideBvh& tree, std::span<const RayOrigin> origins,
                       std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                       std::span<const double> t_min_m) {
  for (std::size_t first = 0; first < directions.size();) {
    const std::size_t left =
        std::min(std::size_t{RayPacket::kMax} - first % RayPacket::kMax, directions.size() - first);
    RayPacket packet(directions.subspan(first, left), part_of(t_min_m, first, left), origins.subspan(first, left));
    traverse_from_origins(view, tree, packet);
    finish_packet(view, packet, hits.data() + first);
    first += packet.count;
  }
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
