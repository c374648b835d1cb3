#include "engine/raycast/packet_caster.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "engine/raycast/packet_cast.h"

namespace simvis {

namespace {

// A piece takes several times as long as waking a thread. One thread therefore casts a whole planar scan.
constexpr std::size_t kPiece = 16 * std::size_t{RayPacket::kMax};

// The number of consecutive rays, from `first` on, that have the same origin.
std::size_t together(std::span<const glm::dvec3> origins_m, std::size_t first) {
  std::size_t end = first + 1;
  while (end < origins_m.size() && origins_m[end] == origins_m[first]) ++end;
  return end - first;
}

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
  share(directions.size(), [&](RayView& view, std::size_t first, std::size_t count) {
    for (std::size_t ray = first, group = 0; ray < first + count; ray += group) {
      group = std::min(together(origins_m, ray), first + count - ray);
      view.begin(world.list, world.items, glm::translate(world_from_sensor, origins_m[ray]));
      cast_bundles(view, world.tree, directions.subspan(ray, group), hits.subspan(ray, group),
                   part_of(t_min_m, ray, group), group);
    }
  });
}

void PacketCaster::share(const RayWorld& world, const glm::dmat4& world_from_sensor, std::size_t rays,
                         const Work& work) {
  for (RayView& view : views_) view.begin(world.list, world.items, world_from_sensor);
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
