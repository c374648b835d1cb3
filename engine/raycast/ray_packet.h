// A packet of rays from one position, or from positions close to each other, that traverse trees together.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include <simvis/ray_caster.h>
#include "engine/geometry/simd.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {

/// Where a ray starts that does not start at the origin of the sensor frame.
struct RayOrigin {
  glm::dvec3 world_m{0};   ///< in the world
  glm::dvec3 sensor_m{0};  ///< the same point in the sensor frame
  double distance_m = 0;   ///< of world_m from the world's origin
};

/// Rays from the origin of the sensor frame whose directions have the same largest component, with the same sign.
/// Sheared along this component (see ray_triangle.h), each ray is a point of a plane, and a rectangle of that plane
/// bounds the packet. What rays with origins of their own may hit is that of rays from the origin of the first one, the
/// apex, with every box and triangle larger by `spread_m`.
struct RayPacket {
  /// Which rays visit mostly the same boxes and therefore are one packet.
  enum class Kind {
    bundle,    ///< at angles to the first ray of at most that of kMinCosine, and kMaxSpread_m from its origin
    scattered  ///< anywhere, with origins of their own: each ray is tested alone against boxes
  };

  static constexpr unsigned kLanes = 4, kBatches = 8, kMax = kLanes * kBatches;
  static_assert(kMax == RayCaster::kPacketSize);
  static constexpr double kMaxSpread_m = 0.05;  ///< larger boxes cost more than smaller packets
  static constexpr double kMinCosine = 0.9;     ///< about 25 degrees: others do not visit mostly the same boxes

  /// Takes as many of the first rays as fit into one packet, at least one. `t_min_m` and `origins` are empty or as long
  /// as `rays`, the directions, which must outlive the packet.
  RayPacket(std::span<const glm::dvec3> rays, std::span<const double> t_min_m, std::span<const RayOrigin> origins = {},
            Kind kind = Kind::bundle);

  /// The largest component of a direction and its sign, which the rays of a packet have in common, as a number.
  static constexpr unsigned kSides = 6;
  static unsigned side_of(const glm::dvec3& direction);

  ShearedRay ray(unsigned index) const;
  const glm::dvec3& direction(unsigned index) const { return directions[index]; }

  /// Largest range of the rays' nearest hits; infinity while a ray has no hit.
  SIMVIS_INLINE double farthest_m() const {
    Double4 farthest = range_m[0];
    for (unsigned i = 1; i < batches; ++i) farthest = max(farthest, range_m[i]);
    return hmax(farthest);
  }

  const glm::dvec3* directions = nullptr;  ///< of the rays, in the caller's memory
  Kind kind = Kind::bundle;
  unsigned count = 0, batches = 0;
  int x = 0, y = 1, z = 2;  ///< axes of the sensor frame; z: the largest component
  double sign = 1;          ///< sign of that component
  double min_per_z = 0;     ///< smallest absolute value of the rays' per_z

  bool own_origins = false;    ///< whether rays have origins of their own; otherwise the next three are 0
  glm::dvec3 apex_m{0};        ///< origin of the first ray, sensor frame
  double apex_distance_m = 0,  ///< of the apex from the sensor's origin
      spread_m = 0;            ///< largest distance of a ray's origin from the apex
  Double4 start_m[3][kBatches], world_m[3][kBatches];  ///< own origins from the apex, and in the world; by axis
  Double4 distance_m[kBatches];                        ///< of own origins from the world's

  Double4 shear_x[kBatches], shear_y[kBatches], per_z[kBatches];
  /// Nearest hits so far; hits at or before `t_min_m` are skipped. SIMD lanes without a ray hit nothing.
  Double4 range_m[kBatches], t_min_m[kBatches];
  Mask4 placed[kBatches], primitive[kBatches];
  /// Bounds of the shears of each batch, four batches in one vector.
  Double4 low_x[kBatches / 4], high_x[kBatches / 4], low_y[kBatches / 4], high_y[kBatches / 4];

  /// The same in float32, eight rays in one vector: the shears along x and along y, the range of the nearest hit,
  /// rounded up, and the bounds of all shears.
  static constexpr unsigned kEights = kMax / 8;
  Float8 shears[2][kEights], end_m[kEights];
  float low_shear[2], high_shear[2];
  double low[2], high[2];  ///< bounds of all shears in double

  /// Computes end_m again after new hits.
  SIMVIS_INLINE void update_ends() {
    for (unsigned i = 0; i < kEights; ++i) end_m[i] = to_floats(range_m[2 * i], range_m[2 * i + 1]) * (1 + 0x1p-22f);
  }

  /// Planes through the sensor: the four sides, and the plane perpendicular to the largest component. A ray can only
  /// hit points p with n . p >= 0 for each of these five. The sixth normal is the negated direction along which
  /// distances are measured. Normals are up to sqrt(2) long.
  static constexpr int kPlanes = 6;
  Float8 normal_x, normal_y, normal_z;  ///< the two unused SIMD lanes are 0

 private:
  SIMVIS_FOR_EACH_MACHINE static void fill(RayPacket& packet, std::span<const glm::dvec3> rays,
                                           std::span<const double> passed_m, std::span<const RayOrigin> origins);
  void place(std::span<const glm::dvec3> rays, std::span<const double> passed_m, std::span<const RayOrigin> origins);
  /// What is accumulated over the rays, by SIMD lane.
  struct Sums {
    Double4 direction[3] = {splat4(0), splat4(0), splat4(0)};  ///< sum of the directions, along x, y and z
    Double4 min_per_z = splat4(std::numeric_limits<double>::infinity());
  };
  void set_axes(const glm::dvec3& leading);
  unsigned count_together(const glm::dvec3& leading, const Double4& along_x, const Double4& along_y,
                          const Double4& along_z) const;
  unsigned take_batch(std::span<const glm::dvec3> rays, std::span<const double> passed_m,
                      std::span<const RayOrigin> origins, Sums& sums);
  void pad_batches();
  void bound_shears(const Double4* exact, Double4* lows, Double4* highs, int axis);
  void set_planes(const Double4 (&direction)[3]);
  void begin_at(const RayOrigin& first);
  unsigned set_origins(unsigned batch, std::span<const RayOrigin> origins);
};

}  // namespace simvis
