// What a URDF file says of masses, collisions and drives. The importer of parts leaves it out: only physics needs it.
// An SDF model says the same in other words: import/sdf/sdf_dynamics.h.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include <simvis/location.h>
#include <simvis/mesh.h>
#include <simvis/part_importer.h>

namespace simvis {

struct UrdfInertial {
  double mass_kg = 0;
  glm::dmat4 link_from_inertia{1.0};
  glm::dmat3 inertia_kg_m2{0.0};  ///< about the origin of that frame, along its axes
};

struct UrdfCollision {
  enum class Kind { box, sphere, cylinder, capsule, plane, mesh, surface } kind = Kind::box;
  glm::dmat4 link_from_shape{1.0};
  glm::dvec3 size{0};  ///< box: edges in m; sphere: the radius in x; cylinder and capsule, along z: the radius
                       ///< in x, in z the length between the ends or half balls; mesh: its scale. A plane is
                       ///< z = 0 without an end, and solid below
  std::filesystem::path file{};                     ///< of a mesh
  std::shared_ptr<const Mesh> surface{};            ///< of a surface that no file has
  std::optional<double> friction{}, restitution{};  ///< as those of an element `body`; none: the file gives none
  Location where{};
};

struct UrdfMovedLink {
  std::string name;
  std::optional<UrdfInertial> inertial;
  std::vector<UrdfCollision> collisions;
  Location where{};
};

/// Angles in radians.
struct UrdfMovingJoint {
  enum class Kind { fixed, revolute, continuous, prismatic, floating, planar } kind = Kind::fixed;
  std::string name;
  std::size_t parent = 0, child = 0;  ///< indices of links
  glm::dmat4 parent_from_joint{1.0};
  glm::dvec3 axis{1, 0, 0};                ///< unit length
  std::optional<double> lower{}, upper{};  ///< none: it is open
  double max_effort = 0;                   ///< N m or N; 0: the file gives none
  double max_speed = 0;                    ///< rad/s or m/s; 0: the file gives none
  double damping = 0, friction = 0;        ///< N m s/rad or N s/m; N m or N
  double stiffness = 0, rest = 0;          ///< of a spring: N m/rad or N/m, and where it is relaxed, in rad or m
  std::string leader{};                    ///< of a joint that mimics another
  double multiplier = 1, offset = 0;       ///< position = multiplier * leader + offset, in rad or m
  Location where{};
};

/// Links and joints as a tree: the first link is the root, every other one is the child of one joint, and joints stand
/// behind those above them.
struct UrdfDynamics {
  std::vector<UrdfMovedLink> links;
  std::vector<UrdfMovingJoint> joints;
};

/// Reads the file as the importer does, xacro included, and what is said of dynamics strictly.
/// Throws InputError with the place: as the importer; a number that is none; a mass, size, damping or friction that is
/// negative; a mesh that is missing.
UrdfDynamics read_urdf_dynamics(const ImportRequest& request);

}  // namespace simvis
