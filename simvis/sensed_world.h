// What sensors may know about the scene besides their pose and the draw list. Only what a sensor needs is computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/frame_time.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "elements/sensed_physics.h"
#include "scenegraph/flattener.h"
#include "scenegraph/motion.h"
#include "scenegraph/scene_motion.h"
#include "simvis/item_heat_table.h"
#include "simvis/object_ids.h"
#include "simvis/scene_builder.h"

namespace simvis {

class GnssJammer;

/// The world as all sensors of a simulation see it, and its motion from frame to frame.
class SensedWorlds {
 public:
  /// Follows a change of the scene, and warns of parts that sensors name and that are not there. It is called before
  /// the flattener's next update(). The scene and the flattener must outlive this object.
  void follow(BuiltScene& scene, Flattener& flattener);

  /// Follows the flattener's update() in each frame that anything is needed in, skipped ones too. `list` is its result.
  void update(const BuiltScene& scene, const Flattener& flattener, const DrawList& list, const FrameTime& time);

  /// Nothing is computed for a sensor that is off. It is on at first.
  void enable(std::size_t sensor_id, bool on);

  /// Forgets the motion of a sensor that is due in a frame in which it is not in the scene. When it is there again, its
  /// motion begins anew.
  void hide(std::size_t sensor_id);

  /// The world as the sensor of this id sees it, which is due in the frame of the last update(), skipped or not; null
  /// if it needs nothing. `seen` is the list of that update() as the sensor sees it, see IgnoredItems.
  const SensedWorld* look(std::size_t sensor_id, const DrawList& seen, const FrameTime& time);

  /// The ids of the items of the flattener's last update(). Valid until the next call, or look().
  ObjectIds& object_ids(const Scene& scene, const Flattener& flattener) {
    ids_.update(scene, flattener);
    return ids_;
  }

  /// The poses, items and joints that the next frame is compared with. Sensors are on that are on in the state.
  void archive(StateArchive& state);

  /// Poses, items and joints compared with their previous frame, since the simulation was made.
  std::uint64_t motions() const { return motions_; }

 private:
  class World;
  struct Value {
    struct At {
      std::int64_t time_ns = 0;
      double value = 0;
      void archive(StateArchive& state) {
        state(time_ns);
        state.finite(value);
        state.require_past(time_ns);
      }
    };
    std::optional<At> now, before;
    void archive(StateArchive& state) {
      state(now, before);
      state.require(!before || (now && before->time_ns < now->time_ns));
    }
    double mean_speed() const {
      return before ? (now->value - before->value) * 1e9 / static_cast<double>(now->time_ns - before->time_ns) : 0;
    }
  };
  struct Point {
    std::string name;
    const InsertionPoint* node;
  };
  // Its value is multiplier * that of the leader + offset; a joint that follows no other one leads itself. Indices in
  // Parameters::elements().
  struct Joint {
    std::size_t element, leader;
    bool slides = false;
    double multiplier = 1, offset = 0;
  };
  static std::vector<Joint> joints_of(const BuiltScene& scene, const std::string& point);
  // Of one sensor.
  struct Sensed {
    SensorNeeds needs;
    const Mount* mount = nullptr;
    bool on = true;
    PoseHistory poses;
    std::vector<std::string> above;    // insertion points above the sensor, the nearest one first
    std::string body;                  // the first of them that physics moves; empty: none
    std::optional<glm::dvec3> body_m;  // the sensor's place in that body
    bool stays = false;                // there since the last frame
    std::vector<Point> points;         // that match the pattern
    std::vector<Joint> joints;
    std::map<std::size_t, Value> joint_values;             // of leaders, by index in Parameters::elements()
    std::map<std::string, Point> parts;                    // by name
    std::optional<std::int64_t> due_ns, before_ns;         // the last frames in which it was due
    std::vector<std::shared_ptr<const MotionPath>> paths;  // by transform, since before_ns
    std::vector<std::optional<glm::dmat4>> before;         // by transform, at before_ns
    std::vector<ItemMove> moves;
    MotionPath path;
    const DrawList* seen = nullptr;        // of the last look()
    std::span<const SceneObject> objects;  // of the frame
    std::unique_ptr<SensedWorld> world;
  };
  void follow_physics();
  void follow_pose(Sensed& sensed, const Flattener& flattener, const FrameTime& time);
  void follow_body(Sensed& sensed, const glm::dvec3& place_m);
  static void forget_motion(Sensed& sensed);
  void follow_joints(Sensed& sensed, const Parameters& parameters, const FrameTime& time);
  void follow_scene(const Flattener& flattener, const DrawList& list, const FrameTime& time);
  void follow_moves(Sensed& sensed, const FrameTime& time);

  std::map<std::size_t, Sensed> sensed_;     // by BuiltSensor::id
  std::vector<const GnssJammer*> jammers_;   // of the scene
  std::optional<SceneMotion> scene_motion_;  // empty unless a sensor that is on needs it
  ObjectIds ids_;
  ItemHeatTable heat_;
  std::shared_ptr<SensedPhysics> physics_;  // null without a sensor that asks for it
  const BuiltScene* scene_ = nullptr;
  const Flattener* flattener_ = nullptr;
  const DrawList* list_ = nullptr;
  std::uint64_t motions_ = 0;
};

}  // namespace simvis
