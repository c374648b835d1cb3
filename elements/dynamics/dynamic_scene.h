// The bodies of a scene, and the world in which they move: what the elements `physics`, `body`, `robot` and `vehicle`
// share.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/element.h>
#include <simvis/pose.h>
#include "elements/dynamics/attachment.h"
#include "elements/dynamics/drawn_bodies.h"
#include "elements/dynamics/hand_pulls.h"
#include "elements/dynamics/world/world.h"
#include "elements/dynamics/wrench_element.h"
#include "elements/sensed_physics.h"

namespace simvis {

/// Something that an element puts into the world.
class DynamicObject {
 public:
  virtual ~DynamicObject() = default;
  /// Adds itself to the world as it stands at the start, and returns its id. `world_from_point` is the pose of its
  /// insertion point now, its own transform included; it is rigid.
  virtual std::size_t enter(DynamicsWorld& world, const glm::dmat4& world_from_point) = 0;
  /// Called before the steps of a frame, and then before each step `share` of the way through them, up to 1.
  virtual void begin_steps(DynamicsWorld& world, const glm::dmat4& world_from_point) = 0;
  virtual void before_step(DynamicsWorld& /*world*/, double /*share*/) {}
  /// The body and the links that enter() adds; valid as long as the object.
  virtual DynamicParts parts() const = 0;

  /// The link of its body that forces move and an insertion point moves with; -1: the base, or the body itself. Empty:
  /// none.
  virtual std::optional<int> link_at(std::string_view insertion_point) const {
    return insertion_point == point ? std::optional(-1) : std::nullopt;
  }
  /// The pose of an insertion point, for which link_at() returns a link, in the frame of that link.
  virtual glm::dmat4 body_from_point(std::string_view /*insertion_point*/) const { return glm::dmat4(1); }
  /// Whether an insertion point is that of its body, or of a link of it.
  virtual bool has_any(std::string_view insertion_point) const { return insertion_point == point; }
  /// Whether this insertion point belongs to that link of its body; -1: the base, or the body itself.
  virtual bool has_part(std::string_view insertion_point, int /*link*/) const { return insertion_point == point; }
  /// Returns an insertion point that moves with a link, or for -1 with the base or the body itself.
  virtual std::string point_of(int /*link*/) const { return point; }
  std::string name, point;  ///< of the element, and its insertion point
  std::string carrier{};    ///< the element `pose` of its file that places it; it stands while physics moves the body
  Location where;           ///< of its command
  struct MovedLink {
    std::string joint;     ///< the name of the element of type joint in front of it, or of a fixed joint
    std::size_t link = 0;  ///< in ArticulationDesc::links
  };
  std::vector<MovedLink> moved_links;  ///< of a robot
  std::optional<std::size_t> id;       ///< in the world; DynamicScene sets it
  bool stands = false;                 ///< nothing but a new value moves it
  bool follows_scene = false;          ///< begin_steps() needs the pose of its point in each frame
};

/// A body, or a link of one; as the default the world.
struct StandingBody {
  const DynamicObject* object = nullptr;
  int link = -1;  ///< -1: the base, or the body itself
  /// Whether forces move it.
  bool is_moved() const { return object != nullptr && object->parts().of_link(link).mass != nullptr; }
};

/// What stands at an insertion point; empty if nothing does.
std::optional<StandingBody> find_body(std::span<DynamicObject* const> objects, std::string_view insertion_point);

/// A constraint between bodies of two objects, or of one.
struct DynamicConstraint {
  const DynamicObject* a = nullptr;
  const DynamicObject* b = nullptr;  ///< null: the world, in which b_from_joint stands
  ConstraintDesc desc;               ///< its ids follow from the objects
};

/// Parts of two objects that do not collide, see WorldPart.
struct DynamicPair {
  const DynamicObject* a = nullptr;
  int part_a = 0;
  const DynamicObject* b = nullptr;
  int part_b = 0;
};

class DynamicScene {
 public:
  DynamicScene(Scene& scene, const WorldDesc& desc, std::int64_t step_ns)
      : scene_(scene), desc_(desc), step_ns_(step_ns) {}

  /// Objects enter the world at the next advance(), in the order of their names: that of their commands does not count.
  void add(DynamicObject& object) {
    objects_.push_back(&object);
    wrenches_.forget_bodies();
    advanced_to_ns_.reset();
  }
  void remove(DynamicObject& object);
  /// They hold from when all objects have entered, and go with them.
  void add(const DynamicConstraint& constraint) { new_constraints_.push_back(constraint); }
  void keep_apart(const DynamicPair& pair) { new_pairs_.push_back(pair); }

