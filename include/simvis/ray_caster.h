// Casting of rays into a draw list: where a laser hits, exact up to the rounding of double.
//
// Exactness. There are two engines, the host's cores and a compute shader on the device. Both only find candidates, in
// float32, with trees whose boxes are padded so that no relevant triangle is missed. The decision whether and where a
// ray hits a triangle is made in double on the triangle itself (see engine/raycast/ray_triangle.h); its vertices are
// the mesh's float32 positions, taken as exact, in the frame of the sensor. The result is therefore that of testing
// every triangle in double, whatever the trees look like, and bit for bit the same with either engine: the closest hit,
// and among several hits at one range the first primitive of the item that comes first by content (see
// engine/draw/canonical_order.h). shaders/ray_cast.comp derives its margins.
//
// Candidates on the host. Neighbouring rays form packets of up to 32, and a packet is a pyramid: four sides and the
// range of the farthest closest hit so far. Tree nodes have eight children; all eight boxes are tested against one
// plane at a time, and the up to four triangles of a leaf against the planes of the packet. A mesh's tree is in the
// mesh's frame, with its centre at the origin and its half diagonal as the unit; the pyramid is transformed into this
// frame and scaled so that no number is larger than about 1. The float32 rounding of each test is then below kPadding
// (in engine/geometry/box_padding.h; engine/raycast/packet_cast.cpp adds up the rounding errors). The tree over items
// has its origin near the sensor, and its boxes are padded by the same share of their distance. The test in double
// handles four rays at a time.
//
// Where the rays of a packet lie farther apart than a mesh's triangles, they share few boxes and go through the mesh
// one by one: a ray is tested against the eight boxes of a node at a time, in the mesh's frame, and then in double
// against the triangles of a leaf. Boxes are padded by kPadding of the sensor's distance there too. Both ways give the
// same bytes; the estimate that chooses is in engine/raycast/single_rays.h.
//
// Watertight. Rays through a shared edge or vertex of a mesh hit at least one of its triangles.
//
// Exact shapes. A mesh with a `surface` (see <simvis/exact_surface.h>) has no tree: a ray that reaches its box is
// tested with the shape, in double and on the host with either engine. engine/raycast/ray_surface.h derives the bound.
//
// Grids and clouds. A mesh that is a large regular grid of heights has no tree either: engine/raycast/height_grid.h
// finds the triangles to test. The points of a solid cloud (engine/draw/solid_cloud.h) are spheres in a tree; each is
// tested as an exact shape, and is the primitive that a ray hits.
//
// Error bound of a range r (u = 2^-53, theta the angle of incidence), computed by range_error_bound(): vertices are
// displaced by at most e = u (28 (reach + distance) + 21 offset) when they are transformed to the sensor frame, which
// moves the plane by e and the range by e / cos(theta). The weights of the corners round by 6 u m^2 / area, where m is
// the distance of the farthest corner from the ray, times the corners' difference in depth. No range leaves the depths
// of its triangle's corners. Float32 enters last, when a range is stored. Which surface a beam within about 1e-15 rad
// of an edge hits is decided by rounding; the bound does not cover this.
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
#include <simvis/export.h>
#include <simvis/frame_plan.h>

namespace simvis {

class Device;

/// The closest hit of a ray.
struct RayHit {
  /// Range along the ray in metres; +infinity: no hit, and the other members are 0.
  double range_m = std::numeric_limits<double>::infinity();
  double error_bound_m = 0;     ///< of range_m as a double
  std::uint32_t item = 0;       ///< in DrawList::items
  std::uint32_t primitive = 0;  ///< in the item's mesh; of an exact shape the face, as kRoundFace

  bool operator==(const RayHit&) const = default;  ///< member by member
};

/// Which sides rays hit of surfaces whose material is single-sided, see Material::double_sided. Discs of solid clouds
/// and all other surfaces are hit from both.
enum class HitSides : std::uint8_t {
  both,  ///< as a laser does
  front  ///< as a camera does: rays pass the back, also where it coincides with the front of another surface
};

/// Callback that reports that hits[first] to hits[first + count - 1] are complete.
///
/// Threads  called by the thread that has cast these rays. Several threads may call it at a time, each for other hits.
///          All calls happen before cast() returns.
using HitsReady = std::function<void(std::size_t first, std::size_t count)>;

/// The work of a caster since it was made in counts, without times.
struct RayCounters {
  std::uint64_t rays = 0;         ///< rays cast
  std::uint64_t item_tests = 0,   ///< tests of a ray packet with an item
      triangle_tests = 0;         ///< of a ray packet with a triangle, or of one ray with a leaf's triangles or a shape
  std::uint64_t single_rays = 0;  ///< host only: rays that went through the mesh of an item one by one, summed over
                                  ///< items, because they lie farther apart than its triangles
  std::uint64_t meshes_built = 0,      ///< meshes that were new to the caster; casters share their trees, which
                                       ///< are built when a ray first comes near
      triangles_built = 0;             ///< triangles of these trees that rays can hit
  std::uint64_t items_placed = 0;      ///< boxes computed for the tree over items
  std::uint64_t item_trees_built = 0,  ///< trees over items that were built
      item_trees_refitted = 0;         ///< trees over items whose boxes were updated
  std::uint64_t bytes_uploaded = 0;    ///< device only: of trees and items; a ray takes 16 bytes more
  std::uint64_t dispatches = 0;        ///< device only: compute dispatches
  std::uint64_t rays_walked = 0;       ///< device only: rays for which the host had to traverse trees itself

