#include "simvis/sensed_world.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_set>
#include <utility>

#include "elements/gnss_jammer.h"
#include "elements/joint.h"
#include "elements/mimic_joint.h"
#include "engine/base/assert.h"
#include "scenegraph/graph_walk.h"
#include "simvis/mount_frame.h"

namespace simvis {

namespace {

constexpr std::string_view kWorldPoint = "ROOT", kAllObjects = "*";

/// The insertion points at which the objects around a mount are inserted, the innermost one first. What is inserted at
/// a point stands in front of it in the same group.
std::vector<std::string> points_above(const Group& root, const Mount& mount) {
  std::vector<const Group*> open;
  std::vector<std::string> found;
  const auto look = [&] {
    const Node* below = &mount;
    for (auto group = open.rbegin(); group != open.rend(); below = *group++) {
      const std::vector<NodePtr>& children = (*group)->children();
      auto each = std::ranges::find(children, below, &NodePtr::get);
      for (; each != children.end(); ++each) {
        if ((*each)->kind() == NodeKind::insertion_point) found.push_back((*each)->name);
      }
    }
  };
  walk_graph(root, {.visit =
                        [&](const Node& node, const WalkState&) {
                          if (&node == &mount) look();
                          if (const auto* const group = dynamic_cast<const Group*>(&node)) open.push_back(group);
                        },
                    .leave = [&](const Group&) { open.pop_back(); }});
  return found;
}

}  // namespace

/// One sensor's view.
class SensedWorlds::World : public SensedWorld {
 public:
  World(const SensedWorlds& worlds, const Sensed& sensed) : worlds_(worlds), sensed_(sensed) {}

  Motion motion() const override {
    SIMVIS_ASSERT(sensed_.needs.motion);
    Motion motion = sensed_.poses.motion();
    if (!sensed_.stays) return motion;
    if (const auto step = worlds_.physics_->motion_of(sensed_.body); step && step->step_s > 0) {
      motion.acceleration_mps2 = step->acceleration_m_s2(*sensed_.body_m);
    }
    return motion;
  }

  glm::dvec3 velocity_mps(std::uint32_t item, const glm::dvec3& point_m) const override {
    SIMVIS_ASSERT(sensed_.needs.item_motion);
    const std::uint32_t transform = worlds_.list_->items[item].transform;
    if (transform >= sensed_.before.size() || !sensed_.before[transform]) return glm::dvec3(0);
    const double seconds = static_cast<double>(*sensed_.due_ns - *sensed_.before_ns) / 1e9;
    return matter_velocity_mps(*sensed_.before[transform], worlds_.list_->world_from_node[transform], point_m, seconds);
  }

  ItemRange items_of(std::string_view point) const override {
    const auto part = sensed_.parts.find(std::string(point));
    if (part == sensed_.parts.end()) return {};
    const Flattener::PointPlace* const place = worlds_.flattener_->find_point(*part->second.node);
    return place == nullptr ? ItemRange{} : ItemRange{place->first_item, place->end_item};
  }

  std::vector<SensedPoint> points() const override {
    std::vector<SensedPoint> found;
    for (std::uint32_t number = 0; number < sensed_.points.size(); ++number) {
      const Point& point = sensed_.points[number];
      const Flattener::PointPlace* const place = worlds_.flattener_->find_point(*point.node);
      glm::dmat4 rigid;
      if (place == nullptr || !rigid_mount_frame(worlds_.list_->world_from_node[place->transform], rigid)) continue;
      found.push_back({.name = point.name, .number = number, .world_from_point = rigid});
      if (place->transform < sensed_.paths.size()) found.back().path = sensed_.paths[place->transform];
    }
    return found;
  }

  std::vector<SensedJoint> joints() const override {
    std::vector<SensedJoint> found;
    for (const Joint& joint : sensed_.joints) {
      const Value& value = sensed_.joint_values.at(joint.leader);
      const double unit = joint.slides ? 1 : glm::radians(1.0);
      const auto& leader = dynamic_cast<const JointElement&>(*worlds_.scene_->elements[joint.leader]);
      const double speed = leader.speed().value_or(value.mean_speed());
      found.push_back({.name = worlds_.scene_->parameters.elements()[joint.element].name,
                       .slides = joint.slides,
                       .position = (joint.multiplier * value.now->value + joint.offset) * unit,
                       .velocity = joint.multiplier * speed * unit,
                       .effort = joint.element == joint.leader ? leader.effort() : std::nullopt});
    }
    return found;
  }

  std::span<const ItemMove> item_moves() const override {
    SIMVIS_ASSERT(sensed_.needs.item_moves);
    return sensed_.moves;
  }

  const MotionPath& sensor_path() const override {
    SIMVIS_ASSERT(sensed_.needs.item_moves);
    return sensed_.path;
  }

