#include "elements/dynamics/dynamic_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/pose.h>
#include "elements/dynamics/world/engine_module.h"
#include "engine/base/assert.h"
#include "engine/base/decimal.h"
#include "scenegraph/graph_walk.h"

namespace simvis {
namespace {

// The rounding of a chain of poses; a scale that matters is larger.
constexpr double kRigid = 1e-6;

// Bodies that stand on each other may overlap by this: people place them to the centimetre.
constexpr double kMaxOverlap_m = 0.01;

// A group in the world that notes the scene's physics. It has the name of the element.
class PhysicsMark : public SensedPhysics {
 public:
  explicit PhysicsMark(std::shared_ptr<DynamicScene> dynamic) : dynamic_(std::move(dynamic)) {}
  const std::shared_ptr<DynamicScene>& dynamic() const { return dynamic_; }
  std::optional<std::vector<PointContact>> contacts_at(std::string_view point) const override {
    return dynamic_->contacts_at(point);
  }
  void measure_loads(std::set<std::string, std::less<>> joints) override { dynamic_->measure_loads(std::move(joints)); }
  std::optional<JointLoad> load_of(std::string_view joint) const override { return dynamic_->load_of(joint); }
  bool moves(std::string_view point) const override { return dynamic_->moves(point); }
  void follow_points(std::set<std::string, std::less<>> points) override { dynamic_->follow_points(std::move(points)); }
  std::optional<StepMotion> motion_of(std::string_view point) const override { return dynamic_->motion_of(point); }
  std::optional<StepMotion::At> state_of(std::string_view point) const override { return dynamic_->state_of(point); }
  std::vector<DrawnBody> drawn_bodies() const override { return dynamic_->drawn_bodies(); }
  DrawnPhysics drawn_state() const override { return dynamic_->drawn_state(); }
  void pull(std::uint64_t puller, const std::optional<BodyPull>& pull) override { dynamic_->pull(puller, pull); }
  void report_to(ProgressCallback progress) override { dynamic_->report_to(std::move(progress)); }

 private:
  std::shared_ptr<DynamicScene> dynamic_;
};

std::shared_ptr<const PhysicsMark> find_mark(const Scene& scene) {
  for (const NodePtr& child : scene.root()->children()) {
    if (const auto mark = std::dynamic_pointer_cast<const PhysicsMark>(child)) return mark;
  }
  return nullptr;
}

// The insertion points of a scene as it stands, from one walk.
class PointPlaces {
 public:
  PointPlaces() = default;
  explicit PointPlaces(const Scene& scene) {
    std::size_t now = kNone;
    std::vector<std::size_t> saved;
    walk_graph(*scene.root(), {.visit =
                                   [&](const Node& node, const WalkState& state) {
                                     if (node.kind() == NodeKind::transform) {
                                       transforms_.push_back({&node, now});
                                       now = transforms_.size() - 1;
                                     }
                                     if (node.kind() == NodeKind::insertion_point) {
                                       places_.emplace(node.name, Place{state.world_from_node, now});
                                     }
                                     if (saves(node)) saved.push_back(now);
                                   },
                               .leave =
                                   [&](const Group& group) {
                                     if (!saves(group)) return;
                                     now = saved.back();
                                     saved.pop_back();
                                   }});
  }

  const glm::dmat4& pose_at(const DynamicObject& object) const {
    const auto found = places_.find(object.point);
    if (found == places_.end()) {
      fail_at(object.where, "element " + in_quotes(object.name) + " stands in a part that is switched off, where " +
                                "nothing can move, expected it in one that is on");
    }
    if (!is_rigid(found->second.world_from_point, kRigid)) {
      fail_at(object.where, "element " + in_quotes(object.name) +
                                " stands where an element scales its part, expected the part's own attribute "
                                "\"scale\"");
    }
    return found->second.world_from_point;
  }

