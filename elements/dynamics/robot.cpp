#include "elements/dynamics/robot.h"

#include <algorithm>
#include <glm/trigonometric.hpp>
#include <iterator>
#include <limits>

#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/model_part.h"
#include "engine/base/words.h"
#include "import/model/single_tree.h"

namespace simvis {
namespace {

constexpr AttributeSpec joint_list(std::string_view name, std::string_view text) {
  return {.name = name, .kind = AttributeKind::text, .text = text};
}

constexpr std::string_view kKeptJoints = "kept_joints";

constexpr std::string_view kServoStiffness = "stiffness", kServoDamping = "damping";
constexpr double kMaxServo = 1e12;

constexpr AttributeSpec kRobotDriveRows[] = {
    {.name = "base",
     .kind = AttributeKind::choice,
     .default_value = "fixed",
     .text = "fixed: the root link stays where it stands; free: forces move it too",
     .choices = "fixed free"},
    {.name = "control",
     .kind = AttributeKind::choice,
     .default_value = "file",
     .text = "what the targets of joints are that no list names; file: what the actuators of an MJCF file say, "
             "positions for other formats",
     .choices = "file position servo velocity effort none"},
    joint_list("position_joints", "joints driven by position, separated by spaces"),
    joint_list("servo_joints", "joints driven by a spring and a damper towards their target, separated by spaces"),
    joint_list("velocity_joints", "joints driven by velocity, separated by spaces"),
    joint_list("effort_joints", "joints driven by effort, separated by spaces"),
    joint_list("free_joints", "joints without a drive, separated by spaces"),
    joint_list(kKeptJoints, "fixed joints whose load a sensor force_torque measures, separated by spaces"),
    {.name = "gain",
     .default_value = "20",
     .unit = "1/s",
     .text = "rate at which a drive by position closes the distance to its target",
     .min = 0,
     .open_min = true},
    {.name = kServoStiffness,
     .unit = "N m/rad or N/m",
     .text = "effort of a servo per distance from its target; required if there is one",
     .min = 0,
     .max = kMaxServo},
    {.name = kServoDamping,
     .default_value = "0",
     .unit = "N m s/rad or N s/m",
     .text = "effort of a servo per speed, against it",
     .min = 0,
     .max = kMaxServo},
    {.name = "max_effort",
     .unit = "N m or N",
     .text = "largest effort of each drive; default: that of the file",
     .min = 0,
     .open_min = true},
    kSrdfRow,
};

AttributeTable robot_attributes() {
  static const AttributeTable table =
      join_tables({{std::begin(kRobotDriveRows), std::end(kRobotDriveRows)}, surface_rows(), pose_rows()});
  return table;
}

const ElementRegistration kRobotRegistration({
    .name = "robot",
    .summary = "Gives the links of a URDF, SDF or MJCF part masses and collisions, and drives its joints.",
    .notes =
        "Needs an element physics before it in the scene. Each driven joint has a parameter target_JOINT: an "
        "angle or length, a velocity or an effort. A servo also has effort_JOINT, which is added to the efforts of its "
        "spring and damper. The physics writes the values of the elements joint, and the "
        "place of a free base; a value that is set puts joint or base there, at rest. Links of one robot do not "
        "collide with each other, except those of an MJCF file, and with an SRDF file those that it does not disable.",
    .attributes = robot_attributes(),
    .create = create_element<RobotElement>,
});

// Above what counts as exploded, in rad/s or m/s.
constexpr double kNoSpeedLimit = 10 * kMaxSpeed_rad_s;

struct ControlList {
  std::string_view attribute, choice;
  JointControl control;
};
constexpr ControlList kControlLists[] = {{"", "file", JointControl::file},
                                         {"position_joints", "position", JointControl::position},
                                         {"servo_joints", "servo", JointControl::servo},
                                         {"velocity_joints", "velocity", JointControl::speed},
                                         {"effort_joints", "effort", JointControl::effort},
                                         {"free_joints", "none", JointControl::none}};

std::vector<std::string> read_kept_joints(const ElementContext& context, const ModelTree& dynamics) {
  if (!context.attributes.is_set(kKeptJoints)) return {};
  std::vector<std::string_view> known;
  for (const ModelJoint& joint : dynamics.joints) {
    if (joint.kind == ModelJoint::Kind::fixed && !joint.name.empty()) known.push_back(joint.name);
  }
  const std::vector<std::string_view> kept = words_of(context.attributes.text(kKeptJoints));
  for (const std::string_view word : kept) {
    if (std::ranges::count(known, word) > 0) continue;
    fail_at(context.attributes.where(kKeptJoints),
            "there is no fixed joint " + in_quotes(word) + suggestion(word, known));
  }
  return {kept.begin(), kept.end()};
}

RobotDescription read_robot(const ElementContext& context, const ModelPart& part) {
  const ModelDescription& file = part.source.description(context.scene.pool());
  CollisionMeshes meshes(file.meshes, context.scene.pool());
  for (const std::string& warning : file.warnings) context.scene.warn(warning);
  const ModelTree model = single_tree(file);
  RobotDescription robot = describe_robot(context.scene, model,
                                          {.surface = read_robot_surface(context),
                                           .kept_joints = read_kept_joints(context, model),
                                           .base_moves = context.attributes.choice("base") == "free"},
                                          meshes);
  if (file.total_mass_kg) set_total_mass({&robot, 1}, *file.total_mass_kg);
  robot.has_drives = file.has_drives;
  set_link_contacts(read_link_contacts(context, file), robot);
  return robot;
}

ModelPart robot_part(const ElementContext& context) {
  return find_model_part(context, context.command.require("insert_at"), "a robot");
}

glm::dquat turn_of(const glm::dmat4& pose) { return glm::normalize(glm::quat_cast(glm::dmat3(pose))); }

}  // namespace

RobotElement::RobotElement(const ElementContext& context) : RobotElement(context, robot_part(context)) {}

RobotElement::RobotElement(const ElementContext& context, const ModelPart& part)
    : RobotElement(context, read_robot(context, part), part.prefix) {
  const ModelDescription& file = part.source.description(context.scene.pool());
  if (!file.constraints.empty()) {
    context.scene.warn(file.constraints.front().where,
                       "constraints between links are not taken over by an element of "
                       "type \"robot\"; one of type \"models\" has them");
  }
}

RobotElement::RobotElement(const ElementContext& context, RobotDescription robot, const std::string& prefix)
    : dynamic_(find_dynamic_scene(context)),
      transform_(std::make_shared<Transform>()),
      gain_per_s_(context.attributes.number("gain")),
      damping_(context.attributes.number(kServoDamping)),
      has_weight_(robot.has_weight),
      has_drives_(robot.has_drives),
      is_whole_part_(context.scene.has_part(context.command.require("insert_at").value)),
      prefix_(prefix) {
  name = context.command.require("name").value;
  point = context.command.require("insert_at").value;
  where = context.command.where;
  desc_ = std::move(robot.body);
  desc_.fixed_base = context.attributes.choice("base") == "fixed";
  stands = desc_.fixed_base;
  links_ = std::move(robot.links);
  for (const auto& [joint, link] : robot.kept_joints) moved_links.push_back({prefix + joint, link});
  for (RobotDescription::NamedLink& link : links_) link.name = prefix + link.name;
  // Fixed joints may make one body of several links of the file. It has the name of the one with an insertion point.
  std::stable_partition(links_.begin(), links_.end(), [&](const RobotDescription::NamedLink& link) {
    return context.scene.has_insertion_point(link.name);
  });
  if (context.attributes.is_set(kServoStiffness)) stiffness_ = context.attributes.number(kServoStiffness);
  read_joints(context, robot.joints, prefix);
  transform_->name = name;
  context.scene.insert(context.command, transform_);
  dynamic_->add(*this);
}

RobotElement::~RobotElement() {
  for (Joint& joint : joints_) {
    if (joint.driver) {
      joint.driver->value = nullptr;
      joint.driver->speed = nullptr;
      joint.driver->effort = nullptr;
    }
    if (joint.ball_driver) joint.ball_driver->value = nullptr;
  }
  dynamic_->remove(*this);
}

void RobotElement::read_joints(const ElementContext& context, const std::vector<RobotJoint>& described,
                               const std::string& prefix) {
  for (const RobotJoint& each : described) {
    Joint joint{.described = each};
    joint.to_si = each.model.kind == ModelJoint::Kind::prismatic ? 1 : glm::radians(1.0);
    joint.max_effort =
        context.attributes.is_set("max_effort") ? context.attributes.number("max_effort") : each.model.max_effort;
    joint.max_speed = each.model.max_speed > 0 ? each.model.max_speed : kNoSpeedLimit;
    read_control(context, joint);
    moved_links.push_back({prefix + each.model.name, each.link});
    joints_.push_back(std::move(joint));
  }
  for (const ControlList& list : kControlLists) {
    if (list.attribute.empty() || !context.attributes.is_set(list.attribute)) continue;
    for (const std::string_view word : words_of(context.attributes.text(list.attribute))) {
      const auto is_it = [&](const Joint& joint) {
        return joint.described.model.name == word && !joint.described.leader && !joint.is_ball();
      };
      if (std::ranges::any_of(joints_, is_it)) continue;
      std::vector<std::string_view> known;
      for (const Joint& joint : joints_) known.push_back(joint.described.model.name);
      fail_at(context.attributes.where(list.attribute),
              "there is no joint " + in_quotes(word) + suggestion(word, known) + " that could be driven by itself");
    }
  }
  for (Joint& joint : joints_) connect(context, prefix, joint);
}

void RobotElement::read_control(const ElementContext& context, Joint& joint) const {
  if (joint.described.leader || joint.is_ball()) return;
  const std::string& joint_name = joint.described.model.name;
  const ControlList* chosen = nullptr;
  for (const ControlList& list : kControlLists) {
    if (list.attribute.empty() || !context.attributes.is_set(list.attribute)) continue;
    const std::vector<std::string_view> names = words_of(context.attributes.text(list.attribute));
    if (std::ranges::count(names, joint_name) == 0) continue;
    if (chosen != nullptr) {
      fail_at(context.attributes.where(list.attribute), "joint " + in_quotes(joint_name) + " is also one of " +
                                                            in_quotes(chosen->attribute) + ", expected it in one list");
    }
    chosen = &list;
  }
  if (chosen == nullptr) {
    chosen =
        std::ranges::find(kControlLists, std::string_view(context.attributes.choice("control")), &ControlList::choice);
  }
  joint.control = chosen->control;
  if (joint.control == JointControl::file && has_drives_) {
    if (!joint.described.model.drive) joint.control = JointControl::none;
    return;
  }
  if (joint.control == JointControl::file) joint.control = JointControl::position;
  if (joint.control == JointControl::servo && !context.attributes.is_set(kServoStiffness)) {
    fail_at(context.command.where,
            "joint " + in_quotes(joint_name) + " is a servo, expected an attribute " + in_quotes(kServoStiffness));
  }
  if (joint.control == JointControl::none || joint.max_effort > 0) return;
  context.scene.warn(context.command.where, "joint " + in_quotes(joint_name) +
                                                " is not driven: its file gives no effort; \"max_effort\" sets one");
  joint.control = JointControl::none;
}

void RobotElement::connect(const ElementContext& context, const std::string& prefix, Joint& joint) {
  if (joint.is_ball()) return connect_ball(context, prefix, joint);
  if (joint.described.leader) return;
  auto* const element = dynamic_cast<JointElement*>(context.find_element(prefix + joint.described.model.name));
  if (element == nullptr) return;
  joint.driver = element->driver();
  if (joint.driver->value) {
    fail_at(context.command.where, "joint " + in_quotes(joint.described.model.name) + " is moved by another robot of " +
                                       "physics, expected one robot for a part");
  }
  joint.start = joint.driver->current * joint.to_si;
  joint.target = target_at_start(joint);
  joint.row = "target_" + joint.described.model.name;
  joint.row_text = "of the joint " + joint.described.model.name;
  joint.effort_row = "effort_" + joint.described.model.name;
  joint.effort_text = "effort that the servo of the joint " + joint.described.model.name + " adds";
  joint.row_default = format_number(is_effort(joint) ? joint.target : joint.target / joint.to_si);
  joint.driver->value = [this, link = joint.described.link, to_si = joint.to_si](std::int64_t time_ns) {
    dynamic_->advance(time_ns);
    return dynamic_->world()->joint(*this->id, link).position / to_si;
  };
  joint.driver->speed = [this, link = joint.described.link, to_si = joint.to_si]() -> std::optional<double> {
    if (!this->id) return std::nullopt;
    return dynamic_->is_running() ? dynamic_->world()->joint(*this->id, link).speed / to_si : 0;
  };
  joint.driver->effort = [this, link = joint.described.link] {
    return this->id ? dynamic_->world()->joint(*this->id, link).effort : std::numeric_limits<double>::quiet_NaN();
  };
}

void RobotElement::connect_ball(const ElementContext& context, const std::string& prefix, Joint& joint) {
  auto* const element = dynamic_cast<PoseElement*>(context.find_element(prefix + joint.described.model.name));
  if (element == nullptr) return;
  joint.ball_driver = element->driver();
  joint.ball_driver->value = [this, link = joint.described.link](std::int64_t time_ns) {
    dynamic_->advance(time_ns);
    return glm::dmat4(glm::mat4_cast(dynamic_->world()->ball(*this->id, link)));
  };
}

void RobotElement::update(ParameterView values) {
  const ParameterView place = values.first(kPoseValues);
  was_set_ = was_set_ || !std::ranges::equal(place, written_);
  std::ranges::copy(place, written_.begin());
  transform_->set_matrix(matrix_of_pose(place));
  std::size_t i = kPoseValues;
  for (Joint& joint : joints_) {
    if (!joint.driver || joint.control == JointControl::none) continue;
    joint.target = values[i++] * (is_effort(joint) ? 1 : joint.to_si);
    if (joint.control == JointControl::servo) joint.feed_forward = values[i++];
  }
}

double RobotElement::start_of(const Joint& joint) const {
  if (!joint.described.leader) return joint.start;
  const ModelJoint& model = joint.described.model;
  return model.multiplier * start_of(joints_[*joint.described.leader]) + model.offset;
}

std::size_t RobotElement::enter(DynamicsWorld& world, const glm::dmat4& world_from_point) {
  if (!entered_) {
    world_from_parent_ = world_from_point * rigid_inverse(transform_->matrix());
    desc_.world_from_base = world_from_point;
    for (Joint& joint : joints_) {
      if (joint.driver) joint.start = joint.driver->current * joint.to_si;
    }
    for (const Joint& joint : joints_) {
      LinkDesc& link = desc_.links[joint.described.link];
      if (joint.is_ball()) {
        if (joint.ball_driver) link.turn = turn_of(joint.ball_driver->current);
      } else {
        link.position = start_of(joint);
      }
    }
    entered_ = true;
  }
  was_set_ = false;
  for (Joint& joint : joints_) {
    if (joint.driver) joint.driver->was_set = false;
    if (joint.ball_driver) joint.ball_driver->was_set = false;
  }
  if (!desc_.links.empty() || is_articulation_) return world.add_articulation(desc_);
  return world.add_body({.kind = desc_.fixed_base ? BodyKind::fixed : BodyKind::dynamic,
                         .world_from_body = desc_.world_from_base,
                         .mass = desc_.mass,
                         .shapes = desc_.shapes,
                         .surface = desc_.surface,
                         .has_weight = has_weight_});
}

const RobotDescription::NamedLink* RobotElement::find_link(const std::string& name_in_file) const {
  const auto named = std::ranges::find(links_, prefix_ + name_in_file, &RobotDescription::NamedLink::name);
  return named == links_.end() ? nullptr : &*named;
}

std::optional<int> RobotElement::link_at(std::string_view insertion_point) const {
  const auto named = std::ranges::find(links_, insertion_point, &RobotDescription::NamedLink::name);
  return named == links_.end() ? DynamicObject::link_at(insertion_point) : std::optional(named->link);
}

glm::dmat4 RobotElement::body_from_point(std::string_view insertion_point) const {
  const auto named = std::ranges::find(links_, insertion_point, &RobotDescription::NamedLink::name);
  return named == links_.end() ? glm::dmat4(1) : named->link_from_part;
}

bool RobotElement::has_any(std::string_view insertion_point) const {
  return (is_whole_part_ && insertion_point == point) ||
         std::ranges::find(links_, insertion_point, &RobotDescription::NamedLink::name) != links_.end();
}

bool RobotElement::has_part(std::string_view insertion_point, int link) const {
  if (is_whole_part_ && insertion_point == point) return true;
  const auto named = std::ranges::find(links_, insertion_point, &RobotDescription::NamedLink::name);
  return named != links_.end() && named->link == link;
}

void RobotElement::begin_steps(DynamicsWorld& world, const glm::dmat4& /*world_from_point*/) {
  if (was_set_) world.move(*id, world_from_parent_ * transform_->matrix());
  was_set_ = false;
  for (Joint& joint : joints_) {
    if (joint.ball_driver && joint.ball_driver->was_set) {
      world.place_ball(*id, joint.described.link, turn_of(joint.ball_driver->current));
      joint.ball_driver->was_set = false;
    }
    if (!joint.driver || !joint.driver->was_set) continue;
    world.place_joint(*id, joint.described.link, joint.driver->current * joint.to_si);
    joint.driver->was_set = false;
  }
}

JointDrive RobotElement::drive_of_file(const Joint& joint) {
  const double friction = joint.described.model.friction;
  const ModelDrive& drive = *joint.described.model.drive;
  switch (drive.kind) {
    case ModelDrive::Kind::position:
      return {.kind = JointDrive::Kind::servo,
              .target = joint.target,
              .max_effort = drive.max_effort,
              .min_effort = drive.min_effort,
              .stiffness = drive.gain,
              .damping = drive.damping,
              .friction = friction};
    case ModelDrive::Kind::velocity:
      return {.kind = JointDrive::Kind::servo,
              .max_effort = drive.max_effort,
              .min_effort = drive.min_effort,
              .damping = drive.gain,
              .target_speed = joint.target,
              .friction = friction};
    case ModelDrive::Kind::effort:
      break;
  }
  return {.kind = JointDrive::Kind::effort,
          .target = std::clamp(drive.gain * joint.target, drive.min_effort, drive.max_effort),
          .friction = friction};
}

JointDrive RobotElement::drive_of(const DynamicsWorld& world, const Joint& joint) const {
  if (joint.described.leader && !joint.described.model.is_coupled) {
    const ModelJoint& model = joint.described.model;
    const JointState leader = world.joint(*id, joints_[*joint.described.leader].described.link);
    return {.kind = JointDrive::Kind::position,
            .target = model.multiplier * leader.position + model.offset,
            .max_effort = joint.max_effort > 0 ? joint.max_effort : joints_[*joint.described.leader].max_effort,
            .target_speed = model.multiplier * leader.speed,
            .gain_per_s = gain_per_s_,
            .max_speed = kNoSpeedLimit};
  }
  switch (joint.control) {
    case JointControl::position:
      return {.kind = JointDrive::Kind::position,
              .target = joint.target,
              .max_effort = joint.max_effort,
              .gain_per_s = gain_per_s_,
              .max_speed = joint.max_speed};
    case JointControl::servo:
      return {.kind = JointDrive::Kind::servo,
              .target = joint.target,
              .max_effort = joint.max_effort,
              .stiffness = stiffness_,
              .damping = damping_,
              .feed_forward = joint.feed_forward,
              .friction = joint.described.model.friction};
    case JointControl::speed:
      return {JointDrive::Kind::speed, joint.target, joint.max_effort};
    case JointControl::effort:
      return {JointDrive::Kind::effort, joint.target, joint.max_effort};
    case JointControl::file:
      return drive_of_file(joint);
    case JointControl::none:
      break;
  }
  return {.friction = joint.described.model.friction};
}

void RobotElement::before_step(DynamicsWorld& world, double /*share*/) {
  for (const Joint& joint : joints_) {
    if (!joint.is_ball()) world.drive(*id, joint.described.link, drive_of(world, joint));
  }
}

void RobotElement::advance(std::int64_t time_ns, std::span<double> values) {
  dynamic_->advance(time_ns);
  if (!id || was_set_) return;
  write_pose(rigid_inverse(world_from_parent_) * dynamic_->world()->state(*id).world_from_body, values);
  std::ranges::copy(values.first(kPoseValues), written_.begin());
}

// Where joints started counts again after a restart. The elements that show them may come before the physics, which
// makes the robot enter, so that their flags are set here too.
void RobotElement::archive(StateArchive& state) {
  state(desc_.world_from_base, entered_, was_set_, world_from_parent_, written_);
  for (LinkDesc& link : desc_.links) state(link.position, link.turn);
  for (Joint& joint : joints_) {
    state(joint.start);
    if (joint.driver) state(joint.driver->was_set);
    if (joint.ball_driver) state(joint.ball_driver->was_set);
  }
}

}  // namespace simvis
