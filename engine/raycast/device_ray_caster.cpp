// Casts rays on a Vulkan device.
//
// A compute shader traverses the trees in float32 and returns, for each ray, the triangles that it may hit first. The
// host decides among them in double, as ray_caster.h says. If the shader's list is not complete up to the hit that the
// host finds, the host traverses its own trees for that ray and starts from this hit.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <utility>

#include <simvis/device.h>
#include "engine/base/assert.h"
#include "engine/raycast/item_tree.h"
#include "engine/raycast/packet_cast.h"
#include "engine/raycast/packet_caster.h"
#include "engine/raycast/packet_finish.h"
#include "engine/raycast/ray_dispatch.h"
#include "engine/raycast/tlas.h"
#include "engine/vulkan/frame_commands.h"

namespace simvis {

namespace {

float rounded_down(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded <= value ? rounded : std::nextafter(rounded, 0.0f);
}

/// The data of the world on the device.
struct DeviceWorld {
  explicit DeviceWorld(DeviceImpl& device)
      : commands(device, "the casting of rays"), uploads(device), meshes(device), top(device), dispatch(device) {}

  FrameCommands commands;
  Uploads uploads;
  BlasPool meshes;
  Tlas top;
  RayDispatch dispatch;
  bool current = false;  // up to date with RayInstances except for its last changes
};

class DeviceRayCaster : public RayCaster {
 public:
  explicit DeviceRayCaster(Device& device)
      : device_(device),
        items_(device.impl().cache_folder, device.impl().threads),
        packet_caster_(device.impl().threads) {}
  void set_world(const DrawList& list) override {
    list_ = &list;
    ignored_.clear();
  }
  void ignore(std::span<const std::uint32_t> items) override { ignored_.assign(items.begin(), items.end()); }
  void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
            std::span<const double> t_min_m, const HitsReady& there, HitSides sides) override;
  void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                 std::span<const double> t_min_m) override;
  void parallel_for(std::size_t count, std::size_t piece, const LoopBody& body) override {
    items_.threads().parallel_for(count, piece, body);
  }
  unsigned threads() const override { return items_.threads().size(); }
  RayCounters counters() const override { return items_.counters; }
  void name_memory(std::vector<PlannedMemory>& memory) const override;
  std::string_view engine() const override { return "a compute shader"; }

 private:
  void update(const glm::dvec3& world_place);
  void find_candidates(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                       std::span<const double> t_min_m, HitSides sides);
  void upload(VkCommandBuffer commands);
  void dispatch(VkCommandBuffer commands, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                std::span<const double> t_min_m, HitSides sides);
  void decide(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
              std::span<const double> t_min_m, HitSides sides);
  RayHit decide(RayView& view, RayPacket& ray, const shader::RayCandidates& candidates, bool& walked) const;
  RayWorld world(HitSides sides) const { return {*list_, items_, tree_.tree(), sides}; }

  Device& device_;
  const DrawList* list_ = nullptr;
  std::vector<std::uint32_t> ignored_;  // items of the list
  RayInstances items_;
  ItemTree tree_;                     // for rays that the host traverses
  std::optional<DeviceWorld> world_;  // exists from the first cast on
  bool uploaded_ = false;             // whether the changes are uploaded in this cast
  PacketCaster packet_caster_;
};

void DeviceRayCaster::cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                           std::span<RayHit> hits, std::span<const double> t_min_m, const HitsReady& there,
                           HitSides sides) {
  SIMVIS_ASSERT(list_ != nullptr && hits.size() == directions.size());
  SIMVIS_ASSERT(t_min_m.empty() || t_min_m.size() == directions.size());
  update(glm::dvec3(world_from_sensor[3]));
  const std::size_t most = world_->dispatch.max_rays();
  // One pass, except for more than max_rays() rays. Changes are uploaded even if there are no rays.
  for (std::size_t first = 0; first < directions.size() || !uploaded_; first += most) {
    const std::size_t count = std::min(most, directions.size() - first);
    const std::span<const double> part_t_min_m = part_of(t_min_m, first, count);
    find_candidates(world_from_sensor, directions.subspan(first, count), part_t_min_m, sides);
    decide(world_from_sensor, directions.subspan(first, count), hits.subspan(first, count), part_t_min_m, sides);
    if (there && count > 0) there(first, count);
  }
  items_.counters.rays += directions.size();
}

void DeviceRayCaster::update(const glm::dvec3& world_place) {
  if (!world_) world_.emplace(device_.impl());
  items_.update(*list_, ignored_, world_place);
  tree_.update(items_);
  uploaded_ = false;
}

// The host casts these rays: one dispatch per origin would cost more than the host needs for the few rays of an origin.
// The call of find_candidates() without rays keeps the trees on the device up to date.
void DeviceRayCaster::cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                                std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                                std::span<const double> t_min_m) {
  SIMVIS_ASSERT(t_min_m.empty() || t_min_m.size() == directions.size());
  SIMVIS_ASSERT(list_ != nullptr && hits.size() == directions.size() && origins_m.size() == directions.size());
  for (std::size_t start = 0, served = 0; start < directions.size(); start += served) {
    update(glm::dvec3(glm::translate(world_from_sensor, origins_m[start])[3]));
    served = items_.in_reach(world_from_sensor, origins_m.subspan(start));
    find_candidates(world_from_sensor, {}, {}, HitSides::both);
    packet_caster_.cast_from(world(HitSides::both), world_from_sensor, origins_m.subspan(start, served),
                             directions.subspan(start, served), hits.subspan(start, served),
                             part_of(t_min_m, start, served));
    items_.counters.rays += served;
    items_.counters.rays_walked += served;
  }
}

