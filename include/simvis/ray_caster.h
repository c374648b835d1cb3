// Casts rays into a draw list: what a laser meets, exact to the rounding of double.
//
// How it decides. There are two engines, the host's cores and a compute shader on the device, and neither decides: they
// only find candidates, in float32, with trees whose boxes are padded such that nothing that matters is missed. Whether
// a ray meets a triangle, and where, is decided in double on the triangle itself (see ray_triangle.h), whose vertices
// are the mesh's float32 positions, taken as exact, in the frame of the sensor. So the result is that of testing every
// triangle in double, whatever the trees look like, and the same to the bit by either engine: the nearest hit, and of
// several at one range the first primitive of the item that comes first by content (see canonical_order.h).
// ray_cast.comp says what its margins are.
//
// How the host finds candidates. Neighbouring rays travel in bundles of up to 32, and a bundle is a pyramid: four sides
// and how far its farthest nearest hit is. Trees have eight children to a node; all eight boxes are held against one
// plane at a time, and the up to four triangles of a leaf against the bundle's. A mesh's tree is in the mesh's frame,
// its middle at the origin, its half diagonal the unit, and the pyramid is brought there, scaled such that nothing is
// larger than about 1: float32 then rounds what decides by less than kPadding (in ray_instances.h; packet_cast.cpp
// counts what rounds). The tree over items has its origin near the sensor, and its boxes are padded by the same share
// of their distance. Double decides upon four rays at a time.
//
// Watertight. Rays through a shared edge or vertex of a mesh meet at least one of its triangles.
//
// The bound of a range r (u = 2^-53, theta the incidence), all of it in range_error_bound(): vertices reach the sensor
// frame displaced by at most e = u (28 (reach + distance) + 21 offset), which moves the plane by e and the range by
// e / cos(theta); the weights of the corners round by 6 u m^2 / area, m the farthest corner from the ray, times the
// corners' difference in depth; and no range leaves the depths of its triangle's corners. Float32 comes in last, when
// a range is stored. Which surface a beam within some 1e-15 rad of an edge meets is rounding's to decide; the bound
// does not speak of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>

namespace simvis {

class Device;

/// What a ray meets: range along the ray in metres, +infinity for nothing (then the rest is 0).
struct RayHit {
  double range_m = std::numeric_limits<double>::infinity();
  double error_bound_m = 0;     ///< of range_m as a double
  std::uint32_t item = 0;       ///< of the draw list
  std::uint32_t primitive = 0;  ///< of its mesh

  bool operator==(const RayHit&) const = default;
};

/// Told that hits[first] to hits[first + count - 1] are there, by whichever thread has cast them: several may be told
/// at a time, each of other hits, and all before cast() returns.
using HitsReady = std::function<void(std::size_t first, std::size_t count)>;

/// What casting has cost since the caster was made, counted and not timed.
struct RayCounters {
  std::uint64_t rays = 0;
  std::uint64_t item_tests = 0, triangle_tests = 0;     ///< of a bundle of rays with an item, and with a triangle
  std::uint64_t meshes_built = 0, triangles_built = 0;  ///< that rays can meet: trees are made when one comes near
  std::uint64_t items_placed = 0;                       ///< boxes computed for the tree over items
  std::uint64_t item_trees_built = 0, item_trees_refitted = 0;
  // Of a device only:
  std::uint64_t bytes_uploaded = 0;  ///< of trees and items; a ray takes 16 more
  std::uint64_t dispatches = 0;
  std::uint64_t rays_walked = 0;  ///< for which the host had to look into trees itself

  bool operator==(const RayCounters&) const = default;
};

/// Triangles are met from either side, lines and points not at all. Of a material those points are met which a depth
/// sensor sees (see Material), by alpha (base colour x vertex colour x texture, largest level). What lies beyond
/// 10^18 m is not met.
///
/// Errors   MachineError where memory runs out.
/// Threading  one thread at a time; cast() itself uses all cores for many rays, and gives the same on any number.
class RayCaster {
 public:
  /// Rays that follow one another are cast together, up to so many: it costs less where they are neighbours. Of very
  /// many rays these are the first so many, the next so many, and so on.
  static constexpr std::uint32_t kPacketSize = 32;

  RayCaster() = default;
  virtual ~RayCaster() = default;
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// What is cast into from now on. The list must stay as it is until the last cast() into it. Costs nothing: trees
  /// are made at the next cast(), for meshes that have none yet (told apart by identity), and over items if one moved.
  virtual void set_world(const DrawList& list) = 0;

  /// Casts from the sensor's origin. `world_from_sensor` is rigid; directions are unit vectors in the sensor frame;
  /// hits[i] belongs to directions[i]. What ray i meets at or before the range `t_min_m[i]`, in metres, it passes:
  /// empty, or as long as directions, each 0 or from 10^-30 to 10^18. `there`, if given, goes on with hits while others
  /// are still cast.
  virtual void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                    std::span<const double> t_min_m = {}, const HitsReady& there = {}) = 0;

  /// From many places: hits[i] is, to the bit, what cast() gives for directions[i] where the sensor stands at
  /// glm::translate(world_from_sensor, origins_m[i]). Costs less where rays of one origin follow one another. On a
  /// device they are cast by the host, in double.
  virtual void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                         std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                         std::span<const double> t_min_m = {}) = 0;

  virtual RayCounters counters() const = 0;

  /// Adds all memory that it holds on the device.
  virtual void name_memory(std::vector<PlannedMemory>&) const {}

  /// Whether it leaves the device alone, and so may cast while that renders.
  virtual bool on_host() const { return false; }

  /// Who casts, for people.
  virtual std::string_view engine() const = 0;
};

/// On the host's cores. `cache`: a folder where trees of large meshes are kept between runs; empty: nowhere.
std::unique_ptr<RayCaster> make_host_ray_caster(const std::filesystem::path& cache = {});

/// A compute shader on the device, which must outlive it; several share a device only from one thread, and with its
/// renderers. Nothing is made before the first cast. Same hits as by the host, to the bit.
/// Errors   MachineError where the device cannot address trees of that size, or fails.
std::unique_ptr<RayCaster> make_device_ray_caster(Device& device);

/// The faster one: the host where the device is its own cores; else the device.
std::unique_ptr<RayCaster> make_ray_caster(Device& device);

}  // namespace simvis
