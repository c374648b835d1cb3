// What a sensor asks of the scene beyond its own pose and the draw list, and gets.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/export.h>
#include <simvis/motion_path.h>
#include <simvis/object_tree.h>
#include <simvis/pose.h>
#include <simvis/scan.h>
#include <simvis/surface_heat.h>

namespace simvis {

/// An insertion point of the scene.
struct SensedPoint {
  std::string name;                  ///< of the insertion point
  std::uint32_t number = 0;          ///< by name, among all that match, those that are off included
  glm::dmat4 world_from_point{1.0};  ///< rigid
  /// Since the sensor was last due, with SensorNeeds::item_moves. Null: it stands still.
  std::shared_ptr<const MotionPath> path{};
};

/// A joint of the scene: an element of type `joint` or `mimic_joint`.
struct SensedJoint {
  std::string name;     ///< the element's name
  bool slides = false;  ///< its position is in metres, otherwise in radians
  double position = 0,  ///< m or rad
      velocity = 0;     ///< m/s or rad/s, where no physics moves the joint the mean since the previous frame;
                        ///< 0 at the first
  std::optional<double> effort{};  ///< N or N m, of its drive in the last step of physics; NaN in a simulation that
                                   ///< follows another one. Empty: no physics moves it, or it follows another joint
};

/// Consecutive items of the draw list.
struct ItemRange {
  std::uint32_t first = 0,  ///< in DrawList::items
      end = 0;              ///< one past the last
};

/// The ids of the items of the draw list, by item. They follow from names, not from the draw list: the same object has
/// the same id in all sensors, frames, runs and processes, whatever else the scene has.
struct ItemIds {
  std::span<const std::uint32_t> instance,  ///< of the object that has the item, at least 1: what a label makes one
                                            ///< object, else the part or link
      semantic,                             ///< of its class, as elements of type `label` say; 0: none
      shape;                                ///< of the item itself, at least 1; no two items share one
};

/// The heat of the items of the draw list.
struct SensedHeat {
  std::span<const std::uint32_t> of_item;  ///< by item: its place in `surfaces`; 0: no element `temperature` names it
  std::span<const SurfaceHeat> surfaces;   ///< at least one
  ThermalSurroundings surroundings;        ///< of the scene
};

/// The whole scene of a frame, for a sensor that compares it with that of another frame.
struct SensedScene {
  const DrawList& list;                  ///< what it draws and casts rays into
  std::span<const std::uint32_t> shape;  ///< as in ItemIds
};

/// What a sensor needs to know about the scene beyond its own pose and the draw list. Only this is computed.
struct SensorNeeds {
  bool motion = false;               ///< SensedWorld::motion()
  bool item_motion = false;          ///< SensedWorld::velocity_mps()
  std::vector<std::string> parts{};  ///< names of objects for SensedWorld::items_of()
  std::string points{};              ///< names and patterns of objects for SensedWorld::points()
  std::string joints_of{};           ///< insertion point for SensedWorld::joints()
  bool item_moves = false;           ///< SensedWorld::item_moves(), sensor_path(), SensedPoint::path
  bool moves_in_one_piece = false;   ///< the same without the frames since the sensor was last due
  bool item_ids = false;             ///< SensedWorld::item_ids()
  bool objects = false;              ///< SensedWorld::objects()
  bool heat = false;                 ///< SensedWorld::heat()
  bool scene = false;                ///< SensedWorld::scene(), also before Sensor::skip_frame()
  std::string contacts_of{};         ///< insertion point for SensedWorld::contacts()
  std::string load_of{};             ///< element of type joint for SensedWorld::joint_load()
  bool gnss_jamming = false;         ///< SensedWorld::gnss_is_jammed()
  bool shapes = false;               ///< the shapes of the scene for its rays, though its type has sees_shapes false

  /// Whether it is nothing of SensedWorld.
  bool none() const {
    return !motion && !item_motion && !item_moves && !item_ids && !objects && !heat && !scene && parts.empty() &&
           points.empty() && joints_of.empty() && contacts_of.empty() && load_of.empty() && !gnss_jamming;
  }
};

/// What a sensor may know about the scene of the frame, as far as its SensorNeeds name it.
///
/// Lifetime  valid from Sensor::sense() until the end of cast() of the same frame.
class SIMVIS_API SensedWorld {
 public:
  virtual ~SensedWorld() = default;
  /// The motion of the sensor. If a body of physics carries it and nothing moves it on the body, the acceleration is
  /// that of the body's last step before the frame.
  virtual Motion motion() const = 0;
  /// The velocity of the matter of an item at a point of the world; world frame.
  virtual glm::dvec3 velocity_mps(std::uint32_t item, const glm::dvec3& point_m) const = 0;
  /// The items of what stands at an insertion point: of its part, and of everything inserted there. Empty if it is off.
  virtual ItemRange items_of(std::string_view point) const = 0;
  /// The insertion points of the objects that the patterns name, sorted by name, without those that are off. ROOT is
  /// not among them.
  virtual std::vector<SensedPoint> points() const = 0;
  /// The joints of the part that has the insertion point, those in its file and those that follow others included, in
  /// the order of their commands; of ROOT: all joints.
  virtual std::vector<SensedJoint> joints() const = 0;
  /// The items that have moved since the sensor was last due, in the order of the list. An item that is new since then,
  /// or that has changed its shape or scale, is not among them.
  virtual std::span<const ItemMove> item_moves() const = 0;
  /// The path of the sensor since it was last due. It stands still where the path of an item would be missing.
  virtual const MotionPath& sensor_path() const = 0;
  /// The ids of the items of this frame's draw list.
  virtual ItemIds item_ids() const = 0;
  /// The objects of this frame's scene, as Simulation::objects() has them.
  virtual std::span<const SceneObject> objects() const = 0;
  /// The heat of the items of this frame's draw list.
  virtual SensedHeat heat() const = 0;
  /// The scene of this frame.
  virtual SensedScene scene() const = 0;
  /// Where physics has the body at the insertion point touch other bodies; at the point of a robot's link: this link,
  /// with what fixed joints hold on it. Empty if no body of physics stands there.
  virtual std::optional<std::vector<Contact>> contacts() const = 0;
  /// What the joint carries. Empty if no robot of physics has it.
  virtual std::optional<JointLoad> joint_load() const = 0;
  /// Whether an element of type gnss_jammer reaches the sensor.
  virtual bool gnss_is_jammed() const = 0;
};

}  // namespace simvis