  /// The elements that push bodies, see wrench_element.h.
  WrenchElements& wrenches() { return wrenches_; }
  /// What holds bodies together, see attachment.h.
  Attachments& attachments() { return attachments_; }
  /// The body at the insertion point that an attribute names. Throws InputError at the attribute: nothing stands there.
  StandingBody require_body(const CommandAttribute& insertion_point) const;

  /// Advances by the time since the last call, in whole steps; what is left counts later. The first call makes the
  /// world, at the start; a second call with the same time does nothing. The progress of long work is reported.
  /// Throws InputError at a body's command if it cannot enter, Error if a body cannot go on.
  void advance(std::int64_t time_ns);
  void set_running(bool runs) { runs_ = runs; }  ///< false: time passes, and nothing moves
  bool is_running() const { return runs_; }
  /// From the next advance() on, everything is as at the first one.
  void restart() {
    restarts_ = true;
    advanced_to_ns_.reset();
  }

  /// Null before the first advance(), and for an object that has not entered yet.
  const DynamicsWorld* world() const { return world_.get(); }
  DynamicsWorld* world() { return world_.get(); }
  std::uint64_t steps() const { return steps_; }  ///< since the start

  /// As those of SensedPhysics.
  std::optional<std::vector<PointContact>> contacts_at(std::string_view point) const;
  void measure_loads(std::set<std::string, std::less<>> joints) { measured_ = std::move(joints); }
  std::optional<JointLoad> load_of(std::string_view joint) const;
  bool moves(std::string_view point) const;
  void follow_points(std::set<std::string, std::less<>> points);
  std::optional<StepMotion> motion_of(std::string_view point) const;
  std::vector<DrawnBody> drawn_bodies() const;
  DrawnPhysics drawn_state() const;
  void pull(std::uint64_t puller, const std::optional<BodyPull>& pull);
  void report_to(ProgressCallback progress) { progress_ = std::move(progress); }

 private:
  // A point whose motion sensors read, and its body before and after the last step.
  struct Followed {
    std::optional<WorldLink> link;  // empty: it is not in the world
    std::optional<StepMotion> last{};
  };
  void find_followed();
  void note(Followed& followed, StepMotion::At StepMotion::*when) const;
  void note_followed(StepMotion::At StepMotion::*when);
  [[noreturn]] void fail(std::size_t id);
  void make_world();
  void choose_loads();
  void enter();
  void join();
  void warn_of_overlaps();
  void begin_steps();
  void step(std::int64_t count);
  const DynamicObject* object_of(std::size_t id) const;  // null: it has been removed
  void require_still(const DynamicObject& object, std::span<const Node* const> transforms,
                     const std::map<std::string_view, const DynamicObject*>& by_name) const;

  Scene& scene_;
  WorldDesc desc_;
  std::int64_t step_ns_, last_ns_ = 0, left_ns_ = 0;
  std::optional<std::int64_t> advanced_to_ns_;  // empty: something is new since then
  std::uint64_t steps_ = 0;
  bool runs_ = true, restarts_ = false;
  ProgressCallback progress_;
  std::string failure_;  // what step() has thrown
  std::unique_ptr<DynamicsWorld> world_;
  std::vector<DynamicObject*> objects_;
  std::map<std::size_t, const DynamicObject*> entered_;  // by id
  std::vector<std::size_t> removed_;                     // ids; they leave the world at the next advance()
  // The latter are not in the world yet.
  std::vector<DynamicConstraint> constraints_, new_constraints_;
  std::vector<DynamicPair> pairs_, new_pairs_;
  WrenchElements wrenches_;
  Attachments attachments_;
  HandPulls pulls_;
  std::set<std::string, std::less<>> measured_;            // elements of type joint whose loads sensors read
  std::map<std::string, Followed, std::less<>> followed_;  // by point
};

/// Notes `dynamic` in the scene for the element of this command. Throws InputError if the scene has one already.
void declare_dynamic_scene(const ElementContext& context, std::shared_ptr<DynamicScene> dynamic);

/// The scene's own. Throws InputError at the command if no element `physics` has been made.
std::shared_ptr<DynamicScene> find_dynamic_scene(const ElementContext& context);

}  // namespace simvis