  /// The transforms that apply at a point, outermost first.
  std::vector<const Node*> transforms_at(const std::string& point) const {
    std::vector<const Node*> transforms;
    const auto found = places_.find(point);
    if (found == places_.end()) return transforms;
    for (std::size_t i = found->second.transform; i != kNone; i = transforms_[i].before) {
      transforms.push_back(transforms_[i].node);
    }
    std::ranges::reverse(transforms);
    return transforms;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  static bool saves(const Node& node) { return node.kind() == NodeKind::separator || node.kind() == NodeKind::visual; }
  struct Place {
    glm::dmat4 world_from_point;
    std::size_t transform;  // the innermost one
  };
  struct AppliedTransform {
    const Node* node;
    std::size_t before;  // the next outer one
  };
  std::map<std::string, Place, std::less<>> places_;
  std::vector<AppliedTransform> transforms_;
};

}  // namespace

void declare_dynamic_scene(const ElementContext& context, std::shared_ptr<DynamicScene> dynamic) {
  if (const auto other = find_mark(context.scene)) {
    fail_at(context.command.where, "the scene has physics already, by element " + in_quotes(other->name) +
                                       ", expected one element of type \"physics\"");
  }
  const auto mark = std::make_shared<PhysicsMark>(std::move(dynamic));
  mark->name = context.command.require("name").value;
  context.scene.insert_in_world(context.command, mark);
}

std::shared_ptr<DynamicScene> find_dynamic_scene(const ElementContext& context) {
  const auto mark = find_mark(context.scene);
  if (mark == nullptr) {
    fail_at(context.command.where, "the scene has no physics yet, expected an element of type \"physics\" before " +
                                       in_quotes(context.command.require("name").value));
  }
  return mark->dynamic();
}

void DynamicScene::remove(DynamicObject& object) {
  if (object.id) {
    removed_.push_back(*object.id);
    pulls_.remove_body(*object.id);
    entered_.erase(*object.id);
  }
  std::erase(objects_, &object);
  wrenches_.forget_bodies();
  attachments_.forget_bodies();
  const auto has_it = [&](const auto& each) { return each.a == &object || each.b == &object; };
  for (auto* const list : {&constraints_, &new_constraints_}) std::erase_if(*list, has_it);
  for (auto* const list : {&pairs_, &new_pairs_}) std::erase_if(*list, has_it);
}

void DynamicScene::advance(std::int64_t time_ns) {
  if (!failure_.empty()) throw Error(failure_);
  if (advanced_to_ns_ == time_ns) return;
  if (world_ == nullptr || restarts_) {
    make_world();
    last_ns_ = time_ns;
  }
  leave();
  enter();
  if (runs_) left_ns_ += std::max<std::int64_t>(time_ns - last_ns_, 0);
  last_ns_ = time_ns;
  if (runs_) {
    begin_steps();
    step(left_ns_ / step_ns_);
  }
  advanced_to_ns_ = time_ns;
}

void DynamicScene::leave() {
  for (const std::size_t id : std::exchange(removed_, {})) world_->remove(id);
}

void DynamicScene::make_world() {
  forget_world();
  world_ = dynamics_engine().make_world(desc_);
}

void DynamicScene::forget_world() {
  world_.reset();
  for (DynamicObject* const object : objects_) object->id.reset();
  new_constraints_.insert(new_constraints_.begin(), constraints_.begin(), constraints_.end());
  new_pairs_.insert(new_pairs_.begin(), pairs_.begin(), pairs_.end());
  constraints_.clear();
  pairs_.clear();
  wrenches_.restart();
  attachments_.restart();
  pulls_.clear();
  for (auto& [point, followed] : followed_) followed.last.reset();
  removed_.clear();
  entered_.clear();
  left_ns_ = 0;
  steps_ = 0;
  restarts_ = false;
}

void DynamicScene::enter() {
  if (std::ranges::all_of(objects_, [](const DynamicObject* object) { return object->id.has_value(); })) return;
  const PointPlaces places(scene_);
  std::map<std::string_view, const DynamicObject*> by_name;
  for (const DynamicObject* const object : objects_) by_name.emplace(object->name, object);
  std::vector<DynamicObject*> entering;
  std::ranges::copy_if(objects_, std::back_inserter(entering), [](const auto* object) { return !object->id; });
  std::ranges::sort(entering, {}, [](const DynamicObject* object) { return object->name; });
  for (DynamicObject* const object : entering) {
    if (!object->follows_scene) require_still(*object, places.transforms_at(object->point), by_name);
    object->id = object->enter(*world_, places.pose_at(*object));
    entered_.emplace(*object->id, object);
  }
  join();
  if (steps_ == 0) warn_of_overlaps();
}

void DynamicScene::join() {
  for (DynamicConstraint& each : new_constraints_) {
    each.desc.a.id = *each.a->id;
    if (each.b != nullptr) each.desc.b->id = *each.b->id;
    world_->add_constraint(each.desc);
    constraints_.push_back(each);
  }
  new_constraints_.clear();
  for (const DynamicPair& each : new_pairs_) {
    world_->keep_apart({*each.a->id, each.part_a}, {*each.b->id, each.part_b});
    pairs_.push_back(each);
  }
  new_pairs_.clear();
}

// Bodies that overlap at the start are thrown apart.
void DynamicScene::warn_of_overlaps() {
  for (const WorldContact& contact : world_->touching()) {
    if (contact.depth_m < kMaxOverlap_m) continue;
    const DynamicObject &a = *object_of(contact.body_a), &b = *object_of(contact.body_b);
    const std::string who = &a == &b ? "two links of element " + in_quotes(a.name)
                                     : "elements " + in_quotes(a.name) + " and " + in_quotes(b.name);
    scene_.warn(a.where, who + " overlap at the start, expected bodies apart from each other");
  }
  scene_.undo().commit();
}

const DynamicObject* DynamicScene::object_of(std::size_t id) const {
  const auto found = entered_.find(id);
  return found == entered_.end() ? nullptr : found->second;
}

// What moves by forces stands where no other element moves it.
void DynamicScene::require_still(const DynamicObject& object, std::span<const Node* const> transforms,
                                 const std::map<std::string_view, const DynamicObject*>& by_name) const {
  for (const Node* const transform : transforms) {
    if (transform->name == object.name || transform->name == object.carrier ||
        scene_.find_node(transform->name).get() != transform)
      continue;
    const auto other = by_name.find(transform->name);
    if (other != by_name.end() && other->second->stands) continue;
    fail_at(object.where, "element " + in_quotes(object.name) + " and element " + in_quotes(transform->name) +
                              " both move " + in_quotes(object.point) + ", expected one of them, or the place of the " +
                              "part in its attribute \"pose_offset\"");
  }
}

void DynamicScene::choose_loads() {
  for (const DynamicObject* const object : objects_) {
    for (const DynamicObject::MovedLink& each : object->moved_links) {
      world_->measure_load(*object->id, each.link, measured_.contains(each.joint));
    }
  }
}

std::optional<JointLoad> DynamicScene::load_of(std::string_view joint) const {
  for (const DynamicObject* const object : objects_) {
    const auto found = std::ranges::find(object->moved_links, joint, &DynamicObject::MovedLink::joint);
    if (found == object->moved_links.end()) continue;
    const LinkLoad load = object->id ? world_->load(*object->id, found->link) : LinkLoad();
    return JointLoad{.point_m = load.origin_m, .force_n = load.force_n, .torque_nm = load.torque_nm};
  }
  return std::nullopt;
}

bool DynamicScene::moves(std::string_view point) const {
  return std::ranges::any_of(objects_, [&](const DynamicObject* object) { return object->link_at(point).has_value(); });
}

void DynamicScene::follow_points(std::set<std::string, std::less<>> points) {
  std::erase_if(followed_, [&](const auto& each) { return !points.contains(each.first); });
  for (const std::string& point : points) followed_.try_emplace(point);
}

std::optional<StepMotion> DynamicScene::motion_of(std::string_view point) const {
  const auto found = followed_.find(point);
  return found == followed_.end() ? std::nullopt : found->second.last;
}

// Objects come and go between frames.
void DynamicScene::find_followed() {
  for (auto& [point, followed] : followed_) {
    followed.link.reset();
    for (const DynamicObject* const object : objects_) {
      if (const std::optional<int> link = object->link_at(point)) followed.link = WorldLink{*object->id, *link};
    }
    if (!followed.link) {
      followed.last.reset();
    } else if (!followed.last) {
      followed.last.emplace();
      followed.last->after = state_at(*followed.link);
    }
  }
}

StepMotion::At DynamicScene::state_at(const WorldLink& link) const {
  const BodyState state = world_->state(link);
  return {state.world_from_body, state.center_m, state.velocity_m_s, state.angular_velocity_rad_s};
}

std::optional<StepMotion::At> DynamicScene::state_of(std::string_view point) const {
  if (world_ == nullptr) return std::nullopt;
  for (const DynamicObject* const object : objects_) {
    const std::optional<int> link = object->id ? object->link_at(point) : std::nullopt;
    if (link) return state_at({*object->id, *link});
  }
  return std::nullopt;
}

std::optional<std::vector<PointContact>> DynamicScene::contacts_at(std::string_view point) const {
  const auto has = [&](const DynamicObject& object) { return object.has_any(point); };
  if (std::ranges::none_of(objects_, [&](const DynamicObject* object) { return has(*object); })) return std::nullopt;
  const auto is_at = [&](std::size_t id, int link) {
    const DynamicObject* const object = object_of(id);
    return object != nullptr && object->has_part(point, link);
  };
  const auto point_of = [&](std::size_t id, int link) {
    const DynamicObject* const object = object_of(id);
    return object == nullptr ? std::string() : object->point_of(link);
  };
  std::vector<PointContact> contacts;
  for (const WorldContact& each : world_ == nullptr ? std::vector<WorldContact>() : world_->contacts()) {
    const bool is_a = is_at(each.body_a, each.link_a), is_b = is_at(each.body_b, each.link_b);
    if (is_a == is_b) continue;
    std::string own = point_of(each.body_a, each.link_a), other = point_of(each.body_b, each.link_b);
    if (is_b) std::swap(own, other);
    contacts.push_back({.contact = {.point_m = each.point_m,
                                    .normal = is_a ? each.normal : -each.normal,
                                    .depth_m = each.depth_m,
                                    .force_n = each.force_n},
                        .own = std::move(own),
                        .other = std::move(other)});
  }
  return contacts;
}

// Objects that have not entered the world have no pose and are left out.
std::vector<DrawnBody> DynamicScene::drawn_bodies() const {
  std::vector<DrawnBody> bodies;
  for (const DynamicObject* const object : objects_) {
    if (!object->id) continue;
    append_drawn_bodies(
        object->name, object->parts(), [object](int link) { return object->point_of(link); }, bodies);
  }
  return bodies;
}

DrawnPhysics DynamicScene::drawn_state() const {
  DrawnPhysics drawn;
  if (world_ == nullptr) return drawn;
  std::map<WorldLink, std::size_t> numbers;
  for (const DynamicObject* const object : objects_) {
    if (!object->id) continue;
    const int links = static_cast<int>(object->parts().links.size());
    for (int link = -1; link < links; ++link) {
      const WorldLink place{*object->id, link};
      numbers.emplace(place, drawn.world_from_body.size());
      drawn.world_from_body.push_back(world_->state(place).world_from_body);
    }
  }
  const auto number_of = [&](std::size_t id, int link) {
    const auto found = numbers.find({id, link});
    return found == numbers.end() ? std::nullopt : std::optional(found->second);
  };
  for (const WorldContact& each : world_->contacts()) {
    drawn.contacts.push_back(
        {.contact = {.point_m = each.point_m, .normal = each.normal, .depth_m = each.depth_m, .force_n = each.force_n},
         .a = number_of(each.body_a, each.link_a),
         .b = number_of(each.body_b, each.link_b)});
  }
  return drawn;
}

void DynamicScene::pull(std::uint64_t puller, const std::optional<BodyPull>& pull) {
  if (world_ == nullptr) throw InputError("the bodies have not been put into the world yet");
  if (!pull) return pulls_.release(puller);
  std::size_t first = 0;
  for (const DynamicObject* const object : objects_) {
    if (!object->id) continue;
    const DynamicParts parts = object->parts();
    const std::size_t place = pull->body - first;  // 0: the body or the base; then the links
    first += 1 + parts.links.size();
    if (place > parts.links.size()) continue;
    const int link = static_cast<int>(place) - 1;
    if (parts.of_link(link).mass == nullptr) throw InputError("no force moves " + in_quotes(object->point_of(link)));
    return pulls_.set(puller, {*object->id, link}, parts, *pull);
  }
  throw InputError("there is no body " + std::to_string(pull->body));
}

StandingBody DynamicScene::require_body(const CommandAttribute& insertion_point) const {
  if (const auto body = find_body(objects_, insertion_point.value)) return *body;
  fail_at(insertion_point.where,
          "no body stands at " + in_quotes(insertion_point.value) +
              ", expected the insertion point of an earlier element body, robot or vehicle, or of a robot's link");
}

void DynamicScene::begin_steps() {
  choose_loads();
  find_followed();
  wrenches_.find_bodies(objects_);
  const bool follows = std::ranges::any_of(objects_, [](const DynamicObject* object) { return object->follows_scene; });
  const PointPlaces places = follows ? PointPlaces(scene_) : PointPlaces();
  for (DynamicObject* const object : objects_) {
    object->begin_steps(*world_, object->follows_scene ? places.pose_at(*object) : glm::dmat4(1));
  }
  attachments_.act(*world_, objects_);
}

// If the report of progress throws, the steps that are left follow at the next advance().
void DynamicScene::step(std::int64_t count) {
  constexpr std::int64_t kReportedSteps = 100;
  for (std::int64_t i = 1; i <= count; ++i) {
    if (progress_ && i % kReportedSteps == 0) {
      progress_({"physics", static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(count)});
    }
    const double share = static_cast<double>(i) / static_cast<double>(count);
    for (DynamicObject* const object : objects_) object->before_step(*world_, share);
    wrenches_.act(*world_, {static_cast<double>(steps_) * desc_.step_s, desc_.step_s, desc_.gravity_m_s2});
    pulls_.act(*world_);
    if (i == count) note_followed(&StepMotion::before);
    const std::optional<std::size_t> failed = world_->step();
    ++steps_;
    left_ns_ -= step_ns_;
    if (failed) fail(*failed);
    if (i == count) note_followed(&StepMotion::after);
  }
}

void DynamicScene::note_followed(StepMotion::At StepMotion::*when) {
  for (auto& [point, followed] : followed_) {
    if (!followed.link) continue;
    (*followed.last).*when = state_at(*followed.link);
    followed.last->step_s = desc_.step_s;
  }
}

void DynamicScene::fail(std::size_t id) {
  const DynamicObject& object = *object_of(id);
  failure_ = to_string(object.where) + ": error: element " + in_quotes(object.name) + " has exploded at " +
             decimal(static_cast<double>(steps_) * desc_.step_s, 6) + " s of physics: its speed is above " +
             decimal(kMaxSpeed_m_s, 6) + " m/s or " + decimal(kMaxSpeed_rad_s, 6) +
             " rad/s, expected a shorter step, softer drives or bodies that do not overlap at the start";
  throw Error(failure_);
}

}  // namespace simvis
