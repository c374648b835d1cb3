#include "engine/ray_bundle.h"

#include <algorithm>

namespace simvis {

namespace {

// Rays farther apart than this do not see much the same any more: about 25 degrees.
constexpr double kLeastCosine = 0.9;

}  // namespace

RayBundle::RayBundle(std::span<const glm::dvec3> directions, std::span<const double> passed_m) {
  const ShearedRay first(directions[0]);
  x = first.x;
  y = first.y;
  z = first.z;
  sign = first.per_z < 0 ? -1 : 1;
  least_per_z = std::numeric_limits<double>::infinity();
  glm::dvec3 sum(0);
  const unsigned most = static_cast<unsigned>(std::min<std::size_t>(kMost, directions.size()));
  for (; count < most; ++count) {
    const ShearedRay ray(directions[count]);
    if (ray.z != z || ray.per_z * sign < 0 || glm::dot(directions[count], directions[0]) < kLeastCosine) break;
    const unsigned batch = count / kLanes, lane = count % kLanes;
    shear_x[batch][lane] = ray.shear_x;
    shear_y[batch][lane] = ray.shear_y;
    per_z[batch][lane] = ray.per_z;
    least_per_z = std::min(least_per_z, std::abs(ray.per_z));
    sum += directions[count];
  }
  batches = (count + kLanes - 1) / kLanes;
  for (unsigned i = count; i < batches * kLanes; ++i) {
    shear_x[i / kLanes][i % kLanes] = shear_x[(count - 1) / kLanes][(count - 1) % kLanes];
    shear_y[i / kLanes][i % kLanes] = shear_y[(count - 1) / kLanes][(count - 1) % kLanes];
    per_z[i / kLanes][i % kLanes] = per_z[(count - 1) / kLanes][(count - 1) % kLanes];
  }
  double low[2] = {least_per_z, least_per_z}, high[2] = {-least_per_z, -least_per_z};
  for (unsigned batch = 0; batch < batches; ++batch) {
    const auto bounds = [](const Double4& v, double& low_of, double& high_of) {
      low_of = std::min({v[0], v[1], v[2], v[3]});
      high_of = std::max({v[0], v[1], v[2], v[3]});
    };
    bounds(shear_x[batch], low_x[batch], high_x[batch]);
    bounds(shear_y[batch], low_y[batch], high_y[batch]);
    low[0] = std::min(low[0], low_x[batch]);
    high[0] = std::max(high[0], high_x[batch]);
    low[1] = std::min(low[1], low_y[batch]);
    high[1] = std::max(high[1], high_y[batch]);
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      const unsigned i = batch * kLanes + lane;
      range_m[batch][lane] = i < count ? std::numeric_limits<double>::infinity() : -1;
      beyond_m[batch][lane] = i < count && !passed_m.empty() ? passed_m[i] : 0;
    }
    placed[batch] = primitive[batch] = Mask4{};
  }
  for (glm::dvec3& normal : normals) normal = glm::dvec3(0);
  normals[0][x] = sign;
  normals[0][z] = -sign * low[0];
  normals[1][x] = -sign;
  normals[1][z] = sign * high[0];
  normals[2][y] = sign;
  normals[2][z] = -sign * low[1];
  normals[3][y] = -sign;
  normals[3][z] = sign * high[1];
  normals[4][z] = sign;
  normals[5] = -glm::normalize(sum);
}

ShearedRay RayBundle::ray(unsigned index) const {
  ShearedRay ray;
  ray.x = x;
  ray.y = y;
  ray.z = z;
  ray.shear_x = shear_x[index / kLanes][index % kLanes];
  ray.shear_y = shear_y[index / kLanes][index % kLanes];
  ray.per_z = per_z[index / kLanes][index % kLanes];
  return ray;
}

}  // namespace simvis
