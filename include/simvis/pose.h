// Poses as written in scene files, their matrices, motion, and what bodies of physics exert on each other.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/export.h>

namespace simvis {

/// The largest absolute coordinate that is accepted. The limit prevents overflow in chains of poses.
inline constexpr double kMaxCoordinate_m = 1e15;

/// A position and an orientation: x forward, y left, z up (REP 103); R = Rz(yaw) Ry(pitch) Rx(roll).
struct Pose {
  glm::dvec3 position_m{0};  ///< in the parent's frame
  double roll_rad = 0,       ///< rotation about x
      pitch_rad = 0,         ///< rotation about y
      yaw_rad = 0;           ///< rotation about z
};

/// How a rigid frame moves: its origin and its rotation, as vectors in the world frame.
///
/// Motion follows from poses at the frames of the simulation. Velocities are the mean of the time since the previous
/// frame: the constant twist (screw motion) that leads from the pose then to the pose now. Accelerations are the change
/// between the twists of the last two such times over the time between their middles. At the first frame after the load
/// or after the frame was hidden, everything stands still; at the second one the twist counts as constant.
struct Motion {
  glm::dvec3 velocity_mps{0},          ///< of the origin
      angular_velocity_radps{0},       ///< about the axes of the world
      acceleration_mps2{0},            ///< of the origin
      angular_acceleration_radps2{0};  ///< about the axes of the world
};

/// A place where two bodies of physics touch. World frame.
struct Contact {
  glm::dvec3 point_m{0},           ///< midway between both surfaces
      normal{0, 0, 1};             ///< unit length, towards the body whose contacts were asked for
  double depth_m = 0,              ///< above 0: the bodies overlap by so much; below 0: they are so far apart
      force_n = 0;                 ///< along the normal, mean of the last step of physics
  std::uint32_t own_instance = 0,  ///< SceneObject::instance of the part or link whose contacts were requested; 0: none
      other_instance = 0;          ///< that of the part or link that touches it; 0: none
};

/// What the link behind a joint exerts on the link in front of it, mean of the last step of physics. World frame.
struct JointLoad {
  glm::dvec3 point_m{0},  ///< the joint's origin
      force_n{0},         ///< force
      torque_nm{0};       ///< torque about the joint's origin
};

/// The matrix parent_from_child of a pose.
SIMVIS_API glm::dmat4 to_matrix(const Pose& pose);

/// The pose of a matrix parent_from_child that is rigid. roll and yaw lie within [-pi, pi], pitch within [-pi/2, pi/2].
/// Where the pose looks straight up or down, only the sum or difference of roll and yaw is defined; one of them is 0.
SIMVIS_API Pose to_pose(const glm::dmat4& rigid);

/// Whether a matrix is a rotation and a translation: finite, right-handed, and each element of R transpose(R) and of
/// the last row within `tolerance` of its value.
SIMVIS_API bool is_rigid(const glm::dmat4& m, double tolerance);

/// The matrix parent_from_child of a pose whose angles are in degrees, as in scene files. Multiples of 90 degrees give
/// exact rotations, see sincos_deg().
SIMVIS_API glm::dmat4 matrix_from_degrees(const glm::dvec3& position_m, double roll_deg, double pitch_deg,
                                          double yaw_deg);

/// Sine and cosine of one angle.
struct SinCos {
  double sin,  ///< sine
      cos;     ///< cosine
};

/// Sine and cosine of a finite angle in degrees. Angles of any size are reduced exactly; multiples of 90 degrees give
/// exactly 0, 1 or -1.
SIMVIS_API SinCos sincos_deg(double angle_deg);

/// The inverse of a rigid matrix (rotation and translation only).
SIMVIS_API glm::dmat4 rigid_inverse(const glm::dmat4& m);

/// The matrix sensor_from_view of a camera that looks along +x of its sensor frame; the view frame is x right, y down,
/// z forward. The reference is always valid.
SIMVIS_API const glm::dmat4& sensor_from_view();

}  // namespace simvis