  ItemIds item_ids() const override {
    SIMVIS_ASSERT(sensed_.needs.item_ids);
    return worlds_.ids_.ids();
  }

  std::span<const SceneObject> objects() const override {
    SIMVIS_ASSERT(sensed_.needs.objects);
    return sensed_.objects;
  }

  SensedHeat heat() const override {
    SIMVIS_ASSERT(sensed_.needs.heat);
    return worlds_.heat_.heat();
  }

  SensedScene scene() const override {
    SIMVIS_ASSERT(sensed_.needs.scene);
    return {*sensed_.seen, worlds_.ids_.ids().shape};
  }

  std::optional<std::vector<Contact>> contacts() const override {
    SIMVIS_ASSERT(!sensed_.needs.contacts_of.empty());
    if (worlds_.physics_ == nullptr) return std::nullopt;
    std::optional<std::vector<PointContact>> found = worlds_.physics_->contacts_at(sensed_.needs.contacts_of);
    if (!found) return std::nullopt;
    std::vector<Contact> contacts;
    for (PointContact& each : *found) {
      each.contact.own_instance = worlds_.ids_.id_of(each.own);
      each.contact.other_instance = worlds_.ids_.id_of(each.other);
      contacts.push_back(each.contact);
    }
    return contacts;
  }

  std::optional<JointLoad> joint_load() const override {
    SIMVIS_ASSERT(!sensed_.needs.load_of.empty());
    return worlds_.physics_ == nullptr ? std::nullopt : worlds_.physics_->load_of(sensed_.needs.load_of);
  }

  bool gnss_is_jammed() const override {
    SIMVIS_ASSERT(sensed_.needs.gnss_jamming);
    glm::dmat4 world_from_sensor, world_from_jammer;
    if (worlds_.jammers_.empty() || !worlds_.flattener_->find_mount(*sensed_.mount, world_from_sensor)) return false;
    return std::ranges::any_of(worlds_.jammers_, [&](const GnssJammer* const jammer) {
      return worlds_.flattener_->find_mount(jammer->mount(), world_from_jammer) &&
             glm::distance(world_from_jammer[3], world_from_sensor[3]) < jammer->range_m();
    });
  }

 private:
  const SensedWorlds& worlds_;
  const Sensed& sensed_;
};

// The joints of the part that has the insertion point.
std::vector<SensedWorlds::Joint> SensedWorlds::joints_of(const BuiltScene& scene, const std::string& point) {
  const ObjectTree& tree = scene.scene.objects();
  std::set<std::string> points;
  if (const std::optional<std::uint32_t> object = tree.find(point); object && point != kWorldPoint) {
    for (std::string& each : tree.names_in(tree[*object].part)) points.insert(std::move(each));
  }
  std::vector<Joint> joints;
  std::map<std::string_view, std::size_t> leaders;
  const std::vector<ElementDescriptor>& elements = scene.parameters.elements();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Element* const element = scene.elements[i].get();
    const bool is_in = point == kWorldPoint || points.contains(elements[i].insertion_point);
    if (const auto* const joint = dynamic_cast<const JointElement*>(element)) {
      leaders.emplace(elements[i].name, i);
      if (is_in) joints.push_back({.element = i, .leader = i, .slides = joint->slides()});
    } else if (const auto* const mimic = dynamic_cast<const MimicJointElement*>(element); mimic != nullptr && is_in) {
      const MimicJointElement::Law& law = mimic->law();
      joints.push_back({i, leaders.at(law.leader), law.slides, law.multiplier, law.offset});
    }
  }
  return joints;
}

