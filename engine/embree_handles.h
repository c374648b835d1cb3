// What Embree's parts here have in common: handles that let go, and how numbers reach it.
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <memory>

#include "engine/ray_items.h"

namespace simvis {

struct ReleaseEmbree {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using EmbreeDevice = std::unique_ptr<RTCDeviceTy, ReleaseEmbree>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, ReleaseEmbree>;
using EmbreeGeometry = std::unique_ptr<RTCGeometryTy, ReleaseEmbree>;

/// Throws MachineError if something went wrong since the last call.
void check_embree(RTCDevice device);

inline RTCBounds bounds_of(const Box& box) {
  return {.lower_x = box.low.x,
          .lower_y = box.low.y,
          .lower_z = box.low.z,
          .align0 = 0,
          .upper_x = box.high.x,
          .upper_y = box.high.y,
          .upper_z = box.high.z,
          .align1 = 0};
}

/// A direction of about unit length in float32. Embree takes the sign of components below 1e-18 for that of +0 in one
/// place and for their own in another, and loses hits; at 1e-9 they matter to nobody yet.
inline glm::vec3 float_direction(const glm::dvec3& direction) {
  constexpr double kNothing = 1e-9;
  return {std::abs(direction.x) < kNothing ? 0 : direction.x, std::abs(direction.y) < kNothing ? 0 : direction.y,
          std::abs(direction.z) < kNothing ? 0 : direction.z};
}

/// The end of a ray in float32 such that a hit at `range` is still on it: box tests round, too.
inline float end_of_ray(double range) {
  constexpr double kLargest = std::numeric_limits<float>::max() / 2;
  return range < kLargest ? static_cast<float>(range * (1 + kPadding)) : std::numeric_limits<float>::infinity();
}

}  // namespace simvis
