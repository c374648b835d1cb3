// Motion from differences of world poses, in double. <simvis/pose.h> defines what a Motion is.
//
// The twist from a pose P0 to a pose P1 is the logarithm of inverse(P0) P1 over the time between them (Murray, Li,
// Sastry, "A Mathematical Introduction to Robotic Manipulation", 1994, section 2.3): the constant angular and linear
// velocity, in the moving frame, that leads from one pose to the other along a screw. A constant screw motion has the
// same twist in every interval, so its velocities and accelerations are exact except for rounding.
//
// Rounding. The elements of a rotation are wrong by some u = 2^-53, and positions by some u of their distance from the
// world's origin. Over a time dt an angular velocity is therefore wrong by about 10 u / dt, a velocity by
// 10 u distance / dt, and accelerations by twice that over another dt.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/pose.h>
#include <simvis/state_archive.h>

namespace simvis {

/// Angular and linear velocity of a frame, in the frame itself.
struct Twist {
  glm::dvec3 angular_radps{0}, linear_mps{0};
};

/// The constant twist that leads from one rigid pose to another in `seconds`, by a turn of at most pi.
Twist twist_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now, double seconds);

/// Products of poses stay rigid within this; a transform that differs more was scaled, sheared or mirrored.
inline constexpr double kMotionRigidity = 1e-9;

/// The velocity of matter at a point of the world, the mean of `seconds` in which its transform changed: by the twist,
/// or by the matter's way if it does not move rigidly.
glm::dvec3 matter_velocity_mps(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now,
                               const glm::dvec3& point_m, double seconds);

/// The poses of one frame at the last frames of the simulation.
class PoseHistory {
 public:
  /// Adds the pose at a time, in place of those at the same time and later.
  void add(std::int64_t time_ns, const glm::dmat4& world_from_body);
  /// The next pose is a first one.
  void clear() { count_ = 0; }
  Motion motion() const;
  void archive(StateArchive& state);

 private:
  struct At {
    std::int64_t time_ns = 0;
    glm::dmat4 world_from_body{1.0};
    void archive(StateArchive& state) {
      state(time_ns);
      state.finite(world_from_body);
    }
  };
  std::array<At, 3> poses_;  // the last one first
  std::size_t count_ = 0;
};

}  // namespace simvis