void SensedWorlds::follow(BuiltScene& scene, Flattener& flattener) {
  scene_ = &scene;
  flattener_ = &flattener;
  const ObjectTree& tree = scene.scene.objects();
  std::map<std::size_t, Sensed> before = std::exchange(sensed_, {});
  std::unordered_set<const Node*> watched;
  for (const BuiltSensor& sensor : scene.sensors) {
    SensorNeeds needs = sensor.sensor->needs();
    if (needs.none()) continue;
    Sensed& sensed = sensed_[sensor.id];
    std::map<std::size_t, Value> known_joints;
    if (const auto known = before.find(sensor.id); known != before.end()) {
      sensed.poses = known->second.poses;
      sensed.due_ns = known->second.due_ns;
      sensed.before_ns = known->second.before_ns;
      known_joints = std::move(known->second.joint_values);
      sensed.on = known->second.on;
      sensed.body_m = known->second.body_m;
    }
    sensed.mount = sensor.mount.get();
    for (const std::string& part : needs.parts) {
      const std::optional<std::uint32_t> object = tree.find(part);
      if (!object) {
        scene.scene.warn(sensor.command.where,
                         "sensor " + in_quotes(sensor.name) + ": " + tree.unknown("part or link", part));
        continue;
      }
      sensed.parts[part] = {tree[*object].name, &scene.scene.point_node(tree[*object].name)};
      watched.insert(sensed.parts[part].node);
    }
    std::vector<std::string> unknown;
    for (const std::uint32_t object : tree.named(needs.points, unknown)) {
      sensed.points.push_back({tree[object].name, &scene.scene.point_node(tree[object].name)});
      watched.insert(sensed.points.back().node);
    }
    for (const std::string& each : unknown) {
      if (each == kAllObjects) continue;  // a scene without parts
      scene.scene.warn(sensor.command.where,
                       "sensor " + in_quotes(sensor.name) + ": " + tree.unknown("part or link", each));
    }
    if (needs.motion) sensed.above = points_above(*scene.scene.root(), *sensor.mount);
    if (!needs.joints_of.empty()) sensed.joints = joints_of(scene, needs.joints_of);
    for (const Joint& joint : sensed.joints) sensed.joint_values[joint.leader] = known_joints[joint.leader];
    sensed.needs = std::move(needs);
    sensed.world = std::make_unique<World>(*this, sensed);
  }
  flattener.watch(std::move(watched));
  jammers_.clear();
  for (const std::unique_ptr<Element>& element : scene.elements) {
    if (const auto* const jammer = dynamic_cast<const GnssJammer*>(element.get())) jammers_.push_back(jammer);
  }
  follow_physics();
}

void SensedWorlds::follow_physics() {
  std::set<std::string, std::less<>> loads, points;
  const auto asks = [](const auto& each) {
    return each.second.needs.motion || !each.second.needs.contacts_of.empty() || !each.second.needs.load_of.empty();
  };
  if (physics_ == nullptr && std::ranges::none_of(sensed_, asks)) return;
  physics_ = find_physics(scene_->scene);
  for (auto& [id, sensed] : sensed_) {
    const auto moved = std::ranges::find_if(
        sensed.above, [&](const std::string& point) { return physics_ != nullptr && physics_->moves(point); });
    sensed.body = moved == sensed.above.end() ? "" : *moved;
    sensed.stays = false;
    if (sensed.on && !sensed.needs.load_of.empty()) loads.insert(sensed.needs.load_of);
    if (sensed.on && !sensed.body.empty()) points.insert(sensed.body);
  }
  if (physics_ == nullptr) return;
  physics_->measure_loads(std::move(loads));
  physics_->follow_points(std::move(points));
}

// Something may stand between a sensor and the body above it that moves, or the sensor in front of the body's element.
void SensedWorlds::follow_body(Sensed& sensed, const glm::dvec3& place_m) {
  constexpr double kStays_m = 1e-6;  // of products of poses in metres, rounded by 1e-13; what moves does so by more
  sensed.stays = false;
  const std::optional<StepMotion> step = sensed.body.empty() ? std::nullopt : physics_->motion_of(sensed.body);
  if (!step) return sensed.body_m.reset();
  const glm::dvec3 now(rigid_inverse(step->after.world_from_body) * glm::dvec4(place_m, 1));
  sensed.stays = sensed.body_m && glm::distance(*sensed.body_m, now) < kStays_m;
  sensed.body_m = now;
}

void SensedWorlds::update(const BuiltScene& scene, const Flattener& flattener, const DrawList& list,
                          const FrameTime& time) {
  list_ = &list;
  // Where sensors decide which frames there are, each one compares its own.
  for (auto& [id, sensed] : sensed_) {
    if (!sensed.on || time.when_due) continue;
    if (sensed.needs.motion && !sensed.needs.item_motion) follow_pose(sensed, flattener, time);
    follow_joints(sensed, scene.parameters, time);
  }
  follow_scene(flattener, list, time);
}

void SensedWorlds::follow_scene(const Flattener& flattener, const DrawList& list, const FrameTime& time) {
  bool is_needed = false;
  std::int64_t first_ns = time.time_ns;
  for (const auto& [id, sensed] : sensed_) {
    if (!sensed.on || !(sensed.needs.item_moves || sensed.needs.item_motion)) continue;
    is_needed = true;
    // Its last frame may be made again.
    first_ns = std::min(first_ns, sensed.before_ns.value_or(sensed.due_ns.value_or(first_ns)));
  }
  if (!is_needed) return scene_motion_.reset();
  if (!scene_motion_) scene_motion_.emplace();
  scene_motion_->forget_before(first_ns);
  scene_motion_->update(flattener, list, time.time_ns);
  motions_ += list.world_from_node.size();
}

void SensedWorlds::follow_pose(Sensed& sensed, const Flattener& flattener, const FrameTime& time) {
  glm::dmat4 world_from_mount, world_from_sensor;
  ++motions_;
  if (flattener.find_mount(*sensed.mount, world_from_mount) && rigid_mount_frame(world_from_mount, world_from_sensor)) {
    sensed.poses.add(time.time_ns, world_from_sensor);
    follow_body(sensed, glm::dvec3(world_from_sensor[3]));
  } else {
    sensed.poses.clear();
  }
}

