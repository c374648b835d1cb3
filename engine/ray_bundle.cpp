#include "engine/ray_bundle.h"

#include <algorithm>

namespace simvis {

namespace {

// Rays farther apart than this do not see much the same any more: about 25 degrees.
constexpr double kLeastCosine = 0.9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// As ShearedRay has it.
int largest_axis(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

}  // namespace

RayBundle::RayBundle(std::span<const glm::dvec3> directions, std::span<const double> passed_m) {
  z = largest_axis(directions[0]);
  x = (z + 1) % 3;
  y = (z + 2) % 3;
  sign = directions[0][z] < 0 ? -1 : 1;
  glm::dvec3 sum(0);
  Double4 along_z[kBatches];
  const auto take = [&](unsigned index, const glm::dvec3& direction) {
    const unsigned batch = index / kLanes, lane = index % kLanes;
    shear_x[batch][lane] = direction[x];
    shear_y[batch][lane] = direction[y];
    along_z[batch][lane] = direction[z];
  };
  const unsigned most = static_cast<unsigned>(std::min<std::size_t>(kMost, directions.size()));
  for (; count < most; ++count) {
    const glm::dvec3& direction = directions[count];
    if (largest_axis(direction) != z || direction[z] * sign < 0) break;
    if (glm::dot(direction, directions[0]) < kLeastCosine) break;
    take(count, direction);
    sum += direction;
  }
  batches = (count + kLanes - 1) / kLanes;
  for (unsigned i = count; i < batches * kLanes; ++i) take(i, directions[count - 1]);
  // As ShearedRay does.
  Double4 least_z = all4(kInfinity);
  for (unsigned batch = 0; batch < batches; ++batch) {
    per_z[batch] = all4(1) / along_z[batch];
    shear_x[batch] /= along_z[batch];
    shear_y[batch] /= along_z[batch];
    least_z = least(least_z, abs4(per_z[batch]));
  }
  least_per_z = -greatest(-least_z);
  double low[2] = {kInfinity, kInfinity}, high[2] = {-kInfinity, -kInfinity};
  for (unsigned i = 0; i < kBatches / 4; ++i) {
    low_x[i] = low_y[i] = all4(kInfinity);
    high_x[i] = high_y[i] = all4(-kInfinity);
  }
  for (unsigned batch = 0; batch < batches; ++batch) {
    const auto bounds = [&](const Double4& v, Double4* lows, Double4* highs, int axis) {
      const double low_of = std::min({v[0], v[1], v[2], v[3]}), high_of = std::max({v[0], v[1], v[2], v[3]});
      lows[batch / 4][batch % 4] = low_of;
      highs[batch / 4][batch % 4] = high_of;
      low[axis] = std::min(low[axis], low_of);
      high[axis] = std::max(high[axis], high_of);
    };
    bounds(shear_x[batch], low_x, high_x, 0);
    bounds(shear_y[batch], low_y, high_y, 1);
    for (unsigned lane = 0; lane < kLanes; ++lane) {
      const unsigned i = batch * kLanes + lane;
      range_m[batch][lane] = i < count ? kInfinity : -1;
      beyond_m[batch][lane] = i < count && !passed_m.empty() ? passed_m[i] : 0;
    }
    placed[batch] = primitive[batch] = Mask4{};
  }
  for (unsigned i = 0; i < kMost; ++i) {
    const unsigned ray = std::min(i, count - 1);
    shears[0][i / 8][i % 8] = static_cast<float>(shear_x[ray / kLanes][ray % kLanes]);
    shears[1][i / 8][i % 8] = static_cast<float>(shear_y[ray / kLanes][ray % kLanes]);
  }
  for (int axis = 0; axis < 2; ++axis) {
    low_shear[axis] = static_cast<float>(low[axis]);
    high_shear[axis] = static_cast<float>(high[axis]);
  }
  for (unsigned batch = batches; batch < kBatches; ++batch) range_m[batch] = all4(-1);
  take_ends();
  glm::dvec3 normals[kPlanes];
  const auto set_side = [&](int plane, int axis, double side, double shear) {
    normals[plane] = glm::dvec3(0);
    normals[plane][axis] = side * sign;
    normals[plane][z] = -side * sign * shear;
  };
  set_side(0, x, 1, low[0]);
  set_side(1, x, -1, high[0]);
  set_side(2, y, 1, low[1]);
  set_side(3, y, -1, high[1]);
  normals[4] = glm::dvec3(0);
  normals[4][z] = sign;
  normals[5] = -glm::normalize(sum);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 normal = i < kPlanes ? normals[i] : glm::dvec3(0);
    normal_x[i] = static_cast<float>(normal.x);
    normal_y[i] = static_cast<float>(normal.y);
    normal_z[i] = static_cast<float>(normal.z);
  }
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
