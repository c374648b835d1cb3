// Rays from one place that travel together: neighbours of a scan, that see much the same.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include <simvis/ray_caster.h>
#include "engine/geometry/simd.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {

/// Rays from the origin of the sensor frame whose directions have the same largest component, of the same sign. Sheared
/// along it (see ray_triangle.h) each is a point of a plane, and the bundle a rectangle there.
struct RayPacket {
  static constexpr unsigned kLanes = 4, kBatches = 8, kMax = kLanes * kBatches;
  static_assert(kMax == RayCaster::kPacketSize);

  /// From as many of the first rays as fit together, at least one. `t_min_m` is empty or as long.
  RayPacket(std::span<const glm::dvec3> directions, std::span<const double> t_min_m);

  ShearedRay ray(unsigned index) const;

  /// Range of the farthest of the nearest hits, infinity while a ray has met nothing.
  SIMVIS_INLINE double farthest_m() const {
    Double4 farthest = range_m[0];
    for (unsigned i = 1; i < batches; ++i) farthest = max(farthest, range_m[i]);
    return hmax(farthest);
  }

  unsigned count = 0, batches = 0;
  int x = 0, y = 1, z = 2;  ///< axes of the sensor frame; z: the largest component
  double sign = 1;          ///< of that component
  double min_per_z = 0;     ///< of the amounts of the rays' per_z

  Double4 shear_x[kBatches], shear_y[kBatches], per_z[kBatches];
  /// Nearest hits so far; what is met at or before `t_min_m` is passed. Lanes without a ray meet nothing.
  Double4 range_m[kBatches], t_min_m[kBatches];
  Mask4 placed[kBatches], primitive[kBatches];
  /// Of the shears of each batch, four batches side by side.
  Double4 low_x[kBatches / 4], high_x[kBatches / 4], low_y[kBatches / 4], high_y[kBatches / 4];

  /// Once more in float32, eight rays side by side: the shears along x and along y, and the range of the nearest hit,
  /// rounded up.
  static constexpr unsigned kEights = kMax / 8;
  Float8 shears[2][kEights], end_m[kEights];
  float low_shear[2], high_shear[2];
  double low[2], high[2];  ///< the same in double

  /// After hits were found: end_m anew.
  SIMVIS_INLINE void update_ends() {
    for (unsigned i = 0; i < kEights; ++i) {
      using Float4 = float __attribute__((vector_size(16)));
      const Float4 first = __builtin_convertvector(range_m[2 * i], Float4);
      const Float4 second = __builtin_convertvector(range_m[2 * i + 1], Float4);
      end_m[i] = __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7) * (1 + 0x1p-22f);
    }
  }

  /// What lies before all of these planes through the sensor, n . p >= 0, may be met: the sides, and the plane across
  /// the largest component. The last is the direction that distances are counted along, turned round. Normals are up to
  /// sqrt(2) long.
  static constexpr int kPlanes = 6;
  Float8 normal_x, normal_y, normal_z;  ///< the two lanes that are left over are 0

 private:
  static void fill(RayPacket& packet, std::span<const glm::dvec3> directions, std::span<const double> passed_m);
  void place(std::span<const glm::dvec3> directions, std::span<const double> passed_m);
};

}  // namespace simvis