void DeviceRayCaster::name_memory(std::vector<PlannedMemory>& memory) const {
  if (!world_) return;
  const auto add = [&](const Buffer& buffer, const char* reason) {
    if (!buffer) return;
    memory.push_back({buffer.desc().name, reason, buffer.memory_bytes(), world_->uploads.bytes_to(buffer)});
  };
  add(world_->meshes.nodes(), "the tree of each mesh that rays can hit");
  add(world_->meshes.triangles(), "the triangles of each mesh that rays can hit");
  add(world_->top.nodes(), "the tree over items");
  add(world_->top.blocks(), "transforms of the items");
  for (const Buffer* const buffer : world_->dispatch.buffers()) add(*buffer, "rays and their candidates");
}

void DeviceRayCaster::find_candidates(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                                      std::span<const double> t_min_m, HitSides sides) {
  try {
    const VkCommandBuffer commands = world_->commands.begin();
    if (!uploaded_) upload(commands);
    if (!directions.empty() && !items_.items().empty()) {
      dispatch(commands, world_from_sensor, directions, t_min_m, sides);
    }
    world_->commands.submit_and_wait();
    world_->uploads.release();
  } catch (...) {
    // The recorded commands never ran, so none of their uploads count.
    world_->commands.abandon();
    world_->uploads.release();
    world_->meshes.clear();
    world_->top.clear();
    world_->current = false;
    throw;
  }
}

void DeviceRayCaster::upload(VkCommandBuffer commands) {
  DeviceWorld& world = *world_;
  world.uploads.begin(commands);
  const bool other_meshes = items_.structure_changed() || items_.meshes_changed() || !world.current;
  const bool meshes_moved = other_meshes && world.meshes.update(items_, world.uploads);
  world.top.update(*list_, items_, world.meshes, meshes_moved, world.uploads);
  world.uploads.finish();
  items_.counters.bytes_uploaded += world.uploads.bytes();
  world.current = uploaded_ = true;
}

void DeviceRayCaster::dispatch(VkCommandBuffer commands, const glm::dmat4& world_from_sensor,
                               std::span<const glm::dvec3> directions, std::span<const double> t_min_m,
                               HitSides sides) {
  DeviceWorld& world = *world_;
  const std::span<glm::vec4> world_directions = world.dispatch.directions(directions.size());
  const glm::dmat3 turn(world_from_sensor);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const float passed_m = t_min_m.empty() ? 0 : rounded_down(t_min_m[i]);
    world_directions[i] = glm::vec4(glm::vec3(turn * directions[i]), passed_m);
  }
  world.dispatch.record(commands,
                        {world.top.nodes(), world.top.blocks(), world.meshes.nodes(), world.meshes.triangles()},
                        block_of(glm::dvec3(world_from_sensor[3]), items_.origin(),
                                 static_cast<std::uint32_t>(directions.size()), sides));
  ++items_.counters.dispatches;
}

void DeviceRayCaster::decide(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
                             std::span<RayHit> hits, std::span<const double> t_min_m, HitSides sides) {
  if (directions.empty() || items_.items().empty()) {
    std::ranges::fill(hits, RayHit{});
    return;
  }
  const std::span<const shader::RayCandidates> candidates = world_->dispatch.candidates(directions.size());
  std::atomic<std::uint64_t> walked = 0;
  packet_caster_.share(world(sides), world_from_sensor, directions.size(),
                       [&](RayView& view, std::size_t first, std::size_t count) {
                         std::uint64_t here = 0;
                         for (std::size_t i = first; i < first + count; ++i) {
                           bool by_host = false;
                           RayPacket ray(directions.subspan(i, 1), part_of(t_min_m, i, 1));
                           hits[i] = decide(view, ray, candidates[i], by_host);
                           here += by_host;
                         }
                         walked += here;
                       });
  items_.counters.rays_walked += walked;
}

RayHit DeviceRayCaster::decide(RayView& view, RayPacket& ray, const shader::RayCandidates& candidates,
                               bool& walked) const {
  for (const std::uint32_t placed : items_.endless()) {
    if (view.placed(placed).visible) traverse_packet(view, placed, ray);
  }
  for (std::uint32_t i = 0; i < candidates.count; ++i) {
    const std::uint32_t placed = world_->top.placed(candidates.found[i].x), primitive = candidates.found[i].y;
    if (primitive == SIMVIS_WHOLE_ITEM) {
      traverse_packet(view, placed, ray);
      walked = true;
    } else {
      try_triangle(view, placed, primitive, ray);
    }
  }
  // A triangle that is not in the list lies at complete_to_m or farther.
  const bool complete = candidates.complete_to_m > SIMVIS_FAR_M || ray.farthest_m() < candidates.complete_to_m;
  if (!complete) {
    traverse_packet(view, tree_.tree(), ray);
    walked = true;
  }
  RayHit hit;
  finish_packet(view, ray, &hit);
  return hit;
}

}  // namespace

std::unique_ptr<RayCaster> make_device_ray_caster(Device& device) { return std::make_unique<DeviceRayCaster>(device); }

}  // namespace simvis
