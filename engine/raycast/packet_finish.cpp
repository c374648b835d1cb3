#include "engine/raycast/packet_finish.h"

#include <algorithm>
#include <type_traits>

#include "engine/raycast/own_origins.h"
#include "engine/raycast/packet_triangle.h"

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_on_shape(RayView& view, const RayPacket& packet, unsigned batch, unsigned lane) {
  return packet.range_m[batch][lane] != kInfinity &&
         view.surface(view.seen(static_cast<std::uint32_t>(packet.placed[batch][lane]))) != nullptr;
}

// Whether one of the first `lanes` rays of a batch met an exact shape. It costs nothing where no shape was near.
SIMVIS_INLINE bool meets_shape(RayView& view, const RayPacket& packet, unsigned batch, unsigned lanes) {
  if (!view.has_surfaces()) return false;
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if (is_on_shape(view, packet, batch, lane)) return true;
  }
  return false;
}

// Gives the same bounds as bounds_of_batch() does for triangles.
void finish_one_by_one(RayView& view, const RayPacket& packet, unsigned first, unsigned lanes, RayHit* hits) {
  for (unsigned ray = first; ray < first + lanes; ++ray) {
    const unsigned batch = ray / RayPacket::kLanes, lane = ray % RayPacket::kLanes;
    view.finished_singly += packet.range_m[batch][lane] != kInfinity && !is_on_shape(view, packet, batch, lane);
    const ClosestHit nearest{packet.range_m[batch][lane], static_cast<std::uint32_t>(packet.placed[batch][lane]),
                             static_cast<std::uint32_t>(packet.primitive[batch][lane])};
    hits[ray] = packet.own_origins
                    ? view.finish_from(origin_of(packet, ray), packet.ray(ray), packet.direction(ray), nearest)
                    : view.finish(packet.ray(ray), packet.direction(ray), nearest);
  }
}

// In place of HitItems where no ray has an origin of its own.
struct NoItems {
  NoItems(RayView&, std::uint32_t) {}
};

template <bool kOwn>
SIMVIS_INLINE void finish(RayView& view, const RayPacket& packet, unsigned batch, RayHit* hits) {
  const unsigned first = batch * RayPacket::kLanes, lanes = std::min(RayPacket::kLanes, packet.count - first);
  const Mask4 &placed = packet.placed[batch], &primitive = packet.primitive[batch];
  unsigned seen = 0;  // the last lane whose triangle was loaded
  while (seen < lanes && packet.range_m[batch][seen] == kInfinity) ++seen;
  if (seen == lanes) {
    std::fill_n(hits + first, lanes, RayHit{});
    return;
  }
  if (meets_shape(view, packet, batch, lanes)) return finish_one_by_one(view, packet, first, lanes, hits);
  const auto see = [&](unsigned lane) __attribute__((always_inline)) {
    const auto of_item = static_cast<std::uint32_t>(placed[lane]),
               of_mesh = static_cast<std::uint32_t>(primitive[lane]);
    const SeenItem& item = view.seen(of_item);
    const Mesh& mesh = *view.placed(of_item).mesh->mesh();
    if constexpr (!kOwn) return HitTriangle{place_corners(mesh, of_mesh, item.placement), item.corner_error_m};
    const MeshPlacement turned{item.placement.linear, glm::dvec3(0)};
    return HitTriangle{place_corners(mesh, of_mesh, turned), item.corner_error_m};
  };
  HitTriangles found(see(seen));  // lanes without a hit hold the triangle of another lane
  [[maybe_unused]] std::conditional_t<kOwn, HitItems, NoItems> items(view, static_cast<std::uint32_t>(placed[seen]));
  for (unsigned lane = seen + 1; lane < lanes; ++lane) {
    if (packet.range_m[batch][lane] == kInfinity) continue;
    if (placed[lane] == placed[seen] && primitive[lane] == primitive[seen]) continue;
    found.set_from(lane, see(lane));
    if constexpr (kOwn) {
      if (placed[lane] != placed[seen]) items.set_from(lane, view, static_cast<std::uint32_t>(placed[lane]));
    }
    seen = lane;
  }
  if constexpr (kOwn) items.move(packet, batch, view.world_from_sensor(), found);
  bool unsure = false;
  const Double4 bounds = bounds_of_batch(packet, batch, found, unsure);
  for (unsigned lane = 0; lane < lanes; ++lane) {
    const double range_m = packet.range_m[batch][lane];
    const auto of_item = static_cast<std::uint32_t>(placed[lane]),
               of_mesh = static_cast<std::uint32_t>(primitive[lane]);
    if (range_m == kInfinity) {
      hits[first + lane] = {};
    } else if (unsure) {
      finish_one_by_one(view, packet, first + lane, 1, hits);
    } else {
      hits[first + lane] = {range_m, bounds[lane], view.placed(of_item).item, of_mesh};
    }
  }
}

SIMVIS_FOR_EACH_MACHINE void finish_batches(RayView& view, const RayPacket& packet, RayHit* hits) {
  for (unsigned batch = 0; batch < packet.batches; ++batch) {
    if (packet.own_origins) {
      finish<true>(view, packet, batch, hits);
    } else {
      finish<false>(view, packet, batch, hits);
    }
  }
}

}  // namespace

void finish_packet(RayView& view, const RayPacket& packet, RayHit* hits) { finish_batches(view, packet, hits); }

}  // namespace simvis