void SensedWorlds::follow_joints(Sensed& sensed, const Parameters& parameters, const FrameTime& time) {
  for (auto& [joint, values] : sensed.joint_values) {
    ++motions_;
    if (values.now && values.now->time_ns < time.time_ns) values.before = values.now;
    values.now = {time.time_ns, parameters.values()[parameters.elements()[joint].first_value]};
  }
}

// A frame that is made again follows the same frame before.
void SensedWorlds::follow_moves(Sensed& sensed, const FrameTime& time) {
  if (sensed.due_ns && *sensed.due_ns < time.time_ns) sensed.before_ns = sensed.due_ns;
  sensed.due_ns = time.time_ns;
  sensed.moves.clear();
  sensed.paths.clear();
  sensed.before.clear();
  sensed.path = {};
  if (!sensed.before_ns) return;
  if (sensed.needs.item_motion) sensed.before = scene_motion_->world_from_node(*sensed.before_ns);
  if (!sensed.needs.item_moves) return;
  std::vector<std::int64_t> times_ns{*sensed.before_ns, time.time_ns};
  // Frames that other sensors decide have no part in what this one measures.
  if (!time.when_due && !sensed.needs.moves_in_one_piece) times_ns = scene_motion_->times_from(*sensed.before_ns);
  sensed.paths = scene_motion_->paths(times_ns);
  for (std::uint32_t i = 0; i < list_->items.size(); ++i) {
    const std::shared_ptr<const MotionPath>& path = sensed.paths[list_->items[i].transform];
    if (path != nullptr && list_->items[i].visible) sensed.moves.push_back({i, path});
  }
  const std::optional<std::uint32_t> mount = flattener_->transform_of(*sensed.mount);
  if (mount && sensed.paths[*mount] != nullptr) sensed.path = *sensed.paths[*mount];
}

void SensedWorlds::forget_motion(Sensed& sensed) {
  sensed.poses.clear();
  sensed.due_ns.reset();
  sensed.before_ns.reset();
}

void SensedWorlds::enable(std::size_t sensor_id, bool on) {
  const auto found = sensed_.find(sensor_id);
  if (found == sensed_.end()) return;
  found->second.on = on;
  forget_motion(found->second);
  follow_physics();
}

void SensedWorlds::hide(std::size_t sensor_id) {
  const auto found = sensed_.find(sensor_id);
  if (found != sensed_.end()) forget_motion(found->second);
}

const SensedWorld* SensedWorlds::look(std::size_t sensor_id, const DrawList& seen, const FrameTime& time) {
  const auto found = sensed_.find(sensor_id);
  if (found == sensed_.end()) return nullptr;
  Sensed& sensed = found->second;
  sensed.seen = &seen;
  if (sensed.needs.item_moves || sensed.needs.item_motion) follow_moves(sensed, time);
  // Its own motion is compared with that of items, which is the mean of the same time.
  const bool in_due_frames = time.when_due || sensed.needs.item_motion;
  if (sensed.needs.motion && in_due_frames) follow_pose(sensed, *flattener_, time);
  if (time.when_due) follow_joints(sensed, scene_->parameters, time);
  const bool needs_ids =
      sensed.needs.item_ids || sensed.needs.objects || sensed.needs.scene || !sensed.needs.contacts_of.empty();
  if (needs_ids) ids_.update(scene_->scene, *flattener_);
  if (sensed.needs.objects) sensed.objects = ids_.objects(*flattener_, *list_);
  if (sensed.needs.heat) heat_.update(scene_->scene, *flattener_);
  return sensed.world.get();
}

void SensedWorlds::archive(StateArchive& state) {
  for (auto& [id, sensed] : sensed_) {
    state(sensed.poses, sensed.body_m, sensed.stays, sensed.due_ns, sensed.before_ns);
    if (sensed.body_m) state.require(std::isfinite(glm::dot(*sensed.body_m, *sensed.body_m)));
    for (const std::optional<std::int64_t>& each : {sensed.due_ns, sensed.before_ns}) {
      if (each) state.require_past(*each);
    }
    state.require(!sensed.before_ns || (sensed.due_ns && *sensed.before_ns < *sensed.due_ns));
    for (auto& [joint, value] : sensed.joint_values) state(value);
  }
  bool is_followed = scene_motion_.has_value();
  state(is_followed);
  if (!is_followed) return scene_motion_.reset();
  if (!scene_motion_) scene_motion_.emplace();
  scene_motion_->archive(state, TransformNumbers(*scene_->scene.root()));
}

}  // namespace simvis
