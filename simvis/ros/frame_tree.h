// The frames of a scene as ROS has them (REP 103, REP 105): their names, their parents, and which of them can move.
// Recordings, Foxglove and DDS take all transforms and all frame_ids from here.
//
//   world ── POINT ── nested POINT ── SENSOR ── SENSOR_optical
//   [world ──] odom ── POINT of an odometry that gives the transform; while the sensor is off, world ── POINT
//
// POINT    an insertion point at which a sensor stands, that an element `frame` names, or that belongs to the robot of
//          an element `robot_description`. Its parent is the nearest of them around it, else the world.
// SENSOR   has no frame of its own if its attribute `frame` is that of its POINT and it stands there without an offset.
// Moves    a transform can move if a node of an element stands between its two frames: a joint, a pose, a body, an
//          animated node. All others are fixed as long as the scene stays the same. A transform that moves in another
//          way counts as fixed until it first does; see ros::Transforms.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "simvis/frame.h"
#include "simvis/ros/frame_chains.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// A transform of one frame of a simulation.
struct FrameTransform {
  std::string parent, child;
  glm::dmat4 parent_from_child{1.0};  ///< rigid
  bool moves = false;                 ///< it can be another one in the next frame
};

class FrameTree {
 public:
  /// Names and parents of the frames of the scene, if it has changed. Throws InputError: two frames would have one
  /// name, or two odometries give the transform of one frame.
  void follow(const BuiltScene& scene);
  /// As follow(), and the poses of a frame of the simulation.
  void update(const BuiltScene& scene, std::span<const PlacedSensor> sensors);

  /// Of the last update(), parents before their children where both are given.
  const std::vector<FrameTransform>& transforms() const { return transforms_; }

  const std::string& world() const { return world_; }
  std::string of_point(const std::string& point) const;
  std::string of_sensor(const BuiltSensor& sensor) const;
  /// The poses of all insertion points that have a frame and are not below a switch that is off; rigid.
  const std::map<std::string, glm::dmat4>& world_from_point() const { return world_from_point_; }
  /// Where a sensor stands in the frame of its insertion point; empty: it stands at ROOT, or its point has no pose.
  std::optional<glm::dmat4> point_from_sensor(const PlacedSensor& sensor) const;

 private:
  struct Point {
    std::string parent;    // another one of points_; empty: the world
    bool moves = false;    // in its parent
    std::string odometry;  // the sensor that gives its transform; empty: none
  };
  void find_points(const BuiltScene& scene);
  void collect_points(const BuiltScene& scene);
  void find_parents(const BuiltScene& scene, const FrameChains& chains, const std::set<const Node*>& movers);
  void order_points(const BuiltScene& scene, const FrameChains& chains);
  void find_moving_sensors(const BuiltScene& scene, const FrameChains& chains, const std::set<const Node*>& movers);
  void find_odometries(const BuiltScene& scene);
  void check_names(const BuiltScene& scene) const;
  bool shares_frame(const BuiltSensor& sensor) const;
  void place_points(const BuiltScene& scene);
  void add_point(const std::string& name, const Point& point);
  void add_sensor(const PlacedSensor& sensor);
  void add_odometry(const PlacedSensor& sensor);

  std::optional<std::size_t> changes_;  // of the scene that were followed
  std::string world_;
  std::map<std::string, std::string> named_;  // frames by insertion point, as elements say
  std::map<std::string, Point> points_;       // without ROOT
  std::set<std::string> moving_sensors_;      // in the frames of their insertion points
  std::vector<std::string> order_;            // names in points_, parents before children
  std::map<std::string, glm::dmat4> world_from_point_;
  std::vector<FrameTransform> transforms_;
};

/// A number that grows with each change of the parts, elements and sensors of a scene; 0 for an empty scene.
std::size_t count_changes(const BuiltScene& scene);

/// The name of the frame of a camera's view: x to the right, y down, z forward. `view` is empty if the camera has one
/// view.
std::string optical_frame(const std::string& sensor_frame, const std::string& view);

/// The insertion point of a sensor; ROOT if its command names none.
std::string insertion_point(const BuiltSensor& sensor);

/// The frame of the pose of an odometry; "odom" by default.
std::string odometry_frame(const BuiltSensor& sensor);

}  // namespace simvis