  bool operator==(const RayCounters&) const = default;  ///< member by member
};

/// Casts rays into a draw list. Surfaces are hit from both sides unless HitSides says otherwise, points of solid clouds
/// from outside and inside, other points and lines never. Where a material is transparent, what is depth-visible is hit
/// (see Material), by alpha (base colour x vertex colour x texture, largest level). Nothing beyond 10^18 m is hit.
///
/// Frames   the sensor's: x forward, y left, z up. Ranges are in metres along the ray.
/// Errors   MachineError if memory runs out or the device fails.
/// Threads  one thread at a time calls a caster. cast() itself uses all threads of its pool for many rays and gives the
///          same bytes for any number of threads. Casters that cast in different threads at once share the pool.
class SIMVIS_API RayCaster {
 public:
  /// The size of a ray packet: consecutive rays are cast together, which costs less if they are neighbours. Packets are
  /// the first kPacketSize rays, the next kPacketSize rays, and so on.
  static constexpr std::uint32_t kPacketSize = 32;

  RayCaster() = default;
  virtual ~RayCaster() = default;
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Sets the list that rays are cast into from now on. The list must live and stay unchanged until the last cast()
  /// into it. The call itself costs nothing: the next cast() builds trees for meshes that have none yet (meshes are
  /// distinguished by identity), and over items if one moved.
  virtual void set_world(const DrawList& list) = 0;

  /// Rays pass these items of the list too, ascending, until the next call; none at first and after set_world().
  virtual void ignore(std::span<const std::uint32_t> items) = 0;

  /// Casts from the sensor's origin. `world_from_sensor` is rigid; directions are unit vectors in the sensor frame;
  /// hits[i] belongs to directions[i]. Surfaces at or before the range `t_min_m[i]`, in metres, are ignored by ray i:
  /// the span is empty, or as long as directions, each value 0 or from 10^-30 to 10^18. `there`, if given, is called
  /// for finished hits while other rays are still being cast.
  virtual void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                    std::span<const double> t_min_m = {}, const HitsReady& there = {},
                    HitSides sides = HitSides::both) = 0;

  /// Casts from many origins: hits[i] is, bit for bit, what cast() gives for directions[i] with the sensor at
  /// glm::translate(world_from_sensor, origins_m[i]) and HitSides::both. This costs less if rays of one origin are
  /// consecutive. A device caster lets the host cast these rays, in double.
  virtual void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                         std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                         std::span<const double> t_min_m = {}) = 0;

  /// The part of a loop that one thread does.
  using LoopBody = std::function<void(std::size_t slot, std::size_t first, std::size_t count)>;
  /// Divides [0, count) into pieces of the size `piece` and calls `body` for each of them on the threads of its pool,
  /// for sensors that compute on the host. `slot` is below threads(), and no other call has it at the same time. An
  /// exception of `body` is rethrown.
  virtual void parallel_for(std::size_t count, std::size_t piece, const LoopBody& body);
  virtual unsigned threads() const { return 1; }  ///< that parallel_for() uses

  /// The work since the caster was made.
  virtual RayCounters counters() const = 0;

  /// Appends all memory that it holds on the device.
  virtual void name_memory(std::vector<PlannedMemory>&) const {}

  /// Whether it does not use the device, so that it may cast while the device renders.
  virtual bool on_host() const { return false; }

  /// The name of the engine, for people. The text is static.
  virtual std::string_view engine() const = 0;
};

/// A caster on the host's cores. `cache` is a folder that keeps trees of large meshes between runs; empty: they are not
/// kept. `threads` as SimulationDesc::threads.
SIMVIS_API std::unique_ptr<RayCaster> make_host_ray_caster(const std::filesystem::path& cache = {},
                                                           unsigned threads = 0);

/// A caster with a compute shader on the device. Nothing is allocated before the first cast. Hits are bit for bit those
/// of the host caster.
///
/// Errors    MachineError if the device cannot address trees of that size, or fails.
/// Lifetime  the device must outlive the caster.
/// Threads   all casters and renderers of one device are used by one thread at a time.
SIMVIS_API std::unique_ptr<RayCaster> make_device_ray_caster(Device& device);

/// The faster caster for a device: the host caster if the device is the host's own cores, otherwise the device caster.
/// Errors, lifetime and threads as make_device_ray_caster().
SIMVIS_API std::unique_ptr<RayCaster> make_ray_caster(Device& device);

}  // namespace simvis
