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
#include "elements/dynamics/attachments.h"
#include "elements/dynamics/dynamic_object.h"
#include "elements/dynamics/hand_pulls.h"
#include "elements/dynamics/world/world.h"
#include "elements/dynamics/wrench_sources.h"
#include "elements/sensed_physics.h"

namespace simvis {

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
    attachments_.forget_bodies();
    advanced_to_ns_.reset();
  }
  void remove(DynamicObject& object);
  /// They hold from when all objects have entered, and go with them.
  void add(const DynamicConstraint& constraint) { new_constraints_.push_back(constraint); }
  void keep_apart(const DynamicPair& pair) { new_pairs_.push_back(pair); }

  /// What pushes bodies, see wrench_sources.h.
  WrenchSources& wrenches() { return wrenches_; }
  /// What holds bodies together, see attachments.h.
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

  /// Writes the state between two frames, or replaces it by that of a scene with the same objects. Pulls end when it is
  /// read. Throws InputError.
  void archive(StateArchive& state);

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
  std::optional<StepMotion::At> state_of(std::string_view point) const;
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
  StepMotion::At state_at(const WorldLink& link) const;
  void note_followed(StepMotion::At StepMotion::*when);
  [[noreturn]] void fail(std::size_t id);
  void make_world();
  void forget_world();
  void leave();
  void choose_loads();
  void enter();
  void join();
  void archive_objects(StateArchive& state);
  void make_world_as(StateArchive& state, const std::vector<std::optional<std::size_t>>& ids, std::size_t constraints,
                     std::size_t pairs);
  void archive_followed(StateArchive& state);
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
  WrenchSources wrenches_;
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
